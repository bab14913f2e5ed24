//! `cede verify campaign`: shielded vehicles among adversaries that keep the contract.

use super::checked::{Check, Checked, Finding};
use crate::failure::Failure;
use crate::safety::Kind;
use cede_controller::dangerous::Sound;
use cede_sim::campaign::{Setup, Tally, campaign};
use clap::Args;

/// The text below the options in `cede help verify campaign`.
const HELP: &str = "\
Drives shielded vehicles among adversaries, judged by rapier2d. Exit code 1 if one of them collides.";

/// Scenarios of one set-up before the next set-up, at most.
const BATCH: u64 = 500;

/// What the totals of all set-ups are called.
pub(super) const ALL: &str = "all";

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

/// A set-up by its name, with what was seen of it.
type SetupRow = (&'static str, Tally);

impl Campaign {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.check()?.tell(self.json)
    }

    /// The set-ups, and all of them together.
    fn rows(&self) -> Vec<SetupRow> {
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
        let names = setups.iter().map(|(name, _)| *name);
        names.zip(tallies).chain([(ALL, all)]).collect()
    }
}

impl Check for Campaign {
    fn check(&self) -> Result<Checked, Failure> {
        let rows = self.rows();
        let all = rows.last().map(|(_, all)| *all).unwrap_or_default();
        let mut lines = vec![format!(
            "{:26} {:>9} {:>10} {:>9} {:>11} {:>13} {:>8}",
            "set-up", "scenarios", "steps", "overlaps", "unverified", "interventions", "cleared"
        )];
        lines.extend(rows.iter().map(text));
        Ok(Checked {
            text: lines.join("\n"),
            json: serde_json::json!({ "seed": self.seed, "setups": rows.iter().map(json).collect::<Vec<_>>() }),
            summary: format!("{} steps: {}", all.steps, counted(&all)),
            findings: rows.iter().map(finding).collect(),
            open: (!clean(&all)).then(|| counted(&all)),
        })
    }
}

fn clean(tally: &Tally) -> bool {
    tally.overlaps + tally.unverified + tally.false_breaches == 0
}

fn counted(tally: &Tally) -> String {
    format!(
        "{} overlaps, {} steps without a plan, {} false breaches",
        tally.overlaps, tally.unverified, tally.false_breaches
    )
}

fn finding((name, tally): &SetupRow) -> Finding {
    let said = format!("{} steps: {}", tally.steps, counted(tally));
    Finding::new(Kind::Campaign, *name, clean(tally), said)
}

fn text((name, tally): &SetupRow) -> String {
    let Tally {
        scenarios,
        steps,
        overlaps,
        unverified,
        interventions,
        cleared,
        ..
    } = tally;
    format!(
        "{name:26} {scenarios:>9} {steps:>10} {overlaps:>9} {unverified:>11} {interventions:>13} {cleared:>8}"
    )
}

fn json((name, tally): &SetupRow) -> serde_json::Value {
    serde_json::json!({
        "name": name, "scenarios": tally.scenarios, "steps": tally.steps, "overlaps": tally.overlaps,
        "unverified": tally.unverified, "false_breaches": tally.false_breaches,
        "interventions": tally.interventions, "cleared": tally.cleared,
    })
}
