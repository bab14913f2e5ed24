//! A number as the reals have it and as `f32` computes it, for all inputs of a box at once.

use crate::interval::Interval;
use cede_controller::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What the real-valued expression can be, what its `f32` evaluation can be, and how far the one can be from
/// the other at the same inputs.
///
/// The `f32` operations round to the nearest, with gradual underflow. Rounding is monotone, so the `f32` results
/// at the ends of an interval are the ends of the `f32` results: they need no outward rounding.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounded {
    /// Holds the real result.
    pub(super) exact: Interval,
    /// Hold the `f32` result, which is a finite number unless [`Rounded::error`] is infinite.
    computed: [f32; 2],
    /// The `f32` result is at most this far from the real one.
    pub(super) error: f64,
}

impl Rounded {
    const UNKNOWN: Self = Self {
        exact: Interval {
            lo: f64::NEG_INFINITY,
            hi: f64::INFINITY,
        },
        computed: [f32::NEG_INFINITY, f32::INFINITY],
        error: f64::INFINITY,
    };

    /// Any `f32` from `lo` to `hi`: an input, so without an error.
    pub(super) fn input([lo, hi]: [f32; 2]) -> Self {
        Self {
            exact: Interval::new(lo.into(), hi.into()),
            computed: [lo, hi],
            error: 0.0,
        }
    }

    /// The result of an operation that rounds: its operands' errors bring in `carried`, its own
    /// rounding half a unit in the last place.
    fn rounding(exact: Interval, computed: [f32; 2], carried: f64) -> Self {
        Self::within(exact, computed, up(carried + half_unit(computed)))
    }

    /// A result with this error, or the distance from one end to the other, which is never exceeded.
    fn within(exact: Interval, computed: [f32; 2], error: f64) -> Self {
        let [lo, hi] = computed.map(f64::from);
        let farthest = up((hi - exact.lo).max(exact.hi - lo));
        // Also false if one of them is not a number.
        if !(lo.is_finite() && hi.is_finite() && exact.magnitude().is_finite() && error >= 0.0) {
            return Self::UNKNOWN;
        }
        Self {
            exact,
            computed,
            error: error.min(farthest.max(0.0)),
        }
    }

    /// The number, if it is one, the same in the reals and in `f32`.
    fn known(self) -> Option<f32> {
        let [lo, hi] = self.computed;
        (lo == hi && self.exact == Interval::point(lo.into()) && self.error == 0.0).then_some(lo)
    }

    /// The largest magnitude of the real number.
    fn size(self) -> f64 {
        self.exact.magnitude()
    }

    /// The `f32` results of a monotone operation at the corners: their hull holds all.
    fn corners(self, other: Self, operation: fn(f32, f32) -> f32) -> [f32; 2] {
        let ([a, b], [c, d]) = (self.computed, other.computed);
        let results = [(a, c), (a, d), (b, c), (b, d)].map(|(x, y)| operation(x, y));
        if results.iter().any(|r| r.is_nan()) {
            return Self::UNKNOWN.computed;
        }
        results
            .iter()
            .fold([f32::INFINITY, f32::NEG_INFINITY], |[lo, hi], &r| {
                [lo.min(r), hi.max(r)]
            })
    }

    /// Whether this is certainly not below `other`, in the reals and in `f32`.
    fn not_below(self, other: Self) -> bool {
        self.exact.lo >= other.exact.hi && self.computed[0] >= other.computed[1]
    }
}

/// The next `f64` above: covers the rounding of the operation before.
fn up(value: f64) -> f64 {
    value.next_up()
}

/// Half the distance from an `f32` in this interval to its neighbour, at most: what rounding to nearest can do.
fn half_unit([lo, hi]: [f32; 2]) -> f64 {
    let size = lo.abs().max(hi.abs());
    if size.is_finite() {
        0.5 * (f64::from(size.next_up()) - f64::from(size))
    } else {
        f64::INFINITY
    }
}

/// Whether multiplication by it is exact, but for underflow.
fn is_power_of_two(value: f32) -> bool {
    value.is_normal() && value.to_bits() << 9 == 0
}

impl Add for Rounded {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let computed = self.corners(other, |a, b| a + b);
        if let (Some(a), Some(b)) = (self.known(), other.known()) {
            let sum = f64::from(a) + f64::from(b);
            // The sum of two `f32` of like size is exact in `f64`: here, of a number and itself.
            if a == b && f64::from(a + b) == sum {
                return Self::input([a + b; 2]);
            }
        }
        let carried = up(self.error + other.error);
        Self::rounding(self.exact + other.exact, computed, carried)
    }
}

impl Sub for Rounded {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Rounded {
    type Output = Self;
    fn neg(self) -> Self {
        let [lo, hi] = self.computed;
        Self {
            exact: -self.exact,
            computed: [-hi, -lo],
            error: self.error,
        }
    }
}

impl Mul for Rounded {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let exact = self.exact * other.exact;
        let computed = self.corners(other, |a, b| a * b);
        let first = up(self.size() * other.error);
        let second = up(up(other.size() + other.error) * self.error);
        let carried = up(first + second);
        let factors = [self.known(), other.known()];
        if factors.into_iter().flatten().any(is_power_of_two) {
            // Exact, unless the result is subnormal.
            let lost = half_unit([0.0; 2]);
            return Self::within(exact, computed, up(carried + lost));
        }
        Self::rounding(exact, computed, carried)
    }
}

/// By numbers that are certainly positive; by others nothing is known.
impl Div for Rounded {
    type Output = Self;
    fn div(self, by: Self) -> Self {
        let least = f64::from(by.computed[0]);
        if !(by.exact.lo > 0.0 && least > 0.0) {
            return Self::UNKNOWN;
        }
        let exact = self.exact / by.exact;
        let computed = self.corners(by, |a, b| a / b);
        // ã/b̃ − a/b = (ã − a)/b̃ − (a/b)(b̃ − b)/b̃
        let numerator = up(self.error + up(exact.magnitude() * by.error));
        Self::rounding(exact, computed, up(numerator / least))
    }
}

impl Real for Rounded {
    fn of(value: f32) -> Self {
        Self::input([value; 2])
    }

    /// Of a real number that is not negative; that the computed one is none is checked.
    fn sqrt(self) -> Self {
        let [lo, hi] = self.computed;
        if lo < 0.0 {
            return Self::UNKNOWN;
        }
        let exact = Real::sqrt(self.exact);
        // √x̃ − √x = (x̃ − x)/(√x̃ + √x), and at most √|x̃ − x|.
        let sum = (exact.lo.max(0.0) + f64::from(lo).sqrt().next_down()).next_down();
        let carried = up(self.error / sum.max(0.0)).min(up(self.error.sqrt()));
        Self::rounding(exact, [Real::sqrt(lo), Real::sqrt(hi)], carried)
    }

    fn min(self, other: Self) -> Self {
        -Real::max(-self, -other)
    }

    fn max(self, other: Self) -> Self {
        if self.not_below(other) {
            return self;
        }
        if other.not_below(self) {
            return other;
        }
        let ([a, b], [c, d]) = (self.computed, other.computed);
        Self::within(
            Real::max(self.exact, other.exact),
            [a.max(c), b.max(d)],
            self.error.max(other.error),
        )
    }
}
