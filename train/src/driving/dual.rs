//! A number with its derivatives: what the controller's formulas become when a gradient goes through them.

use cede_controller::{Elementary, Real};
use core::ops::{Add, Div, Mul, Neg, Sub};

/// How many variables derivatives are taken by.
pub const VARIABLES: usize = 4;

/// Below this, y² + x² makes the angle of (x, y) so steep that it would drown every other gradient.
const STEEPEST_ANGLE: f32 = 1.0;

/// A number and its derivatives by [`VARIABLES`] variables.
///
/// Where a function has a kink, the derivative is that of the side that is selected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual {
    /// The number.
    pub value: f32,
    /// Its derivatives.
    pub slopes: [f32; VARIABLES],
}

impl Dual {
    /// A number that depends on variable `index` with slope `slope`.
    #[must_use]
    pub fn variable(value: f32, index: usize, slope: f32) -> Self {
        let mut slopes = [0.0; VARIABLES];
        slopes[index] = slope;
        Self { value, slopes }
    }

    #[inline]
    fn map(self, value: f32, slope: impl Fn(f32) -> f32) -> Self {
        Self {
            value,
            slopes: self.slopes.map(slope),
        }
    }

    #[inline]
    fn zip(self, other: Self, value: f32, slope: impl Fn(f32, f32) -> f32) -> Self {
        Self {
            value,
            slopes: core::array::from_fn(|i| slope(self.slopes[i], other.slopes[i])),
        }
    }
}

impl Add for Dual {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, self.value + other.value, |a, b| a + b)
    }
}

impl Sub for Dual {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, self.value - other.value, |a, b| a - b)
    }
}

impl Mul for Dual {
    type Output = Self;
    #[inline]
    #[expect(
        clippy::suspicious_arithmetic_impl,
        reason = "the product rule is a sum"
    )]
    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        self.zip(other, value, |a, b| a * other.value + b * self.value)
    }
}

impl Div for Dual {
    type Output = Self;
    #[inline]
    fn div(self, by: Self) -> Self {
        let square = by.value * by.value;
        self.zip(by, self.value / by.value, |a, b| {
            a / by.value - self.value * b / square
        })
    }
}

impl Neg for Dual {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.map(-self.value, |a| -a)
    }
}

impl Real for Dual {
    #[inline]
    fn of(value: f32) -> Self {
        Self {
            value,
            slopes: [0.0; VARIABLES],
        }
    }

    #[inline]
    fn sqrt(self) -> Self {
        let root = Real::sqrt(self.value);
        self.map(root, |a| a / (root + root))
    }

    #[inline]
    fn min(self, other: Self) -> Self {
        if other.value < self.value {
            other
        } else {
            self
        }
    }

    #[inline]
    fn max(self, other: Self) -> Self {
        if other.value > self.value {
            other
        } else {
            self
        }
    }
}

impl Elementary for Dual {
    /// The derivative is scaled by the exact quotient, not by the rounded one.
    #[inline]
    fn scaled(self, numerator: f32, denominator: f32) -> Self {
        self.map(self.value.scaled(numerator, denominator), |a| {
            a * numerator / denominator
        })
    }

    #[inline]
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }

    #[inline]
    fn within(self, limit: f32) -> Self {
        let value = self.value.within(limit);
        if value == self.value {
            self
        } else {
            Self::of(value)
        }
    }

    #[inline]
    fn not_negative(self, then: Self, otherwise: Self) -> Self {
        if self.value >= 0.0 { then } else { otherwise }
    }

    /// The derivatives are those of the angle, flattened near the origin: see `STEEPEST_ANGLE`.
    #[inline]
    fn angle(self, other: Self, origin: Self) -> Self {
        let (y, x) = (self.value, other.value);
        if y == 0.0 && x == 0.0 {
            return origin;
        }
        let scale = 1.0 / (x * x + y * y).max(STEEPEST_ANGLE);
        let (by_y, by_x) = (scale * x, scale * y);
        self.zip(other, y.angle(x, 0.0), |dy, dx| by_y * dy - by_x * dx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::OrientedBox;
    use cede_controller::geometry::{Footprint, Point, Pose, Vector, unit};
    use cede_controller::kinematics::{State, advance};

    /// The derivatives of `of` at `x` beside finite differences.
    fn holds(of: impl Fn([Dual; 2]) -> Dual, x: [f32; 2]) {
        let at = |x: [f32; 2]| of([Dual::variable(x[0], 0, 1.0), Dual::variable(x[1], 1, 1.0)]);
        let got = at(x).slopes;
        for i in 0..2 {
            let h = 1e-2;
            let moved = |h: f32| {
                let mut x = x;
                x[i] += h;
                at(x).value
            };
            let expected = (moved(h) - moved(-h)) / (2.0 * h);
            assert!(
                (got[i] - expected).abs() < 2e-3 * (1.0 + expected.abs()),
                "{got:?}: {expected}"
            );
        }
    }

    #[test]
    fn derivatives_agree_with_finite_differences() {
        for x in [[2.0, 3.0], [0.7, 5.0], [4.0, 0.5]] {
            holds(|[a, b]| a * b - a / b, x);
            holds(|[a, b]| (a + b).sqrt() - -a, x);
            holds(|[a, b]| a.max(b) + Real::min(a, b) * a, x);
            holds(|[a, b]| a.scaled(0.5, 3.0) * b.abs().within(4.0), x);
            holds(|[a, b]| a.angle(b, a), x);
        }
    }

    #[test]
    fn one_step_of_the_kinematics_has_the_derivatives_of_its_motion() {
        // Driven on, and to rest within the step.
        for x in [[6.0, -2.0], [0.2, -3.0]] {
            let step = |[v, a]: [Dual; 2]| {
                advance(
                    State {
                        s: Dual::of(1.0),
                        v,
                    },
                    a,
                )
            };
            holds(|x| step(x).s, x);
            holds(|x| step(x).v, x);
        }
    }

    #[test]
    fn a_separation_has_the_derivatives_of_the_gap() {
        let fixed = OrientedBox::new(
            Pose {
                position: Point::new(0.0, 0.0),
                direction: unit(1.0, 0.0),
            },
            Footprint::PAPER,
        );
        let dual = |b: OrientedBox, centre: Point<Dual>| OrientedBox {
            centre,
            direction: Vector::new(Dual::of(b.direction.x), Dual::of(b.direction.y)),
            half_length: Dual::of(b.half_length),
            half_width: Dual::of(b.half_width),
        };
        let here = Point::new(Dual::of(0.0), Dual::of(0.0));
        let gap = |[x, y]: [Dual; 2]| dual(fixed, here).separation(&dual(fixed, Point::new(x, y)));
        holds(gap, [8.0, 1.0]);
        holds(gap, [1.0, 4.0]);
    }
}
