//! The contract's numbers in f64, so that the attacker computes with its own precision.

use cede_controller::Contract;

/// What the contract allows; see the fields of [`Contract`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numbers {
    /// Time from one decision to the next in s.
    pub period: f64,
    /// A call may be so much early or late, in s.
    pub jitter: f64,
    /// A command is in effect after so much, in s.
    pub latency: f64,
    /// Largest error of an arc length in m.
    pub position_error: f64,
    /// Largest error of a speed in m/s.
    pub speed_error: f64,
    /// The ego.
    pub ego: Means,
    /// The acceleration that the ego surely achieves in m/s².
    pub go: f64,
    /// The braking that the ego surely achieves in m/s².
    pub brakes: f64,
    /// How the ego follows commands.
    pub drivetrain: Drivetrain,
    /// Every other.
    pub other: Means,
    /// Reaction of one behind the ego in s.
    pub reaction: f64,
    /// What one behind the ego brakes at, in m/s².
    pub follower_braking: f64,
    /// The rule of precedence that everybody keeps.
    pub rule: Option<Rule>,
}

/// How far an ego may be from what is commanded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drivetrain {
    /// Longest time constant in s with which the acceleration follows.
    pub lag: f64,
    /// Share of a command by which the acceleration may differ from it.
    pub gain: f64,
    /// Acceleration in m/s², either way, that nobody commands.
    pub disturbance: f64,
}

impl Drivetrain {
    /// By how much (m/s²) the acceleration may differ from `command`.
    #[must_use]
    pub fn off(&self, command: f64) -> f64 {
        self.gain * command.abs() + self.disturbance
    }

    /// Whether it does just what is commanded, at once.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.lag == 0.0 && self.gain == 0.0 && self.disturbance == 0.0
    }
}

/// Bounds of one vehicle's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Means {
    /// Highest speed in m/s.
    pub speed: f64,
    /// Hardest acceleration in m/s².
    pub acceleration: f64,
    /// Hardest braking in m/s².
    pub braking: f64,
}

/// A rule of precedence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// One that is so near (m) has arrived.
    pub distance: f64,
    /// Arrivals within so many periods are a tie.
    pub tie: u16,
    /// Braking in m/s² with which one stops that has to wait.
    pub braking: f64,
    /// Periods of rest after which precedence passes on; 0: never.
    pub patience: u16,
}

impl Numbers {
    /// Those of `contract`.
    #[must_use]
    pub fn of(contract: &Contract) -> Self {
        let (ego, other, follower) = (contract.ego(), contract.other(), contract.follower());
        let drivetrain = Drivetrain {
            lag: ego.lag.into(),
            gain: ego.gain.into(),
            disturbance: ego.disturbance.into(),
        };
        let [go, braking, acceleration] = [ego.go, ego.braking, ego.acceleration].map(f64::from);
        Self {
            period: contract.period().into(),
            jitter: contract.jitter().into(),
            latency: contract.latency().into(),
            position_error: contract.position_error().into(),
            speed_error: contract.speed_error().into(),
            ego: Means {
                speed: ego.max_speed.into(),
                acceleration: acceleration + drivetrain.off(acceleration),
                braking: braking + drivetrain.off(braking),
            },
            go: go - drivetrain.off(go),
            brakes: braking - drivetrain.off(braking),
            drivetrain,
            other: Means {
                speed: other.max_speed.into(),
                acceleration: other.acceleration.into(),
                braking: other.braking.into(),
            },
            reaction: follower.reaction.into(),
            follower_braking: follower.braking.into(),
            rule: contract.precedence().map(|rule| Rule {
                distance: rule.distance.into(),
                tie: rule.tie,
                braking: rule.braking.into(),
                patience: rule.patience,
            }),
        }
    }

    /// Seconds until a command is certainly followed.
    #[must_use]
    pub fn response(&self) -> f64 {
        self.latency + 4.0 * self.jitter + self.drivetrain.lag
    }

    /// The distance that one at `v` needs to stop behind an ego at `ego_v`, after having accelerated for the whole of
    /// its reaction time, however hard the ego brakes within its means (responsibility-sensitive safety).
    #[must_use]
    pub fn safe_gap(&self, v: f64, ego_v: f64) -> f64 {
        let start = crate::motion::State { s: 0.0, v };
        let reacted = start.after(self.other.acceleration, self.reaction, self.other.speed);
        let ahead = self.ego.braking.max(self.follower_braking);
        (reacted.rest(self.follower_braking) - ego_v * ego_v / (2.0 * ahead)).max(0.0)
    }
}
