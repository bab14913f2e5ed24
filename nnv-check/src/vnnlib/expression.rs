//! Statements and formulas from S-expressions.

use super::VnnlibError;
use super::decimal;
use super::lexer::{Place, Sexp};
use num_rational::BigRational;
use num_traits::{One as _, Zero as _};
use std::collections::BTreeMap;

/// A top-level statement.
pub(super) enum Statement {
    /// Declaration of the input with this index.
    Input(usize),
    /// Declaration of the output with this index.
    Output(usize),
    Assert(Formula),
}

/// A formula over linear constraints.
pub(super) enum Formula {
    And(Vec<Formula>),
    Or(Vec<Formula>, Place),
    Atom(Atom),
}

/// Σ inputs + Σ outputs ≤ bound, or <; no coefficient is zero, and indices rise.
pub(super) struct Atom {
    pub(super) inputs: Vec<(usize, BigRational)>,
    pub(super) outputs: Vec<(usize, BigRational)>,
    pub(super) bound: BigRational,
    pub(super) strict: bool,
    pub(super) place: Place,
}

/// The most variables of a kind; an index beyond it is a typing error, or hostile.
const MOST_VARIABLES: usize = 1 << 16;

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Variable {
    X(usize),
    Y(usize),
}

fn variable(word: &str) -> Option<Variable> {
    let index = |digits: &str| digits.parse().ok().filter(|&i: &usize| i < MOST_VARIABLES);
    if let Some(digits) = word.strip_prefix("X_") {
        index(digits).map(Variable::X)
    } else {
        index(word.strip_prefix("Y_")?).map(Variable::Y)
    }
}

/// One statement.
pub(super) fn statement(expression: &Sexp<'_>) -> Result<Statement, VnnlibError> {
    let place = expression.place();
    let Sexp::List(items, _) = expression else {
        return Err(place.error("expected (declare-const …) or (assert …)".to_owned()));
    };
    match items.as_slice() {
        [
            Sexp::Word("declare-const", _),
            Sexp::Word(name, at),
            Sexp::Word("Real", _),
        ] => match variable(name) {
            Some(Variable::X(index)) => Ok(Statement::Input(index)),
            Some(Variable::Y(index)) => Ok(Statement::Output(index)),
            None => Err(at.error(format!(
                "variable {name}: expected X_i or Y_i with i < {MOST_VARIABLES}"
            ))),
        },
        [Sexp::Word("assert", _), body] => formula(body).map(Statement::Assert),
        _ => Err(place.error("expected (declare-const NAME Real) or (assert FORMULA)".to_owned())),
    }
}

