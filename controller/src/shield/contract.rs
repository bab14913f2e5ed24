//! What the shield assumes of the world, in numbers.

/// The assumptions under which the shield's guarantee holds.
///
/// Guarantee: the ego is never in a conflict zone together with another vehicle, and never
/// hits a vehicle ahead of it in its lane. `docs/shield.md` has the theorem.
///
/// Where it enters a lane ahead of another, the guarantee needs others that are no lamer than the ego: the ego's `acceleration` at most theirs and
/// at most `braking` or the follower's, its `max_speed` at most theirs, as in the named contracts. This is not checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contract {
    /// Time from one decision to the next in s, in (0, 1].
    pub period: f32,
    /// A command takes effect within this time in s, in [0, `period`]; until then the one before it does.
    pub latency: f32,
    /// Largest error of a sensed arc length in m, the ego's or another's, in [0, 10].
    pub position_error: f32,
    /// Largest error of a sensed speed in m/s, in [0, 10].
    pub speed_error: f32,
    /// Subtracted from every margin, in m, in [0, 10]: covers the rounding of `f32`.
    pub slack: f32,
    /// What the ego can do.
    pub ego: Ego,
    /// What every other vehicle can do, at most.
    pub other: Other,
    /// What a vehicle does that finds the ego ahead of it in its lane.
    pub follower: Follower,
    /// The rule of precedence that the others keep, if they do: without it nobody's courtesy is
    /// assumed where routes cross.
    pub precedence: Option<Precedence>,
}

/// What the ego can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ego {
    /// No acceleration is commanded at or above this speed, in m/s, in (0, 100]; a limiter may keep the vehicle from
    /// going faster, and errs by `speed_error` at most. The guarantee holds with a limiter and without one.
    pub max_speed: f32,
    /// Largest acceleration that is commanded, in m/s², in (0, 20].
    pub acceleration: f32,
    /// Acceleration that it achieves, below its limiter's speed, when it must clear a zone, in m/s², in (0, `acceleration`].
    pub go: f32,
    /// Braking that it achieves, and the hardest that is commanded, in m/s², in (0, 20].
    pub braking: f32,
}

/// What another vehicle can do, at most. It follows its route forwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Other {
    /// Highest speed in m/s, in (0, 100]. A vehicle seen above it keeps that speed at most.
    pub max_speed: f32,
    /// Hardest acceleration in m/s², in (0, 20].
    pub acceleration: f32,
    /// Hardest braking in m/s², in [the ego's `braking`, 20].
    pub braking: f32,
}

/// What a vehicle does that finds the ego ahead of it in its lane: after `reaction` it brakes at
/// `braking` or harder for as long as it must, if that is enough to stop behind the ego
/// (responsibility-sensitive safety; Shalev-Shwartz, Shammah and Shashua, arXiv:1708.06374).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follower {
    /// Reaction time in s, in [0, 10].
    pub reaction: f32,
    /// Braking in m/s², in (0, the other's hardest `braking`].
    pub braking: f32,
}

/// Who arrived first goes first; in a tie, who has the right of way.
///
/// A vehicle arrives when it comes within `distance` of its zone with the other. The one with
/// precedence assumes that the other stays out of the zone if it can still stop before it. Whoever stands in a zone
/// has precedence there; nobody waits in one for somebody without the right of way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precedence {
    /// Metres before the zone at which a vehicle has arrived, in (0, 200].
    pub distance: f32,
    /// Arrivals within this many periods of each other are a tie. If the one without the right of way
    /// came one period more before the other, nobody has precedence: the two may count differently.
    pub tie: u16,
    /// Braking in m/s², in (0, 20], with which the other is expected to stop.
    pub braking: f32,
    /// Periods for which a vehicle with precedence may rest, while the other rests as well, before precedence
    /// goes to the other, and after twice, four times … as many back and forth; at least 5, or 0 if it is
    /// never lost. The first few periods of a turn are nobody's, so that 10 or more is useful.
    pub patience: u16,
}

impl Precedence {
    /// An all-way stop: 12 m, half a second, 3 m/s², and turns of 1.5 s, 3 s, 6 s, …
    pub const ALL_WAY_STOP: Self = Self {
        distance: 12.0,
        tie: 5,
        braking: 3.0,
        patience: 15,
    };
}

/// The first number of a [`Contract`] that is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContractError {
    /// `period` or `latency`.
    Time,
    /// `position_error`, `speed_error` or `slack`.
    Tolerance,
    /// A number of [`Ego`].
    Ego,
    /// A number of [`Other`].
    Other,
    /// A number of [`Follower`].
    Follower,
    /// A number of [`Precedence`].
    Precedence,
}

