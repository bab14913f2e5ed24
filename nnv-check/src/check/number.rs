//! The numbers that bounds are computed in: intervals rounded outward, which are fast, and exact
//! numbers, which decide where a bound meets its threshold or rounding is all that is left.

use crate::dyadic::Dyadic;
use crate::interval::Interval;
use crate::model::Activation;
use std::cmp::Ordering;

/// A number, known exactly or between two others.
pub(super) trait Number: Clone {
    /// A finite `f64`.
    fn of(value: f64) -> Self;
    fn zero() -> Self;
    fn plus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    fn negated(&self) -> Self;
    /// Its sign, if that is certain.
    fn sign(&self) -> Option<Ordering>;
    /// Whether anything is known of it.
    fn is_known(&self) -> bool;
    /// A number that is certainly not above it, and compares exactly.
    fn lower(&self) -> Self;
    /// Least value of the product with a number from `low` to `high`.
    fn least_product(&self, low: &Self, high: &Self) -> Self;
    /// sums += self·row, element by element.
    fn add_scaled(&self, sums: &mut [Self], row: &[f64]);
    /// Of two lower bounds of one number, the better one.
    fn greater(&self, other: &Self) -> Self;
    /// About `self` / `by` in [0, 1], for 0 < `self` < `by`.
    fn share(&self, by: &Self) -> f64;
    /// Whether every exact weight w(1 + δ), |δ| ≤ `uncertainty`, can be accounted for.
    fn spread(uncertainty: f64) -> Option<Self>;
    /// For c·f(z) with z in [l, u]: (factor, offset) with factor·z + offset ≤ c·f(z), for
    /// activations that are not piecewise linear.
    fn curve(activation: Activation, l: &Self, u: &Self, c: &Self) -> Option<(Self, Self)>;
}

impl Number for Interval {
    fn of(value: f64) -> Self {
        Self::point(value)
    }

    fn zero() -> Self {
        Self::ZERO
    }

    fn plus(&self, other: &Self) -> Self {
        self.add(*other)
    }

    fn times(&self, other: &Self) -> Self {
        self.mul(*other)
    }

    fn negated(&self) -> Self {
        self.neg()
    }

    fn sign(&self) -> Option<Ordering> {
        if self.lo > 0.0 {
            Some(Ordering::Greater)
        } else if self.hi < 0.0 {
            Some(Ordering::Less)
        } else {
            (*self == Self::ZERO).then_some(Ordering::Equal)
        }
    }

    fn is_known(&self) -> bool {
        Interval::is_known(*self)
    }

    fn lower(&self) -> Self {
        Self::point(if self.lo.is_finite() {
            self.lo
        } else {
            f64::NEG_INFINITY
        })
    }

    fn least_product(&self, low: &Self, high: &Self) -> Self {
        let range = Self {
            lo: low.lo,
            hi: high.hi,
        };
        self.mul(range)
    }

    fn add_scaled(&self, sums: &mut [Self], row: &[f64]) {
        Interval::add_scaled(*self, sums, row);
    }

    fn greater(&self, other: &Self) -> Self {
        Self::point(self.lo.max(other.lo))
    }

    fn share(&self, by: &Self) -> f64 {
        (self.lo / by.lo).clamp(0.0, 1.0)
    }

    fn spread(uncertainty: f64) -> Option<Self> {
        Some(Self {
            lo: 1.0 - uncertainty,
            hi: 1.0 + uncertainty,
        })
    }

    fn curve(activation: Activation, l: &Self, u: &Self, c: &Self) -> Option<(Self, Self)> {
        let rising = match c.sign()? {
            Ordering::Equal => return Some((Self::ZERO, Self::ZERO)),
            sign => sign == Ordering::Greater,
        };
        let (l, u) = (l.lo, u.hi);
        let Activation::Tanh = activation else {
            return None;
        };
        // tanh z − slope·z does not fall if slope ≤ tanh′ everywhere, and tanh′ is least at an end.
        let (low, high) = (l.tanh(), u.tanh());
        let flattest = ((1.0 - low * low).min(1.0 - high * high) - 1e-9).max(0.0);
        // Where the slope is not 0, the ends are below 11.
        let offset = match (rising, flattest > 0.0) {
            (true, true) => low - flattest * l - 1e-14,
            (true, false) => low - 1e-14,
            (false, true) => high - flattest * u + 1e-14,
            (false, false) => high + 1e-14,
        };
        Some((c.mul(Self::point(flattest)), c.mul(Self::point(offset))))
    }
}

impl Number for Dyadic {
    fn of(value: f64) -> Self {
        Dyadic::of(value).unwrap_or_else(Dyadic::zero)
    }

    fn zero() -> Self {
        Dyadic::zero()
    }

    fn plus(&self, other: &Self) -> Self {
        self + other
    }

    fn times(&self, other: &Self) -> Self {
        self * other
    }

    fn negated(&self) -> Self {
        -self
    }

    fn sign(&self) -> Option<Ordering> {
        Some(Dyadic::sign(self))
    }

    fn is_known(&self) -> bool {
        true
    }

    fn lower(&self) -> Self {
        self.clone()
    }

    fn least_product(&self, low: &Self, high: &Self) -> Self {
        self * if Dyadic::sign(self) == Ordering::Greater {
            low
        } else {
            high
        }
    }

    fn add_scaled(&self, sums: &mut [Self], row: &[f64]) {
        for (sum, &w) in sums.iter_mut().zip(row) {
            if w != 0.0 {
                *sum = &*sum + &(self * &<Self as Number>::of(w));
            }
        }
    }

    fn greater(&self, other: &Self) -> Self {
        self.max(other).clone()
    }

    fn share(&self, by: &Self) -> f64 {
        Dyadic::share(self, by).clamp(0.0, 1.0)
    }

    fn spread(uncertainty: f64) -> Option<Self> {
        (uncertainty == 0.0).then(|| <Self as Number>::of(1.0))
    }

    fn curve(_: Activation, _: &Self, _: &Self, _: &Self) -> Option<(Self, Self)> {
        None
    }
}
