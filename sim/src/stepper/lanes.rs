//! Eight numbers at a time: the vector instance of the controller's formulas.
//!
//! Every operation but [`Elementary::angle`] gives in each lane the bits that `f32` gives, so a formula on eight
//! numbers is the formula on each of them (tested below and in `sim/tests/batch.rs`).

use cede_controller::{Elementary, Real};
use core::f32::consts::FRAC_PI_2;
use core::ops::{Add, Div, Mul, Neg, Sub};
use wide::f32x8;

/// Eight numbers, computed with together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Eight(f32x8);

impl Eight {
    /// The eight, each for itself.
    #[inline]
    pub(crate) fn lanes(self) -> [f32; 8] {
        self.0.to_array()
    }

    /// Bit `i` is set where number `i` is 0 or negative.
    #[inline]
    pub(crate) fn not_positive(self) -> u32 {
        self.0.simd_le(f32x8::ZERO).to_bitmask()
    }

    /// Bit `i` is set where number `i` is at least that of `other`.
    #[inline]
    pub(crate) fn at_least(self, other: Self) -> u32 {
        self.0.simd_ge(other.0).to_bitmask()
    }

    /// Whether every number is greater than that of `other`.
    #[inline]
    pub(crate) fn all_greater(self, other: Self) -> bool {
        self.0.simd_gt(other.0).all()
    }

    /// `self` in the lanes in which `from` ≤ `at` < `until`, else `otherwise`.
    #[inline]
    pub(crate) fn during(self, [from, until]: [Self; 2], at: Self, otherwise: Self) -> Self {
        let during = at.0.simd_ge(from.0) & at.0.simd_lt(until.0);
        Self(during.bitselect(self.0, otherwise.0))
    }
}

impl From<[f32; 8]> for Eight {
    #[inline]
    fn from(lanes: [f32; 8]) -> Self {
        Self(lanes.into())
    }
}

impl Add for Eight {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Eight {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Mul for Eight {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl Div for Eight {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl Neg for Eight {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        // The sign alone, as for `f32`: 0 − 0 would be +0.
        Self(self.0 ^ f32x8::splat(-0.0))
    }
}

impl Real for Eight {
    #[inline]
    fn of(value: f32) -> Self {
        Self(f32x8::splat(value))
    }

    #[inline]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline]
    fn min(self, other: Self) -> Self {
        Self(other.0.simd_lt(self.0).bitselect(other.0, self.0))
    }

    #[inline]
    fn max(self, other: Self) -> Self {
        Self(other.0.simd_gt(self.0).bitselect(other.0, self.0))
    }
}

impl Elementary for Eight {
    #[inline]
    fn scaled(self, numerator: f32, denominator: f32) -> Self {
        self * Self::of(numerator / denominator)
    }

    #[inline]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    #[inline]
    fn within(self, limit: f32) -> Self {
        let most = f32x8::splat(limit);
        let raised = self.0.simd_ge(-most).bitselect(self.0, -most);
        Self(raised.simd_gt(most).bitselect(most, raised))
    }

    #[inline]
    fn not_negative(self, then: Self, otherwise: Self) -> Self {
        Self(self.0.simd_ge(f32x8::ZERO).bitselect(then.0, otherwise.0))
    }

    /// Not to the bit what `f32` gives: within 4·10⁻⁷ rad of it for coordinates that are 0 or at
    /// least 10⁻³⁰, by a polynomial.
    #[inline]
    fn angle(self, other: Self, origin: Self) -> Self {
        let angle = first_quadrant_angle(self.0, other.0);
        let somewhere = (self.0 + other.0).simd_gt(f32x8::ZERO);
        Self(somewhere.bitselect(angle, origin.0))
    }
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
    use crate::reward::svo_deviation;
    use crate::stepper::{Goal, step};
    use cede_controller::geometry::{Vector, unit};
    use cede_controller::kinematics::{State, advance, clamp_acceleration};
    use cede_controller::policy::svo::svo;
    use cede_controller::separation::OrientedBox;
    use cede_controller::{Footprint, Point, Pose};
    use proptest::prelude::*;

    const TOLERANCE: f32 = 4e-7;

    fn deviation(v: f32, d: f32, other_v: f32, other_d: f32) -> f32 {
        let [a, b, c, e, last] = [v, d, other_v, other_d, 0.3].map(Eight::of);
        let fast = svo(a, b, c, e, last);
        (fast.lanes()[0] - svo(v, d, other_v, other_d, 0.3)).abs()
    }

    #[test]
    fn svo_agrees_with_the_scalar_s_over_all_angles() {
        // Slopes in steps of 2⁻¹⁸, both ways round.
        for i in 0..=1_u32 << 18 {
            let slope = i as f32 / (1_u32 << 18) as f32;
            let worst = deviation(1.0, 1.0, slope, 1.0).max(deviation(slope, 1.0, 1.0, 1.0));
            assert!(worst <= TOLERANCE, "{slope}: {worst}");
        }
    }

