//! A scenario as plain data: who is where, who drives how, who sees what.

use crate::actuator::{Takeover, Weakness};
use crate::human::{Gait, Manner};
use crate::motion::State;
use crate::proposer::Proposer;
use crate::sight::Sensing;
use crate::site::Site;
use crate::sway::Sway;
use cede_controller::Contract;

/// Who drives a vehicle.
#[derive(Clone, Debug, PartialEq)]
pub enum Driver {
    /// A proposer behind a shield.
    Shielded {
        /// What it wants.
        proposer: Proposer,
        /// The tick from which on control is handed over, as soon as the shield is ready; 0: at once, or not at all.
        from: u64,
        /// Who drives until then.
        before: Manner,
    },
    /// A proposer behind the plain rule: brakes at 3 m/s² when times overlap.
    Plain {
        /// What it wants.
        proposer: Proposer,
    },
    /// Nobody that looks out for others.
    Human(Manner),
    /// On foot.
    Walker(Gait),
}

/// A vehicle at the beginning.
#[derive(Clone, Debug, PartialEq)]
pub struct Car {
    /// Its lane.
    pub lane: usize,
    /// Its motion.
    pub start: State,
    /// The acceleration that is in effect.
    pub acceleration: f64,
    /// Who drives it.
    pub driver: Driver,
    /// It does not accelerate beyond this speed (m/s).
    pub cap: f64,
    /// How commands take effect.
    pub takeover: Takeover,
    /// Where it is beside its lane.
    pub sway: Sway,
}

/// How the world differs from the contract.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outside {
    /// What shielded vehicles do worse.
    pub weakness: Weakness,
    /// Latency in units of the contract's.
    pub latency: f64,
    /// What others can do in units of the contract's.
    pub others: f64,
    /// Largest deviation of a call from its time, in units of the period.
    pub jitter: f64,
    /// Probability that a call is missed.
    pub missed: f64,
}

impl Outside {
    /// Not at all.
    pub const NOT: Self = Self {
        weakness: Weakness::NONE,
        latency: 1.0,
        others: 1.0,
        jitter: 0.0,
        missed: 0.0,
    };
}

/// A scenario.
#[derive(Clone, Debug)]
pub struct Setup<'s> {
    /// Where.
    pub site: &'s Site,
    /// What the shields assume.
    pub contract: Contract,
    /// Who.
    pub cars: Vec<Car>,
    /// How long, in ticks.
    pub ticks: u64,
    /// What is seen.
    pub sensing: Sensing,
    /// What is not as the contract says.
    pub outside: Outside,
    /// For everything that is drawn on the way.
    pub seed: u64,
}
