//! Numbers m·2ᵉ, exact: sums, products and comparisons of `f64` without rounding, underflow or
//! overflow.

use num_bigint::{BigInt, Sign};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// The number `mantissa`·2^`exponent`.
#[derive(Clone, Debug)]
pub(crate) struct Dyadic {
    mantissa: BigInt,
    exponent: i64,
}

impl Dyadic {
    pub(crate) fn zero() -> Self {
        Self::from(BigInt::zero())
    }

    /// mantissa·2^exponent.
    pub(crate) fn new(mantissa: BigInt, exponent: i64) -> Self {
        Self { mantissa, exponent }
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.mantissa.is_zero()
    }

    pub(crate) fn sign(&self) -> Ordering {
        match self.mantissa.sign() {
            Sign::Minus => Ordering::Less,
            Sign::NoSign => Ordering::Equal,
            Sign::Plus => Ordering::Greater,
        }
    }

    /// `None` if the value is not finite.
    pub(crate) fn of(value: f64) -> Option<Self> {
        if !value.is_finite() {
            return None;
        }
        let bits = value.to_bits();
        let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i64, bits & ((1 << 52) - 1));
        let (mantissa, exponent) = match (exponent, fraction) {
            (0, 0) => return Some(Self::zero()),
            (0, fraction) => (fraction, -1074),
            (exponent, fraction) => (fraction | 1 << 52, exponent - 1075),
        };
        let zeros = mantissa.trailing_zeros();
        let odd = BigInt::from(mantissa >> zeros);
        Some(Self {
            mantissa: if value < 0.0 { -odd } else { odd },
            exponent: exponent + i64::from(zeros),
        })
    }

    /// As a fraction.
    pub(crate) fn rational(&self) -> BigRational {
        let shift = self.exponent.unsigned_abs();
        if self.exponent >= 0 {
            BigRational::from(&self.mantissa << shift)
        } else {
            BigRational::new(self.mantissa.clone(), BigInt::from(1) << shift)
        }
    }

    /// About `self` / `by` in [0, 1], for 0 ≤ `self` ≤ `by` and `by` > 0: off by less than 2⁻⁵².
    pub(crate) fn share(&self, by: &Self) -> f64 {
        let exponent = self.exponent.min(by.exponent);
        let ratio = (self.over(exponent) << 53_u32) / by.over(exponent);
        ratio.to_f64().unwrap_or(0.0) * 0.5_f64.powi(53)
    }

    /// The mantissa for an exponent that is not above the number's own.
    fn over(&self, exponent: i64) -> BigInt {
        &self.mantissa << self.exponent.abs_diff(exponent)
    }

    fn common(&self, other: &Self, combine: impl Fn(BigInt, &BigInt) -> BigInt) -> Self {
        let (low, high) = if self.exponent <= other.exponent {
            (self, other)
        } else {
            (other, self)
        };
        Self {
            mantissa: combine(high.over(low.exponent), &low.mantissa),
            exponent: low.exponent,
        }
    }
}

