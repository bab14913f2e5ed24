//! `cede verify campaign`: shielded vehicles among adversaries that keep the contract.

use super::checked::{Check, Checked, Finding};
use crate::failure::Failure;
use crate::safety::Kind;
use cede_controller::dangerous::Sound;
use cede_sim::campaign::{Setup, Tally, campaign};
use clap::Args;
use std::ops::Range;
use std::str::FromStr;

/// The text below the options in `cede help verify campaign`.
const HELP: &str = "\
Drives shielded vehicles among adversaries, judged by rapier2d. Exit code 1 if one of them collides.

As an array of 8 jobs, each of which prints its share of the counts:
  cede verify campaign --scenarios 1000000 --shard $SLURM_ARRAY_TASK_ID/8 --json     # sbatch --array=1-8";

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
    /// Number of scenarios of each set-up, in place of a number of steps.
    #[arg(long, value_name = "N", conflicts_with = "steps", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    scenarios: Option<u64>,
    /// Run only this share of the scenarios, from 1/N to N/N. All shares together count what the whole does.
    #[arg(long, value_name = "I/N", requires = "scenarios")]
    shard: Option<Shard>,
    /// Seed of the first scenario.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(..=u64::MAX / 2))]
    seed: u64,
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

/// A share of the scenarios.
#[derive(Clone, Copy)]
struct Shard {
    /// Its number, from 1.
    number: u64,
    /// Number of all shares.
    of: u64,
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers = text.split_once('/');
        let numbers =
            numbers.and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        let shard = numbers.map(|(number, of)| Self { number, of });
        shard
            .filter(|shard| (1..=shard.of).contains(&shard.number))
            .ok_or("a share is I/N with I from 1 to N, as in 3/8")
    }
}

impl Shard {
    const WHOLE: Self = Self { number: 1, of: 1 };

    /// The places from 0 to `all` that are in it.
    fn of(self, all: u64) -> Range<u64> {
        // Below `all`, so it fits.
        let end = |shares: u64| (u128::from(all) * u128::from(shares) / u128::from(self.of)) as u64;
        end(self.number - 1)..end(self.number)
    }
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
        let tallies = match self.scenarios {
            Some(scenarios) => self.counted(scenarios),
            None => self.until_steps(),
        };
        let all = tallies.iter().copied().fold(Tally::default(), Tally::plus);
        let setups = Setup::all();
        let names = setups.iter().map(|(name, _)| *name);
        names.zip(tallies).chain([(ALL, all)]).collect()
    }

    /// Of its share of `scenarios` scenarios of each set-up.
    fn counted(&self, scenarios: u64) -> Vec<Tally> {
        let share = self.shard.unwrap_or(Shard::WHOLE).of(scenarios);
        let first = (0..).map(|place| self.seed + place * scenarios + share.start);
        let setups = Setup::all().into_iter().zip(first);
        setups
            .map(|((_, setup), seed)| campaign::<Sound>(setup, share.end - share.start, seed))
            .collect()
    }

    /// Of batches of all set-ups, until there are enough steps.
    fn until_steps(&self) -> Vec<Tally> {
        let setups = Setup::all();
        let mut tallies = vec![Tally::default(); setups.len()];
        let mut seed = self.seed;
        while tallies.iter().map(|t| t.steps).sum::<u64>() < self.steps {
            for ((_, setup), tally) in setups.iter().zip(&mut tallies) {
                *tally = tally.plus(campaign::<Sound>(*setup, BATCH, seed));
                seed = seed.saturating_add(BATCH);
            }
        }
        tallies
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
