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
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
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
        let all = tallies.into_iter().fold(Tally::default(), Tally::plus);
        let names = setups.iter().map(|(name, _)| *name).chain(["all"]);
        let rows: Vec<_> = names.zip(tallies.into_iter().chain([all])).collect();
        if self.json {
            let rows: Vec<_> = rows.iter().map(|(name, tally)| json(name, tally)).collect();
            println!("{}", serde_json::json!({ "seed": self.seed, "rows": rows }));
        } else {
            print(&rows);
        }
        match all.overlaps + all.unverified + all.false_breaches {
            0 => Ok(()),
            _ => Err(Failure::Check(format!(
                "{} overlaps, {} steps without a plan, {} false breaches",
                all.overlaps, all.unverified, all.false_breaches
            ))),
        }
    }
}

fn print(rows: &[(&str, Tally)]) {
    println!(
        "{:26} {:>9} {:>10} {:>9} {:>11} {:>13} {:>8}",
        "set-up", "scenarios", "steps", "overlaps", "unverified", "interventions", "cleared"
    );
    for (name, tally) in rows {
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
}

fn json(name: &str, tally: &Tally) -> serde_json::Value {
    serde_json::json!({
        "setup": name, "scenarios": tally.scenarios, "steps": tally.steps, "overlaps": tally.overlaps,
        "unverified": tally.unverified, "false_breaches": tally.false_breaches,
        "interventions": tally.interventions, "cleared": tally.cleared,
    })
}
