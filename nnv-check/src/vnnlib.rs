//! Reads properties in VNN-LIB 1.0, with declarations of `X_i` and `Y_i`, and in VNN-LIB 2.0, with a network of one input
//! and one output tensor; and assertions over them.
//!
//! Understood: `and`, `or`, `<=`, `>=`, `<`, `>`, `=`, `==`, `!=` (two sides or a chain), `+`, `-`, `*` and `/`
//! by constants. Inputs must be bounded by constants, outputs are constrained linearly. Every
//! decimal has its exact value, all arithmetic of the reader is exact, and < is not ≤.

mod decimal;
mod expression;
mod lexer;
mod names;

use super::property::{Conjunction, Halfspace, InputBox, Limit, Property, Query};
use super::{dyadic, gzip};
use expression::{Atom, Formula};
use names::{Names, Variable};
use num_rational::BigRational;
use num_traits::{Signed as _, Zero as _};
use std::collections::HashMap;
use std::sync::Arc;

/// Why a property cannot be used, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {what}")]
#[non_exhaustive]
pub struct VnnlibError {
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// What is wrong, and how to mend it.
    pub what: String,
}

/// The most numbers that a property may expand to.
const MOST_NUMBERS: usize = 1 << 24;

/// Reads a property. Never panics, and takes time linear in the text and in the conjunctions that
/// it expands to (at most 2²⁴ numbers in all).
///
/// # Errors
/// With line and column, if the text is not VNN-LIB, an input is unbounded, or a constraint is
/// not linear or mixes inputs and outputs.
pub fn read(text: &str) -> Result<Property, VnnlibError> {
    let expressions = lexer::parse(text)?;
    let second = match expressions.first() {
        Some(first) => expression::version(first)?.is_some(),
        None => false,
    };
    let mut names = match second {
        true => Names::Tensors(None),
        false => Names::Numbered(0, 0),
    };
    let mut formulas = Vec::new();
    for expression in expressions.iter().skip(usize::from(second)) {
        expression::statement(expression, &mut names, &mut formulas)?;
    }
    let [inputs, outputs] = names.counts();
    let start = vec![Disjunct {
        ranges: vec![Range::default(); inputs],
        outputs: Vec::new(),
    }];
    let mut queries: Vec<Query> = Vec::new();
    let mut places: HashMap<Key, usize> = HashMap::new();
    for disjunct in conjoin(start, &Formula::And(formulas), outputs)? {
        let Some((region, limits)) = domain(&disjunct.ranges, &names)? else {
            continue;
        };
        let place = *places.entry(key(&region, &limits)).or_insert(queries.len());
        match queries.get_mut(place) {
            Some(query) => query.unsafe_set.push(disjunct.outputs),
            None => queries.push(Query {
                region,
                limits,
                unsafe_set: vec![disjunct.outputs],
            }),
        }
    }
    Ok(Property {
        inputs,
        outputs,
        queries,
    })
}

/// [`read`] from the bytes of a file, packed with gzip or not.
///
/// # Errors
/// As [`read`], and if the bytes are not UTF-8.
pub fn read_bytes(bytes: &[u8]) -> Result<Property, VnnlibError> {
    let fault = |what| VnnlibError {
        line: 1,
        column: 1,
        what,
    };
    let bytes = &gzip::unpacked(bytes).map_err(|e| fault(format!("not a gzip file: {e}")))?;
    let text = std::str::from_utf8(bytes).map_err(|e| VnnlibError {
        line: 1 + bytes[..e.valid_up_to()]
            .iter()
            .filter(|&&b| b == b'\n')
            .count(),
        column: 1,
        what: "is not text in UTF-8".to_owned(),
    })?;
    read(text)
}

/// What tells the inputs of one query from those of another.
type Key = (Vec<u64>, Vec<Limit>);

fn key(region: &InputBox, limits: &[Limit]) -> Key {
    let sides = region.lower.iter().chain(&region.upper);
    (sides.map(|s| s.to_bits()).collect(), limits.to_vec())
}

/// One conjunction of the disjunctive normal form, as it grows.
#[derive(Clone)]
struct Disjunct {
    ranges: Vec<Range>,
    outputs: Conjunction,
}

impl Disjunct {
    /// How many numbers it holds.
    fn size(&self) -> usize {
        let atoms = self.outputs.iter().map(|h| h.coefficients().len());
        2 * self.ranges.len() + atoms.sum::<usize>()
    }
}

/// The range of an input; it may still be unbounded or empty.
#[derive(Clone, Default)]
struct Range {
    lower: Option<Arc<Side>>,
    upper: Option<Arc<Side>>,
}

/// A limit, and whether it is excluded itself.
#[derive(PartialEq)]
struct Side {
    value: BigRational,
    strict: bool,
}

