//! The numbers that the margins are computed in.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// What a margin needs of a number: `f32` in the vehicle, intervals in a proof.
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

    /// The smaller of two numbers.
    #[must_use]
    fn min(self, other: Self) -> Self;

    /// The larger of two numbers.
    #[must_use]
    fn max(self, other: Self) -> Self;
}

impl Real for f32 {
    #[inline]
    fn of(value: f32) -> Self {
        value
    }

    #[inline]
    fn sqrt(self) -> Self {
        libm::sqrtf(self)
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
