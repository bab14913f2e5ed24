//! Matrix products with a constant.

use super::arguments::{Arguments, Mixed};
use super::elementwise::over;
use super::{Constant, Operation, Recorder, Value};
use crate::onnx::shape::{MOST_WEIGHTS, Shape};
use crate::onnx::tensor::Values;
use std::sync::Arc;

/// A matrix product of a value and a constant, in either order, as a linear map of the value's
/// elements.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    constant: Arc<[f64]>,
    variable_first: bool,
    /// Strides of the left factor: from row to row, and along the sum.
    left: (usize, usize),
    /// Strides of the right factor: along the sum, and from column to column.
    right: (usize, usize),
    rows: usize,
    columns: usize,
    inner: usize,
}

impl Linear {
    /// Number of elements of the value that it is applied to.
    #[must_use]
    pub fn inputs(&self) -> usize {
        let outer = if self.variable_first {
            self.rows
        } else {
            self.columns
        };
        outer * self.inner
    }

    /// Number of elements of the result.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.rows * self.columns
    }

    /// Element `output` of the result: indices of the value's elements and their coefficients, in
    /// the order of the sum. Panics if there is no such element.
    #[must_use]
    pub fn terms(&self, output: usize) -> Vec<(usize, f64)> {
        let (row, column) = (output / self.columns, output % self.columns);
        let left = |k: usize| row * self.left.0 + k * self.left.1;
        let right = |k: usize| k * self.right.0 + column * self.right.1;
        let term = |k| {
            if self.variable_first {
                (left(k), self.constant[right(k)])
            } else {
                (right(k), self.constant[left(k)])
            }
        };
        (0..self.inner).map(term).collect()
    }

    fn checked(self) -> Result<Self, String> {
        let terms = self.outputs().checked_mul(self.inner);
        if terms.is_some_and(|terms| terms <= MOST_WEIGHTS) {
            return Ok(self);
        }
        let (inputs, outputs) = (self.inputs(), self.outputs());
        Err(format!(
            "maps {inputs} elements to {outputs} by more than {MOST_WEIGHTS} (2²⁶) weights"
        ))
    }
}

fn unfit(a: &Shape, b: &Shape) -> String {
    format!("shapes {:?} and {:?} do not fit", a.dims(), b.dims())
}

/// The shapes of the left and of the right factor.
fn factors<'a>(mixed: &Mixed<'a>) -> (&'a Shape, &'a Shape) {
    if mixed.variable_first {
        (&mixed.variable.shape, mixed.shape)
    } else {
        (mixed.shape, &mixed.variable.shape)
    }
}

/// The last two dimensions of a factor, a vector standing as a row (on the left) or a column.
fn matrix(shape: &Shape, left: bool) -> Result<(usize, usize), String> {
    match shape.dims() {
        [n] if left => Ok((1, *n)),
        [n] => Ok((*n, 1)),
        [batch @ .., m, n] if batch.iter().product::<usize>() == 1 => Ok((*m, *n)),
        [outer @ .., n] if left && !outer.is_empty() => Ok((outer.iter().product(), *n)),
        dims => Err(format!("a factor of shape {dims:?} is not supported")),
    }
}

pub(super) fn matmul(arguments: &Arguments<'_>, recorder: &mut Recorder) -> Result<Value, String> {
    let mixed = arguments.mixed()?;
    let (a, b) = factors(&mixed);
    let ((rows, inner), (inner_b, columns)) = (matrix(a, true)?, matrix(b, false)?);
    if inner != inner_b {
        return Err(unfit(a, b));
    }
    let mut dims = a.dims()[..a.dims().len().saturating_sub(1)].to_vec();
    if b.dims().len() > 1 {
        dims.push(columns);
    }
    let shape = Shape::new(dims)
        .filter(|s| s.size() == rows * columns)
        .ok_or("gives a shape that is not supported")?;
    let linear = Linear {
        constant: mixed.values.into(),
        variable_first: mixed.variable_first,
        left: (inner, 1),
        right: (columns, 1),
        rows,
        columns,
        inner,
    };
    let operation = Operation::Linear(linear.checked()?);
    recorder.charge_constant(mixed.values.len())?;
    recorder
        .push(arguments, vec![mixed.variable.index], operation, shape)
        .map(Value::Variable)
}

pub(super) fn gemm(arguments: &Arguments<'_>, recorder: &mut Recorder) -> Result<Value, String> {
    let mixed = arguments.mixed()?;
    let real = |name| arguments.attribute(name).map_or(1.0, |a| f64::from(a.f));
    let (alpha, beta) = (real("alpha"), real("beta"));
    if !alpha.is_finite() || !beta.is_finite() {
        return Err("alpha or beta is not finite".to_owned());
    }
    let (linear, shape) = product(arguments, &mixed)?;
    let bias = bias(arguments, &shape)?;
    recorder.charge_constant(mixed.values.len())?;
    let mut push = |from: usize, operation| {
        let value = recorder.push(arguments, vec![from], operation, shape.clone());
        value.map(|value| value.index)
    };
    let mut index = push(mixed.variable.index, Operation::Linear(linear))?;
    if alpha != 1.0 {
        index = push(index, Operation::Scale(vec![alpha; shape.size()]))?;
    }
    if let Some(constant) = bias {
        let (own, other) = (1.0, beta);
        index = push(
            index,
            Operation::Add {
                own,
                other,
                constant,
            },
        )?;
    }
    Ok(Value::Variable(super::Variable { index, shape }))
}

/// Gemm's product, its factors transposed as the attributes say.
fn product(arguments: &Arguments<'_>, mixed: &Mixed<'_>) -> Result<(Linear, Shape), String> {
    let flag = |name| arguments.integer(name, 0) != 0;
    let (a, b) = factors(mixed);
    let (&[a0, a1], &[b0, b1]) = (a.dims(), b.dims()) else {
        let (a, b) = (a.dims(), b.dims());
        return Err(format!("shapes {a:?} and {b:?} are not matrices"));
    };
    let (rows, inner, left) = if flag("transA") {
        (a1, a0, (1, a1))
    } else {
        (a0, a1, (a1, 1))
    };
    let (inner_b, columns, right) = if flag("transB") {
        (b1, b0, (1, b1))
    } else {
        (b0, b1, (b1, 1))
    };
    if inner != inner_b {
        return Err(unfit(a, b));
    }
    let shape = Shape::new(vec![rows, columns])
        .ok_or_else(|| format!("gives more than {MOST_WEIGHTS} elements"))?;
    let linear = Linear {
        constant: mixed.values.into(),
        variable_first: mixed.variable_first,
        left,
        right,
        rows,
        columns,
        inner,
    };
    Ok((linear.checked()?, shape))
}

/// Gemm's third input, broadcast to the result's shape.
fn bias(arguments: &Arguments<'_>, whole: &Shape) -> Result<Option<Vec<f64>>, String> {
    if !arguments.given(2) {
        return Ok(None);
    }
    match arguments.value(2)? {
        Value::Constant(Constant {
            shape,
            values: Values::Real(values),
        }) if shape.broadcast(whole).as_ref() == Some(whole) => {
            Ok(Some(over(values, shape, whole)))
        }
        _ => Err("its third input must be a real constant that fits the result".to_owned()),
    }
}
