//! What the shield assumes of the world, in numbers.

mod builder;
mod demand;
#[cfg(feature = "serde")]
mod serial;

pub use builder::ContractBuilder;
pub use demand::ContractError;

/// Commands in flight at most: so many periods may the latency last.
pub const FLIGHTS: usize = 10;

/// The assumptions under which the shield's guarantee holds.
///
/// Guarantee: the ego is never in a conflict zone together with another vehicle, and never
/// hits a vehicle ahead of it in its lane. `docs/theorem.md` has the proof.
///
/// A contract that exists is valid: there are the named ones, and those that [`ContractBuilder::build`]
/// has checked.
///
/// ```
/// use cede_controller::Contract;
///
/// let mine = Contract::builder().ego_braking(4.0).latency(0.05).build()?;
/// assert_eq!(mine.ego().braking, 4.0);
///
/// let error = Contract::builder().ego_braking(9.0).build().unwrap_err();
/// assert!(error.to_string().starts_with("ego.braking = 9 is outside (0, 8]"));
/// # Ok::<(), cede_controller::ContractError>(())
/// ```
///
/// Nothing can be changed afterwards; [`Contract::to_builder`] begins another one.
///
/// ```compile_fail,E0616
/// let mut contract = cede_controller::Contract::WORST_CASE;
/// contract.latency = 9.0;
/// ```
///
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "serial::Numbers"))]
pub struct Contract {
    pub(super) period: f32,
    pub(super) latency: f32,
    pub(super) jitter: f32,
    pub(super) position_error: f32,
    pub(super) speed_error: f32,
    pub(super) slack: f32,
    pub(super) ego: Ego,
    pub(super) other: Other,
    pub(super) follower: Follower,
    pub(super) precedence: Option<Precedence>,
}

/// What the ego can do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct Ego {
    /// No command accelerates the ego beyond this speed, in m/s, up to the others' `max_speed`; one that is given
    /// while the ego's own state is missing may, by what is then not known of its speed. At least 0.01 m/s more than
    /// 2 `speed_error` + (`acceleration` + `emergency`) (`latency` + 4 `jitter` + `lag`) + `go` `period`, all of them as hard as
    /// they may be achieved: up to so far below it the ego may be held back.
    /// A limiter may keep the vehicle from going faster, and errs by `speed_error` at most. The guarantee holds with
    /// a limiter and without one.
    pub max_speed: f32,
    /// Largest acceleration that is commanded, in m/s². What it may lead to is in (0, the others' `acceleration`], and no
    /// larger than the larger of `braking` and the follower's.
    pub acceleration: f32,
    /// Acceleration that is commanded, below its limiter's speed, when it must clear a zone, in m/s², up to `acceleration`.
    /// It leads to 0.01 m/s² at least.
    pub go: f32,
    /// Braking that plans command, in m/s², and while there is one the hardest that is. It leads to 0.01 m/s² at least, and
    /// to the others' `braking` at most.
    pub braking: f32,
    /// Braking that is commanded while no plan is safe, in m/s², in [`braking`, the others' `braking`]: all there is.
    /// Nothing counts on it.
    pub emergency: f32,
    /// Time constant (s), at most, of the first-order lag with which the acceleration follows a command that is in effect,
    /// in [0, 1].
    pub lag: f32,
    /// By which share of a command the acceleration may differ from it, in [0, 0.5].
    pub gain: f32,
    /// Acceleration (m/s²), either way, that nobody commands, in [0, 5]: g times the steepest grade, wind.
    pub disturbance: f32,
}

/// What another vehicle can do, at most. It follows its route forwards.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[non_exhaustive]
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
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[non_exhaustive]
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
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[non_exhaustive]
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
    /// A rule of one's own; [`ContractBuilder::build`] checks its numbers.
    #[must_use]
    pub const fn new(distance: f32, tie: u16, braking: f32, patience: u16) -> Self {
        Self {
            distance,
            tie,
            braking,
            patience,
        }
    }

    /// An all-way stop: 12 m, half a second, 3 m/s², and turns of 1.5 s, 3 s, 6 s, …
    pub const ALL_WAY_STOP: Self = Self {
        distance: 12.0,
        tie: 5,
        braking: 3.0,
        patience: 15,
    };
}

