//! The dial: which social value orientation (SVO) the ego shows.
//!
//! A driver of orientation φ weighs its own outcome U = v/d by cos φ and the other's, Û = v̂/d̂, by sin φ
//! ([`svo`](crate::policy::svo)). The policy learned from people as they are, and weighs both alike: φ = π/4. With another
//! φ it is shown the other's outcome as many times as large as sin φ is of cos φ: an other that is tan φ times as near.
//! An altruist sees everybody come sooner, and waits for those for whom the policy would not; an egoist sees them come
//! later.

use crate::policy::pair::{Pair, VehicleState};
use crate::real::Real;
use core::f32::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_4, FRAC_PI_6, PI};
use core::fmt;

/// The other counts as at most this many times as near, or as far. Orientations beyond 76° and below 14° are as these.
pub const MOST: f32 = 4.0;

/// The orientation that the ego shows: 0 an egoist, π/4 as people drive, π/2 an altruist.
///
/// ```
/// use cede_controller::Orientation;
///
/// let courteous = Orientation::from_degrees(60.0)?;
/// assert!(courteous > Orientation::LEARNED);
/// assert!(Orientation::from_degrees(120.0).is_err());
/// # Ok::<(), cede_controller::OrientationError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Orientation {
    radians: f32,
    /// tan φ, within [1 / [`MOST`], [`MOST`]]; exactly 1 at π/4.
    weight: f32,
}

impl Orientation {
    /// As people drive: the policy's decisions are exactly those that it has without a dial.
    pub const LEARNED: Self = Self {
        radians: FRAC_PI_4,
        weight: 1.0,
    };

    /// 15, 30, 45, 60 and 75°.
    pub const FIVE: [Self; 5] = [
        Self::of(PI / 12.0, 0.267_949_2),
        Self::of(FRAC_PI_6, 0.577_350_26),
        Self::LEARNED,
        Self::of(FRAC_PI_3, 1.732_050_8),
        Self::of(PI * 5.0 / 12.0, 3.732_051),
    ];

    const fn of(radians: f32, weight: f32) -> Self {
        Self { radians, weight }
    }

    /// The orientation φ in radians.
    ///
    /// # Errors
    /// [`OrientationError::Range`] outside of [0, π/2], or if it is not a number.
    pub fn new(radians: f32) -> Result<Self, OrientationError> {
        if !(0.0..=FRAC_PI_2).contains(&radians) {
            return Err(OrientationError::Range);
        }
        if radians == FRAC_PI_4 {
            return Ok(Self::LEARNED);
        }
        // At π/2 the cosine of an f32 is just above or below 0.
        let weight = libm::sinf(radians) / Real::max(libm::cosf(radians), f32::MIN_POSITIVE);
        Ok(Self {
            radians,
            weight: Real::min(Real::max(weight, 1.0 / MOST), MOST),
        })
    }

    /// The orientation in degrees, in [0, 90].
    ///
    /// # Errors
    /// See [`Orientation::new`].
    pub fn from_degrees(degrees: f32) -> Result<Self, OrientationError> {
        match degrees {
            45.0 => Ok(Self::LEARNED),
            90.0 => Self::new(FRAC_PI_2),
            _ => Self::new(degrees.to_radians()),
        }
    }

    /// φ in radians.
    #[must_use]
    pub const fn radians(self) -> f32 {
        self.radians
    }

    /// `pair` as the ego weighs it; nothing, where that is as it is: at π/4, and once the other is past its conflict point.
    pub(super) fn weigh(self, pair: &Pair) -> Option<Pair> {
        let other = VehicleState {
            distance: pair.other.distance / self.weight,
            ..pair.other
        };
        let shown = self.weight != 1.0 && pair.other.distance > 0.0;
        shown.then_some(Pair { other, ..*pair })
    }

    /// Of what is proposed for the weighed pair and for the pair as it is (m/s²): an altruist never accelerates more than
    /// without the dial, an egoist never less.
    pub(super) fn choose(self, weighed: f32, plain: f32) -> f32 {
        if self.weight > 1.0 {
            Real::min(plain, weighed)
        } else {
            Real::max(plain, weighed)
        }
    }
}

impl Default for Orientation {
    fn default() -> Self {
        Self::LEARNED
    }
}

/// Why the policy cannot show an orientation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OrientationError {
    /// It is not between 0 and π/2.
    Range,
    /// The policy sees coordinates ([`FeatureSet::Raw`](crate::FeatureSet::Raw)), in which no distance can be weighed.
    Raw,
    /// The policy commands both vehicles ([`Perspective::Joint`](crate::Perspective::Joint)): what one gains by the dial,
    /// the other loses.
    Joint,
}

impl fmt::Display for OrientationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Range => "an orientation is between 0 and 90° (π/2): 0 an egoist, 45° as learned, 90° an altruist",
            Self::Raw => "this policy sees coordinates (features `raw`): it cannot show another orientation than it learned",
            Self::Joint => "this policy commands both vehicles (perspective `joint`): it cannot show one's orientation",
        })
    }
}

impl core::error::Error for OrientationError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::policy::pair::testing::pair;

    #[test]
    fn the_settings_are_in_order_and_their_ends_are_limited() {
        let weights = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0]
            .map(|degrees| Orientation::from_degrees(degrees).unwrap().weight);
        assert!(weights.is_sorted_by(|a, b| a < b), "{weights:?}");
        assert_eq!((weights[0], weights[3], weights[6]), (0.25, 1.0, 4.0));
        assert!((weights[2] * weights[4] - 1.0).abs() < 1e-6);
        assert_eq!(Orientation::new(FRAC_PI_4), Ok(Orientation::LEARNED));
        for (five, degrees) in Orientation::FIVE.iter().zip([15.0, 30.0, 45.0, 60.0, 75.0]) {
            let same = Orientation::from_degrees(degrees).unwrap();
            assert!((five.radians - same.radians).abs() < 1e-6, "{degrees}");
            assert!((five.weight / same.weight - 1.0).abs() < 1e-5, "{degrees}");
        }
        for outside in [-1.0, 90.1, f32::NAN, f32::INFINITY] {
            let refused = Orientation::from_degrees(outside);
            assert_eq!(refused, Err(OrientationError::Range), "{outside}");
        }
    }

    #[test]
    fn an_altruist_sees_the_other_nearer_and_measures_a_higher_svo() {
        let seen = |degrees| Orientation::from_degrees(degrees).unwrap().weigh(&pair());
        let (egoist, altruist) = (seen(30.0).unwrap(), seen(60.0).unwrap());
        assert!(altruist.other.distance < 20.0 && egoist.other.distance > 20.0);
        assert!(egoist.svo() < pair().svo() && pair().svo() < altruist.svo());
        assert_eq!(altruist.ego, pair().ego);
        assert_eq!(seen(45.0), None);
    }

    #[test]
    fn one_that_has_passed_is_seen_as_it_is() {
        let mut passed = pair();
        passed.other.distance = -1.0;
        let altruist = Orientation::from_degrees(90.0).unwrap();
        assert_eq!(altruist.weigh(&passed), None);
    }
}
