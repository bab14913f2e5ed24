//! What is asked of a network: whether any input of a box gives an output in an unsafe set.

use super::dyadic::{self, Dyadic};
use super::interval::Interval;
use super::model::Network;
use num_bigint::BigInt;
use num_integer::Integer as _;
use num_rational::BigRational;
use num_traits::{One as _, Signed as _, ToPrimitive as _, Zero as _};
use std::cmp::Ordering;
use std::sync::Arc;

/// A closed box of inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct InputBox {
    /// Least value of each input.
    pub lower: Vec<f64>,
    /// Greatest value of each input.
    pub upper: Vec<f64>,
}

impl InputBox {
    /// Whether the point lies in the box.
    #[must_use]
    pub fn contains(&self, point: &[f64]) -> bool {
        point.len() == self.lower.len()
            && point.iter().zip(&self.lower).all(|(x, lo)| x >= lo)
            && point.iter().zip(&self.upper).all(|(x, hi)| x <= hi)
    }
}

/// One linear constraint on the outputs: coefficients · y ≤ bound, or <.
///
/// The coefficients are exact. Where they are no `f64`, even after all have been multiplied by one
/// positive number, [`Self::coefficients`] are next to them.
#[derive(Clone, Debug, PartialEq)]
pub struct Halfspace {
    coefficients: Vec<f64>,
    bound: f64,
    strict: bool,
    /// The exact coefficients, then the bound, where the `f64` are not exact.
    exact: Option<Arc<[Dyadic]>>,
}

/// Sizes of coefficients whose products with ordinary numbers neither overflow nor vanish.
const TAME: std::ops::Range<f64> = 1e-30..1e30;

/// Most bits of a constraint's common denominator.
const MOST_BITS: u64 = 1 << 17;

impl Halfspace {
    /// coefficients · y ≤ bound, one coefficient for each output. Panics if a number is not finite.
    #[must_use]
    pub fn new(coefficients: Vec<f64>, bound: f64) -> Self {
        assert!(
            coefficients.iter().all(|c| c.is_finite()) && bound.is_finite(),
            "a constraint with a number that is not finite"
        );
        Self {
            coefficients,
            bound,
            strict: false,
            exact: None,
        }
    }

    /// The constraint with < in place of ≤.
    #[must_use]
    pub fn strict(self) -> Self {
        Self {
            strict: true,
            ..self
        }
    }

    /// The constraint Σ terms ≤ bound on so many outputs, multiplied by a positive number so that it
    /// is exact where that is possible, and neither large nor small; `None` if their common
    /// denominator is too long to be computed with.
    pub(crate) fn of_fractions(
        terms: &[(usize, BigRational)],
        bound: &BigRational,
        outputs: usize,
    ) -> Option<Self> {
        let all = || terms.iter().map(|(_, c)| c).chain([bound]);
        let tame =
            |c: &BigRational| c.is_zero() || exactly(c).is_some_and(|c| TAME.contains(&c.abs()));
        let unit = if all().all(tame) {
            BigRational::one()
        } else {
            let denominators = all().try_fold(BigInt::one(), |unit, c| {
                Some(unit.lcm(c.denom())).filter(|unit| unit.bits() <= MOST_BITS)
            })?;
            let largest = all()
                .map(|c| c.abs())
                .max()
                .unwrap_or_else(BigRational::zero);
            let whole = largest * &denominators;
            // A power of two brings the largest near 1.
            BigRational::new(denominators, BigInt::one() << whole.to_integer().bits())
        };
        let scaled = |c: &BigRational| c * &unit;
        let rounded = |c: &BigRational| dyadic::nearest(&scaled(c));
        let mut coefficients = vec![0.0; outputs];
        for (index, c) in terms {
            coefficients[*index] = rounded(c);
        }
        let exact = all().all(|c| exactly(&scaled(c)).is_some());
        let exact = (!exact).then(|| {
            let mut exact = vec![Dyadic::zero(); outputs + 1];
            let of = |c: &BigRational| {
                // The denominator is a power of two by the choice of the unit.
                let c = scaled(c);
                Dyadic::new(c.numer().clone(), 1 - c.denom().bits() as i64)
            };
            for (index, c) in terms {
                exact[*index] = of(c);
            }
            exact[outputs] = of(bound);
            exact.into()
        });
        Some(Self {
            coefficients,
            bound: rounded(bound),
            strict: false,
            exact,
        })
    }

