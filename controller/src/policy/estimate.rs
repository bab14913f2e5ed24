//! The social value orientation (SVO) that another vehicle shows, estimated from what it does.
//!
//! A Bayesian filter over five settings of the [dial](crate::policy::orientation): the policy, seated in the other vehicle,
//! says what a driver of each orientation would do next; how the other then accelerates makes some of them likelier.

use crate::policy::Policy;
use crate::policy::orientation::Orientation;
use crate::policy::pair::Pair;
use crate::real::{Elementary, Real, tanh};

/// The orientations that are compared.
const SETTINGS: [Orientation; 5] = Orientation::FIVE;
/// Scale (m/s) of the Laplace distribution of how far the speed strays from what a setting expects, in a second of looks:
/// people are coarser than the policy, and what they do in consecutive periods is not independent.
const SCALE: f32 = 0.1;
/// Time constant (s) with which what is known fades.
const MEMORY: f32 = 2.5;
/// Accelerations (m/s²) count up to here.
const MOST: f32 = 6.0;
/// Variance (rad²) of the settings if all are alike: that of 15, 30, 45, 60 and 75° is 450 square degrees.
const ALIKE: f32 = 0.137_077_84;

/// What is known of the orientation that one other shows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Estimate {
    /// Its orientation (rad), the mean over what is possible: π/4 if nothing is known.
    pub svo: f32,
    /// In [0, 1]: 0 if nothing is known, 1 if no doubt is left.
    pub confidence: f32,
    /// The acceleration (m/s²) that is expected of it, within ± 3.
    pub acceleration: f32,
}

/// The filter for one other vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OrientationFilter {
    /// Logarithms of the settings' likelihoods.
    likelihoods: [f32; SETTINGS.len()],
    /// What each setting expected the other to do (m/s²) when it was seen last, and its speed (m/s) then.
    expected: Option<([f32; SETTINGS.len()], f32)>,
}

impl OrientationFilter {
    /// Looks at the other of `pair`, as the ego sees the two, `elapsed` seconds after the last look.
    ///
    /// Cost: five passes through the network of `policy`. Finite for finite `elapsed` above 0 and any `pair` whatsoever.
    pub fn look(&mut self, policy: &Policy<'_>, pair: &Pair, elapsed: f32) -> Estimate {
        let speed = pair.other.speed;
        if let Some((expected, before)) = self.expected {
            let acceleration = ((speed - before) / elapsed).within(MOST);
            let kept = exp(-elapsed / MEMORY);
            for (known, setting) in self.likelihoods.iter_mut().zip(expected) {
                let wanted = held(setting, before, elapsed);
                let strayed = elapsed * Elementary::abs(acceleration - wanted);
                *known = kept * *known - strayed / SCALE;
            }
        }
        let accelerations = proposals(policy, &pair.swapped());
        self.expected = Some((accelerations, speed));
        self.estimate(accelerations, speed, elapsed)
    }

    /// Forgets what was expected, not what is known: the next look is at another moment than was meant.
    pub fn skip(&mut self) {
        self.expected = None;
    }

    fn estimate(&self, accelerations: [f32; SETTINGS.len()], speed: f32, elapsed: f32) -> Estimate {
        let most = self.likelihoods.into_iter().fold(f32::MIN, Real::max);
        let weights = self.likelihoods.map(|known| exp(known - most));
        // The likeliest weighs 1.
        let sum: f32 = weights.iter().sum();
        let mean = |values: [f32; SETTINGS.len()]| {
            let all = weights.iter().zip(values);
            all.map(|(weight, value)| weight * value).sum::<f32>() / sum
        };
        let settings = SETTINGS.map(Orientation::radians);
        let svo = mean(settings);
        let spread = mean(settings.map(|setting| (setting - svo) * (setting - svo)));
        Estimate {
            svo,
            confidence: Real::max(1.0 - crate::real::sqrt(spread / ALIKE), 0.0),
            acceleration: mean(accelerations.map(|a| held(a, speed, elapsed))),
        }
    }
}

/// The acceleration (m/s²) over a step of `elapsed` seconds of a vehicle that wants `wanted` at `speed`: it does not reverse.
fn held(wanted: f32, speed: f32, elapsed: f32) -> f32 {
    Real::max(wanted, -Real::max(speed, 0.0) / elapsed)
}