impl core::fmt::Display for ContractError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Time => "the period must be in (0, 1] s and the latency no longer",
            Self::Tolerance => "an error or the slack is negative, or larger than 10",
            Self::Ego => "the ego's speed, acceleration or braking is out of range",
            Self::Other => "the others' speed, acceleration or braking is out of range",
            Self::Follower => "the follower's reaction time or braking is out of range",
            Self::Precedence => "a number of the rule of precedence is out of range, or it asks for turns of a vehicle that brakes or goes too gently",
        })
    }
}

impl core::error::Error for ContractError {}

impl Contract {
    /// The worst case: others accelerate at 3 m/s² up to 15 m/s and may brake at 8; a command takes
    /// effect one period late; at crossings nobody is courteous. Sensors are exact.
    pub const WORST_CASE: Self = Self {
        period: 0.1,
        latency: 0.1,
        position_error: 0.0,
        speed_error: 0.0,
        slack: 0.01,
        ego: Ego {
            max_speed: 15.0,
            acceleration: 3.0,
            go: 3.0,
            braking: 3.0,
        },
        other: Other {
            max_speed: 15.0,
            acceleration: 3.0,
            braking: 8.0,
        },
        follower: Follower {
            reaction: 0.5,
            braking: 4.0,
        },
        precedence: None,
    };

    /// [`Contract::WORST_CASE`] among vehicles that keep the rule of precedence of an all-way stop.
    pub const ALL_WAY_STOP: Self = Self {
        precedence: Some(Precedence::ALL_WAY_STOP),
        ..Self::WORST_CASE
    };

    /// The speed (m/s) up to which a vehicle counts as one at rest: a quarter of what `go` gives in a period.
    pub(super) fn rest_speed(&self) -> f32 {
        0.25 * self.ego.go * self.period
    }

    /// Whether a vehicle whose turn is past stops where the other expects it, and is seen if it does not: one that
    /// goes gets faster, in spite of its limiter, than one that may be taken for one at rest.
    fn takes_turns(&self, rule: Precedence) -> bool {
        let rest = self.rest_speed() + 2.0 * self.speed_error;
        self.ego.braking >= rule.braking && rest < self.ego.max_speed - self.speed_error
    }

    /// The contract, if every number is in its range.
    ///
    /// # Errors
    /// The first that is not. Never panics.
    pub fn checked(self) -> Result<Self, ContractError> {
        use ContractError as E;
        let up_to = |value: f32, limit: f32| value > 0.0 && value <= limit;
        let from_zero = |value: f32, limit: f32| value >= 0.0 && value <= limit;
        let (ego, other, follower) = (self.ego, self.other, self.follower);
        let checks = [
            (up_to(self.period, 1.0), E::Time),
            (from_zero(self.latency, self.period), E::Time),
            (from_zero(self.position_error, 10.0), E::Tolerance),
            (from_zero(self.speed_error, 10.0), E::Tolerance),
            (from_zero(self.slack, 10.0), E::Tolerance),
            (up_to(ego.max_speed, 100.0), E::Ego),
            (up_to(ego.acceleration, 20.0), E::Ego),
            (up_to(ego.go, ego.acceleration), E::Ego),
            (up_to(ego.braking, 20.0), E::Ego),
            (up_to(other.max_speed, 100.0), E::Other),
            (up_to(other.acceleration, 20.0), E::Other),
            (up_to(other.braking, 20.0), E::Other),
            // The gap to a leader is smallest at the end only if the leader can brake harder.
            (other.braking >= ego.braking, E::Other),
            (from_zero(follower.reaction, 10.0), E::Follower),
            (up_to(follower.braking, other.braking), E::Follower),
            (
                self.precedence
                    .is_none_or(|p| up_to(p.distance, 200.0) && up_to(p.braking, 20.0)),
                E::Precedence,
            ),
            (
                self.precedence
                    .is_none_or(|p| p.patience == 0 || (p.patience >= 5 && self.takes_turns(p))),
                E::Precedence,
            ),
        ];
        match checks.iter().find(|(holds, _)| !holds) {
            Some(&(_, error)) => Err(error),
            None => Ok(self),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_named_contracts_are_in_range() {
        assert!(Contract::WORST_CASE.checked().is_ok());
        assert!(Contract::ALL_WAY_STOP.checked().is_ok());
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        let mut contract = Contract::WORST_CASE;
        contract.latency = 0.2;
        assert_eq!(contract.checked(), Err(ContractError::Time));
        contract = Contract::WORST_CASE;
        contract.ego.go = f32::NAN;
        assert_eq!(contract.checked(), Err(ContractError::Ego));
        contract = Contract::WORST_CASE;
        contract.ego.braking = 9.0;
        assert_eq!(contract.checked(), Err(ContractError::Other));
    }
}