    /// One coefficient for each output, exact unless [`Self::is_rounded`].
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// The right-hand side, exact unless [`Self::is_rounded`].
    #[must_use]
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// Whether equality does not satisfy it.
    #[must_use]
    pub fn is_strict(&self) -> bool {
        self.strict
    }

    /// Whether coefficients and bound are next to the exact ones only: off by at most
    /// [`f64::EPSILON`] of their size or 2⁻¹⁰⁷⁴.
    #[must_use]
    pub fn is_rounded(&self) -> bool {
        self.exact.is_some()
    }

    /// coefficients · y − bound in plain `f64`: positive where the constraint is violated.
    #[must_use]
    pub fn excess(&self, y: &[f64]) -> f64 {
        self.coefficients
            .iter()
            .zip(y)
            .map(|(c, v)| c * v)
            .sum::<f64>()
            - self.bound
    }

    /// The exact coefficients, then the exact bound.
    pub(crate) fn exact(&self) -> Vec<Dyadic> {
        match &self.exact {
            Some(exact) => exact.to_vec(),
            None => {
                let all = self.coefficients.iter().chain([&self.bound]);
                all.filter_map(|&c| Dyadic::of(c)).collect()
            }
        }
    }

    /// Intervals that contain the exact coefficients, then one that contains the exact bound.
    pub(crate) fn enclosed(&self) -> Vec<Interval> {
        let all = self.coefficients.iter().chain([&self.bound]);
        let rounded = self.is_rounded();
        let range = |&c: &f64| Interval {
            lo: if rounded { c.next_down() } else { c },
            hi: if rounded { c.next_up() } else { c },
        };
        all.map(range).collect()
    }

    /// Whether outputs with this exact excess satisfy it.
    fn admits(&self, excess: Ordering) -> bool {
        excess == Ordering::Less || excess == Ordering::Equal && !self.strict
    }

    /// Whether these outputs satisfy it.
    fn holds(&self, y: &[BigRational]) -> bool {
        let exact = self.exact();
        let terms = exact.iter().zip(y);
        let sum = terms.map(|(c, y)| c.rational() * y).sum::<BigRational>();
        let bound = exact
            .last()
            .map_or_else(BigRational::zero, Dyadic::rational);
        self.admits(sum.cmp(&bound))
    }

    /// Whether all outputs in these intervals satisfy it (`Some(true)`), none (`Some(false)`), or
    /// that is not known.
    fn decides(&self, y: &[Interval]) -> Option<bool> {
        let all = self.enclosed();
        let (bound, coefficients) = all.split_last()?;
        let terms = coefficients.iter().zip(y);
        let sum = terms.fold(bound.neg(), |sum, (c, y)| sum.add(c.mul(*y)));
        match sum {
            sum if !sum.is_known() => None,
            Interval { hi, .. } if hi < 0.0 => Some(true),
            Interval { lo, .. } if lo > 0.0 => Some(false),
            _ => None,
        }
    }
}

/// The `f64` of this value, if there is one.
pub(crate) fn exactly(value: &BigRational) -> Option<f64> {
    // Most values are short: the denominator is the quickest test.
    let near = if value.is_integer() && value.numer().bits() <= 53 {
        return value.numer().to_f64();
    } else {
        let shift = value.denom().bits() - 1;
        if value.denom().trailing_zeros() != Some(shift) {
            return None;
        }
        dyadic::nearest(value)
    };
    (dyadic::exact(near).as_ref() == Some(value)).then_some(near)
}

/// A conjunction of constraints on the outputs: one convex part of the unsafe set. An empty
/// conjunction holds everywhere.
pub type Conjunction = Vec<Halfspace>;

/// A side of an input's range that is not the closed one of the box.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Limit {
    /// Which input.
    pub input: usize,
    /// Whether it is the upper side.
    pub upper: bool,
    /// The exact value, inside the box's or equal to it.
    pub value: BigRational,
    /// Whether the value itself is excluded.
    pub strict: bool,
}

/// Is there an input whose output satisfies all of one of the conjunctions?
#[derive(Clone, Debug, PartialEq)]
pub struct Query {
    /// The smallest closed box of `f64` that contains the inputs.
    pub region: InputBox,
    /// Where the inputs' exact limits are not those of the box.
    pub limits: Vec<Limit>,
    /// The unsafe set: a union of convex sets.
    pub unsafe_set: Vec<Conjunction>,
}

impl Query {
    /// A query about all points of a closed box.
    #[must_use]
    pub fn new(region: InputBox, unsafe_set: Vec<Conjunction>) -> Self {
        Self {
            region,
            limits: Vec::new(),
            unsafe_set,
        }
    }

