//! Reads properties in VNN-LIB 1.0: declarations of `X_i` and `Y_i`, and assertions over them.
//!
//! Understood: `and`, `or`, `<=`, `>=`, `<`, `>`, `=`, `+`, `-`, `*` by constants. Inputs must be
//! bounded by constants, outputs are constrained linearly. Every decimal stands for the nearest
//! `f64`, and a strict comparison is read as its closure (a superset of the unsafe set).

mod expression;
mod lexer;

use super::property::{Conjunction, Halfspace, InputBox, Property, Query};
use expression::{Atom, Formula};

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

/// Reads a property. Never panics, and takes time linear in the text times the number of
/// conjunctions it expands to (at most 2²⁴ numbers in all).
///
/// # Errors
/// With line and column, if the text is not VNN-LIB, an input is unbounded, or a constraint is
/// not linear or mixes inputs and outputs.
pub fn read(text: &str) -> Result<Property, VnnlibError> {
    let expressions = lexer::parse(text)?;
    let mut inputs = 0;
    let mut outputs = 0;
    let mut formulas = Vec::new();
    for expression in &expressions {
        match expression::statement(expression)? {
            expression::Statement::Input(index) => inputs = inputs.max(index + 1),
            expression::Statement::Output(index) => outputs = outputs.max(index + 1),
            expression::Statement::Assert(formula) => formulas.push(formula),
        }
    }
    let disjuncts = normalise(&Formula::And(formulas), inputs, outputs)?;
    let mut queries: Vec<Query> = Vec::new();
    for Disjunct { region, outputs } in disjuncts {
        let region = region.closed()?;
        let Some(region) = region else { continue };
        match queries.iter_mut().find(|q| q.region == region) {
            Some(query) => query.unsafe_set.push(outputs),
            None => queries.push(Query {
                region,
                unsafe_set: vec![outputs],
            }),
        }
    }
    Ok(Property {
        inputs,
        outputs,
        queries,
    })
}

/// One conjunction of the disjunctive normal form, as it grows.
#[derive(Clone)]
struct Disjunct {
    region: Region,
    outputs: Conjunction,
}

impl Disjunct {
    /// How many numbers it holds.
    fn size(&self) -> usize {
        2 * self.region.0.len()
            + self
                .outputs
                .iter()
                .map(|h| h.coefficients.len())
                .sum::<usize>()
    }
}

/// A box that may still be unbounded or empty.
#[derive(Clone)]
struct Region(Vec<(f64, f64)>);

impl Region {
    /// The box; `None` if it is empty.
    fn closed(self) -> Result<Option<InputBox>, VnnlibError> {
        if let Some(i) = self
            .0
            .iter()
            .position(|(lo, hi)| !lo.is_finite() || !hi.is_finite())
        {
            let what =
                format!("X_{i} is not bounded on both sides; assert (>= X_{i} …) and (<= X_{i} …)");
            return Err(VnnlibError {
                line: 1,
                column: 1,
                what,
            });
        }
        let (lower, upper): (Vec<_>, Vec<_>) = self.0.into_iter().unzip();
        let empty = lower.iter().zip(&upper).any(|(lo, hi)| lo > hi);
        Ok((!empty).then_some(InputBox { lower, upper }))
    }
}

/// The disjunctive normal form.
fn normalise(
    formula: &Formula,
    inputs: usize,
    outputs: usize,
) -> Result<Vec<Disjunct>, VnnlibError> {
    let all = Region(vec![(f64::NEG_INFINITY, f64::INFINITY); inputs]);
    let start = vec![Disjunct {
        region: all,
        outputs: Vec::new(),
    }];
    conjoin(start, formula, outputs)
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
            let mut all = Vec::new();
            for part in parts {
                all.extend(conjoin(so_far.clone(), part, outputs)?);
                if all.iter().map(Disjunct::size).sum::<usize>() > MOST_NUMBERS {
                    return Err(place
                        .error("expands to too many conjunctions; split the property".to_owned()));
                }
            }
            Ok(all)
        }
        Formula::Atom(atom) => so_far.into_iter().map(|d| add(d, atom, outputs)).collect(),
    }
}

/// The conjunction with one more constraint.
fn add(mut disjunct: Disjunct, atom: &Atom, outputs: usize) -> Result<Disjunct, VnnlibError> {
    let Atom {
        inputs: of_x,
        outputs: of_y,
        bound,
        place,
    } = atom;
    match (of_x.as_slice(), of_y.as_slice()) {
        (&[(index, c)], []) => {
            let Some((lo, hi)) = disjunct.region.0.get_mut(index) else {
                return Err(place.error(format!("X_{index} is not declared")));
            };
            let limit = bound / c;
            if c > 0.0 {
                *hi = hi.min(limit);
            } else {
                *lo = lo.max(limit);
            }
        }
        ([], [_, ..]) => {
            let mut coefficients = vec![0.0; outputs];
            for &(index, c) in of_y {
                let Some(slot) = coefficients.get_mut(index) else {
                    return Err(place.error(format!("Y_{index} is not declared")));
                };
                *slot = c;
            }
            disjunct.outputs.push(Halfspace {
                coefficients,
                bound: *bound,
            });
        }
        ([], []) => return Err(place.error("a comparison of constants".to_owned())),
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
    Ok(disjunct)
}

#[cfg(test)]
mod tests;
