//! The numbers that formulas are computed in.
//!
//! Every formula of this crate that others need is written once, generic over its number. The
//! vehicle runs it on `f32`; a batch of simulations on vectors of them; training on numbers that
//! carry derivatives; proofs on intervals and on expressions for a solver.

use core::ops::{Add, Div, Mul, Neg, Sub};
use nalgebra::Scalar;

/// What a margin of the shield needs of a number.
///
/// There is no comparison: a margin is one expression without branches, so that
/// an interval of inputs has one interval of margins.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The number itself: every `f32` is exact in every implementation.
    fn of(value: f32) -> Self;

    /// The square root, correctly rounded; of a number that is not negative.
    #[must_use]
    fn sqrt(self) -> Self;

    /// The smaller of two numbers; `self` if they are equal.
    #[must_use]
    fn min(self, other: Self) -> Self;

    /// The larger of two numbers; `self` if they are equal.
    #[must_use]
    fn max(self, other: Self) -> Self;
}

/// What kinematics, the separation of footprints, the features and the SVO need beside [`Real`].
pub trait Elementary: Real + Scalar {
    /// `self` times the constant `numerator`/`denominator`, the quotient rounded to `f32`.
    #[must_use]
    fn scaled(self, numerator: f32, denominator: f32) -> Self;

    /// The absolute value.
    #[must_use]
    fn abs(self) -> Self;

    /// `self` limited to ± `limit`; what is not a number becomes −`limit`.
    #[must_use]
    fn within(self, limit: f32) -> Self;

    /// `then` if `self` ≥ 0, else `otherwise`, also if `self` is not a number.
    #[must_use]
    fn not_negative(self, then: Self, otherwise: Self) -> Self;

    /// The angle (rad, in [0, π/2]) of the point with ordinate `self` ≥ 0 and abscissa `other` ≥ 0;
    /// `origin` if both are 0.
    #[must_use]
    fn angle(self, other: Self, origin: Self) -> Self;
}

/// The correctly rounded square root: by the core with the feature `core-sqrt`, with the same bits.
#[inline]
pub(crate) fn sqrt(x: f32) -> f32 {
    #[cfg(feature = "core-sqrt")]
    return cede_sqrt::sqrtf(x);
    #[cfg(not(feature = "core-sqrt"))]
    libm::sqrtf(x)
}

/// The hyperbolic tangent; with the feature `micromath` a coarser one.
#[inline]
pub(crate) fn tanh(x: f32) -> f32 {
    #[cfg(feature = "micromath")]
    return crate::coarse::tanh(x);
    #[cfg(not(feature = "micromath"))]
    libm::tanhf(x)
}

/// The angle (rad) of the point (`x`, `y`); with the feature `micromath` a coarser one.
#[inline]
pub(crate) fn atan2(y: f32, x: f32) -> f32 {
    #[cfg(feature = "micromath")]
    return crate::coarse::atan2(y, x);
    #[cfg(not(feature = "micromath"))]
    libm::atan2f(y, x)
}

impl Real for f32 {
    #[inline]
    fn of(value: f32) -> Self {
        value
    }

    #[inline]
    fn sqrt(self) -> Self {
        sqrt(self)
    }

    // Not `f32::min` and `max`, which differ between processors on ±0.
    #[inline]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    #[inline]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

impl Elementary for f32 {
    #[inline]
    fn scaled(self, numerator: f32, denominator: f32) -> Self {
        self * (numerator / denominator)
    }

    #[inline]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline]
    fn within(self, limit: f32) -> Self {
        if self > limit {
            limit
        } else if self >= -limit {
            self
        } else {
            -limit
        }
    }

    #[inline]
    fn not_negative(self, then: Self, otherwise: Self) -> Self {
        if self >= 0.0 { then } else { otherwise }
    }

    #[inline]
    fn angle(self, other: Self, origin: Self) -> Self {
        if self == 0.0 && other == 0.0 {
            origin
        } else {
            atan2(self, other)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_hold_for_what_is_not_a_number() {
        assert_eq!(f32::NAN.within(8.0), -8.0);
        assert_eq!(f32::INFINITY.within(8.0), 8.0);
        assert_eq!((-3.0_f32).within(8.0), -3.0);
        assert_eq!(f32::NAN.not_negative(1.0, 2.0), 2.0);
    }
}
