//! What came of a campaign, family by family.

use crate::scenario::Family;
use crate::tally::Tally;
use serde::Serialize;
use std::fmt;

/// One row.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The family.
    pub family: &'static str,
    /// What came of it.
    #[serde(flatten)]
    pub tally: Tally,
}

/// The rows of all families.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Seed of the first scenario of each family.
    pub seed: u64,
    /// One for each family.
    pub rows: Vec<Row>,
    /// How long it took.
    pub seconds: f64,
}

impl Report {
    /// Nothing yet.
    #[must_use]
    pub fn new(seed: u64, families: &[&Family]) -> Self {
        let row = |family: &&Family| Row {
            family: family.name,
            tally: Tally::default(),
        };
        Self {
            seed,
            rows: families.iter().map(row).collect(),
            seconds: 0.0,
        }
    }

    /// Adds what came of a round, in the order of the families.
    pub fn add(&mut self, tallies: &[Tally]) {
        for (row, tally) in self.rows.iter_mut().zip(tallies) {
            row.tally = std::mem::take(&mut row.tally).plus(tally.clone());
        }
    }

    /// All families together.
    #[must_use]
    pub fn total(&self) -> Tally {
        let tallies = self.rows.iter().map(|row| row.tally.clone());
        tallies.fold(Tally::default(), Tally::plus)
    }

    /// Decisions of shields.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.rows.iter().map(|row| row.tally.steps).sum()
    }

    /// Families in which the shield failed.
    #[must_use]
    pub fn bad(&self) -> usize {
        self.rows.iter().filter(|row| row.tally.is_bad()).count()
    }

    /// As JSON: what came of all families together, and the rows.
    ///
    /// # Panics
    /// Never: every number is finite.
    #[must_use]
    pub fn json(&self) -> String {
        #[derive(Serialize)]
        struct Summary<'a> {
            total: Tally,
            #[serde(flatten)]
            report: &'a Report,
        }
        let summary = Summary {
            total: self.total(),
            report: self,
        };
        serde_json::to_string_pretty(&summary).expect("plain numbers and strings")
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:14} {:>9} {:>8} {:>11} {:>8} {:>8} {:>8} {:>9} {:>9} {:>9}",
            "family",
            "scenarios",
            "skipped",
            "steps",
            "overlaps",
            "breaches",
            "faults",
            "unplanned",
            "different",
            "through"
        )?;
        for row in &self.rows {
            line(f, row.family, &row.tally)?;
        }
        line(f, "all", &self.total())?;
        if self.seconds > 0.0 {
            let rate = self.steps() as f64 / self.seconds;
            writeln!(f, "{:.0} s, {rate:.0} steps/s", self.seconds)?;
        }
        for row in &self.rows {
            if let Some(case) = &row.tally.case {
                writeln!(
                    f,
                    "cede-attack replay {} {} --trace    # {}",
                    row.family, case.seed, case.what
                )?;
            }
        }
        Ok(())
    }
}

fn line(f: &mut fmt::Formatter<'_>, name: &str, tally: &Tally) -> fmt::Result {
    let through = 100.0 * tally.through as f64 / tally.shielded.max(1) as f64;
    writeln!(
        f,
        "{name:14} {:>9} {:>8} {:>11} {:>8} {:>8} {:>8} {:>9} {:>9} {through:>7.1} %",
        tally.scenarios,
        tally.skipped,
        tally.steps,
        tally.overlaps,
        tally.false_breaches,
        tally.false_faults,
        tally.unplanned,
        tally.different,
    )
}
