//! Closed intervals with outward rounding.

use cede_controller::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A closed interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
}

impl Interval {
    pub(crate) const ZERO: Self = Self::point(0.0);

    pub(crate) const fn point(value: f64) -> Self {
        Self {
            lo: value,
            hi: value,
        }
    }

    /// The interval, one step wider on either side: covers the rounding of the operation before.
    fn out(lo: f64, hi: f64) -> Self {
        Self {
            lo: lo.next_down(),
            hi: hi.next_up(),
        }
    }

    pub(crate) fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// The lower end alone.
    pub(crate) fn low(self) -> Self {
        Self::point(self.lo)
    }

    /// The upper end alone.
    pub(crate) fn high(self) -> Self {
        Self::point(self.hi)
    }

    pub(crate) fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Whether the two have a point in common.
    pub(crate) fn meets(self, other: Self) -> bool {
        self.lo <= other.hi && other.lo <= self.hi
    }

    /// What both hold; where rounding leaves nothing, the nearest point of the first.
    pub(crate) fn and(self, other: Self) -> Self {
        self.clamp(other.lo, other.hi)
    }

    /// Wider by `by` on either side.
    pub(crate) fn wider(self, by: f64) -> Self {
        Self::out(self.lo - by, self.hi + by)
    }

    pub(crate) fn scale(self, factor: f64) -> Self {
        self.mul(Self::point(factor))
    }

    pub(crate) fn add(self, other: Self) -> Self {
        Self::out(self.lo + other.lo, self.hi + other.hi)
    }

    pub(crate) fn sub(self, other: Self) -> Self {
        Self::out(self.lo - other.hi, self.hi - other.lo)
    }

    pub(crate) fn mul(self, other: Self) -> Self {
        let products = [
            self.lo * other.lo,
            self.lo * other.hi,
            self.hi * other.lo,
            self.hi * other.hi,
        ];
        if products.iter().any(|p| p.is_nan()) {
            // Infinity times zero.
            return Self::new(f64::NEG_INFINITY, f64::INFINITY);
        }
        let least = products.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let most = products.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        Self::out(least, most)
    }

    /// Division by an interval of positive numbers.
    pub(crate) fn div(self, by: Self) -> Self {
        self.mul(Self::out(1.0 / by.hi, 1.0 / by.lo))
    }

    pub(crate) fn hull(self, other: Self) -> Self {
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }

    pub(crate) fn clamp(self, lo: f64, hi: f64) -> Self {
        Self {
            lo: self.lo.clamp(lo, hi),
            hi: self.hi.clamp(lo, hi),
        }
    }

    pub(crate) fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    pub(crate) fn middle(self) -> f64 {
        0.5 * (self.lo + self.hi)
    }

    /// Half the width, from [`Self::middle`] to the further end.
    pub(crate) fn radius(self) -> f64 {
        let middle = self.middle();
        (self.hi - middle).max(middle - self.lo).next_up()
    }
}

/// As the shield's margins want their numbers.
///
/// Division is by intervals of positive numbers only, as everywhere in the margins.
impl Real for Interval {
    fn of(value: f32) -> Self {
        Self::point(value.into())
    }

    fn sqrt(self) -> Self {
        Self::out(self.lo.max(0.0).sqrt(), self.hi.max(0.0).sqrt())
    }

    fn min(self, other: Self) -> Self {
        Self::new(self.lo.min(other.lo), self.hi.min(other.hi))
    }

    fn max(self, other: Self) -> Self {
        Self::new(self.lo.max(other.lo), self.hi.max(other.hi))
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::add(self, other)
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::sub(self, other)
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::mul(self, other)
    }
}

impl Div for Interval {
    type Output = Self;
    fn div(self, by: Self) -> Self {
        Self::div(self, by)
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.hi, -self.lo)
    }
}
