//! The controller's features on a whole box of states: their ranges, those of their derivatives, and
//! what `f32` may make of them.

pub(super) use crate::interval::Interval;
use cede_controller::{Elementary, Real};
use std::f64::consts::FRAC_PI_2;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Number of state variables.
pub(super) const STATE: usize = 4;

/// Relative rounding of one `f32` operation: twice what rounding to nearest can do, which covers the
/// rounding of this bound as well.
const UNIT: f64 = f32::EPSILON as f64;

/// Absolute rounding of one `f32` operation whose result underflows: more than the smallest `f32`.
const UNDERFLOW: f64 = 1e-44;

/// More than the error of `libm::atan2f` (below one unit in the last place), in rad.
const ANGLE: f64 = 16.0 * f32::EPSILON as f64;

/// The range of a function on a box of states, the ranges of its partial derivatives (its
/// generalised ones, where it has a kink: the mean value theorem holds for both), and how far its
/// `f32` computation can be from it at the same state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Enclosure {
    pub(super) value: Interval,
    pub(super) slopes: [Interval; STATE],
    /// The `f32` computation is at most this far off.
    pub(super) rounding: f64,
    /// And at most this share of the value off; infinite where that is not known.
    relative: f64,
}

const ANY: Interval = Interval {
    lo: f64::NEG_INFINITY,
    hi: f64::INFINITY,
};

impl Enclosure {
    /// State variable number `index`, an `f32` in `value`.
    pub(super) fn variable(value: Interval, index: usize) -> Self {
        let mut slopes = [Interval::ZERO; STATE];
        slopes[index] = Interval::point(1.0);
        Self {
            value,
            slopes,
            rounding: 0.0,
            relative: 0.0,
        }
    }

    /// The result of an operation: the error that its operands bring in, and its own rounding.
    fn rounded(value: Interval, slopes: [Interval; STATE], carried: f64) -> Self {
        Self {
            value,
            slopes,
            rounding: (carried + UNIT * value.magnitude() + UNDERFLOW).next_up(),
            relative: f64::INFINITY,
        }
    }

    fn slopes(self, other: Self, of: impl Fn(Interval, Interval) -> Interval) -> [Interval; STATE] {
        std::array::from_fn(|i| of(self.slopes[i], other.slopes[i]))
    }

    /// One of the two, and it is not certain which; both are equal where the choice changes.
    fn either(self, other: Self, value: Interval) -> Self {
        Self {
            value,
            slopes: self.slopes(other, Interval::hull),
            rounding: self.rounding.max(other.rounding),
            relative: self.relative.max(other.relative),
        }
    }
}

impl Add for Enclosure {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let slopes = self.slopes(other, Interval::add);
        let carried = self.rounding + other.rounding;
        Self::rounded(self.value.add(other.value), slopes, carried)
    }
}

impl Sub for Enclosure {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Enclosure {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            slopes: self.slopes.map(Interval::neg),
            ..self
        }
    }
}

impl Mul for Enclosure {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let slopes = self.slopes(other, |a, b| a.mul(other.value).add(b.mul(self.value)));
        let carried = self.value.magnitude() * other.rounding
            + (other.value.magnitude() + other.rounding) * self.rounding;
        Self {
            relative: (1.0 + self.relative) * (1.0 + other.relative) * (1.0 + UNIT) - 1.0 + UNIT,
            ..Self::rounded(self.value.mul(other.value), slopes, carried)
        }
    }
}

/// By something positive.
impl Div for Enclosure {
    type Output = Self;
    fn div(self, by: Self) -> Self {
        let value = self.value.div(by.value);
        let slopes = self.slopes(by, |a, b| a.sub(value.mul(b)).div(by.value));
        // ã/b̃ − a/b = (ã − a)/b̃ − (a/b)(b̃ − b)/b̃
        let least = by.value.lo - by.rounding;
        let carried = if least > 0.0 {
            (self.rounding + value.magnitude() * by.rounding) / least
        } else {
            f64::INFINITY
        };
        Self::rounded(value, slopes, carried)
    }
}

impl Real for Enclosure {
    fn of(value: f32) -> Self {
        Self {
            value: Interval::of(value),
            slopes: [Interval::ZERO; STATE],
            rounding: 0.0,
            relative: 0.0,
        }
    }

    /// Of something positive; of anything else nothing is known.
    fn sqrt(self) -> Self {
        let value = Real::sqrt(self.value);
        let least = (self.value.lo - self.rounding).max(0.0).sqrt();
        let slopes = self.slopes.map(|slope| {
            if least > 0.0 {
                slope.div(value.scale(2.0))
            } else {
                ANY
            }
        });
        Self::rounded(value, slopes, self.rounding / least)
    }

    fn min(self, other: Self) -> Self {
        -Real::max(-self, -other)
    }

    fn max(self, other: Self) -> Self {
        let value = Real::max(self.value, other.value);
        let all = self.either(other, value);
        // What is larger in the reals is so for the derivatives; `f32` may choose the other one.
        let slopes = if self.value.lo >= other.value.hi {
            self.slopes
        } else if other.value.lo >= self.value.hi {
            other.slopes
        } else {
            all.slopes
        };
        Self { slopes, ..all }
    }
}

impl Elementary for Enclosure {
    fn scaled(self, numerator: f32, denominator: f32) -> Self {
        self * Self::of(numerator / denominator)
    }

    fn abs(self) -> Self {
        self.max(-self)
    }

    fn within(self, limit: f32) -> Self {
        Real::max(Real::min(self, Self::of(limit)), Self::of(-limit))
    }

    /// Where the sign is not certain, of either: then there may be a jump.
    fn not_negative(self, then: Self, otherwise: Self) -> Self {
        if self.value.lo - self.rounding >= 0.0 {
            return then;
        }
        if self.value.hi + self.rounding < 0.0 {
            return otherwise;
        }
        let value = then.value.hull(otherwise.value);
        Self {
            slopes: [ANY; STATE],
            rounding: then.rounding.max(otherwise.rounding) + (value.hi - value.lo),
            relative: f64::INFINITY,
            value,
        }
    }

    fn angle(self, other: Self, origin: Self) -> Self {
        let (y, x) = (
            self.value.clamp(0.0, f64::INFINITY),
            other.value.clamp(0.0, f64::INFINITY),
        );
        // A few steps more than one: the system's atan2 is not correctly rounded.
        let slack = 8.0 * f64::EPSILON;
        let squares = y.mul(y).add(x.mul(x));
        if squares.lo <= 0.0 {
            let all = Interval::new(-slack, FRAC_PI_2 + slack);
            return Self {
                value: all.hull(origin.value),
                slopes: [ANY; STATE],
                // Whatever `f32` computes is in that range, but for the rounding of its ends.
                rounding: ANGLE + origin.rounding,
                relative: f64::INFINITY,
            };
        }
        // |x·δy − y·δx| / (x² + y²), which is at most δ where both err by a share δ of themselves.
        let share = self.relative.max(other.relative);
        let carried = x.magnitude() * self.rounding + y.magnitude() * other.rounding;
        Self {
            value: Interval::new(y.lo.atan2(x.hi) - slack, y.hi.atan2(x.lo) + slack),
            slopes: self.slopes(other, |dy, dx| x.mul(dy).sub(y.mul(dx)).div(squares)),
            rounding: ANGLE + (2.0 * share).min(2.0 * carried / squares.lo),
            relative: f64::INFINITY,
        }
    }
}
