//! `cede-attack sharp`.

use super::count;
use cede_attack::mutants::{self, Mutant};
use clap::Args as ClapArgs;

/// Shows that the attacker is sharp: shields with one broken rule each are caught.
#[derive(ClapArgs)]
pub(crate) struct Args {
    /// Scenarios of each family in which a broken shield has to be caught.
    #[arg(long, default_value = "4096", value_parser = count)]
    scenarios: u64,
    /// Only rules whose names contain this.
    #[arg(long, default_value = "")]
    rule: String,
    /// Seed of the first scenario.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

impl Args {
    pub(crate) fn run(self) -> bool {
        let mut sharp = true;
        let chosen = |mutant: &&Mutant| mutant.name.contains(&self.rule);
        for mutant in mutants::ALL.iter().filter(chosen) {
            let caught = mutant.hunt(self.seed, self.scenarios);
            match &caught {
                Some(caught) => println!("{:28} {caught}", mutant.name),
                None => println!("{:28} NOT CAUGHT", mutant.name),
            }
            sharp &= caught.is_some();
        }
        sharp
    }
}
