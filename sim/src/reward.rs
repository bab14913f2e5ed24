//! The paper's rewards (equations 6 to 10, with the errata of `docs/method.md`).
//!
//! A step earns r = −r₁ − 2r₂ − r₃ + r₄. What it earns at once is −r₁ + r₄; r₂ and r₃ need the
//! episode's length, so they are added to every step of an episode once it has ended (the
//! *episode-replay* reward).

use cede_controller::Elementary;

/// r₄: what a collision earns.
pub const COLLISION: f32 = -10.0;
/// r₁ of a step past the record's end, where there is nothing to compare with.
pub const PAST_THE_RECORD: f32 = 0.5;
/// Deviation of the SVO (rad) at which r₁ reaches 1.
pub const SVO_SCALE: f32 = 0.5;
/// Sum of the two speeds (m/s) at which r₃ weighs the length error by 1.
pub const SPEED_SCALE: f32 = 20.0;

/// r₁ in [0, 1]: deviation of the SVO from the recorded one at the same step (both in rad).
#[must_use]
#[inline]
pub fn svo_deviation<R: Elementary>(svo: R, recorded: R) -> R {
    R::of(1.0).min((svo - recorded).abs().scaled(1.0, SVO_SCALE))
}

/// Length of an episode that has ended, beside the recorded one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EpisodeLength {
    /// Steps l that it took.
    pub steps: u32,
    /// Steps l_GT of the record, at least 1.
    pub recorded: u32,
}

impl EpisodeLength {
    /// (l − l_GT) / l_GT, in [−1, 1] for an episode that is cut at twice the record's length.
    #[must_use]
    pub fn error(self) -> f32 {
        let recorded = self.recorded as f32;
        (self.steps as f32 - recorded) / recorded
    }

    /// −2r₂ − r₃: what a step that ends with the two `speeds` (their sum, m/s) earns afterwards.
    #[must_use]
    pub fn replayed(self, speeds: f32) -> f32 {
        let error = self.error();
        -2.0 * error.abs() + speeds * (1.0 / SPEED_SCALE) * error
    }

    /// The sum of [`EpisodeLength::replayed`] over the episode, given the sum of `speeds` over its steps.
    #[must_use]
    pub fn replayed_total(self, speeds: f32) -> f32 {
        let error = self.error();
        -2.0 * error.abs() * self.steps as f32 + speeds * (1.0 / SPEED_SCALE) * error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviation_saturates_at_half_a_radian() {
        assert_eq!(svo_deviation(0.75, 0.5), 0.5);
        assert_eq!(svo_deviation(0.0, 1.5), 1.0);
    }

    #[test]
    fn too_slow_an_episode_rewards_speed_and_too_fast_a_one_penalises_it() {
        let slow = EpisodeLength {
            steps: 30,
            recorded: 20,
        };
        let fast = EpisodeLength {
            steps: 10,
            recorded: 20,
        };
        assert_eq!(slow.replayed(10.0), -1.0 + 0.25);
        assert_eq!(fast.replayed(10.0), -1.0 - 0.25);
        let exact = EpisodeLength {
            steps: 20,
            recorded: 20,
        };
        assert_eq!(exact.replayed(10.0), 0.0);
        assert_eq!(slow.replayed_total(300.0), 30.0 * slow.replayed(10.0));
    }
}
