//! Decimals with their exact values.

use num_bigint::BigInt;
use num_rational::BigRational;

/// The largest power of ten that a decimal may be written with, and the most digits: far more than
/// the exact decimal of any `f64` has. Beyond them a hostile file could take forever.
pub(super) const MOST_DIGITS: usize = 5000;
/// The most bits of the numerator or denominator of a number that the reader computes.
const MOST_BITS: u64 = 1 << 16;

/// Whether a number is of a size that is computed with.
pub(super) fn is_moderate(value: &BigRational) -> bool {
    value.numer().bits() <= MOST_BITS && value.denom().bits() <= MOST_BITS
}

/// The value of a decimal such as `-12.5e-3`; `None` if the word is none, or beyond
/// [`MOST_DIGITS`].
pub(super) fn value(word: &str) -> Option<BigRational> {
    let (mantissa, exponent) = match word.find(['e', 'E']) {
        Some(at) => (&word[..at], word[at + 1..].parse::<i64>().ok()?),
        None => (word, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let (negative, whole) = match whole.strip_prefix('-') {
        Some(whole) => (true, whole),
        None => (false, whole.strip_prefix('+').unwrap_or(whole)),
    };
    let mut digits = whole.bytes().chain(fraction.bytes());
    if whole.len() + fraction.len() == 0
        || !digits.all(|b| b.is_ascii_digit())
        || exponent.unsigned_abs() > MOST_DIGITS as u64
        || mantissa.len() > MOST_DIGITS
    {
        return None;
    }
    let digits = integer(whole, fraction)?;
    let digits = if negative { -digits } else { digits };
    let exponent = exponent.checked_sub(i64::try_from(fraction.len()).ok()?)?;
    let power = u32::try_from(exponent.unsigned_abs()).ok()?;
    Some(if exponent >= 0 {
        BigRational::from(digits * BigInt::from(10).pow(power))
    } else {
        BigRational::new(digits, BigInt::from(10).pow(power))
    })
}

/// The digits of both parts as one integer.
fn integer(whole: &str, fraction: &str) -> Option<BigInt> {
    let all = [whole, fraction].concat();
    match all.parse::<u64>() {
        Ok(short) => Some(short.into()),
        Err(_) => BigInt::parse_bytes(all.as_bytes(), 10),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_have_their_exact_values() {
        let of = |n: i64, d: i64| Some(BigRational::new(n.into(), d.into()));
        assert_eq!(value("-12.5e-3"), of(-1, 80));
        assert_eq!(value("0.1"), of(1, 10));
        assert_eq!(value("+.5E1"), of(5, 1));
        assert_eq!(value("7."), of(7, 1));
        let long = "1234567890.12345678901234567890";
        let digits = BigInt::parse_bytes(b"123456789012345678901234567890", 10).expect("digits");
        assert_eq!(
            value(long),
            Some(BigRational::new(digits, BigInt::from(10).pow(20)))
        );
        for none in [
            "", ".", "-", "e5", "1e", "1e9999", "nan", "inf", "0x1", "1_0", "--1", "1.-5", "1e5.0",
        ] {
            assert_eq!(value(none), None, "{none}");
        }
    }
}
