//! Eight numbers at a time: the vector twins of scalar functions.
//!
//! Each twin evaluates its scalar's expression in the same order, both sides of a case, and
//! selects; so it gives the same bits (tested below and in `sim/tests/batch.rs`). The compiler
//! would not vectorise the scalars by itself, because it takes a division for too dear to be done in vain.

use crate::reward::SVO_SCALE;
use cede_controller::Footprint;
use cede_controller::kinematics::{MAX_ACCELERATION, STEP};
use cede_controller::policy::svo::MIN_DISTANCE;
use core::f32::consts::FRAC_PI_2;
use wide::f32x8;

/// Twin of [`cede_controller::kinematics::clamp_acceleration`].
#[inline]
fn clamp_acceleration(acceleration: f32x8) -> f32x8 {
    let most = f32x8::splat(MAX_ACCELERATION);
    let raised = acceleration.simd_ge(-most).bitselect(acceleration, -most);
    raised.simd_ge(most).bitselect(most, raised)
}

/// Twin of [`cede_controller::kinematics::advance`] with a clamped acceleration.
#[inline]
pub(super) fn advance(s: f32x8, v: f32x8, acceleration: f32x8) -> (f32x8, f32x8) {
    let acceleration = clamp_acceleration(acceleration);
    let end = v + acceleration * STEP;
    let driven = (v + end) * (0.5 * STEP);
    let stopped = v * v / (acceleration * -2.0);
    let goes_on = end.simd_ge(f32x8::ZERO);
    (
        s + goes_on.bitselect(driven, stopped),
        goes_on.bitselect(end, f32x8::ZERO),
    )
}

/// Twin of [`crate::reward::svo_deviation`].
#[inline]
pub(super) fn svo_deviation(svo: f32x8, recorded: f32x8) -> f32x8 {
    let deviation = (svo - recorded).abs() * (1.0 / SVO_SCALE);
    let one = f32x8::ONE;
    deviation.simd_lt(one).bitselect(deviation, one)
}

/// Rectangles of one size: centres (m) and unit vectors along the lengths.
#[derive(Clone, Copy)]
pub(super) struct Boxes {
    pub(super) centre: [f32x8; 2],
    pub(super) direction: [f32x8; 2],
}

/// Twin of [`cede_controller::separation::OrientedBox::separation`] for vehicles of one `footprint`.
#[inline]
pub(super) fn separation(a: Boxes, b: Boxes, footprint: Footprint) -> f32x8 {
    let between = [b.centre[0] - a.centre[0], b.centre[1] - a.centre[1]];
    let cos = dot(a.direction, b.direction).abs();
    let sin = cross(a.direction, b.direction).abs();
    let (l, w) = (0.5 * footprint.length, 0.5 * footprint.width);
    let along = cos * l + sin * w + l;
    let across = sin * l + cos * w + w;
    larger(
        larger(
            dot(between, a.direction).abs() - along,
            cross(between, a.direction).abs() - across,
        ),
        larger(
            dot(between, b.direction).abs() - along,
            cross(between, b.direction).abs() - across,
        ),
    )
}

#[inline]
fn dot(a: [f32x8; 2], b: [f32x8; 2]) -> f32x8 {
    a[0] * b[0] + a[1] * b[1]
}

#[inline]
fn cross(a: [f32x8; 2], b: [f32x8; 2]) -> f32x8 {
    a[0] * b[1] - a[1] * b[0]
}

#[inline]
fn larger(a: f32x8, b: f32x8) -> f32x8 {
    a.simd_gt(b).bitselect(a, b)
}

/// (atan t − t) / t³ on [0, 1] as a polynomial in t², lowest power first: a fit to the least
/// largest error, 4.9·10⁻⁸ before rounding.
const ARC_TANGENT: [f32; 7] = [
    -0.333_316_6,
    0.199_627_04,
    -0.139_765_81,
    0.097_942_34,
    -0.057_773_575,
    0.023_040_125,
    -0.004_355_403,
];

/// SVO (rad) of the first of two vehicles, from their speeds (m/s) and distances to the conflict point (m).
///
/// Not a twin to the bit: within 4·10⁻⁷ rad of [`cede_controller::policy::svo::svo`] for speeds that are 0
/// or at least 10⁻³⁰, by a polynomial.
#[inline]
pub(super) fn svo(speed: [f32x8; 2], distance: [f32x8; 2], last: f32x8) -> f32x8 {
    let least = f32x8::splat(MIN_DISTANCE);
    let [d, other_d] = distance.map(|d| d.simd_gt(least).bitselect(d, least));
    let own = speed[0] * other_d;
    let others = speed[1] * d;
    let angle = first_quadrant_angle(others, own);
    // With both at rest the angle is not defined.
    (own + others).simd_gt(f32x8::ZERO).bitselect(angle, last)
}

