//! The policy: from a pair of vehicles to the ego's acceleration and the other's, as it expects it.

#[cfg(feature = "embedded-policy")]
pub mod embedded;
mod error;
pub mod estimate;
pub mod features;
pub mod fixed;
pub mod mlp;
pub mod orientation;
pub(crate) mod pair;
pub mod svo;
pub(crate) mod traffic;
pub mod weights;

pub use error::WeightsError;
pub use estimate::{Estimate, OrientationFilter};
pub use features::FeatureSet;
pub use fixed::FixedMlp;
pub use mlp::Mlp;
pub use orientation::{Orientation, OrientationError};
pub use pair::{Crosser, Leader, Pair, Part, VehicleState};
pub use traffic::{NearbyVehicle, TrafficContext};
pub use weights::{Network, Perspective, Weights};

#[cfg(doc)]
use crate::policy::features::LIMIT;
use crate::policy::features::MAX_FEATURES;

/// Largest acceleration and braking (m/s²) that a policy proposes.
pub use crate::kinematics::MAX_ACCELERATION;

/// The acceleration (m/s²) that a network's output stands for.
#[must_use]
#[inline]
pub fn acceleration(output: f32) -> f32 {
    MAX_ACCELERATION * crate::real::tanh(output)
}

/// How [`acceleration`] answers to a small change of the output, where it is `acceleration` (m/s²).
#[must_use]
#[inline]
pub fn acceleration_slope(acceleration: f32) -> f32 {
    MAX_ACCELERATION - acceleration * acceleration / MAX_ACCELERATION
}

/// A network that drives. Copying it copies no weights.
#[derive(Clone, Copy, Debug)]
pub struct Policy<'a> {
    weights: Weights<'a>,
    orientation: Orientation,
}

impl<'a> Policy<'a> {
    /// The policy of a weights file, whose words it borrows.
    ///
    /// Cost: O(words).
    ///
    /// # Errors
    /// See [`Weights::parse`].
    pub fn new(words: &'a [u32]) -> Result<Self, WeightsError> {
        Weights::parse(words).map(Self::from)
    }

    /// The weights file.
    #[must_use]
    pub const fn weights(&self) -> &Weights<'a> {
        &self.weights
    }

    /// The same network, showing `orientation`.
    ///
    /// # Errors
    /// It is another than [`Orientation::LEARNED`], and the network sees coordinates or commands both vehicles.
    pub fn oriented(self, orientation: Orientation) -> Result<Self, OrientationError> {
        match self.without_dial() {
            Some(error) if orientation != Orientation::LEARNED => Err(error),
            _ => Ok(Self {
                orientation,
                ..self
            }),
        }
    }

    /// Why it can show no other orientation than it learned, if it cannot.
    fn without_dial(&self) -> Option<OrientationError> {
        if self.weights.features() == FeatureSet::Raw {
            return Some(OrientationError::Raw);
        }
        (self.weights.perspective() == Perspective::Joint).then_some(OrientationError::Joint)
    }

    /// The orientation that it shows.
    #[must_use]
    pub const fn orientation(&self) -> Orientation {
        self.orientation
    }

    /// What the policy proposes for the ego, and what it expects of the other, in m/s² within ± 3.
    ///
    /// What it expects of the other does not depend on its orientation. In any state an altruist proposes no more, and an
    /// egoist no less, than [`Orientation::LEARNED`].
    ///
    /// Cost: the features, one pass through the network, two `tanh`; twice that with another orientation. Finite and
    /// within ± 3 for any `pair` whatsoever.
    #[must_use]
    pub fn act(&self, pair: &Pair) -> [f32; 2] {
        let [plain, expected] = self.answer(pair);
        [self.shown(self.orientation, pair, plain), expected]
    }

    /// What it proposes with `orientation`, where it proposes `plain` as it learned (m/s²).
    fn shown(&self, orientation: Orientation, pair: &Pair, plain: f32) -> f32 {
        orientation.weigh(pair).map_or(plain, |weighed| {
            let [asked, _] = self.answer(&weighed);
            orientation.choose(asked, plain)
        })
    }

    /// What the network says of `pair`, as it is shown.
    fn answer(&self, pair: &Pair) -> [f32; 2] {
        let inputs = self.inputs(pair);
        let inputs = inputs.get(..self.weights.features().count()).unwrap_or(&[]);
        let [first, second, ..] = self.weights.network().forward(inputs);
        let [first, second] = [first, second].map(acceleration);
        if self.swaps(pair) {
            [second, first]
        } else {
            [first, second]
        }
    }

    /// The network's inputs for `pair`: the normalised features, each within ± [`LIMIT`], then zeros. Those of
    /// a [`Perspective::Joint`] policy are the left-turner's, whoever the ego is.
    ///
    /// Cost: the features. Finite and within ± [`LIMIT`] for any `pair` whatsoever.
    // Not inlined, because its stack is free again when the network needs its own.
    #[must_use]
    #[inline(never)]
    pub fn inputs(&self, pair: &Pair) -> [f32; MAX_FEATURES] {
        let mut inputs = if self.swaps(pair) {
            self.weights.features().of(&pair.swapped())
        } else {
            self.weights.features().of(pair)
        };
        for (input, (centre, scale)) in inputs.iter_mut().zip(self.weights.normalisation()) {
            *input = features::normalised(*input, centre, scale);
        }
        inputs
    }

    /// Whether the network sees the other first.
    fn swaps(&self, pair: &Pair) -> bool {
        self.weights.perspective() == Perspective::Joint && pair.part == Part::Other
    }
}

