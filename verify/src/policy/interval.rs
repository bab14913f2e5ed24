//! Intervals that carry their derivatives.

pub(super) use crate::interval::Interval;

/// Number of state variables.
pub(super) const STATE: usize = 4;

/// The range of a function on a box of states, and the ranges of its partial derivatives (its
/// generalised ones, where it has a kink: the mean value theorem holds for both).
#[derive(Clone, Copy, Debug)]
pub(super) struct Dual {
    pub(super) value: Interval,
    pub(super) slopes: [Interval; STATE],
}

impl Dual {
    pub(super) fn constant(value: f64) -> Self {
        Self {
            value: Interval::point(value),
            slopes: [Interval::ZERO; STATE],
        }
    }

    pub(super) fn variable(value: Interval, index: usize) -> Self {
        let mut variable = Self {
            value,
            slopes: [Interval::ZERO; STATE],
        };
        variable.slopes[index] = Interval::point(1.0);
        variable
    }

    fn zip(
        self,
        other: Self,
        value: Interval,
        slope: impl Fn(Interval, Interval) -> Interval,
    ) -> Self {
        Self {
            value,
            slopes: std::array::from_fn(|i| slope(self.slopes[i], other.slopes[i])),
        }
    }

    fn map(self, value: Interval, slope: impl Fn(Interval) -> Interval) -> Self {
        Self {
            value,
            slopes: self.slopes.map(slope),
        }
    }

    pub(super) fn sub(self, other: Self) -> Self {
        self.zip(other, self.value.sub(other.value), Interval::sub)
    }

    pub(super) fn mul(self, other: Self) -> Self {
        self.zip(other, self.value.mul(other.value), |a, b| {
            a.mul(other.value).add(b.mul(self.value))
        })
    }

    pub(super) fn scale(self, factor: f64) -> Self {
        let factor = Interval::point(factor);
        self.map(self.value.mul(factor), |slope| slope.mul(factor))
    }

    /// Division by something positive.
    pub(super) fn div(self, by: Self) -> Self {
        let value = self.value.div(by.value);
        self.zip(by, value, |a, b| a.sub(value.mul(b)).div(by.value))
    }

    /// Limited to [lo, hi].
    pub(super) fn clamp(self, lo: f64, hi: f64) -> Self {
        let inside = self.value.lo >= lo && self.value.hi <= hi;
        let outside = self.value.lo >= hi || self.value.hi <= lo;
        self.map(self.value.clamp(lo, hi), |slope| match (inside, outside) {
            (true, _) => slope,
            (false, true) => Interval::ZERO,
            (false, false) => slope.hull(Interval::ZERO),
        })
    }

    /// atan2(self, other) of two functions that are never negative.
    pub(super) fn atan2(self, other: Self) -> Self {
        let (p, q) = (
            self.value.clamp(0.0, f64::INFINITY),
            other.value.clamp(0.0, f64::INFINITY),
        );
        // A few steps more than one: the system's atan2 is not correctly rounded.
        let slack = 8.0 * f64::EPSILON;
        let value = Interval {
            lo: p.lo.atan2(q.hi) - slack,
            hi: p.hi.atan2(q.lo) + slack,
        };
        let squares = p.mul(p).add(q.mul(q));
        if squares.lo <= 0.0 {
            let all = Interval {
                lo: -slack,
                hi: std::f64::consts::FRAC_PI_2 + slack,
            };
            let steep = Interval {
                lo: f64::NEG_INFINITY,
                hi: f64::INFINITY,
            };
            return Self {
                value: all,
                slopes: [steep; STATE],
            };
        }
        self.zip(other, value, |dp, dq| q.mul(dp).sub(p.mul(dq)).div(squares))
    }
}
