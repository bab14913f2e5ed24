//! What came of a scenario.

use crate::motion::TICK;

/// Two vehicles in one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// The shielded vehicle, by its number in the set-up.
    pub ego: usize,
    /// The other.
    pub other: usize,
    /// When, in ticks.
    pub tick: u64,
    /// Speeds of both in m/s.
    pub speeds: [f64; 2],
    /// A breach or a fault had been reported before.
    pub flagged: bool,
}

/// What came of a scenario.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// It began with verified plans, so that the guarantee holds.
    pub verified: bool,
    /// Decisions of shields.
    pub steps: u64,
    /// Two vehicles in one place, one of them shielded with a verified plan.
    pub overlap: Option<Overlap>,
    /// Reports of a breach although everybody kept the contract.
    pub breaches: u64,
    /// Reports of a fault of the input although there was none.
    pub faults: u64,
    /// Decisions without a plan after the first verified one.
    pub unplanned: u64,
    /// Repeated calls that gave another decision.
    pub different: u64,
    /// Decisions that did not let the proposal pass.
    pub interventions: u64,
    /// Decisions in which somebody was not watched.
    pub unwatched: u64,
    /// Shielded vehicles.
    pub shielded: u64,
    /// Those that got through.
    pub through: u64,
    /// The least separation of a shielded vehicle from another in m.
    pub closest: f64,
    /// What was wrong first, for people.
    pub first: Option<String>,
}

impl Outcome {
    /// Whether the shield failed.
    #[must_use]
    pub fn is_bad(&self) -> bool {
        self.overlap.is_some() || self.breaches + self.faults + self.unplanned + self.different > 0
    }

    /// Notes what is wrong, if nothing was wrong before.
    pub fn complain(&mut self, tick: u64, what: impl FnOnce() -> String) {
        if self.first.is_none() {
            self.first = Some(format!("{:.3} s: {}", tick as f64 * TICK, what()));
        }
    }
}