impl Contract {
    /// The worst case: others accelerate at 3 m/s² up to 15 m/s and may brake at 8; a command takes
    /// effect one period late; at crossings nobody is courteous. Sensors are exact.
    pub const WORST_CASE: Self = Self {
        period: 0.1,
        latency: 0.1,
        jitter: 0.0,
        position_error: 0.0,
        speed_error: 0.0,
        slack: 0.01,
        ego: Ego {
            max_speed: 15.0,
            acceleration: 3.0,
            go: 3.0,
            braking: 3.0,
            emergency: 3.0,
            lag: 0.0,
            gain: 0.0,
            disturbance: 0.0,
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

    /// A builder that starts from [`Contract::WORST_CASE`].
    pub const fn builder() -> ContractBuilder {
        Self::WORST_CASE.to_builder()
    }

    /// A builder that starts from these numbers.
    pub const fn to_builder(self) -> ContractBuilder {
        ContractBuilder::new(self)
    }

    /// Time from one decision to the next in s, in [0.01, 1].
    #[must_use]
    pub const fn period(&self) -> f32 {
        self.period
    }

    /// A command takes effect within this time in s, in [0, 10 `period` − 6 `jitter`]; until then those before it do, in
    /// the order in which they were given.
    #[must_use]
    pub const fn latency(&self) -> f32 {
        self.latency
    }

    /// How far (s) a call may be from the grid of periods, either way, in [0, 0.35 `period`], with a rule of precedence
    /// up to `period`/8.
    #[must_use]
    pub const fn jitter(&self) -> f32 {
        self.jitter
    }

    /// How long (s) it is uncertain which of two commands is in effect, counted from the moment at which the second may
    /// be given at the earliest: two calls are up to two jitters nearer or farther than they should be.
    #[must_use]
    pub const fn switching(&self) -> f32 {
        self.latency + 4.0 * self.jitter
    }

    /// How long (s) a command may take until the ego is certainly no worse off than if it had been followed at once from
    /// then on: [`Contract::switching`] and the time constant of the lag.
    #[must_use]
    pub const fn response(&self) -> f32 {
        if self.ego.lag == 0.0 {
            self.switching()
        } else {
            self.switching() + self.ego.lag
        }
    }

    /// Whether a command may be followed only after the next one was given.
    pub(super) fn responds_late(&self) -> bool {
        self.response() > self.shortest_period()
    }

    /// Whether the ego achieves just what is commanded, once it follows.
    pub(super) const fn is_exact(&self) -> bool {
        self.ego.gain == 0.0 && self.ego.disturbance == 0.0
    }

    /// The least time (s) from a call that is on time to the next one.
    #[must_use]
    pub const fn shortest_period(&self) -> f32 {
        self.period - 2.0 * self.jitter
    }

    /// Largest error of a sensed arc length in m, the ego's or another's, in [0, 10].
    #[must_use]
    pub const fn position_error(&self) -> f32 {
        self.position_error
    }

    /// Largest error of a sensed speed in m/s, in [0, 10].
    #[must_use]
    pub const fn speed_error(&self) -> f32 {
        self.speed_error
    }

    /// Subtracted from every margin, in m, in [0.01, 10]: covers the rounding of `f32`.
    #[must_use]
    pub const fn slack(&self) -> f32 {
        self.slack
    }

    /// What the ego can do.
    #[must_use]
    pub const fn ego(&self) -> Ego {
        self.ego
    }

    /// What every other vehicle can do, at most.
    #[must_use]
    pub const fn other(&self) -> Other {
        self.other
    }

    /// What a vehicle does that finds the ego ahead of it in its lane.
    #[must_use]
    pub const fn follower(&self) -> Follower {
        self.follower
    }

    /// The rule of precedence that the others keep, if they do: without it nobody's courtesy is
    /// assumed where routes cross.
    #[must_use]
    pub const fn precedence(&self) -> Option<Precedence> {
        self.precedence
    }

    /// Whether commands lead to the same under both.
    pub(super) fn acts_as(&self, former: &Self) -> bool {
        self.latency == former.latency
            && self.ego.lag == former.ego.lag
            && self.ego.gain == former.ego.gain
            && self.ego.disturbance == former.ego.disturbance
            && self.ego.emergency == former.ego.emergency
            && self.ego.acceleration == former.ego.acceleration
    }

    /// Whether a plan that is safe under `former` is safe under this contract: the ego acts the same, and less is to be
    /// feared of everybody else.
    pub(super) fn keeps_plans_of(&self, former: &Self) -> bool {
        let same = self.ego == former.ego
            && self.period == former.period
            && self.slack == former.slack
            && self.precedence == former.precedence;
        let timing = self.latency <= former.latency && self.jitter <= former.jitter;
        let errors =
            self.position_error <= former.position_error && self.speed_error <= former.speed_error;
        let others = self.other.max_speed <= former.other.max_speed
            && self.other.acceleration <= former.other.acceleration
            && self.other.braking <= former.other.braking;
        let follower = self.follower.reaction <= former.follower.reaction
            && self.follower.braking >= former.follower.braking;
        same && timing && errors && others && follower
    }

    /// The speed (m/s) up to which a vehicle counts as one at rest: a quarter of what `go` gives in a period.
    pub(super) const fn rest_speed(&self) -> f32 {
        0.25 * self.ego.go * self.period
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Of a drivetrain that is a quarter off and half a m/s² more, in 0.5 s and some jitter.
    pub(in crate::shield) const INEXACT: Contract = Contract {
        jitter: 0.01,
        latency: 0.3,
        position_error: 0.2,
        speed_error: 0.1,
        slack: 0.02,
        ego: Ego {
            max_speed: 15.0,
            acceleration: 2.0,
            go: 1.0,
            braking: 5.0,
            emergency: 6.0,
            lag: 0.2,
            gain: 0.25,
            disturbance: 0.5,
        },
        other: Other {
            max_speed: 20.0,
            acceleration: 4.0,
            braking: 9.0,
        },
        precedence: Some(Precedence::new(10.0, 5, 2.0, 10)),
        ..Contract::WORST_CASE
    };

    #[test]
    fn the_named_contracts_are_in_range() {
        for contract in [Contract::WORST_CASE, Contract::ALL_WAY_STOP] {
            assert_eq!(contract.to_builder().build(), Ok(contract));
        }
    }

    /// What is said of the worst case, or of the all-way stop, after `change`.
    fn said(contract: Contract, change: impl FnOnce(&mut Contract)) -> std::string::String {
        let mut changed = contract;
        change(&mut changed);
        std::string::ToString::to_string(&changed.to_builder().build().unwrap_err())
    }

    #[test]
    fn numbers_out_of_range_are_named_with_value_and_range() {
        let worst = |change: fn(&mut Contract)| said(Contract::WORST_CASE, change);
        let begins = |text: std::string::String, beginning: &str| {
            assert!(text.starts_with(beginning), "{text}");
        };
        begins(worst(|c| c.period = 0.0), "period = 0 is outside [0.01, 1]");
        begins(
            worst(|c| c.latency = 1.1),
            "latency = 1.1 is outside [0, 1]: ",
        );
        begins(
            worst(|c| c.position_error = -1.0),
            "position_error = -1 is outside [0, 10]",
        );
        begins(worst(|c| c.slack = 0.0), "slack = 0 is outside [0.01, 10]");
        begins(
            worst(|c| (c.jitter, c.latency) = (0.01, 0.95)),
            "latency = 0.95 is outside [0, 0.94",
        );
        begins(
            worst(|c| c.ego.acceleration = 3.5),
            "ego.acceleration = 3.5 is outside (0, 3]: ",
        );
        begins(
            worst(|c| c.ego.max_speed = 16.0),
            "ego.max_speed = 16 is outside [0.9",
        );
        begins(
            worst(|c| c.ego.braking = 9.0),
            "ego.braking = 9 is outside (0, 8]: ",
        );
        begins(
            worst(|c| c.ego.go = f32::NAN),
            "ego.go = NaN is outside [0.01, 3]: ",
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
            "ego.max_speed = 15 is outside (24.975, 15]: ",
        );
    }

    /// A contract of which no two numbers are the same.
    const OWN: Contract = Contract {
        period: 0.2,
        latency: 0.3,
        jitter: 0.02,
        position_error: 0.4,
        speed_error: 0.15,
        slack: 0.05,
        ego: Ego {
            max_speed: 19.0,
            acceleration: 2.5,
            go: 1.5,
            braking: 4.0,
            emergency: 6.0,
            lag: 0.25,
            gain: 0.1,
            disturbance: 0.35,
        },
        other: Other {
            max_speed: 20.0,
            acceleration: 3.5,
            braking: 9.0,
        },
        follower: Follower {
            reaction: 0.7,
            braking: 5.0,
        },
        precedence: Some(Precedence::new(10.0, 6, 2.0, 0)),
    };

    #[test]
    fn each_number_is_set_and_got_by_its_name() {
        let builder = Contract::builder()
            .period(OWN.period())
            .latency(OWN.latency())
            .jitter(OWN.jitter())
            .position_error(OWN.position_error())
            .speed_error(OWN.speed_error())
            .slack(OWN.slack())
            .ego_max_speed(OWN.ego().max_speed)
            .ego_acceleration(OWN.ego().acceleration)
            .ego_go(OWN.ego().go)
            .ego_braking(OWN.ego().braking);
        assert_eq!(builder.unchecked().ego.emergency, OWN.ego.braking);
        let builder = builder
            .ego_emergency(OWN.ego().emergency)
            .ego_lag(OWN.ego().lag)
            .ego_gain(OWN.ego().gain)
            .ego_disturbance(OWN.ego().disturbance)
            .other_max_speed(OWN.other().max_speed)
            .other_acceleration(OWN.other().acceleration)
            .other_braking(OWN.other().braking)
            .follower_reaction(OWN.follower().reaction)
            .follower_braking(OWN.follower().braking)
            .precedence(OWN.precedence());
        assert_eq!(builder.build(), Ok(OWN));
    }

    #[test]
    fn times_are_made_of_latency_jitter_lag_and_period() {
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a}, {b}");
        near(OWN.switching(), 0.38);
        near(OWN.response(), 0.63);
        near(OWN.shortest_period(), 0.16);
        near(OWN.rest_speed(), 0.075);
        let responds_late = |latency: f32| {
            let contract = Contract::builder().jitter(0.01).latency(latency);
            contract.build().unwrap().responds_late()
        };
        assert_eq!([0.03, 0.05].map(responds_late), [false, true]);
        assert!(!Contract::WORST_CASE.responds_late());
    }

    #[test]
    fn an_ego_is_exact_without_gain_error_and_disturbance_only() {
        let exact = |gain, disturbance| {
            let mut contract = OWN;
            (contract.ego.gain, contract.ego.disturbance) = (gain, disturbance);
            contract.is_exact()
        };
        assert!(exact(0.0, 0.0));
        assert!(!exact(0.1, 0.0) && !exact(0.0, 0.1));
    }

    /// A contract after `change`.
    fn changed(change: fn(&mut Contract)) -> Contract {
        let mut contract = OWN;
        change(&mut contract);
        contract
    }

    #[test]
    fn commands_lead_to_the_same_unless_a_number_of_the_drivetrain_differs() {
        let differs: [fn(&mut Contract); 6] = [
            |c| c.latency += 0.1,
            |c| c.ego.lag += 0.1,
            |c| c.ego.gain += 0.1,
            |c| c.ego.disturbance += 0.1,
            |c| c.ego.emergency += 0.1,
            |c| c.ego.acceleration += 0.1,
        ];
        for (i, change) in differs.into_iter().enumerate() {
            assert!(!changed(change).acts_as(&OWN), "{i}");
        }
        assert!(changed(|c| c.other.max_speed += 1.0).acts_as(&OWN));
    }

    #[test]
    fn plans_are_kept_if_the_ego_is_the_same_and_no_number_of_the_others_is_worse() {
        let never: [fn(&mut Contract); 4] = [
            |c| c.ego.max_speed -= 1.0,
            |c| c.period += 0.1,
            |c| c.slack += 0.1,
            |c| c.precedence = None,
        ];
        for (i, change) in never.into_iter().enumerate() {
            assert!(!changed(change).keeps_plans_of(&OWN), "{i}");
            assert!(!OWN.keeps_plans_of(&changed(change)), "{i}");
        }
        let worse: [fn(&mut Contract); 9] = [
            |c| c.latency += 0.1,
            |c| c.jitter += 0.01,
            |c| c.position_error += 0.1,
            |c| c.speed_error += 0.1,
            |c| c.other.max_speed += 1.0,
            |c| c.other.acceleration += 0.1,
            |c| c.other.braking += 0.1,
            |c| c.follower.reaction += 0.1,
            |c| c.follower.braking -= 0.1,
        ];
        for (i, change) in worse.into_iter().enumerate() {
            assert!(!changed(change).keeps_plans_of(&OWN), "{i}");
            assert!(OWN.keeps_plans_of(&changed(change)), "{i}");
        }
        assert!(OWN.keeps_plans_of(&OWN));
    }
}
