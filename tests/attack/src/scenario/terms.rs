//! Random contracts.

use crate::rng::Rng;
use cede_controller::{Contract, Precedence};

/// The numbers of a contract that a family varies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// Errors of position and speed.
    pub errors: [f32; 2],
    /// Period, latency and jitter in s.
    pub times: [f32; 3],
    /// The ego's highest speed and braking.
    pub ego: [f32; 2],
    /// The ego's emergency braking is harder by this factor.
    pub emergency: f32,
    /// The ego's lag in s, the share of its gain's error and the disturbance in m/s².
    pub drivetrain: [f32; 3],
    /// The others' highest speed, acceleration and braking.
    pub other: [f32; 3],
    /// Reaction and braking of followers.
    pub follower: [f32; 2],
    /// The rule of precedence.
    pub rule: Option<Precedence>,
}

impl Terms {
    /// The worst case, with exact sensors.
    pub const WORST: Self = Self {
        errors: [0.0; 2],
        times: [0.1, 0.1, 0.0],
        ego: [15.0, 3.0],
        emergency: 1.0,
        drivetrain: [0.0; 3],
        other: [15.0, 3.0, 8.0],
        follower: [0.5, 4.0],
        rule: None,
    };

    /// The contract; none if its numbers do not go together.
    #[must_use]
    pub fn contract(&self) -> Option<Contract> {
        let Self {
            errors,
            times,
            ego,
            emergency,
            drivetrain: [lag, gain, disturbance],
            other,
            follower,
            rule,
        } = *self;
        let launch = other[1].min(ego[1].max(follower[1])).min(3.0);
        let launch = (launch - disturbance) / (1.0 + gain);
        Contract::builder()
            .position_error(errors[0])
            .speed_error(errors[1])
            .period(times[0])
            .latency(times[1])
            .jitter(times[2])
            .ego_max_speed(ego[0].min(other[0]))
            .ego_braking(ego[1])
            .ego_emergency(emergency * ego[1])
            .ego_lag(lag)
            .ego_gain(gain)
            .ego_disturbance(disturbance)
            .ego_acceleration(launch)
            .ego_go(launch)
            .other_max_speed(other[0])
            .other_acceleration(other[1])
            .other_braking(other[2])
            .follower_reaction(follower[0])
            .follower_braking(follower[1])
            .precedence(rule)
            .build()
            .ok()
    }

    /// Close to the worst case: other brakes, speeds, latencies and reactions.
    #[must_use]
    pub fn usual(rng: &mut Rng) -> Self {
        Self {
            times: rng.pick(&[
                [0.1, 0.1, 0.0],
                [0.1, 0.1, 0.0],
                [0.1, 0.05, 0.0],
                [0.1, 0.0, 0.0],
            ]),
            ego: [
                rng.pick(&[15.0, 15.0, 14.0, 8.0, 1.5]),
                rng.pick(&[3.0, 3.0, 4.0, 6.0]),
            ],
            other: rng.pick(&[
                [15.0, 3.0, 8.0],
                [15.0, 3.0, 8.0],
                [12.0, 2.0, 6.0],
                [20.0, 4.0, 9.0],
            ]),
            follower: rng.pick(&[[0.5, 4.0], [0.5, 4.0], [1.0, 3.0], [0.0, 5.0]]),
            ..Self::WORST
        }
    }

    /// With sensors that err.
    #[must_use]
    pub fn blurred(mut self, rng: &mut Rng) -> Self {
        self.errors = rng.pick(&[
            [0.1, 0.1],
            [0.3, 0.3],
            [0.6, 0.6],
            [0.02, 0.0],
            [0.3, 0.0],
            [0.0, 0.5],
            [1.0, 0.2],
        ]);
        self
    }

    /// With exact sensors or not.
    #[must_use]
    pub fn perhaps_blurred(self, rng: &mut Rng) -> Self {
        if rng.chance(0.5) {
            self
        } else {
            self.blurred(rng)
        }
    }

    /// With other periods, latencies and jitter.
    #[must_use]
    pub fn other_times(mut self, rng: &mut Rng) -> Self {
        self.times = rng.pick(&[
            [0.1, 0.04, 0.01],
            [0.1, 0.0, 0.01],
            [0.1, 0.07, 0.005],
            [0.05, 0.05, 0.0],
            [0.05, 0.02, 0.005],
            [0.2, 0.2, 0.0],
            [0.2, 0.05, 0.025],
            [0.2, 0.0, 0.02],
        ]);
        self
    }

    /// With commands in flight, lag, gain and disturbance.
    #[must_use]
    pub fn driven(mut self, rng: &mut Rng) -> Self {
        self.times = rng.pick(&[
            [0.1, 0.3, 0.0],
            [0.1, 0.3, 0.0125],
            [0.1, 0.2, 0.0],
            [0.1, 0.15, 0.01],
            [0.1, 0.0, 0.0],
            [0.05, 0.2, 0.005],
            [0.2, 0.5, 0.0],
        ]);
        self.drivetrain = rng.pick(&[
            [0.2, 0.1, 0.0],
            [0.2, 0.1, 0.2],
            [0.2, 0.0, 0.0],
            [0.0, 0.1, 0.0],
            [0.0, 0.0, 0.5],
            [0.4, 0.05, 0.1],
        ]);
        self.emergency = rng.pick(&[1.0, 1.2]);
        self.ego[0] = self.ego[0].max(8.0);
        self
    }

    /// All that the manual says of a real car, at once: response, gain, jitter, sensors.
    #[must_use]
    pub fn real(mut self, rng: &mut Rng) -> Self {
        self.times = [0.1, 0.3, rng.pick(&[0.03, 0.03, 0.0])];
        self.drivetrain = [0.2, 0.1, 0.0];
        self.errors = [0.3, 0.3];
        self.ego = [15.0, rng.pick(&[3.0, 4.0, 5.0])];
        self.other = [15.0, 3.0, 9.0];
        self.emergency = 1.2;
        self
    }

    /// With a rule of precedence.
    #[must_use]
    pub fn with_rule(mut self, rng: &mut Rng) -> Self {
        let mut rule = Precedence::ALL_WAY_STOP;
        rule.distance = rng.pick(&[12.0, 12.0, 8.0, 20.0]);
        rule.tie = rng.pick(&[5, 5, 0, 2, 10]);
        rule.patience = rng.pick(&[15, 15, 15, 5, 10, 0]);
        rule.braking = rng.pick(&[3.0, 3.0, 2.0]);
        self.rule = Some(rule);
        self
    }

    /// For vehicles that all have the shield: none is faster than the others fear.
    #[must_use]
    pub fn among_equals(mut self, rng: &mut Rng) -> Self {
        self.ego[0] = rng.pick(&[15.0, 14.0, 14.0, 8.0]);
        self.other[0] = self.other[0].max(15.0);
        self
    }
}