impl Range {
    fn restrict(&mut self, upper: bool, side: Side) {
        let place = if upper {
            &mut self.upper
        } else {
            &mut self.lower
        };
        let tighter = place.as_ref().is_none_or(|old| {
            if side.value == old.value {
                side.strict
            } else {
                (side.value < old.value) == upper
            }
        });
        if tighter {
            *place = Some(Arc::new(side));
        }
    }
}

/// The box of `f64` around the ranges, and the limits that it widens; `None` if there is no input.
fn domain(
    ranges: &[Range],
    names: &Names<'_>,
) -> Result<Option<(InputBox, Vec<Limit>)>, VnnlibError> {
    let mut region = InputBox {
        lower: Vec::with_capacity(ranges.len()),
        upper: Vec::with_capacity(ranges.len()),
    };
    let mut limits = Vec::new();
    let fault = |what| VnnlibError {
        line: 1,
        column: 1,
        what,
    };
    for (input, range) in ranges.iter().enumerate() {
        let Range {
            lower: Some(lower),
            upper: Some(upper),
        } = range
        else {
            let name = names.name(Variable::X(input));
            return Err(fault(format!(
                "{name} is not bounded on both sides; assert (>= {name} …) and (<= {name} …)"
            )));
        };
        if lower.value > upper.value || lower.value == upper.value && (lower.strict || upper.strict)
        {
            return Ok(None);
        }
        let hull = (dyadic::floor(&lower.value), dyadic::ceil(&upper.value));
        if !hull.0.is_finite() || !hull.1.is_finite() {
            return Err(fault(format!(
                "a limit of {} is beyond the range of double precision (about 1.8e308)",
                names.name(Variable::X(input))
            )));
        }
        for (side, hull, upper) in [(lower, hull.0, false), (upper, hull.1, true)] {
            if side.strict || dyadic::exact(hull).as_ref() != Some(&side.value) {
                limits.push(Limit {
                    input,
                    upper,
                    value: side.value.clone(),
                    strict: side.strict,
                });
            }
        }
        region.lower.push(hull.0);
        region.upper.push(hull.1);
    }
    Ok(Some((region, limits)))
}

/// Each of `so_far` together with the formula.
fn conjoin(
    so_far: Vec<Disjunct>,
    formula: &Formula,
    outputs: usize,
) -> Result<Vec<Disjunct>, VnnlibError> {
    match formula {
        Formula::And(parts) => parts
            .iter()
            .try_fold(so_far, |all, part| conjoin(all, part, outputs)),
        Formula::Or(parts, place) => {
            let (mut all, mut size) = (Vec::new(), 0);
            for part in parts {
                let more = conjoin(so_far.clone(), part, outputs)?;
                size += more.iter().map(Disjunct::size).sum::<usize>();
                if size > MOST_NUMBERS {
                    return Err(place
                        .error("expands to too many conjunctions; split the property".to_owned()));
                }
                all.extend(more);
            }
            Ok(all)
        }
        Formula::Atom(atom) => {
            let added = so_far.into_iter().map(|d| add(d, atom, outputs));
            added.filter_map(Result::transpose).collect()
        }
    }
}

/// The conjunction with one more constraint; `None` if that is never met.
fn add(
    mut disjunct: Disjunct,
    atom: &Atom,
    outputs: usize,
) -> Result<Option<Disjunct>, VnnlibError> {
    let Atom {
        inputs: of_x,
        outputs: of_y,
        bound,
        strict,
        place,
    } = atom;
    let strict = *strict;
    match (of_x.as_slice(), of_y.as_slice()) {
        ([(index, c)], []) => {
            let Some(range) = disjunct.ranges.get_mut(*index) else {
                return Err(place.error(format!("X_{index} is not declared")));
            };
            let value = bound / c;
            range.restrict(c.is_positive(), Side { value, strict });
        }
        ([], [.., (last, _)]) => {
            if *last >= outputs {
                return Err(place.error(format!("Y_{last} is not declared")));
            }
            let half = Halfspace::of_fractions(of_y, bound, outputs).ok_or_else(|| {
                place.error("its numbers have too many digits for a common denominator".to_owned())
            })?;
            disjunct
                .outputs
                .push(if strict { half.strict() } else { half });
        }
        ([], []) => {
            let met = if strict {
                bound.is_positive()
            } else {
                bound.is_positive() || bound.is_zero()
            };
            return Ok(met.then_some(disjunct));
        }
        ([_, _, ..], []) => {
            return Err(place.error(
                "a constraint between several inputs; only boxes are supported".to_owned(),
            ));
        }
        (_, _) => {
            return Err(
                place.error("a constraint between inputs and outputs is not supported".to_owned())
            );
        }
    }
    Ok(Some(disjunct))
}

#[cfg(test)]
mod tests;