impl<'a> From<Weights<'a>> for Policy<'a> {
    fn from(weights: Weights<'a>) -> Self {
        Self {
            weights,
            orientation: Orientation::LEARNED,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::geometry::{Footprint, Point, Pose, unit};
    use crate::junction::Control;
    use crate::junction::conflict::RightOfWay;
    use crate::junction::kind::ConflictKind;
    use crate::policy::features::FeatureSet;
    use crate::policy::pair::testing::pair;
    use crate::policy::pair::{Crosser, Leader, VehicleState};
    use crate::policy::weights::testing::file;
    use proptest::prelude::*;

    #[test]
    fn a_joint_policy_commands_the_same_two_vehicles_from_either_seat() {
        let joint = file(FeatureSet::Raw, Perspective::Joint, 16);
        let joint = Policy::new(&joint).unwrap();
        let [left, other] = joint.act(&pair());
        assert_eq!(joint.act(&pair().swapped()), [other, left]);
        assert_ne!(left, other);
    }

    #[test]
    fn an_ego_policy_sees_itself_first() {
        let ego = file(FeatureSet::Route, Perspective::Ego, 16);
        let ego = Policy::new(&ego).unwrap();
        assert_eq!(ego.inputs(&pair())[1], (6.0 - 1.0) * 0.1);
        assert_eq!(ego.inputs(&pair().swapped())[1], (8.0 - 1.0) * 0.1);
    }

    #[test]
    fn only_a_policy_that_drives_one_vehicle_by_distances_shows_an_orientation() {
        let altruist = Orientation::from_degrees(70.0).unwrap();
        for (features, perspective, refused) in [
            (
                FeatureSet::Raw,
                Perspective::Ego,
                Some(OrientationError::Raw),
            ),
            (
                FeatureSet::Route,
                Perspective::Joint,
                Some(OrientationError::Joint),
            ),
            (FeatureSet::Route, Perspective::Ego, None),
        ] {
            let file = file(features, perspective, 16);
            let policy = Policy::new(&file).unwrap();
            assert_eq!(policy.oriented(altruist).err(), refused);
            let neutral = policy.oriented(Orientation::LEARNED).unwrap();
            assert_eq!(neutral.act(&pair()), policy.act(&pair()));
        }
    }

    prop_compose! {
        fn any_vehicle_state()(bits in any::<[u32; 12]>(), follows in any::<bool>()) -> VehicleState {
            let [x, y, dx, dy, ex, ey, speed, distance, length, width, gap, leads] = bits.map(f32::from_bits);
            VehicleState {
                pose: Pose { position: Point::new(x, y), direction: unit(dx, dy) },
                exit: unit(ex, ey),
                speed,
                distance,
                footprint: Footprint { length, width },
                leader: follows.then_some(Leader { gap, speed: leads }),
                crosser: follows.then_some(Crosser { distance: gap, its_distance: leads, its_speed: speed }),
                control: Control::ALL[bits[0] as usize % Control::ALL.len()],
            }
        }
    }

    proptest! {
        #[test]
        fn whatever_the_bits_the_proposal_is_in_range(
            ego in any_vehicle_state(), other in any_vehicle_state(), svo in any::<u32>(), left in any::<bool>(),
        ) {
            let pair = Pair {
                ego,
                other,
                kind: ConflictKind::Merging,
                right_of_way: RightOfWay::Ego,
                part: if left { Part::Left } else { Part::Other },
                last_svo: f32::from_bits(svo),
            };
            for features in FeatureSet::ALL {
                let file = file(features, Perspective::Joint, 16);
                for a in Policy::new(&file).unwrap().act(&pair) {
                    prop_assert!(a.abs() <= MAX_ACCELERATION, "{a}");
                }
            }
        }

        #[test]
        fn an_altruist_never_proposes_more_and_an_egoist_never_less(
            ego in (0.0_f32..60.0, 0.0_f32..15.0), other in (-20.0_f32..80.0, 0.0_f32..15.0), degrees in 0.0_f32..90.0,
        ) {
            let mut pair = pair();
            (pair.ego.distance, pair.ego.speed) = ego;
            (pair.other.distance, pair.other.speed) = other;
            let file = file(FeatureSet::Route, Perspective::Ego, 16);
            let learned = Policy::new(&file).unwrap();
            let shown = learned.oriented(Orientation::from_degrees(degrees).unwrap()).unwrap();
            let ([plain, expected], [asked, same]) = (learned.act(&pair), shown.act(&pair));
            prop_assert_eq!(expected, same);
            if degrees > 45.0 {
                prop_assert!(asked <= plain);
            } else {
                prop_assert!(asked >= plain);
            }
        }
    }
}