impl From<BigInt> for Dyadic {
    fn from(mantissa: BigInt) -> Self {
        Self::new(mantissa, 0)
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;
    fn add(self, other: Self) -> Dyadic {
        if self.is_zero() {
            return other.clone();
        }
        if other.is_zero() {
            return self.clone();
        }
        self.common(other, |a, b| a + b)
    }
}

impl Neg for &Dyadic {
    type Output = Dyadic;
    fn neg(self) -> Dyadic {
        Dyadic {
            mantissa: -&self.mantissa,
            exponent: self.exponent,
        }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;
    fn sub(self, other: Self) -> Dyadic {
        self + &-other
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;
    fn mul(self, other: Self) -> Dyadic {
        Dyadic {
            mantissa: &self.mantissa * &other.mantissa,
            exponent: self.exponent + other.exponent,
        }
    }
}

impl PartialEq for Dyadic {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Dyadic {}

impl PartialOrd for Dyadic {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Dyadic {
    fn cmp(&self, other: &Self) -> Ordering {
        (self - other).sign()
    }
}

/// The greatest `f64` that is not above a fraction, or −∞.
pub(crate) fn floor(value: &BigRational) -> f64 {
    let near = nearest(value);
    if exact(near).is_some_and(|near| &near <= value) || near == f64::NEG_INFINITY {
        near
    } else {
        near.next_down()
    }
}

/// The least `f64` that is not below a fraction, or +∞.
pub(crate) fn ceil(value: &BigRational) -> f64 {
    -floor(&-value)
}

/// The value of a finite `f64` as a fraction.
pub(crate) fn exact(value: f64) -> Option<BigRational> {
    Dyadic::of(value).map(|value| value.rational())
}

/// An `f64` next to a fraction, ±∞ beyond the range: less than two units in the last place off.
pub(crate) fn nearest(value: &BigRational) -> f64 {
    let (numer, denom) = (value.numer().abs(), value.denom());
    // The quotient has at least 64 bits, all the rounding behind them.
    let shift = 66 + denom.bits() as i64 - numer.bits() as i64;
    let quotient = if shift >= 0 {
        (numer << shift.unsigned_abs()) / denom
    } else {
        numer / (denom << shift.unsigned_abs())
    };
    let bits = quotient.bits() as i64;
    let size = if bits - shift < -1100 {
        0.0
    } else {
        let kept = bits.min((bits - shift + 1074).clamp(1, 53));
        let top = (quotient >> (bits - kept).unsigned_abs())
            .to_f64()
            .unwrap_or(0.0);
        scaled(top, bits - kept - shift)
    };
    if value.is_negative() { -size } else { size }
}

/// value·2^`exponent` for a value of which no bit is lost.
fn scaled(mut value: f64, mut exponent: i64) -> f64 {
    while exponent != 0 && value != 0.0 && value.is_finite() {
        let step = exponent.clamp(-1000, 1000);
        value *= 2.0_f64.powi(step as i32);
        exponent -= step;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn finite() -> impl Strategy<Value = f64> {
        any::<u64>()
            .prop_map(f64::from_bits)
            .prop_filter("finite", |v| v.is_finite())
    }

    #[test]
    fn ends_of_the_range_are_exact() {
        for value in [
            0.0,
            5e-324,
            -2.5e-310,
            1.0,
            0.1,
            -f64::MAX,
            f64::MIN_POSITIVE,
        ] {
            let rational = exact(value).expect("finite");
            assert_eq!(rational, BigRational::from_float(value).expect("finite"));
            assert_eq!((floor(&rational), ceil(&rational)), (value, value));
        }
        let tiny = BigRational::new(1.into(), BigInt::from(10).pow(400));
        assert_eq!((floor(&tiny), ceil(&tiny)), (0.0, 5e-324));
        let huge = BigRational::from(BigInt::from(10).pow(400));
        assert_eq!((floor(&huge), ceil(&huge)), (f64::MAX, f64::INFINITY));
        assert_eq!(
            (floor(&-&huge), ceil(&-&huge)),
            (f64::NEG_INFINITY, -f64::MAX)
        );
    }

    proptest! {
        #[test]
        fn arithmetic_is_that_of_fractions(a in finite(), b in finite()) {
            let of = |v: f64| Dyadic::of(v).expect("finite");
            let fraction = |v: f64| BigRational::from_float(v).expect("finite");
            prop_assert_eq!((&of(a) + &of(b)).rational(), fraction(a) + fraction(b));
            prop_assert_eq!((&of(a) - &of(b)).rational(), fraction(a) - fraction(b));
            prop_assert_eq!((&of(a) * &of(b)).rational(), fraction(a) * fraction(b));
            prop_assert_eq!(of(a).cmp(&of(b)), fraction(a).cmp(&fraction(b)));
        }

        #[test]
        fn fractions_lie_between_their_neighbours(a in finite(), b in finite(), c in 1_u64..1 << 40) {
            let fraction = |v: f64| BigRational::from_float(v).expect("finite");
            for value in [fraction(a), fraction(a) / BigRational::from(BigInt::from(c)), fraction(a) + fraction(b)] {
                let (low, high) = (floor(&value), ceil(&value));
                prop_assert!(exact(low).is_none_or(|low| low <= value));
                prop_assert!(exact(high).is_none_or(|high| value <= high));
                prop_assert!(low == high || low.next_up() == high, "{} {}", low, high);
            }
        }
    }
}
