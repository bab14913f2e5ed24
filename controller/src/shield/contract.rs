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
    /// Braking that it achieves, and the hardest that is commanded, in m/s², in (0, the others' `braking`].
    pub braking: f32,
}

/// What another vehicle can do, at most. It follows its route forwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Other {
    /// Highest speed in m/s, in (0, 100]. A vehicle seen above it keeps that speed at most.
    pub max_speed: f32,
    /// Hardest acceleration in m/s², in (0, 20].
    pub acceleration: f32,
    /// Hardest braking in m/s², in (0, 20].
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
    /// Braking in m/s², in (0, 20], with which the other is expected to stop; with `patience`, at most the ego's.
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

/// The first number of a [`Contract`] that is out of its range. Prints as `ego.braking = 9 is outside (0, 8]`, with
/// a reason where the range depends on other numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContractError {
    field: &'static str,
    value: f32,
    range: Range,
    why: &'static str,
}

impl ContractError {
    /// Path of the field in [`Contract`], as in `ego.braking`.
    #[must_use]
    pub const fn field(&self) -> &'static str {
        self.field
    }

    /// The value that it has.
    #[must_use]
    pub const fn value(&self) -> f32 {
        self.value
    }
}

impl core::fmt::Display for ContractError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Range { open, low, high } = self.range;
        let bracket = if open { '(' } else { '[' };
        let Self {
            field, value, why, ..
        } = self;
        write!(
            f,
            "{field} = {value} is outside {bracket}{low}, {high}]{why}"
        )
    }
}

impl core::error::Error for ContractError {}

/// From `low` to `high`, without `low` where it is `open`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    open: bool,
    low: f32,
    high: f32,
}

impl Range {
    /// `(low, high]`.
    const fn above(low: f32, high: f32) -> Self {
        let open = true;
        Self { open, low, high }
    }

    /// `[low, high]`.
    const fn from(low: f32, high: f32) -> Self {
        let open = false;
        Self { open, low, high }
    }

    /// The error of `field`, if `value` is not in the range.
    fn check(self, field: &'static str, value: f32) -> Result<(), ContractError> {
        self.check_since(field, value, "")
    }

