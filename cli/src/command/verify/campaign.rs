//! `cede verify campaign`: shielded vehicles among adversaries that keep the contract.

use crate::failure::Failure;
use cede_controller::dangerous::Sound;
use cede_sim::campaign::{Setup, Tally, campaign};
use clap::Args;

/// The text below the options in `cede help verify campaign`.
const HELP: &str = "\
Drives shielded vehicles among adversaries, judged by rapier2d. Exit code 1 if one of them collides.";

/// Scenarios of one set-up before the next set-up.
const BATCH: u64 = 500;

/// Options of `cede verify campaign`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Campaign {
    /// Minimum number of steps of shielded vehicles.
    #[arg(long, default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    steps: u64,
    /// Seed of the first scenario.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(..=u64::MAX / 2))]
    seed: u64,
}

impl Campaign {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let setups = Setup::all();
        let mut tallies = setups.map(|_| Tally::default());
        let mut seed = self.seed;
        while tallies.iter().map(|t| t.steps).sum::<u64>() < self.steps {
            for ((_, setup), tally) in setups.iter().zip(&mut tallies) {
                *tally = tally.plus(campaign::<Sound>(*setup, BATCH, seed));
                seed = seed.saturating_add(BATCH);
            }
        }
        println!(
            "{:26} {:>9} {:>10} {:>9} {:>11} {:>13} {:>8}",
            "set-up", "scenarios", "steps", "overlaps", "unverified", "interventions", "cleared"
        );
        for ((name, _), tally) in setups.iter().zip(&tallies) {
            print(name, tally);
        }
        let all = tallies.into_iter().fold(Tally::default(), Tally::plus);
        print("all", &all);
        match all.overlaps + all.unverified + all.false_breaches {
            0 => Ok(()),
            _ => Err(Failure::Check(format!(
                "{} overlaps, {} steps without a plan, {} false breaches",
                all.overlaps, all.unverified, all.false_breaches
            ))),
        }
    }
}

fn print(name: &str, tally: &Tally) {
    let Tally {
        scenarios,
        steps,
        overlaps,
        unverified,
        interventions,
        cleared,
        ..
    } = tally;
    println!(
        "{name:26} {scenarios:>9} {steps:>10} {overlaps:>9} {unverified:>11} {interventions:>13} {cleared:>8}"
    );
}
