//! Intervals of `f64`, rounded outward.
//!
//! An end that is infinite or NaN says that nothing is known; it stays so through every operation.

/// The numbers from `lo` to `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
}

/// The smallest positive number: no rounding of a result that is not normal exceeds half of it.
const LEAST: f64 = f64::from_bits(1);

/// At least the rounding errors of two operations whose results add up to `size`, and of taking it
/// off: four times as much.
fn slack(size: f64) -> f64 {
    size * (2.0 * f64::EPSILON) + LEAST
}

impl Interval {
    pub(crate) const ZERO: Self = Self::point(0.0);

    pub(crate) const fn point(value: f64) -> Self {
        Self {
            lo: value,
            hi: value,
        }
    }

    /// Whether both ends are numbers.
    pub(crate) fn is_known(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    fn widened(lo: f64, hi: f64) -> Self {
        Self {
            lo: lo - slack(lo.abs()),
            hi: hi + slack(hi.abs()),
        }
    }

    pub(crate) fn add(self, other: Self) -> Self {
        if self == Self::ZERO {
            return other;
        }
        if other == Self::ZERO {
            return self;
        }
        Self::widened(self.lo + other.lo, self.hi + other.hi)
    }

    pub(crate) fn neg(self) -> Self {
        Self {
            lo: -self.hi,
            hi: -self.lo,
        }
    }

    pub(crate) fn mul(self, other: Self) -> Self {
        if self == Self::ZERO || other == Self::ZERO {
            return Self::ZERO;
        }
        if other == Self::point(1.0) {
            return self;
        }
        if !self.is_known() || !other.is_known() {
            return Self::point(f64::NAN);
        }
        // Products of numbers are never NaN.
        let products = [
            self.lo * other.lo,
            self.lo * other.hi,
            self.hi * other.lo,
            self.hi * other.hi,
        ];
        let least = products.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let most = products.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        Self::widened(least, most)
    }

    /// sums += self·row, element by element.
    pub(crate) fn add_scaled(self, sums: &mut [Self], row: &[f64]) {
        debug_assert!(self.is_known());
        for (sum, &w) in sums.iter_mut().zip(row) {
            let (one, other) = (self.lo * w, self.hi * w);
            let (low, high) = if w < 0.0 { (other, one) } else { (one, other) };
            let (lo, hi) = (sum.lo + low, sum.hi + high);
            // Nothing is added where the weight is 0; chosen at the end, so that the loop has no branch.
            let exact = w == 0.0;
            let below = lo - slack(low.abs() + lo.abs());
            let above = hi + slack(high.abs() + hi.abs());
            sum.lo = if exact { sum.lo } else { below };
            sum.hi = if exact { sum.hi } else { above };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dyadic::Dyadic;
    use proptest::prelude::*;

    fn finite() -> impl Strategy<Value = f64> {
        prop_oneof![
            any::<u64>()
                .prop_map(f64::from_bits)
                .prop_filter("finite", |v| v.is_finite()),
            -10.0..10.0,
            (0_u64..8).prop_map(f64::from_bits),
        ]
    }

    fn holds(interval: Interval, exact: &Dyadic) -> bool {
        !interval.is_known()
            || Dyadic::of(interval.lo).is_some_and(|lo| &lo <= exact)
                && Dyadic::of(interval.hi).is_some_and(|hi| exact <= &hi)
    }

    proptest! {
        #[test]
        fn results_contain_the_exact_ones(a in finite(), b in finite(), c in finite()) {
            let of = |v: f64| Dyadic::of(v).expect("finite");
            let p = Interval::point;
            prop_assert!(holds(p(a).add(p(b)), &(&of(a) + &of(b))));
            let product = p(a).mul(p(b));
            prop_assert!(holds(product, &(&of(a) * &of(b))));
            prop_assert!(holds(product.neg(), &-&(&of(a) * &of(b))));
            let mut sum = [p(c)];
            p(a).add_scaled(&mut sum, &[b]);
            prop_assert!(holds(sum[0], &(&of(c) + &(&of(a) * &of(b)))));
            if product.is_known() {
                prop_assert!(holds(product.mul(p(c)), &(&(&of(a) * &of(b)) * &of(c))));
            }
        }
    }
}
