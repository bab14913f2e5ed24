//! Statements and formulas from S-expressions.

use super::VnnlibError;
use super::decimal;
use super::lexer::{Place, Sexp};
use super::names::{Names, Variable};
use num_rational::BigRational;
use num_traits::{One as _, Zero as _};
use std::collections::BTreeMap;

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

/// The version of a file that says it, `(vnnlib-version <2.0>)`; none of other statements.
///
/// # Errors
/// If it is not supported.
pub(super) fn version(expression: &Sexp<'_>) -> Result<Option<()>, VnnlibError> {
    match expression {
        Sexp::List(items, _) => match items.as_slice() {
            [Sexp::Word("vnnlib-version", _), Sexp::Word(version, at)] => {
                let two = version
                    .strip_prefix("<2.")
                    .and_then(|v| v.strip_suffix('>'));
                if two.is_some_and(|minor| minor.parse::<u32>().is_ok()) {
                    return Ok(Some(()));
                }
                Err(at.error(format!("version {version:.80}: expected <2.0>")))
            }
            _ => Ok(None),
        },
        _ => Ok(None),
    }
}

/// One statement: declares names, or adds the formula that it asserts to `formulas`.
pub(super) fn statement<'a>(
    expression: &Sexp<'a>,
    names: &mut Names<'a>,
    formulas: &mut Vec<Formula>,
) -> Result<(), VnnlibError> {
    let place = expression.place();
    let Sexp::List(items, _) = expression else {
        return Err(place.error("expected a declaration or (assert …)".to_owned()));
    };
    match items.as_slice() {
        [
            Sexp::Word("declare-const", _),
            Sexp::Word(name, at),
            Sexp::Word("Real", _),
        ] => names.declare(name, *at),
        [
            Sexp::Word("declare-network", _),
            Sexp::Word(_, _),
            parts @ ..,
        ] => names.network(parts, place),
        [Sexp::Word("assert", _), body] => {
            formulas.push(formula(body, names)?);
            Ok(())
        }
        [Sexp::Word("vnnlib-version", at), ..] => {
            Err(at.error("the version comes first, and once".to_owned()))
        }
        _ => Err(place.error(
            "expected (declare-const NAME Real), (declare-network NAME …) or (assert FORMULA)"
                .to_owned(),
        )),
    }
}

fn formula(expression: &Sexp<'_>, names: &Names<'_>) -> Result<Formula, VnnlibError> {
    let place = expression.place();
    let Sexp::List(items, _) = expression else {
        return Err(place.error("expected a formula in parentheses".to_owned()));
    };
    let all = |parts: &[Sexp<'_>]| -> Result<Vec<_>, _> {
        parts.iter().map(|part| formula(part, names)).collect()
    };
    match items.as_slice() {
        [Sexp::Word("and", _), parts @ ..] => all(parts).map(Formula::And),
        [Sexp::Word("or", _), parts @ ..] => Ok(Formula::Or(all(parts)?, place)),
        [Sexp::Word(comparison, _), sides @ ..] if sides.len() > 1 && is_comparison(comparison) => {
            let pairs = sides.windows(2);
            let all = pairs.map(|pair| compare(comparison, &pair[0], &pair[1], names));
            all.collect::<Result<_, _>>().map(Formula::And)
        }
        [Sexp::Word(other, at), ..] => Err(at.error(format!(
            "operator {other}: expected and, or, <=, >=, <, >, == or != with two sides"
        ))),
        _ => Err(place.error("expected a formula".to_owned())),
    }
}

fn is_comparison(word: &str) -> bool {
    matches!(word, "<=" | "<" | ">=" | ">" | "=" | "==" | "!=")
}

fn compare(
    comparison: &str,
    a: &Sexp<'_>,
    b: &Sexp<'_>,
    names: &Names<'_>,
) -> Result<Formula, VnnlibError> {
    let atom = |a, b, strict| at_most(a, b, strict, names).map(Formula::Atom);
    match comparison {
        "<=" | "<" => atom(a, b, comparison == "<"),
        ">=" | ">" => atom(b, a, comparison == ">"),
        "!=" => {
            let either = vec![atom(a, b, true)?, atom(b, a, true)?];
            Ok(Formula::Or(either, a.place()))
        }
        _ => Ok(Formula::And(vec![atom(a, b, false)?, atom(b, a, false)?])),
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

fn at_most(
    a: &Sexp<'_>,
    b: &Sexp<'_>,
    strict: bool,
    names: &Names<'_>,
) -> Result<Atom, VnnlibError> {
    let place = a.place();
    let mut difference = linear(a, names)?;
    difference.add(linear(b, names)?, -1.0, place)?;
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

fn linear(expression: &Sexp<'_>, names: &Names<'_>) -> Result<Linear, VnnlibError> {
    let place = expression.place();
    let of = |part| linear(part, names);
    match expression {
        Sexp::Word(..) | Sexp::Element(..) => leaf(expression, names),
        Sexp::List(items, _) => match items.as_slice() {
            [Sexp::Word("+", _), parts @ ..] => sum(parts, 1.0, names, place),
            [Sexp::Word("-", _), only] => sum(std::slice::from_ref(only), -1.0, names, place),
            [Sexp::Word("-", _), first, rest @ ..] => {
                let mut total = of(first)?;
                total.add(sum(rest, 1.0, names, place)?, -1.0, place)?;
                Ok(total)
            }
            [Sexp::Word("*", _), first, rest @ ..] => rest
                .iter()
                .try_fold(of(first)?, |all, part| product(all, of(part)?, place)),
            [Sexp::Word("/", _), a, b] => quotient(of(a)?, &of(b)?, place),
            _ => Err(place.error("expected +, -, * or / of numbers and variables".to_owned())),
        },
    }
}

/// A variable or a number.
fn leaf(expression: &Sexp<'_>, names: &Names<'_>) -> Result<Linear, VnnlibError> {
    let place = expression.place();
    if let Some(variable) = names.variable(expression)? {
        return Ok(Linear {
            terms: BTreeMap::from([(variable, BigRational::one())]),
            constant: BigRational::zero(),
        });
    }
    let number = match expression {
        Sexp::Word(word, _) => decimal::value(word),
        _ => None,
    };
    let constant = number.ok_or_else(|| {
        let most = decimal::MOST_DIGITS;
        place.error(format!(
            "{} is neither a variable nor a number of at most {most} digits and with an exponent of at most {most}",
            expression.word()
        ))
    })?;
    Ok(Linear {
        terms: BTreeMap::new(),
        constant,
    })
}

fn sum(
    parts: &[Sexp<'_>],
    sign: f64,
    names: &Names<'_>,
    place: Place,
) -> Result<Linear, VnnlibError> {
    let mut total = Linear::default();
    for part in parts {
        total.add(linear(part, names)?, sign, place)?;
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