/// atan2(y, x) for x, y ≥ 0, not both 0.
#[inline]
fn first_quadrant_angle(y: f32x8, x: f32x8) -> f32x8 {
    let steep = y.simd_gt(x);
    let t = steep.bitselect(x, y) / steep.bitselect(y, x);
    let square = t * t;
    let [lower @ .., highest] = ARC_TANGENT;
    let mut series = f32x8::splat(highest);
    for coefficient in lower.into_iter().rev() {
        series = series * square + coefficient;
    }
    let angle = t + t * square * series;
    steep.bitselect(FRAC_PI_2 - angle, angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::geometry::{Point, Pose, unit};
    use cede_controller::kinematics::State;
    use cede_controller::separation::OrientedBox;
    use proptest::prelude::*;

    const TOLERANCE: f32 = 4e-7;

    fn deviation(v: f32, d: f32, other_v: f32, other_d: f32) -> f32 {
        let fast = svo(
            [v, other_v].map(f32x8::splat),
            [d, other_d].map(f32x8::splat),
            f32x8::splat(0.3),
        );
        let exact = cede_controller::policy::svo::svo(v, d, other_v, other_d, 0.3);
        (fast.to_array()[0] - exact).abs()
    }

    #[test]
    fn svo_agrees_with_the_controller_s_over_all_angles() {
        // Slopes in steps of 2⁻¹⁸, both ways round.
        for i in 0..=1_u32 << 18 {
            let slope = i as f32 / (1_u32 << 18) as f32;
            let worst = deviation(1.0, 1.0, slope, 1.0).max(deviation(slope, 1.0, 1.0, 1.0));
            assert!(worst <= TOLERANCE, "{slope}: {worst}");
        }
    }

    #[test]
    fn svo_agrees_with_the_controller_s_at_the_edges() {
        let own = [
            (0.0, 10.0),
            (5.0, 0.0),
            (5.0, -1.0),
            (30.0, 200.0),
            (1e-30, 5.0),
        ];
        let others = [(0.0, 10.0), (3.0, 0.0), (1e-3, 100.0), (0.0, 0.0)];
        for (v, d) in own {
            for (other_v, other_d) in others {
                assert!(deviation(v, d, other_v, other_d) <= TOLERANCE);
            }
        }
    }

    proptest! {
        #[test]
        fn a_step_has_the_scalar_s_bits(
            s in -200.0_f32..200.0, v in prop_oneof![Just(0.0_f32), 0.0_f32..30.0],
            a in prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(-0.0), -8.0_f32..8.0],
        ) {
            let scalar = cede_controller::kinematics::advance(State { s, v }, cede_controller::kinematics::clamp_acceleration(a));
            let [s, v, a] = [s, v, a].map(f32x8::splat);
            let (next_s, next_v) = advance(s, v, a);
            prop_assert_eq!(next_s.to_array(), [scalar.s; 8]);
            prop_assert_eq!(next_v.to_array(), [scalar.v; 8]);
        }

        #[test]
        fn a_separation_has_the_scalar_s_bits(
            x in -8.0_f32..8.0, y in -8.0_f32..8.0,
            heading in -3.2_f32..3.2, other_heading in -3.2_f32..3.2,
        ) {
            let pose = |x: f32, y: f32, heading: f32| Pose {
                position: Point::new(x, y),
                direction: unit(heading.cos(), heading.sin()),
            };
            let (a, b) = (pose(1.0, 2.0, heading), pose(1.0 + x, 2.0 + y, other_heading));
            let outline = |pose| OrientedBox::new(pose, Footprint::PAPER);
            let boxes = |pose: Pose| Boxes {
                centre: [pose.position.x, pose.position.y].map(f32x8::splat),
                direction: [pose.direction.x, pose.direction.y].map(f32x8::splat),
            };
            let twin = separation(boxes(a), boxes(b), Footprint::PAPER);
            prop_assert_eq!(twin.to_array(), [outline(a).separation(&outline(b)); 8]);
        }

        #[test]
        fn a_deviation_has_the_scalar_s_bits(svo in 0.0_f32..1.6, recorded in 0.0_f32..1.6) {
            let twin = svo_deviation(f32x8::splat(svo), f32x8::splat(recorded));
            prop_assert_eq!(twin.to_array(), [crate::reward::svo_deviation(svo, recorded); 8]);
        }
    }
}
