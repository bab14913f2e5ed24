//! Social value orientation (SVO) of a vehicle towards another at a conflict point.
//!
//! The outcome of a vehicle is U = v/d, its speed over the distance that it
//! still has to go to the conflict point. The utility U·cos φ + Û·sin φ is
//! largest at φ* = atan2(Û, U): 0 is an individualist, π/4 cooperative, π/2 an
//! altruist. (Equations 2 to 5 of the paper, with the errata of `docs/method.md`.)

use crate::real::Elementary;

/// The SVO (rad) of a vehicle of which nothing is known yet: cooperative.
pub const FIRST: f32 = core::f32::consts::FRAC_PI_4;

/// Distances are floored here (m), so that the outcome at the conflict point stays finite.
pub const MIN_DISTANCE: f32 = 0.1;

/// The SVO φ* in radians, in [0, π/2].
///
/// `speed`, `distance`: the ego's, m/s and m to the conflict point; `other_…`
/// the other's. `last` is returned when both are at rest, where φ* is not
/// defined. Negative speeds count as rest. Finite for finite input.
#[must_use]
#[inline]
pub fn svo<R: Elementary>(speed: R, distance: R, other_speed: R, other_distance: R, last: R) -> R {
    let floor = |d: R| R::of(MIN_DISTANCE).max(d);
    let moving = |v: R| v.max(R::of(0.0));
    // v̂/d̂ over v/d, without a division.
    let ordinate = moving(other_speed) * floor(distance);
    ordinate.angle(moving(speed) * floor(other_distance), last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::{FRAC_PI_2, FRAC_PI_4};

    #[test]
    fn the_three_named_orientations() {
        assert_eq!(svo(5.0, 10.0, 0.0, 10.0, 1.0), 0.0);
        assert_eq!(svo(5.0, 10.0, 5.0, 10.0, 1.0), FRAC_PI_4);
        assert_eq!(svo(0.0, 10.0, 5.0, 10.0, 1.0), FRAC_PI_2);
    }

    #[test]
    fn two_vehicles_at_rest_keep_the_last_value() {
        assert_eq!(svo(0.0, 10.0, 0.0, 10.0, 0.7), 0.7);
    }

    #[test]
    fn the_two_vehicles_orientations_are_complements() {
        let sum = svo(3.0, 12.0, 7.0, 20.0, 0.0) + svo(7.0, 20.0, 3.0, 12.0, 0.0);
        assert!((sum - FRAC_PI_2).abs() < 1e-6);
    }
}
