//! What variables are called: `X_i` and `Y_i` in version 1, elements of declared tensors in version 2.

use super::VnnlibError;
use super::lexer::{Place, Sexp};

/// The most variables of a kind; more are a typing error, or hostile.
pub(super) const MOST_VARIABLES: usize = 1 << 16;

/// An input or an output of the network, by its number.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Variable {
    X(usize),
    Y(usize),
}

/// The variables that are declared.
pub(super) enum Names<'a> {
    /// So many inputs and outputs.
    Numbered(usize, usize),
    /// Those of the one network, once it is declared.
    Tensors(Option<[Tensor<'a>; 2]>),
}

/// A tensor; its elements are numbered row by row.
pub(super) struct Tensor<'a> {
    name: &'a str,
    shape: Vec<usize>,
}

/// Element types whose values are real numbers.
const REAL: [&str; 6] = ["Real", "real", "float16", "float32", "float64", "bfloat16"];

impl<'a> Names<'a> {
    /// The number of inputs and of outputs.
    pub(super) fn counts(&self) -> [usize; 2] {
        match self {
            Self::Numbered(inputs, outputs) => [*inputs, *outputs],
            Self::Tensors(Some([input, output])) => [input.size(), output.size()],
            Self::Tensors(None) => [0, 0],
        }
    }

    /// What variable `variable` is called.
    pub(super) fn name(&self, variable: Variable) -> String {
        let (Variable::X(index) | Variable::Y(index)) = variable;
        match (self, variable) {
            (Self::Tensors(Some([input, _])), Variable::X(_)) => input.element(index),
            (Self::Tensors(Some([_, output])), Variable::Y(_)) => output.element(index),
            (_, Variable::X(_)) => format!("X_{index}"),
            (_, Variable::Y(_)) => format!("Y_{index}"),
        }
    }

    /// The variable that `expression` stands for; none if it is no name.
    ///
    /// # Errors
    /// If it is one that is not declared, or if a tensor has no such element.
    pub(super) fn variable(&self, expression: &Sexp<'_>) -> Result<Option<Variable>, VnnlibError> {
        let (name, indices) = match expression {
            Sexp::Word(name, _) => (*name, None),
            Sexp::Element(name, indices, _) => (*name, Some(*indices)),
            Sexp::List(..) => return Ok(None),
        };
        let place = expression.place();
        match self {
            Self::Numbered(..) => match indices {
                None => Ok(numbered(name)),
                Some(_) => Err(place
                    .error("an element of a tensor: begin with (vnnlib-version <2.0>)".to_owned())),
            },
            Self::Tensors(tensors) if is_name(name) => {
                let [input, output] = tensors.as_ref().ok_or_else(|| {
                    place.error(format!(
                        "{name} is not declared: (declare-network …) comes first"
                    ))
                })?;
                if name == input.name {
                    input.number(indices, place).map(|i| Some(Variable::X(i)))
                } else if name == output.name {
                    output.number(indices, place).map(|i| Some(Variable::Y(i)))
                } else {
                    Err(place.error(format!(
                        "{name} is not declared: there are {} and {}",
                        input.name, output.name
                    )))
                }
            }
            Self::Tensors(_) => Ok(None),
        }
    }

    /// Declares `X_i` or `Y_i`.
    pub(super) fn declare(&mut self, name: &str, place: Place) -> Result<(), VnnlibError> {
        match (self, numbered(name)) {
            (Self::Tensors(_), _) => Err(place.error(
                "declare-const belongs to VNN-LIB 1: expected (declare-network …)".to_owned(),
            )),
            (Self::Numbered(inputs, _), Some(Variable::X(index))) => {
                *inputs = (*inputs).max(index + 1);
                Ok(())
            }
            (Self::Numbered(_, outputs), Some(Variable::Y(index))) => {
                *outputs = (*outputs).max(index + 1);
                Ok(())
            }
            (Self::Numbered(..), None) => Err(place.error(format!(
                "variable {name}: expected X_i or Y_i with i < {MOST_VARIABLES}"
            ))),
        }
    }

