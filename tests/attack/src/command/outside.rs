//! `cede-attack outside`.

use super::count;
use cede_attack::outside;
use clap::Args as ClapArgs;

/// Just outside of the contract: how often it ends in an overlap, beside a plain rule. Only reports.
#[derive(ClapArgs)]
pub(crate) struct Args {
    /// Encounters for each row.
    #[arg(long, default_value = "600", value_parser = count)]
    encounters: u64,
    /// Seed of the first encounter.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Prints the table as JSON.
    #[arg(long)]
    json: bool,
}

impl Args {
    pub(crate) fn run(self) -> bool {
        let table = outside::table(self.seed, self.encounters);
        if self.json {
            println!("{}", outside::json(&table));
        } else {
            print!("{}", outside::markdown(&table));
        }
        true
    }
}
