//! What happens beyond the contract: encounters in which one of its numbers does not hold.
//!
//! One vehicle meets another one, which is hostile (it tries to be hit) or gentle (it keeps its speed, more or less).
//! Time passes in steps of 10 ms, so that lags, delays and jitter are what they say. The same encounters are driven
//! behind the shield, by a plain rule, and with nothing in between.

mod deviation;
mod encounter;
mod plain;

pub use deviation::{Deviation, ROWS, Row};

use super::scenario::{Scenario, Setup};
use crate::judge::Judge;
use crate::statistics::Share;
use cede_controller::{Contract, Footprint};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// What is between the driver and the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guard {
    /// Nothing.
    None,
    /// Brake if two times overlap.
    Plain,
    /// The shield.
    Shield,
}

impl Guard {
    /// Each of them.
    pub const ALL: [Self; 3] = [Self::None, Self::Plain, Self::Shield];
}

/// How the other vehicle drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Temper {
    /// It tries to be hit.
    Hostile,
    /// It keeps its speed, more or less.
    Gentle,
}

/// What was seen of some encounters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Count {
    /// Encounters that begin with a verified plan.
    pub encounters: u64,
    /// Those that end in a collision.
    pub collisions: u64,
    /// Collisions before which the shield said that the contract is broken, that its input is wrong, or that it has no plan.
    pub flagged: u64,
    /// Encounters in which it said so at any time.
    pub noticed: u64,
    /// Sum of the speeds (m/s), one relative to the other, at which they collide.
    pub impact: f64,
}

impl Count {
    /// Both together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            encounters: self.encounters + other.encounters,
            collisions: self.collisions + other.collisions,
            flagged: self.flagged + other.flagged,
            noticed: self.noticed + other.noticed,
            impact: self.impact + other.impact,
        }
    }

    /// Share of the encounters that end in a collision.
    #[must_use]
    pub const fn share(&self) -> Share {
        Share {
            count: self.collisions as usize,
            n: self.encounters as usize,
        }
    }

    /// Mean speed (m/s) of a collision; 0 without one.
    #[must_use]
    pub fn impact_speed(&self) -> f64 {
        self.impact / self.collisions.max(1) as f64
    }
}

/// Drives so many encounters; number i has seed `seed` + i, whatever the guard, the temper and the deviation.
///
/// The same seed gives the same count on any number of threads.
#[must_use]
pub fn beyond(
    contract: Contract,
    deviation: Deviation,
    (guard, temper): (Guard, Temper),
    encounters: u64,
    seed: u64,
) -> Count {
    // A hostile other keeps no rule of precedence.
    let Ok(contract) = contract.to_builder().precedence(None).build() else {
        return Count::default();
    };
    let setup = Setup {
        contract,
        vehicles: 2,
        ..Setup::ADVERSARIES
    };
    let judge = || Judge::new(&[Footprint::PAPER; 2]);
    let counts: Vec<Count> = (seed..seed.saturating_add(encounters))
        .into_par_iter()
        .map_init(judge, |judge, seed| {
            let mut rng = Pcg64::seed_from_u64(seed);
            let scenario = Scenario::random(setup, &mut rng);
            let count = scenario.and_then(|scenario| {
                encounter::run(&scenario, deviation, (guard, temper), rng, judge)
            });
            count.unwrap_or_default()
        })
        .collect();
    // In order, so that sums do not depend on the threads.
    counts.into_iter().fold(Count::default(), Count::plus)
}