fn formula(expression: &Sexp<'_>) -> Result<Formula, VnnlibError> {
    let place = expression.place();
    let Sexp::List(items, _) = expression else {
        return Err(place.error("expected a formula in parentheses".to_owned()));
    };
    let all = |parts: &[Sexp<'_>]| parts.iter().map(formula).collect::<Result<Vec<_>, _>>();
    match items.as_slice() {
        [Sexp::Word("and", _), parts @ ..] => all(parts).map(Formula::And),
        [Sexp::Word("or", _), parts @ ..] => Ok(Formula::Or(all(parts)?, place)),
        [Sexp::Word(comparison, _), sides @ ..] if sides.len() > 1 && is_comparison(comparison) => {
            let pairs = sides.windows(2);
            let all = pairs.map(|pair| compare(comparison, &pair[0], &pair[1], place));
            all.collect::<Result<_, _>>().map(Formula::And)
        }
        [Sexp::Word(other, at), ..] => Err(at.error(format!(
            "operator {other}: expected and, or, <=, >=, <, > or = with two sides"
        ))),
        _ => Err(place.error("expected a formula".to_owned())),
    }
}

fn is_comparison(word: &str) -> bool {
    matches!(word, "<=" | "<" | ">=" | ">" | "=")
}

fn compare(
    comparison: &str,
    a: &Sexp<'_>,
    b: &Sexp<'_>,
    place: Place,
) -> Result<Formula, VnnlibError> {
    let strict = matches!(comparison, "<" | ">");
    let atom = |a, b| at_most(a, b, strict, place).map(Formula::Atom);
    match comparison {
        "<=" | "<" => atom(a, b),
        ">=" | ">" => atom(b, a),
        _ => Ok(Formula::And(vec![atom(a, b)?, atom(b, a)?])),
    }
}

/// A linear expression: terms and a constant.
#[derive(Default)]
struct Linear {
    terms: BTreeMap<Variable, BigRational>,
    constant: BigRational,
}

impl Linear {
    /// Adds ± other.
    ///
    /// # Errors
    /// If a number gets too many digits.
    fn add(&mut self, other: Self, sign: f64, place: Place) -> Result<(), VnnlibError> {
        let signed = |c: BigRational| if sign < 0.0 { -c } else { c };
        self.constant += signed(other.constant);
        moderate(&self.constant, place)?;
        for (variable, c) in other.terms {
            let sum = self.terms.entry(variable).or_insert_with(BigRational::zero);
            *sum += signed(c);
            moderate(sum, place)?;
        }
        Ok(())
    }

    fn scaled(mut self, factor: &BigRational, place: Place) -> Result<Self, VnnlibError> {
        for c in self.terms.values_mut().chain([&mut self.constant]) {
            *c *= factor;
            moderate(c, place)?;
        }
        Ok(self)
    }
}

/// Refuses a number that is too long to be computed with.
fn moderate(value: &BigRational, place: Place) -> Result<(), VnnlibError> {
    if decimal::is_moderate(value) {
        Ok(())
    } else {
        Err(place.error("comes to a number of more than 2¹⁶ bits".to_owned()))
    }
}

fn at_most(a: &Sexp<'_>, b: &Sexp<'_>, strict: bool, place: Place) -> Result<Atom, VnnlibError> {
    let mut difference = linear(a)?;
    difference.add(linear(b)?, -1.0, place)?;
    let mut atom = Atom {
        inputs: Vec::new(),
        outputs: Vec::new(),
        bound: -difference.constant,
        strict,
        place,
    };
    for (variable, c) in difference.terms {
        match variable {
            _ if c.is_zero() => {}
            Variable::X(index) => atom.inputs.push((index, c)),
            Variable::Y(index) => atom.outputs.push((index, c)),
        }
    }
    Ok(atom)
}

fn linear(expression: &Sexp<'_>) -> Result<Linear, VnnlibError> {
    let place = expression.place();
    match expression {
        Sexp::Word(word, _) => {
            if let Some(variable) = variable(word) {
                return Ok(Linear {
                    terms: BTreeMap::from([(variable, BigRational::one())]),
                    constant: BigRational::zero(),
                });
            }
            let constant = decimal::value(word).ok_or_else(|| {
                let most = decimal::MOST_DIGITS;
                place.error(format!(
                    "{word:.80} is neither a variable nor a number of at most {most} digits and with an \
                     exponent of at most {most}"
                ))
            })?;
            Ok(Linear {
                terms: BTreeMap::new(),
                constant,
            })
        }
        Sexp::List(items, _) => match items.as_slice() {
            [Sexp::Word("+", _), parts @ ..] => sum(parts, 1.0, place),
            [Sexp::Word("-", _), only] => sum(std::slice::from_ref(only), -1.0, place),
            [Sexp::Word("-", _), first, rest @ ..] => {
                let mut total = linear(first)?;
                total.add(sum(rest, 1.0, place)?, -1.0, place)?;
                Ok(total)
            }
            [Sexp::Word("*", _), first, rest @ ..] => {
                rest.iter().try_fold(linear(first)?, |all, part| {
                    product(all, linear(part)?, place)
                })
            }
            [Sexp::Word("/", _), a, b] => quotient(linear(a)?, &linear(b)?, place),
            _ => Err(place.error("expected +, -, * or / of numbers and variables".to_owned())),
        },
    }
}

fn sum(parts: &[Sexp<'_>], sign: f64, place: Place) -> Result<Linear, VnnlibError> {
    let mut total = Linear::default();
    for part in parts {
        total.add(linear(part)?, sign, place)?;
    }
    Ok(total)
}

fn product(a: Linear, b: Linear, place: Place) -> Result<Linear, VnnlibError> {
    match (a.terms.is_empty(), b.terms.is_empty()) {
        (true, _) => b.scaled(&a.constant, place),
        (_, true) => a.scaled(&b.constant, place),
        _ => Err(place.error("a product of variables is not linear".to_owned())),
    }
}

fn quotient(a: Linear, b: &Linear, place: Place) -> Result<Linear, VnnlibError> {
    if !b.terms.is_empty() || b.constant.is_zero() {
        return Err(place.error("only by constants other than 0".to_owned()));
    }
    a.scaled(&b.constant.recip(), place)
}