/// eˣ for x ≤ 0, by what the network needs anyway.
fn exp(x: f32) -> f32 {
    let half = tanh(0.5 * x);
    (1.0 + half) / (1.0 - half)
}

/// What the driver of `seat` would do with each of the settings; a policy without a dial does the same with all.
fn proposals(policy: &Policy<'_>, seat: &Pair) -> [f32; SETTINGS.len()] {
    let [plain, _] = policy.answer(seat);
    if policy.without_dial().is_some() {
        return [plain; SETTINGS.len()];
    }
    SETTINGS.map(|orientation| policy.shown(orientation, seat, plain))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::policy::pair::testing::pair;
    use crate::policy::weights::testing::file;
    use crate::{FeatureSet, Perspective};
    use core::f32::consts::FRAC_PI_4;
    use proptest::prelude::*;

    /// What is estimated of an other that drives with one of the settings for 2 s, by the policy that the ego knows.
    fn estimated(policy: &Policy<'_>, setting: usize) -> Estimate {
        let (mut filter, mut seen) = (OrientationFilter::default(), pair());
        let mut last = filter.look(policy, &seen, 0.1);
        for _ in 0..20 {
            let acceleration = proposals(policy, &seen.swapped())[setting];
            seen.other.distance -= 0.1 * seen.other.speed;
            seen.other.speed = (seen.other.speed + 0.1 * acceleration).max(0.0);
            seen.ego.distance -= 0.1 * seen.ego.speed;
            last = filter.look(policy, &seen, 0.1);
        }
        last
    }

    #[test]
    #[cfg(feature = "embedded-policy")]
    fn egoists_and_altruists_are_told_apart() {
        let policy = Policy::new(crate::policy::embedded::words()).unwrap();
        let [egoist, altruist] = [0, 4].map(|setting| estimated(&policy, setting));
        assert!(egoist.svo < altruist.svo - 0.1, "{egoist:?} {altruist:?}");
        assert!(egoist.confidence > 0.1 && altruist.confidence > 0.1);
    }

    #[test]
    fn the_exponential_is_one() {
        for x in [0.0, -0.01, -0.7, -5.0, -20.0, -1e6] {
            assert!((exp(x) - libm::expf(x)).abs() < 2e-7, "{x}: {}", exp(x));
        }
    }

    #[test]
    fn before_anything_is_seen_nothing_is_known() {
        let file = file(FeatureSet::Route, Perspective::Ego, 16);
        let policy = Policy::new(&file).unwrap();
        let first = OrientationFilter::default().look(&policy, &pair(), 0.1);
        assert!((first.svo - FRAC_PI_4).abs() < 1e-6);
        assert!(first.confidence.abs() < 1e-6);
    }

    #[test]
    fn of_a_policy_without_a_dial_nothing_is_learned() {
        let file = file(FeatureSet::Route, Perspective::Joint, 16);
        let policy = Policy::new(&file).unwrap();
        let last = estimated(&policy, 4);
        assert!(
            (last.svo - FRAC_PI_4).abs() < 1e-5 && last.confidence < 1e-3,
            "{last:?}"
        );
    }

    proptest! {
        #[test]
        fn estimates_are_finite_and_within_their_ranges(
            speeds in proptest::collection::vec(any::<u32>(), 1..8), distance in any::<u32>(),
        ) {
            let file = file(FeatureSet::Route, Perspective::Ego, 16);
            let policy = Policy::new(&file).unwrap();
            let (mut filter, mut seen) = (OrientationFilter::default(), pair());
            seen.other.distance = f32::from_bits(distance);
            for speed in speeds {
                seen.other.speed = f32::from_bits(speed);
                let estimate = filter.look(&policy, &seen, 0.1);
                prop_assert!((0.0..=core::f32::consts::FRAC_PI_2).contains(&estimate.svo), "{estimate:?}");
                prop_assert!((0.0..=1.0).contains(&estimate.confidence), "{estimate:?}");
                prop_assert!(estimate.acceleration.abs() <= 3.0, "{estimate:?}");
            }
        }
    }
}