    #[test]
    fn svo_agrees_with_the_scalar_s_at_the_edges() {
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

    /// The bits of `of` on eight numbers and on each of them.
    fn bits(numbers: [f32; 8], of: impl Fn(f32) -> f32, eight: impl Fn(Eight) -> Eight) {
        let expected = numbers.map(|number| of(number).to_bits());
        let lanes = eight(numbers.into()).lanes().map(f32::to_bits);
        assert_eq!(lanes, expected, "{numbers:?}");
    }

    #[test]
    fn every_operation_has_the_scalar_s_bits_on_special_numbers() {
        let numbers = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            0.0,
            -0.0,
            3.0,
            -3.0,
            1e-40,
        ];
        bits(numbers, |x| -x, |x| -x);
        bits(numbers, f32::abs, Elementary::abs);
        bits(numbers, |x| x.within(3.0), |x| x.within(3.0));
        bits(numbers, |x| x.scaled(1.0, 3.0), |x| x.scaled(1.0, 3.0));
        let of = Eight::of;
        for other in numbers {
            bits(numbers, |x| Real::min(x, other), |x| x.min(of(other)));
            bits(numbers, |x| Real::max(x, other), |x| x.max(of(other)));
            let choice = |x: f32| x.not_negative(other, 1.0);
            bits(numbers, choice, |x| x.not_negative(of(other), of(1.0)));
        }
        let roots = [0.0, -0.0, 1e-40, 0.1, 2.0, 3.0, 1e30, f32::INFINITY];
        bits(roots, Real::sqrt, Real::sqrt);
    }

    fn states(s: [f32; 8], v: [f32; 8]) -> State<Eight> {
        State {
            s: s.into(),
            v: v.into(),
        }
    }

    fn number() -> impl Strategy<Value = [f32; 8]> {
        proptest::array::uniform8(-8.0_f32..8.0)
    }

    fn speed() -> impl Strategy<Value = [f32; 8]> {
        proptest::array::uniform8(prop_oneof![Just(0.0_f32), 0.0_f32..30.0])
    }

    fn asked() -> impl Strategy<Value = [f32; 8]> {
        let special = prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(-0.0)];
        proptest::array::uniform8(prop_oneof![special, -8.0_f32..8.0])
    }

    fn pose(x: f32, y: f32, heading: f32) -> Pose {
        Pose {
            position: Point::new(x, y),
            direction: unit(heading.cos(), heading.sin()),
        }
    }

    /// The boxes of eight poses.
    fn boxes(poses: [Pose; 8]) -> OrientedBox<Eight> {
        let outline = OrientedBox::new(poses[0], Footprint::PAPER);
        let of = |number: fn(&Pose) -> f32| Eight::from(poses.map(|pose| number(&pose)));
        OrientedBox {
            centre: Point::new(of(|p| p.position.x), of(|p| p.position.y)),
            direction: Vector::new(of(|p| p.direction.x), of(|p| p.direction.y)),
            half_length: Eight::of(outline.half_length),
            half_width: Eight::of(outline.half_width),
        }
    }

    proptest! {
        #[test]
        fn motion_has_the_scalar_s_bits(s in number(), v in speed(), a in asked()) {
            let next = advance(states(s, v), clamp_acceleration(Eight::from(a)));
            for i in 0..8 {
                let scalar = advance(State { s: s[i], v: v[i] }, clamp_acceleration(a[i]));
                prop_assert_eq!(next.s.lanes()[i].to_bits(), scalar.s.to_bits());
                prop_assert_eq!(next.v.lanes()[i].to_bits(), scalar.v.to_bits());
            }
        }

        #[test]
        fn a_separation_has_the_scalar_s_bits(
            x in number(), y in number(), heading in number(), other_heading in number(),
        ) {
            let a = core::array::from_fn(|i| pose(1.0, 2.0, heading[i]));
            let b = core::array::from_fn(|i| pose(1.0 + x[i], 2.0 + y[i], other_heading[i]));
            let gap = boxes(a).separation(&boxes(b)).lanes();
            for i in 0..8 {
                let [a, b] = [a[i], b[i]].map(|pose| OrientedBox::new(pose, Footprint::PAPER));
                prop_assert_eq!(gap[i].to_bits(), a.separation(&b).to_bits());
            }
        }

        #[test]
        fn a_deviation_has_the_scalar_s_bits(svo in number(), recorded in number()) {
            let deviation = svo_deviation(Eight::from(svo), Eight::from(recorded)).lanes();
            for i in 0..8 {
                let scalar = svo_deviation(svo[i], recorded[i]);
                prop_assert_eq!(deviation[i].to_bits(), scalar.to_bits());
            }
        }

        /// Motion, margins, arrivals and end.
        #[test]
        fn a_step_of_eight_is_eight_steps(
            s in number(), v in speed(), a in asked(), gap in number(), taken in 0_u8..4,
        ) {
            let taken = f32::from(taken);
            let goal = Goal { conflict_s: [2.0, 1.0], exits: None, limit: 3.0 };
            let goals = Goal {
                conflict_s: goal.conflict_s.map(Eight::of),
                exits: None,
                limit: Eight::of(goal.limit),
            };
            let a = a.map(clamp_acceleration);
            let before = [states(s, v), states(v, s.map(f32::abs))];
            let all = step(&goals, Eight::of(taken), before, [Eight::from(a); 2], |_| gap.into());
            for i in 0..8 {
                let before = [(s[i], v[i]), (v[i], s[i].abs())].map(|(s, v)| State { s, v });
                let one = step(&goal, taken, before, [a[i]; 2], |_| gap[i]);
                let lane = all.lane(i);
                prop_assert_eq!(lane.states, one.states);
                prop_assert_eq!(lane.distance, one.distance);
                prop_assert_eq!(lane.end(), one.end());
                prop_assert_eq!(lane.arrivals(), one.arrivals());
                let over = all.margin().not_positive() >> i & 1 == 1;
                prop_assert_eq!(over, one.end().is_some());
            }
        }
    }
}
