//! How a contract of one's own is made.

use super::demand::first_fault;
use super::{Contract, ContractError, Precedence};
#[cfg(doc)]
use super::{Ego, Follower, Other};

/// Numbers on the way to a [`Contract`]; see [`Contract::builder`].
///
/// Everything is `const`: a contract that is known beforehand is checked when it is compiled.
///
/// ```
/// use cede_controller::Contract;
///
/// const LORRY: Contract = match Contract::builder().ego_braking(2.5).ego_go(1.0).build() {
///     Ok(contract) => contract,
///     Err(_) => panic!("a number is out of its range"),
/// };
/// assert_eq!(LORRY.ego().go, 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use = "`build` makes the contract"]
pub struct ContractBuilder {
    /// Not validated.
    numbers: Contract,
}

impl ContractBuilder {
    pub(super) const fn new(numbers: Contract) -> Self {
        Self { numbers }
    }

    /// Time from one decision to the next in s, in [0.01, 1].
    pub const fn period(mut self, period: f32) -> Self {
        self.numbers.period = period;
        self
    }

    /// A command takes effect within this time in s, in [0, 10 `period` − 6 `jitter`].
    pub const fn latency(mut self, latency: f32) -> Self {
        self.numbers.latency = latency;
        self
    }

    /// How far (s) a call may be from the grid of periods, either way, in [0, 0.35 `period`], with a rule of precedence
    /// up to `period`/8.
    pub const fn jitter(mut self, jitter: f32) -> Self {
        self.numbers.jitter = jitter;
        self
    }

    /// Largest error of a sensed arc length in m, in [0, 10].
    pub const fn position_error(mut self, position_error: f32) -> Self {
        self.numbers.position_error = position_error;
        self
    }

    /// Largest error of a sensed speed in m/s, in [0, 10].
    pub const fn speed_error(mut self, speed_error: f32) -> Self {
        self.numbers.speed_error = speed_error;
        self
    }

    /// Subtracted from every margin, in m, in [0.01, 10]: covers the rounding of `f32`.
    pub const fn slack(mut self, slack: f32) -> Self {
        self.numbers.slack = slack;
        self
    }

    /// [`Ego::max_speed`] in m/s, above what may hold the ego back and up to the others' `max_speed`.
    pub const fn ego_max_speed(mut self, ego_max_speed: f32) -> Self {
        self.numbers.ego.max_speed = ego_max_speed;
        self
    }

    /// [`Ego::acceleration`] in m/s², in (0, the others' `acceleration`].
    pub const fn ego_acceleration(mut self, ego_acceleration: f32) -> Self {
        self.numbers.ego.acceleration = ego_acceleration;
        self
    }

    /// [`Ego::go`] in m/s², in (0, the ego's `acceleration`].
    pub const fn ego_go(mut self, ego_go: f32) -> Self {
        self.numbers.ego.go = ego_go;
        self
    }

    /// [`Ego::braking`] in m/s², in (0, the others' `braking`]; it is [`Ego::emergency`], too, unless that is set later.
    pub const fn ego_braking(mut self, ego_braking: f32) -> Self {
        self.numbers.ego.braking = ego_braking;
        self.numbers.ego.emergency = ego_braking;
        self
    }

    /// [`Ego::emergency`] in m/s², in [the ego's `braking`, the others' `braking`].
    pub const fn ego_emergency(mut self, ego_emergency: f32) -> Self {
        self.numbers.ego.emergency = ego_emergency;
        self
    }

    /// [`Ego::lag`] in s, in [0, 1].
    pub const fn ego_lag(mut self, ego_lag: f32) -> Self {
        self.numbers.ego.lag = ego_lag;
        self
    }

    /// [`Ego::gain`], a share in [0, 0.5].
    pub const fn ego_gain(mut self, ego_gain: f32) -> Self {
        self.numbers.ego.gain = ego_gain;
        self
    }

    /// [`Ego::disturbance`] in m/s², in [0, 5].
    pub const fn ego_disturbance(mut self, ego_disturbance: f32) -> Self {
        self.numbers.ego.disturbance = ego_disturbance;
        self
    }

    /// [`Other::max_speed`] in m/s, in (0, 100].
    pub const fn other_max_speed(mut self, other_max_speed: f32) -> Self {
        self.numbers.other.max_speed = other_max_speed;
        self
    }

    /// [`Other::acceleration`] in m/s², in (0, 20].
    pub const fn other_acceleration(mut self, other_acceleration: f32) -> Self {
        self.numbers.other.acceleration = other_acceleration;
        self
    }

    /// [`Other::braking`] in m/s², in (0, 20].
    pub const fn other_braking(mut self, other_braking: f32) -> Self {
        self.numbers.other.braking = other_braking;
        self
    }

    /// [`Follower::reaction`] in s, in [0, 10].
    pub const fn follower_reaction(mut self, follower_reaction: f32) -> Self {
        self.numbers.follower.reaction = follower_reaction;
        self
    }

    /// [`Follower::braking`] in m/s², in (0, the others' `braking`].
    pub const fn follower_braking(mut self, follower_braking: f32) -> Self {
        self.numbers.follower.braking = follower_braking;
        self
    }

    /// The rule of precedence that the others keep, if they do.
    pub const fn precedence(mut self, precedence: Option<Precedence>) -> Self {
        self.numbers.precedence = precedence;
        self
    }

    /// The contract.
    ///
    /// # Errors
    /// The first number that is out of its range.
    pub const fn build(self) -> Result<Contract, ContractError> {
        match first_fault(&self.numbers) {
            None => Ok(self.numbers),
            Some(error) => Err(error),
        }
    }

    /// See [`crate::dangerous::unchecked`].
    pub(crate) const fn unchecked(self) -> Contract {
        self.numbers
    }
}
