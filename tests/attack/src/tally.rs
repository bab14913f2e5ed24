//! What came of many scenarios.

use crate::outcome::Outcome;
use serde::Serialize;

/// What came of many scenarios of one family.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// Scenarios that began with verified plans.
    pub scenarios: u64,
    /// Those that did not, or for which there was no room.
    pub skipped: u64,
    /// Decisions of shields in the former.
    pub steps: u64,
    /// Scenarios in which a shielded vehicle and another were in one place.
    pub overlaps: u64,
    /// Breaches reported although everybody kept the contract.
    pub false_breaches: u64,
    /// Faults reported although there was none.
    pub false_faults: u64,
    /// Decisions without a plan after the first one with one.
    pub unplanned: u64,
    /// Repeated calls that gave another decision.
    pub different: u64,
    /// Decisions that did not let the proposal pass.
    pub interventions: u64,
    /// Decisions in which somebody was not watched.
    pub unwatched: u64,
    /// Shielded vehicles, and those that got through.
    pub shielded: u64,
    /// Shielded vehicles that got through.
    pub through: u64,
    /// The first scenario with an overlap, or else the first in which something was wrong.
    pub case: Option<Case>,
}

/// A scenario in which something was wrong.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Case {
    /// It has no overlap.
    pub apart: bool,
    /// Its seed.
    pub seed: u64,
    /// What was wrong.
    pub what: String,
}

impl Tally {
    /// Of scenario `seed`.
    #[must_use]
    pub fn of(seed: u64, outcome: &Outcome) -> Self {
        if !outcome.verified {
            return Self {
                skipped: 1,
                ..Self::default()
            };
        }
        let what = || outcome.first.clone().unwrap_or_default();
        Self {
            scenarios: 1,
            skipped: 0,
            steps: outcome.steps,
            overlaps: u64::from(outcome.overlap.is_some()),
            false_breaches: outcome.breaches,
            false_faults: outcome.faults,
            unplanned: outcome.unplanned,
            different: outcome.different,
            interventions: outcome.interventions,
            unwatched: outcome.unwatched,
            shielded: outcome.shielded,
            through: outcome.through,
            case: outcome.is_bad().then(|| Case {
                apart: outcome.overlap.is_none(),
                seed,
                what: what(),
            }),
        }
    }

    /// Both together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        let case = match (self.case, other.case) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        Self {
            scenarios: self.scenarios + other.scenarios,
            skipped: self.skipped + other.skipped,
            steps: self.steps + other.steps,
            overlaps: self.overlaps + other.overlaps,
            false_breaches: self.false_breaches + other.false_breaches,
            false_faults: self.false_faults + other.false_faults,
            unplanned: self.unplanned + other.unplanned,
            different: self.different + other.different,
            interventions: self.interventions + other.interventions,
            unwatched: self.unwatched + other.unwatched,
            shielded: self.shielded + other.shielded,
            through: self.through + other.through,
            case,
        }
    }

    /// Whether the shield failed.
    #[must_use]
    pub fn is_bad(&self) -> bool {
        self.case.is_some()
    }
}