    /// Whether the point is one of the inputs.
    #[must_use]
    pub fn contains(&self, point: &[BigRational]) -> bool {
        let InputBox { lower, upper } = &self.region;
        let within = |side: f64, x: &BigRational, wanted: Ordering| {
            dyadic::exact(side).is_some_and(|side| side == *x || side.cmp(x) == wanted)
        };
        point.len() == lower.len()
            && lower
                .iter()
                .zip(point)
                .all(|(&lo, x)| within(lo, x, Ordering::Less))
            && upper
                .iter()
                .zip(point)
                .all(|(&hi, x)| within(hi, x, Ordering::Greater))
            && self
                .limits
                .iter()
                .all(|limit| limit.admits(&point[limit.input]))
    }

    /// The input nearest to a point, as its exact coordinates: moved onto the limits, or a little
    /// inside where they are excluded. Panics if the point has not one coordinate for each input.
    #[must_use]
    pub fn nearest(&self, point: &[f64]) -> Vec<BigRational> {
        let sides = self.region.lower.iter().zip(&self.region.upper);
        let inside = point.iter().zip(sides).map(|(x, (&lo, &hi))| {
            // A NaN becomes the lower side.
            let x = if *x > lo { x.min(hi) } else { lo };
            dyadic::exact(x).unwrap_or_else(BigRational::zero)
        });
        let mut inside: Vec<BigRational> = inside.collect();
        for limit in &self.limits {
            let x = &mut inside[limit.input];
            if limit.admits(x) {
                continue;
            }
            *x = if limit.strict {
                let other = self.other_side(limit);
                // Near the limit, and inside if anything is.
                let part = BigRational::new(BigInt::one(), BigInt::one() << 60_u32);
                &limit.value + (other - &limit.value) * part
            } else {
                limit.value.clone()
            };
        }
        inside
    }

    /// The exact limit of the same input on its other side.
    fn other_side(&self, limit: &Limit) -> BigRational {
        let opposite = |other: &&Limit| other.input == limit.input && other.upper != limit.upper;
        self.limits.iter().find(opposite).map_or_else(
            || {
                let InputBox { lower, upper } = &self.region;
                let side = if limit.upper { lower } else { upper };
                dyadic::exact(side[limit.input]).unwrap_or_else(BigRational::zero)
            },
            |other| other.value.clone(),
        )
    }

    /// Whether the network's outputs at a point satisfy one of the conjunctions: in exact
    /// arithmetic where the network [is exact](Network::is_exact), else in interval arithmetic
    /// whose doubt counts as no.
    #[must_use]
    pub fn is_unsafe(&self, network: &Network, point: &[BigRational]) -> bool {
        if self.unsafe_set.iter().any(Vec::is_empty) {
            return true;
        }
        let y = network.enclose_rational(point);
        let decided = |c: &Conjunction| {
            let atoms: Vec<_> = c.iter().map(|atom| atom.decides(&y)).collect();
            if atoms.contains(&Some(false)) {
                Some(false)
            } else {
                atoms.iter().all(Option::is_some).then_some(true)
            }
        };
        let all: Vec<Option<bool>> = self.unsafe_set.iter().map(decided).collect();
        if all.contains(&Some(true)) {
            return true;
        }
        if all.iter().all(|c| *c == Some(false)) {
            return false;
        }
        let open = self.unsafe_set.iter().zip(all).filter(|(_, c)| c.is_none());
        network.evaluate(point).is_some_and(|y| {
            let mut open = open;
            open.any(|(c, _)| c.iter().all(|atom| atom.holds(&y)))
        })
    }
}

impl Limit {
    /// Whether a value is on the right side.
    fn admits(&self, x: &BigRational) -> bool {
        match (x.cmp(&self.value), self.upper) {
            (Ordering::Equal, _) => !self.strict,
            (side, upper) => (side == Ordering::Less) == upper,
        }
    }
}

/// A property in normal form: it is violated if any of its queries has a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Property {
    /// Number of inputs of the network it is about.
    pub inputs: usize,
    /// Number of outputs.
    pub outputs: usize,
    /// One query for each distinct set of inputs.
    pub queries: Vec<Query>,
}

impl Property {
    /// Whether this input violates the property, in exact arithmetic: see [`Query::is_unsafe`].
    #[must_use]
    pub fn is_violated(&self, network: &Network, point: &[BigRational]) -> bool {
        let violates = |q: &Query| q.contains(point) && q.is_unsafe(network, point);
        self.queries.iter().any(violates)
    }
}
