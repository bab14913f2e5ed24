//! What a driver behind the shield wants.

use crate::numbers::Numbers;
use crate::rng::Rng;

/// A driver's manner of proposing accelerations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Proposer {
    /// Full throttle.
    Full,
    /// Anything, held for up to two seconds.
    Random,
    /// Anything, another one every time, now and then not a number.
    Nonsense,
    /// Towards a speed, as a policy would.
    Speed {
        /// The speed in m/s.
        wanted: f64,
    },
    /// Brakes for so many periods, then full throttle.
    Waits {
        /// Periods.
        periods: u32,
    },
    /// Creeps up to where the shield holds it, stays there for so many periods, then goes at full throttle.
    Hesitates {
        /// Periods.
        periods: u32,
    },
    /// Always the same.
    Always {
        /// The acceleration in m/s².
        acceleration: f64,
    },
}

impl Proposer {
    /// One of the manners.
    #[must_use]
    pub fn random(rng: &mut Rng) -> Self {
        match rng.below(10) {
            0..4 => Self::Full,
            4..6 => Self::Random,
            6 => Self::Nonsense,
            7 => Self::Waits {
                periods: rng.below(60) as u32,
            },
            _ => Self::Speed {
                wanted: rng.within(1.0, 15.0),
            },
        }
    }
}

/// A driver.
#[derive(Clone, Debug)]
pub struct Driver {
    proposer: Proposer,
    held: f64,
    left: u32,
    calls: u32,
    /// Calls since it came to rest.
    rested: u32,
    rng: Rng,
}

/// Speed of one that creeps in m/s.
const CREEP: f64 = 0.8;

/// So many calls in a row at a speed below that (m/s) show one at rest.
const AT_REST: (u32, f64) = (5, 0.05);

impl Driver {
    /// One of this manner.
    #[must_use]
    pub fn new(proposer: Proposer, rng: Rng) -> Self {
        Self {
            proposer,
            held: 0.0,
            left: 0,
            calls: 0,
            rested: 0,
            rng,
        }
    }

    /// The next proposal (m/s²) at speed `v`; perhaps not a number.
    pub fn propose(&mut self, numbers: &Numbers, v: f64) -> f32 {
        self.calls += 1;
        let (calls, slow) = AT_REST;
        self.rested = if v < slow || self.rested >= calls {
            self.rested + 1
        } else {
            0
        };
        let (braking, most) = (numbers.ego.braking, numbers.ego.acceleration);
        let wanted = match self.proposer {
            Proposer::Full => most,
            Proposer::Random => self.hold(-braking, most),
            Proposer::Nonsense => return self.nonsense(),
            Proposer::Speed { wanted } => (wanted - v).clamp(-braking, most),
            Proposer::Waits { periods } if self.calls <= periods => -braking,
            Proposer::Waits { .. } => most,
            Proposer::Hesitates { periods } => {
                if self.rested < calls {
                    CREEP - v
                } else if self.rested < calls + periods {
                    -braking
                } else {
                    most
                }
            }
            Proposer::Always { acceleration } => acceleration,
        };
        wanted as f32
    }

    fn hold(&mut self, from: f64, to: f64) -> f64 {
        if self.left == 0 {
            self.left = 1 + self.rng.below(20) as u32;
            self.held = self.rng.within(from, to);
        }
        self.left -= 1;
        self.held
    }

    fn nonsense(&mut self) -> f32 {
        match self.rng.below(12) {
            0 => f32::NAN,
            1 => f32::INFINITY,
            2 => f32::NEG_INFINITY,
            3 => f32::MAX,
            _ => self.rng.within(-12.0, 12.0) as f32,
        }
    }
}
