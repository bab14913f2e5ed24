//! Statements and formulas from S-expressions.

use super::VnnlibError;
use super::lexer::{Place, Sexp};

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

/// Σ inputs + Σ outputs ≤ bound; no coefficient is zero.
pub(super) struct Atom {
    pub(super) inputs: Vec<(usize, f64)>,
    pub(super) outputs: Vec<(usize, f64)>,
    pub(super) bound: f64,
    pub(super) place: Place,
}

/// The most variables of a kind; an index beyond it is a typing error, or hostile.
const MOST_VARIABLES: usize = 1 << 16;

#[derive(Clone, Copy, PartialEq)]
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
        [Sexp::Word("<=" | "<", _), a, b] => at_most(a, b, place).map(Formula::Atom),
        [Sexp::Word(">=" | ">", _), a, b] => at_most(b, a, place).map(Formula::Atom),
        [Sexp::Word("=", _), a, b] => {
            let both = [at_most(a, b, place)?, at_most(b, a, place)?];
            Ok(Formula::And(both.into_iter().map(Formula::Atom).collect()))
        }
        [Sexp::Word(other, at), ..] => Err(at.error(format!(
            "operator {other}: expected and, or, <=, >=, <, > or = with two sides"
        ))),
        _ => Err(place.error("expected a formula".to_owned())),
    }
}

/// A linear expression: terms and a constant.
#[derive(Default)]
struct Linear {
    terms: Vec<(Variable, f64)>,
    constant: f64,
}

impl Linear {
    fn add(&mut self, other: &Self, factor: f64) {
        self.constant += factor * other.constant;
        for &(variable, c) in &other.terms {
            match self.terms.iter_mut().find(|(v, _)| *v == variable) {
                Some((_, sum)) => *sum += factor * c,
                None => self.terms.push((variable, factor * c)),
            }
        }
    }
}

fn at_most(a: &Sexp<'_>, b: &Sexp<'_>, place: Place) -> Result<Atom, VnnlibError> {
    let mut difference = linear(a)?;
    difference.add(&linear(b)?, -1.0);
    let mut atom = Atom {
        inputs: Vec::new(),
        outputs: Vec::new(),
        bound: -difference.constant,
        place,
    };
    for (variable, c) in difference.terms {
        if !c.is_finite() {
            return Err(place.error("a coefficient is too large".to_owned()));
        }
        match variable {
            _ if c == 0.0 => {}
            Variable::X(index) => atom.inputs.push((index, c)),
            Variable::Y(index) => atom.outputs.push((index, c)),
        }
    }
    if !atom.bound.is_finite() {
        return Err(place.error("a constant is too large".to_owned()));
    }
    Ok(atom)
}

fn linear(expression: &Sexp<'_>) -> Result<Linear, VnnlibError> {
    let place = expression.place();
    match expression {
        Sexp::Word(word, _) => {
            if let Some(variable) = variable(word) {
                return Ok(Linear {
                    terms: vec![(variable, 1.0)],
                    constant: 0.0,
                });
            }
            let number = word.parse().ok().filter(|v: &f64| v.is_finite());
            let constant = number
                .ok_or_else(|| place.error(format!("{word} is neither a variable nor a number")))?;
            Ok(Linear {
                terms: Vec::new(),
                constant,
            })
        }
        Sexp::List(items, _) => match items.as_slice() {
            [Sexp::Word("+", _), parts @ ..] => sum(parts, 1.0),
            [Sexp::Word("-", _), only] => sum(std::slice::from_ref(only), -1.0),
            [Sexp::Word("-", _), first, rest @ ..] => {
                let mut total = linear(first)?;
                total.add(&sum(rest, 1.0)?, -1.0);
                Ok(total)
            }
            [Sexp::Word("*", _), a, b] => product(linear(a)?, linear(b)?, place),
            _ => Err(place.error("expected +, - or * of numbers and variables".to_owned())),
        },
    }
}

fn sum(parts: &[Sexp<'_>], factor: f64) -> Result<Linear, VnnlibError> {
    let mut total = Linear::default();
    for part in parts {
        total.add(&linear(part)?, factor);
    }
    Ok(total)
}

fn product(a: Linear, b: Linear, place: Place) -> Result<Linear, VnnlibError> {
    let (constant, other) = match (a.terms.is_empty(), b.terms.is_empty()) {
        (true, _) => (a.constant, b),
        (_, true) => (b.constant, a),
        _ => return Err(place.error("a product of variables is not linear".to_owned())),
    };
    let mut total = Linear::default();
    total.add(&other, constant);
    Ok(total)
}
