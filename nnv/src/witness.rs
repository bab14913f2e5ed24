//! Counterexamples, confirmed in exact arithmetic.

use cede_nnv_check::{Conjunction, Network, Query};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed as _, ToPrimitive as _, Zero as _};

/// An input whose exact output is unsafe.
#[derive(Clone, Debug, PartialEq)]
pub struct Witness {
    point: Vec<BigRational>,
    outputs: Vec<f64>,
}

impl Witness {
    /// The point next to the given one, of the query's inputs, if its output is unsafe: in exact
    /// arithmetic where the [network is exact](Network::is_exact), else in interval arithmetic. A
    /// point of `f32` is preferred: an `f32` runtime can be given exactly that.
    pub(super) fn near(network: &Network, query: &Query, point: &[f64]) -> Option<Self> {
        let single: Vec<f64> = point.iter().map(|&x| f64::from(x as f32)).collect();
        let candidates = [single.as_slice(), point];
        let mut points = candidates.into_iter().map(|point| query.nearest(point));
        let holds =
            |point: &Vec<BigRational>| query.contains(point) && query.is_unsafe(network, point);
        let point = points.find(holds)?;
        let outputs = match network.evaluate(&point) {
            Some(y) => y.iter().map(nearest).collect(),
            None => {
                network
                    .run(&point.iter().map(nearest).collect::<Vec<_>>())
                    .values
            }
        };
        Some(Self { point, outputs })
    }

    /// The exact input.
    #[must_use]
    pub fn point(&self) -> &[BigRational] {
        &self.point
    }

    /// The input, each coordinate the nearest `f64`.
    #[must_use]
    pub fn input(&self) -> Vec<f64> {
        self.point.iter().map(nearest).collect()
    }

    /// The outputs, each the nearest `f64`.
    #[must_use]
    pub fn outputs(&self) -> &[f64] {
        &self.outputs
    }

    /// The input's coordinates as exact decimals, or as fractions where they have none.
    #[must_use]
    pub fn decimals(&self) -> Vec<String> {
        self.point.iter().map(decimal).collect()
    }
}

/// Whether a point may satisfy the conjunction, judged by outputs in plain `f64`.
pub(super) fn is_near(conjunction: &Conjunction, y: &[f64]) -> bool {
    conjunction.iter().all(|atom| {
        let terms = atom.coefficients().iter().zip(y);
        let size = terms.map(|(c, y)| (c * y).abs()).sum::<f64>() + atom.bound().abs();
        let excess = atom.excess(y);
        excess <= 1e-9 * size || !(excess - size).is_finite()
    })
}

fn nearest(value: &BigRational) -> f64 {
    value.to_f64().unwrap_or(f64::NAN)
}

/// Places behind the point that are written out; more become an exponent.
const MOST_PLACES: u64 = 60;

/// Zeros before the point that are written out; more become an exponent.
const MOST_ZEROS: usize = 15;

/// The value as a decimal, exactly; as a fraction if it has none.
fn decimal(value: &BigRational) -> String {
    let mut rest = value.denom().clone();
    let mut power = |prime: u32| {
        let mut count = 0_u64;
        while (&rest % prime).is_zero() {
            rest /= prime;
            count += 1;
        }
        count
    };
    let places = power(2).max(power(5));
    if rest != BigInt::from(1) {
        return value.to_string();
    }
    let digits = (value * BigInt::from(10).pow(places as u32)).to_integer();
    if places == 0 {
        let digits = digits.to_string();
        let short = digits.trim_end_matches('0');
        return match digits.len() - short.len() {
            zeros if zeros > MOST_ZEROS => format!("{short}e{zeros}"),
            _ => format!("{digits}.0"),
        };
    }
    if places > MOST_PLACES {
        return format!("{digits}e-{places}");
    }
    let sign = if digits.is_negative() { "-" } else { "" };
    let places = places as usize;
    let digits = format!("{:0>width$}", digits.abs().to_string(), width = places + 1);
    let (whole, fraction) = digits.split_at(digits.len() - places);
    format!("{sign}{whole}.{fraction}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_written_exactly() {
        let of = |n: i64, d: i64| decimal(&BigRational::new(n.into(), d.into()));
        assert_eq!(of(3, 1), "3.0");
        assert_eq!(of(-1, 8), "-0.125");
        assert_eq!(of(-123, 100), "-1.23");
        assert_eq!(of(1, 3), "1/3");
        assert_eq!(decimal(&BigInt::from(10).pow(20).into()), "1e20");
        let tiny = BigRational::from_float(5e-324).expect("finite");
        let text = decimal(&tiny);
        assert!(text.ends_with("e-1074"), "{text}");
        assert_eq!(text.parse(), Ok(5e-324));
        let tenth = BigRational::from_float(0.1).expect("finite");
        assert_eq!(decimal(&tenth).parse(), Ok(0.1));
    }
}