    /// The same; `why` says what the range comes from.
    fn check_since(
        self,
        field: &'static str,
        value: f32,
        why: &'static str,
    ) -> Result<(), ContractError> {
        let low = if self.open {
            value > self.low
        } else {
            value >= self.low
        };
        if low && value <= self.high {
            return Ok(());
        }
        Err(ContractError {
            field,
            value,
            range: self,
            why,
        })
    }
}

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

    /// The contract, if every number is in its range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn checked(self) -> Result<Self, ContractError> {
        Range::above(0.0, 1.0).check("period", self.period)?;
        let late = ": a command takes effect before the next one";
        Range::from(0.0, self.period).check_since("latency", self.latency, late)?;
        let tolerance = Range::from(0.0, 10.0);
        tolerance.check("position_error", self.position_error)?;
        tolerance.check("speed_error", self.speed_error)?;
        tolerance.check("slack", self.slack)?;
        self.check_vehicles()?;
        if let Some(rule) = self.precedence {
            self.check_precedence(rule)?;
        }
        Ok(self)
    }

    fn check_vehicles(&self) -> Result<(), ContractError> {
        let (ego, other, follower) = (self.ego, self.other, self.follower);
        let (speed, acceleration) = (Range::above(0.0, 100.0), Range::above(0.0, 20.0));
        speed.check("other.max_speed", other.max_speed)?;
        acceleration.check("other.acceleration", other.acceleration)?;
        acceleration.check("other.braking", other.braking)?;
        speed.check("ego.max_speed", ego.max_speed)?;
        acceleration.check("ego.acceleration", ego.acceleration)?;
        let commanded = ": it goes no harder than ego.acceleration, the hardest that is commanded";
        Range::above(0.0, ego.acceleration).check_since("ego.go", ego.go, commanded)?;
        // The gap to a leader is smallest at the end only if the leader can brake harder.
        let leader =
            ": it brakes no harder than other.braking, the hardest braking of a vehicle ahead";
        Range::above(0.0, other.braking).check_since("ego.braking", ego.braking, leader)?;
        Range::from(0.0, 10.0).check("follower.reaction", follower.reaction)?;
        let hardest = ": it brakes no harder than other.braking, the hardest of all the others";
        Range::above(0.0, other.braking).check_since("follower.braking", follower.braking, hardest)
    }

    fn check_precedence(&self, rule: Precedence) -> Result<(), ContractError> {
        Range::above(0.0, 200.0).check("precedence.distance", rule.distance)?;
        Range::above(0.0, 20.0).check("precedence.braking", rule.braking)?;
        if rule.patience == 0 {
            return Ok(());
        }
        let turns = "; 0 leaves out the turns";
        Range::from(5.0, f32::from(u16::MAX)).check_since(
            "precedence.patience",
            f32::from(rule.patience),
            turns,
        )?;
        // A vehicle whose turn is past stops where the other expects it.
        let stops =
            ": who takes turns stops as hard as it is expected to, and has ego.braking to do so";
        Range::above(0.0, self.ego.braking).check_since(
            "precedence.braking",
            rule.braking,
            stops,
        )?;
        // One that goes is seen: it gets faster, in spite of its limiter, than one that may be taken for one at rest.
        let seen = ": who takes turns must be seen to go, in spite of speed_error";
        let rest = self.rest_speed() + 2.0 * self.speed_error;
        if rest < self.ego.max_speed - self.speed_error {
            return Ok(());
        }
        Err(ContractError {
            field: "ego.max_speed",
            value: self.ego.max_speed,
            range: Range::above(rest + self.speed_error, 100.0),
            why: seen,
        })
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

    /// What is said of the worst case, or of the all-way stop, after `change`.
    fn said(contract: Contract, change: impl FnOnce(&mut Contract)) -> std::string::String {
        let mut changed = contract;
        change(&mut changed);
        std::string::ToString::to_string(&changed.checked().unwrap_err())
    }

    #[test]
    fn numbers_out_of_range_are_named_with_value_and_range() {
        let worst = |change: fn(&mut Contract)| said(Contract::WORST_CASE, change);
        let begins = |text: std::string::String, beginning: &str| {
            assert!(text.starts_with(beginning), "{text}");
        };
        begins(worst(|c| c.period = 0.0), "period = 0 is outside (0, 1]");
        begins(
            worst(|c| c.latency = 0.2),
            "latency = 0.2 is outside [0, 0.1]: ",
        );
        begins(
            worst(|c| c.position_error = -1.0),
            "position_error = -1 is outside [0, 10]",
        );
        begins(worst(|c| c.slack = 11.0), "slack = 11 is outside [0, 10]");
        begins(
            worst(|c| c.ego.braking = 9.0),
            "ego.braking = 9 is outside (0, 8]: ",
        );
        begins(
            worst(|c| c.ego.go = f32::NAN),
            "ego.go = NaN is outside (0, 3]: ",
        );
        begins(
            worst(|c| c.other.braking = 21.0),
            "other.braking = 21 is outside (0, 20]",
        );
        begins(
            worst(|c| c.follower.braking = 8.5),
            "follower.braking = 8.5 is outside (0, 8]: ",
        );
    }

    #[test]
    fn numbers_of_the_rule_of_precedence_are_named() {
        let stop = |change: fn(&mut Contract, &mut Precedence)| {
            said(Contract::ALL_WAY_STOP, |contract| {
                let mut rule = Precedence::ALL_WAY_STOP;
                change(contract, &mut rule);
                contract.precedence = Some(rule);
            })
        };
        let begins = |text: std::string::String, beginning: &str| {
            assert!(text.starts_with(beginning), "{text}");
        };
        begins(
            stop(|_, rule| rule.distance = 0.0),
            "precedence.distance = 0 is outside (0, 200]",
        );
        begins(
            stop(|_, rule| rule.patience = 4),
            "precedence.patience = 4 is outside [5, 65535]; 0 ",
        );
        begins(
            stop(|_, rule| rule.braking = 3.5),
            "precedence.braking = 3.5 is outside (0, 3]: ",
        );
        begins(
            stop(|contract, _| contract.speed_error = 6.0),
            "ego.max_speed = 15 is outside (18.075, 100]: ",
        );
    }
}
