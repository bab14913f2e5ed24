//! `cede-attack replay`.

use super::family;
use cede_attack::scenario::Family;
use cede_controller::dangerous::Sound;
use clap::Args as ClapArgs;

/// Plays one scenario again.
#[derive(ClapArgs)]
pub(crate) struct Args {
    /// The family.
    #[arg(value_parser = family)]
    family: &'static Family,
    /// The scenario's seed.
    seed: u64,
    /// Prints the scenario and every decision.
    #[arg(long)]
    trace: bool,
}

impl Args {
    pub(crate) fn run(self) -> bool {
        if self.trace {
            self.family.describe(self.seed);
        }
        let outcome = self.family.run::<Sound>(self.seed, self.trace);
        println!("{outcome:#?}");
        !(outcome.verified && outcome.is_bad())
    }
}