    /// Declares the network: one input and one output.
    pub(super) fn network(&mut self, parts: &[Sexp<'a>], place: Place) -> Result<(), VnnlibError> {
        let Self::Tensors(tensors) = self else {
            return Err(place.error(
                "declare-network belongs to VNN-LIB 2: begin with (vnnlib-version <2.0>)"
                    .to_owned(),
            ));
        };
        if tensors.is_some() {
            return Err(place.error("a second network: only one is supported".to_owned()));
        }
        let declarations: Vec<_> = parts
            .iter()
            .map(declaration)
            .collect::<Result<_, VnnlibError>>()?;
        let mut of_kind = [Vec::new(), Vec::new()];
        for (kind, tensor) in declarations {
            of_kind[usize::from(kind == Kind::Output)].push(tensor);
        }
        let both = of_kind.map(|tensors| <[Tensor<'a>; 1]>::try_from(tensors).ok());
        let [Some([input]), Some([output])] = both else {
            return Err(place.error(
                "expected one (declare-input …) and one (declare-output …): others are not supported"
                    .to_owned(),
            ));
        };
        if input.name == output.name {
            return Err(place.error(format!("{} is declared twice", input.name)));
        }
        *tensors = Some([input, output]);
        Ok(())
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Input,
    Output,
}

/// `(declare-input NAME TYPE [SHAPE])`, or of an output; the tensor's name in the ONNX file may follow.
fn declaration<'a>(part: &Sexp<'a>) -> Result<(Kind, Tensor<'a>), VnnlibError> {
    let place = part.place();
    let Sexp::List(items, _) = part else {
        return Err(place.error("expected (declare-input NAME TYPE [SHAPE])".to_owned()));
    };
    let (items, kind) = match items.as_slice() {
        [Sexp::Word("declare-input", _), items @ ..] => (items, Kind::Input),
        [Sexp::Word("declare-output", _), items @ ..] => (items, Kind::Output),
        [Sexp::Word(other, at), ..] => {
            return Err(at.error(format!(
                "{other} is not supported: expected declare-input or declare-output"
            )));
        }
        _ => return Err(place.error("expected a declaration".to_owned())),
    };
    match items {
        [
            Sexp::Word(name, at),
            Sexp::Element(element, shape, here),
            onnx @ ..,
        ] if onnx.len() < 2 => {
            if !is_name(name) {
                return Err(at.error(format!("{name} is no name: expected letters, digits and _")));
            }
            if !REAL.contains(element) {
                return Err(here.error(format!(
                    "type {element}: expected one of {}",
                    REAL.join(", ")
                )));
            }
            let shape = numbers(shape, *here)?;
            let size = shape.iter().try_fold(1_usize, |all, &n| all.checked_mul(n));
            if !size.is_some_and(|size| (1..=MOST_VARIABLES).contains(&size)) {
                return Err(here.error(format!(
                    "a tensor of {size:?} elements: expected 1 to {MOST_VARIABLES}",
                    size = size.unwrap_or(usize::MAX)
                )));
            }
            Ok((kind, Tensor { name, shape }))
        }
        _ => {
            Err(place.error("expected a name, a type and a shape, as in X Real [1, 5]".to_owned()))
        }
    }
}

impl Tensor<'_> {
    fn size(&self) -> usize {
        self.shape.iter().product()
    }

    /// The number of the element at `indices`; without any, that of a scalar.
    fn number(&self, indices: Option<&str>, place: Place) -> Result<usize, VnnlibError> {
        let indices = indices.map_or(Ok(Vec::new()), |indices| numbers(indices, place))?;
        let fits = indices.len() == self.shape.len()
            && indices.iter().zip(&self.shape).all(|(i, n)| i < n);
        if !fits {
            return Err(place.error(format!(
                "{}{indices:?} is no element: the shape is {:?}",
                self.name, self.shape
            )));
        }
        let number = indices.iter().zip(&self.shape);
        Ok(number.fold(0, |all, (i, n)| all * n + i))
    }

    /// What element `number` is called.
    fn element(&self, mut number: usize) -> String {
        let mut indices: Vec<usize> = Vec::new();
        for &n in self.shape.iter().rev() {
            indices.push(number % n);
            number /= n;
        }
        indices.reverse();
        format!("{}{indices:?}", self.name)
    }
}

/// Numbers with commas between them.
fn numbers(text: &str, place: Place) -> Result<Vec<usize>, VnnlibError> {
    if text.trim().is_empty() {
        return Ok(Vec::new());
    }
    let number = |word: &str| {
        word.trim().parse().map_err(|_| {
            place.error(format!(
                "[{text:.80}]: expected numbers with commas between them"
            ))
        })
    };
    text.split(',').map(number).collect()
}

fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_alphabetic())
        && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

fn numbered(word: &str) -> Option<Variable> {
    let index = |digits: &str| digits.parse().ok().filter(|&i: &usize| i < MOST_VARIABLES);
    if let Some(digits) = word.strip_prefix("X_") {
        index(digits).map(Variable::X)
    } else {
        index(word.strip_prefix("Y_")?).map(Variable::Y)
    }
}
