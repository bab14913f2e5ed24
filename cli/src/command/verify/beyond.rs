//! `cede verify beyond`: encounters in which one number of the contract does not hold.

mod chart;

use super::checked::{Check, Checked, Finding};
use crate::contract::{self, Named};
use crate::failure::Failure;
use crate::safety::Kind;
use crate::svg;
use crate::threads::Threads;
use cede_sim::campaign::beyond::{Count, Guard, ROWS, Row, Temper, beyond};
use clap::Args;
use std::path::PathBuf;

/// The text below the options in `cede help verify beyond`.
const HELP: &str = "\
Each cell is the percentage of encounters that end in a collision, and the mean speed of these in m/s, one vehicle
relative to the other. The same encounters are driven without a guard, behind a plain rule that brakes if two times
overlap, and behind the shield. `flagged` is the share of the shield's collisions before which it said that its
contract is broken, its input wrong, or no plan safe; `noticed` is the share of all encounters behind the shield in
which it said so. A rule of precedence is left out of the contract: hostile others keep none. So is a row that
multiplies a number which is 0 in the contract.

Exit code 1 if the shield collides within the contract.";

/// Options of `cede verify beyond`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Beyond {
    /// The shield's contract [default: worst-case]
    #[arg(long, value_name = "NAME|FILE")]
    contract: Option<Named>,
    /// Encounters of each cell; those that begin without a safe plan do not count.
    #[arg(long, default_value_t = 2000, value_parser = clap::value_parser!(u64).range(1..))]
    encounters: u64,
    /// Seed of the first encounter.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(..=u64::MAX / 2))]
    seed: u64,
    /// Also draw the table as bars, in this file (SVG).
    #[arg(long, value_name = "FILE.svg", value_parser = crate::svg::path)]
    draw: Option<PathBuf>,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

/// No collision behind the shield within the contract.
pub(super) const WITHIN: &str = "within the contract";

/// Every collision behind the shield is reported before.
pub(super) const REPORTED: &str = "reported before a collision";

/// A row of the table for one temper of the others.
struct Line {
    row: Row,
    temper: Temper,
    /// In the order of [`Guard::ALL`].
    counts: [Count; 3],
}

impl Beyond {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        self.check()?.tell(self.json)
    }

    fn lines(&self) -> Result<Vec<Line>, Failure> {
        let contract = contract::or_worst_case(self.contract.as_ref())?;
        let mut lines = Vec::new();
        for row in ROWS.into_iter().filter(|row| row.deviates(&contract)) {
            note!("{} …", row.name);
            for temper in [Temper::Hostile, Temper::Gentle] {
                let counts = Guard::ALL.map(|guard| {
                    let driven = (guard, temper);
                    beyond(contract, row.deviation, driven, self.encounters, self.seed)
                });
                lines.push(Line {
                    row,
                    temper,
                    counts,
                });
            }
        }
        Ok(lines)
    }
}

impl Check for Beyond {
    fn check(&self) -> Result<Checked, Failure> {
        let lines = self.lines()?;
        if let Some(path) = &self.draw {
            svg::save(path, &chart::svg(&lines))?;
        }
        let within = shielded(lines.iter().filter(|line| line.row == ROWS[0]));
        let all = shielded(lines.iter());
        let said = format!(
            "{} collisions within the contract, of {} encounters",
            within.collisions, within.encounters
        );
        let reported = format!(
            "{} of {} collisions beyond the contract reported before",
            all.flagged - within.flagged,
            all.collisions - within.collisions
        );
        let objects: Vec<_> = lines.iter().map(Line::json).collect();
        Ok(Checked {
            text: table(&lines, self.encounters),
            json: serde_json::json!({ "seed": self.seed, "rows": objects }),
            summary: format!("{said}; {reported}"),
            findings: vec![
                Finding::new(Kind::Beyond, WITHIN, within.collisions == 0, &said),
                Finding::new(
                    Kind::Beyond,
                    REPORTED,
                    all.flagged == all.collisions,
                    reported,
                ),
            ],
            open: (within.collisions > 0).then_some(said),
        })
    }
}

/// What was seen behind the shield.
fn shielded<'l>(lines: impl Iterator<Item = &'l Line>) -> Count {
    let counts = lines.map(|line| line.counts[2]);
    counts.fold(Count::default(), Count::plus)
}

/// What the words of the table mean.
const LEGEND: &str = "\
hostile: tries to be hit; gentle: keeps its speed. plain rule: brakes if two times overlap.
flagged: collisions behind the shield that it reported before; noticed: encounters in which it reported anything.";

fn table(lines: &[Line], drawn: u64) -> String {
    let n = lines.first().map_or(0, |line| line.counts[2].encounters);
    let mut text = vec![
        format!(
            "{n} encounters a cell, those of {drawn} that begin with a safe plan; collisions in %, and their speed in m/s"
        ),
        LEGEND.to_owned(),
        format!(
            "{:<33} {:<8} {:>12} {:>12} {:>12} {:>8} {:>8}",
            "beyond the contract",
            "others",
            "no guard",
            "plain rule",
            "shield",
            "flagged",
            "noticed"
        ),
    ];
    text.extend(lines.iter().map(Line::text));
    text.join("\n")
}

impl Line {
    fn temper(&self) -> &'static str {
        match self.temper {
            Temper::Hostile => "hostile",
            Temper::Gentle => "gentle",
        }
    }

    fn text(&self) -> String {
        let [none, plain, shield] = self.counts.map(|count| {
            if count.collisions == 0 {
                return "0".to_owned();
            }
            let share = count.share().fraction().unwrap_or_default();
            format!("{:.1} / {:.1}", 100.0 * share, count.impact_speed())
        });
        let flagged = match self.counts[2] {
            Count { collisions: 0, .. } => String::new(),
            Count {
                collisions,
                flagged,
                ..
            } => format!("{:.0} %", 100.0 * flagged as f64 / collisions as f64),
        };
        let Count {
            encounters,
            noticed,
            ..
        } = self.counts[2];
        let noticed = format!("{:.0} %", 100.0 * noticed as f64 / encounters.max(1) as f64);
        format!(
            "{:<33} {:<8} {none:>12} {plain:>12} {shield:>12} {flagged:>8} {noticed:>8}",
            self.row.name,
            self.temper()
        )
    }

    fn json(&self) -> serde_json::Value {
        let cell = |count: Count| {
            let share = count.share();
            serde_json::json!({
                "encounters": count.encounters, "collisions": count.collisions, "flagged": count.flagged,
                "noticed": count.noticed,
                "share": share.fraction(), "share_95": share.interval(), "impact_m_s": count.impact_speed(),
            })
        };
        let [none, plain, shield] = self.counts.map(cell);
        serde_json::json!({
            "beyond": self.row.name, "others": self.temper(),
            "no_guard": none, "plain_rule": plain, "shield": shield,
        })
    }
}
