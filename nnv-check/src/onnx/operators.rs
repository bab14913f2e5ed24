//! What each operator does to constants and to variables.

use super::affine::{Builder, Variable};
use super::proto::{Attribute, Node};
use super::tensor::{self, Constant, Shape};
use crate::model::Activation;
use cede_formats::onnx::Values;
use std::collections::HashMap;

/// A tensor of the graph.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Constant(Constant),
    Variable(Variable),
}

impl Value {
    fn shape(&self) -> &Shape {
        match self {
            Self::Constant(constant) => &constant.shape,
            Self::Variable(variable) => &variable.shape,
        }
    }

    /// The same elements in another shape or order.
    fn rearranged(&self, shape: Shape, pick: impl Fn(usize) -> usize) -> Self {
        fn moved<T: Copy>(values: &[T], size: usize, pick: impl Fn(usize) -> usize) -> Vec<T> {
            (0..size).map(|i| values[pick(i)]).collect()
        }
        match self {
            Self::Variable(variable) => Self::Variable(variable.rearranged(shape, pick)),
            Self::Constant(constant) => {
                let data = match &constant.data {
                    Values::Real(values) => Values::Real(moved(values, shape.size(), pick)),
                    Values::Integer(values) => Values::Integer(moved(values, shape.size(), pick)),
                };
                Self::Constant(Constant { shape, data })
            }
        }
    }
}

/// The values of a node's inputs, and its attributes.
struct Arguments<'a> {
    node: &'a Node,
    values: &'a HashMap<&'a str, Value>,
}

impl<'a> Arguments<'a> {
    fn value(&self, index: usize) -> Result<&'a Value, String> {
        let name = self
            .node
            .input
            .get(index)
            .ok_or_else(|| format!("has no input {index}"))?;
        self.values
            .get(name.as_str())
            .ok_or_else(|| format!("takes {name:?}, which no earlier node gives"))
    }

    fn given(&self, index: usize) -> bool {
        self.node
            .input
            .get(index)
            .is_some_and(|name| !name.is_empty())
    }

    fn integers(&self, index: usize) -> Result<&'a [i64], String> {
        match self.value(index)? {
            Value::Constant(Constant {
                data: Values::Integer(values),
                ..
            }) => Ok(values),
            _ => Err(format!("input {index} must be a constant of integers")),
        }
    }

    fn attribute(&self, name: &str) -> Option<&'a Attribute> {
        self.node.attribute(name)
    }

    fn integer(&self, name: &str, otherwise: i64) -> i64 {
        self.attribute(name)
            .map_or(otherwise, |attribute| attribute.i)
    }

    /// An axis attribute, counted from the end where negative; at most `most`.
    fn axis(&self, otherwise: i64, rank: usize, most: usize) -> Result<usize, String> {
        axis(self.integer("axis", otherwise), rank, most)
    }
}

fn axis(axis: i64, rank: usize, most: usize) -> Result<usize, String> {
    let counted = if axis < 0 {
        usize::try_from(-axis)
            .ok()
            .and_then(|a| rank.checked_sub(a))
    } else {
        usize::try_from(axis).ok()
    };
    counted
        .filter(|&a| a <= most)
        .ok_or_else(|| format!("axis {axis} of a tensor of rank {rank}"))
}

/// The value that a node gives.
pub(super) fn apply(
    node: &Node,
    values: &HashMap<&str, Value>,
    builder: &mut Builder,
) -> Result<Value, String> {
    if !matches!(node.domain.as_str(), "" | "ai.onnx") {
        return Err(format!(
            "operators of domain {:?} are not supported",
            node.domain
        ));
    }
    let arguments = Arguments { node, values };
    match node.op_type.as_str() {
        "Constant" => constant(&arguments),
        "Identity" | "Dropout" => arguments.value(0).cloned(),
        "Relu" => activation(&arguments, builder, Activation::Relu),
        "Tanh" => activation(&arguments, builder, Activation::Tanh),
        "Clip" => clip(&arguments, builder),
        "Flatten" => flatten(&arguments),
        "Reshape" => reshape(&arguments),
        "Squeeze" => squeeze(&arguments),
        "Unsqueeze" => unsqueeze(&arguments),
        "Transpose" => transpose(&arguments),
        "Concat" => concat(&arguments),
        "Add" => sum(&arguments, builder, 1.0),
        "Sub" => sum(&arguments, builder, -1.0),
        "Mul" => multiply(&arguments, builder),
        "Div" => divide(&arguments, builder),
        "MatMul" => matmul(&arguments, builder),
        "Gemm" => gemm(&arguments, builder),
        _ => Err("is not supported".to_owned()),
    }
}

fn constant(arguments: &Arguments<'_>) -> Result<Value, String> {
    if let Some(tensor) = arguments.attribute("value").and_then(|a| a.t.as_ref()) {
        return tensor::read(tensor)
            .map(Value::Constant)
            .map_err(|e| e.to_string());
    }
    let vector = |length: usize| Shape::from_dims(vec![length]).ok_or("is too large");
    let scalar = || Shape::from_dims(Vec::new()).ok_or("is too large");
    let (shape, data) = if let Some(a) = arguments.attribute("value_float") {
        (scalar()?, Values::Real(vec![f64::from(a.f)]))
    } else if let Some(a) = arguments.attribute("value_floats") {
        (
            vector(a.floats.len())?,
            Values::Real(a.floats.iter().copied().map(f64::from).collect()),
        )
    } else if let Some(a) = arguments.attribute("value_int") {
        (scalar()?, Values::Integer(vec![a.i]))
    } else if let Some(a) = arguments.attribute("value_ints") {
        (vector(a.ints.len())?, Values::Integer(a.ints.clone()))
    } else {
        return Err("has no value of a supported kind".to_owned());
    };
    if matches!(&data, Values::Real(values) if values.iter().any(|v| !v.is_finite())) {
        return Err("holds a number that is not finite".to_owned());
    }
    Ok(Value::Constant(Constant { shape, data }))
}

fn activation(
    arguments: &Arguments<'_>,
    builder: &mut Builder,
    activation: Activation,
) -> Result<Value, String> {
    match arguments.value(0)? {
        Value::Variable(variable) => builder.activate(variable, activation).map(Value::Variable),
        Value::Constant(_) => Err("of a constant is not supported".to_owned()),
    }
}

/// min(high, max(low, x)) as low + relu(x − low) and high − relu(high − x).
fn clip(arguments: &Arguments<'_>, builder: &mut Builder) -> Result<Value, String> {
    let Value::Variable(variable) = arguments.value(0)? else {
        return Err("of a constant is not supported".to_owned());
    };
    let mut value = variable.clone();
    for (name, index, sign) in [("min", 1, 1.0), ("max", 2, -1.0)] {
        let Some(bound) = clip_bound(arguments, name, index)? else {
            continue;
        };
        let shape = || variable.shape.clone();
        value = builder.map(&value, shape(), |i| (vec![(i, sign)], -sign * bound))?;
        value = builder.activate(&value, Activation::Relu)?;
        value = builder.map(&value, shape(), |i| (vec![(i, sign)], bound))?;
    }
    Ok(Value::Variable(value))
}

/// A bound of Clip: an attribute up to operator set 10, an input afterwards, and either may be left out.
fn clip_bound(arguments: &Arguments<'_>, name: &str, index: usize) -> Result<Option<f64>, String> {
    if let Some(attribute) = arguments.attribute(name) {
        let bound = f64::from(attribute.f);
        return if bound.is_finite() {
            Ok(Some(bound))
        } else {
            Err(format!("{name} is not finite"))
        };
    }
    if !arguments.given(index) {
        return Ok(None);
    }
    match arguments.value(index)? {
        Value::Constant(Constant {
            data: Values::Real(values),
            ..
        }) if values.len() == 1 => Ok(Some(values[0])),
        _ => Err(format!("{name} must be a real constant")),
    }
}

fn reshaped(value: &Value, dims: Vec<usize>) -> Result<Value, String> {
    let size = value.shape().size();
    let shape = Shape::from_dims(dims).filter(|shape| shape.size() == size);
    let shape = shape.ok_or_else(|| format!("shape {:?} does not fit", value.shape().dims()))?;
    Ok(value.rearranged(shape, |i| i))
}

fn flatten(arguments: &Arguments<'_>) -> Result<Value, String> {
    let value = arguments.value(0)?;
    let dims = value.shape().dims();
    let (left, right) = dims.split_at(arguments.axis(1, dims.len(), dims.len())?);
    reshaped(value, vec![left.iter().product(), right.iter().product()])
}

fn reshape(arguments: &Arguments<'_>) -> Result<Value, String> {
    let value = arguments.value(0)?;
    let old = value.shape().dims();
    let keep_zero = arguments.integer("allowzero", 0) == 0;
    let wanted = arguments.integers(1)?;
    let mut dims = Vec::with_capacity(wanted.len());
    for (i, &d) in wanted.iter().enumerate() {
        dims.push(match d {
            0 if keep_zero => *old.get(i).ok_or("a 0 beyond the rank")?,
            -1 => 1,
            d => usize::try_from(d).map_err(|_| format!("dimension {d}"))?,
        });
    }
    if let Some(free) = wanted.iter().position(|&d| d == -1) {
        let others = dims
            .iter()
            .try_fold(1_usize, |product, &d| product.checked_mul(d))
            .unwrap_or(0);
        dims[free] = value.shape().size().checked_div(others).unwrap_or(0);
    }
    reshaped(value, dims)
}

/// The axes of Squeeze and Unsqueeze: an attribute up to operator set 12, an input afterwards.
fn axes(arguments: &Arguments<'_>) -> Result<Option<Vec<i64>>, String> {
    match arguments.attribute("axes") {
        Some(attribute) => Ok(Some(attribute.ints.clone())),
        None if arguments.given(1) => arguments.integers(1).map(|axes| Some(axes.to_vec())),
        None => Ok(None),
    }
}

fn squeeze(arguments: &Arguments<'_>) -> Result<Value, String> {
    let value = arguments.value(0)?;
    let dims = value.shape().dims();
    let chosen = match axes(arguments)? {
        Some(axes) => axes
            .iter()
            .map(|&a| axis(a, dims.len(), dims.len()))
            .collect::<Result<Vec<_>, _>>()?,
        None => (0..dims.len()).filter(|&i| dims[i] == 1).collect(),
    };
    reshaped(
        value,
        (0..dims.len())
            .filter(|i| !chosen.contains(i))
            .map(|i| dims[i])
            .collect(),
    )
}

fn unsqueeze(arguments: &Arguments<'_>) -> Result<Value, String> {
    let value = arguments.value(0)?;
    let added = axes(arguments)?.ok_or("has no axes")?;
    let rank = value.shape().dims().len() + added.len();
    let added = added
        .iter()
        .map(|&a| axis(a, rank, rank))
        .collect::<Result<Vec<_>, _>>()?;
    let mut old = value.shape().dims().iter().copied();
    let dims = (0..rank).map(|i| {
        if added.contains(&i) {
            1
        } else {
            old.next().unwrap_or(1)
        }
    });
    reshaped(value, dims.collect())
}

fn transpose(arguments: &Arguments<'_>) -> Result<Value, String> {
    let value = arguments.value(0)?;
    let dims = value.shape().dims();
    let order = match arguments.attribute("perm") {
        Some(attribute) => attribute
            .ints
            .iter()
            .map(|&p| usize::try_from(p).unwrap_or(usize::MAX))
            .collect(),
        None => (0..dims.len()).rev().collect::<Vec<_>>(),
    };
    let mut sorted = order.clone();
    sorted.sort_unstable();
    if sorted != (0..dims.len()).collect::<Vec<_>>() {
        return Err(format!("perm {order:?} of a tensor of rank {}", dims.len()));
    }
    let strides: Vec<usize> = (0..dims.len())
        .map(|i| dims[i + 1..].iter().product())
        .collect();
    let new: Vec<usize> = order.iter().map(|&p| dims[p]).collect();
    let shape = Shape::from_dims(new.clone()).ok_or("is too large")?;
    Ok(value.rearranged(shape, |mut flat| {
        let mut index = 0;
        for (&d, &p) in new.iter().zip(&order).rev() {
            index += flat % d * strides[p];
            flat /= d;
        }
        index
    }))
}

fn concat(arguments: &Arguments<'_>) -> Result<Value, String> {
    let mut parts = Vec::new();
    for i in 0..arguments.node.input.len() {
        match arguments.value(i)? {
            Value::Variable(variable) => parts.push(variable),
            Value::Constant(_) => return Err("of constants is not supported".to_owned()),
        }
    }
    let first = parts.first().ok_or("has no input")?.shape.dims();
    let along = arguments.axis(0, first.len(), first.len().saturating_sub(1))?;
    let mut dims = first.to_vec();
    dims[along..=along].fill(0);
    for part in &parts {
        let own = part.shape.dims();
        if own.len() != first.len() || (0..own.len()).any(|i| i != along && own[i] != first[i]) {
            return Err(format!("shapes {first:?} and {own:?} do not fit"));
        }
        dims[along] += own[along];
    }
    let inner: usize = first[along + 1..].iter().product();
    let whole = dims[along] * inner;
    let shape = Shape::from_dims(dims).ok_or("is too large")?;
    let joined = Variable::gathered(&parts, shape, |flat| {
        let (outer, mut within) = (flat / whole, flat % whole);
        let mut part = 0;
        while within >= parts[part].shape.dims()[along] * inner {
            within -= parts[part].shape.dims()[along] * inner;
            part += 1;
        }
        (
            part,
            outer * parts[part].shape.dims()[along] * inner + within,
        )
    });
    joined.map(Value::Variable)
}

/// A variable and a real constant, in either order.
struct Mixed<'a> {
    variable: &'a Variable,
    shape: &'a Shape,
    values: &'a [f64],
    variable_first: bool,
}

fn mixed<'a>(arguments: &Arguments<'a>) -> Result<Mixed<'a>, String> {
    let (variable, constant, variable_first) = match (arguments.value(0)?, arguments.value(1)?) {
        (Value::Variable(variable), Value::Constant(constant)) => (variable, constant, true),
        (Value::Constant(constant), Value::Variable(variable)) => (variable, constant, false),
        (Value::Variable(_), Value::Variable(_)) => {
            return Err("of two values that depend on the input is not supported".to_owned());
        }
        (Value::Constant(_), Value::Constant(_)) => {
            return Err("of two constants is not supported".to_owned());
        }
    };
    match &constant.data {
        Values::Real(values) => Ok(Mixed {
            variable,
            shape: &constant.shape,
            values,
            variable_first,
        }),
        Values::Integer(_) => Err("with integers is not supported".to_owned()),
    }
}

impl Mixed<'_> {
    fn broadcast(&self) -> Result<Shape, String> {
        let (a, b) = (&self.variable.shape, self.shape);
        a.broadcast(b)
            .ok_or_else(|| format!("shapes {:?} and {:?} do not fit", a.dims(), b.dims()))
    }

    /// For an element of the broadcast result: the index of the variable's element, and the constant.
    fn pair(&self, whole: &Shape, flat: usize) -> (usize, f64) {
        (
            self.variable.shape.index_in(whole, flat),
            self.values[self.shape.index_in(whole, flat)],
        )
    }
}

fn sum(
    arguments: &Arguments<'_>,
    builder: &mut Builder,
    sign_of_second: f64,
) -> Result<Value, String> {
    let m = mixed(arguments)?;
    let whole = m.broadcast()?;
    let (of_variable, of_constant) = if m.variable_first {
        (1.0, sign_of_second)
    } else {
        (sign_of_second, 1.0)
    };
    let row = |flat| {
        let (index, constant) = m.pair(&whole, flat);
        (vec![(index, of_variable)], of_constant * constant)
    };
    builder
        .map(m.variable, whole.clone(), row)
        .map(Value::Variable)
}

fn multiply(arguments: &Arguments<'_>, builder: &mut Builder) -> Result<Value, String> {
    let m = mixed(arguments)?;
    let whole = m.broadcast()?;
    builder
        .map(m.variable, whole.clone(), |flat| {
            (vec![m.pair(&whole, flat)], 0.0)
        })
        .map(Value::Variable)
}

fn divide(arguments: &Arguments<'_>, builder: &mut Builder) -> Result<Value, String> {
    let m = mixed(arguments)?;
    if !m.variable_first || m.values.contains(&0.0) {
        return Err("only by constants other than 0".to_owned());
    }
    let whole = m.broadcast()?;
    builder
        .divide(m.variable, whole.clone(), |flat| m.pair(&whole, flat))
        .map(Value::Variable)
}

/// The last two dimensions of a factor, a vector standing as a row (on the left) or a column.
fn factor(shape: &Shape, left: bool) -> Result<(usize, usize), String> {
    match shape.dims() {
        [n] if left => Ok((1, *n)),
        [n] => Ok((*n, 1)),
        [batch @ .., m, n] if batch.iter().product::<usize>() == 1 => Ok((*m, *n)),
        [outer @ .., n] if left && !outer.is_empty() => Ok((outer.iter().product(), *n)),
        dims => Err(format!("a factor of shape {dims:?} is not supported")),
    }
}

fn matmul(arguments: &Arguments<'_>, builder: &mut Builder) -> Result<Value, String> {
    let m = mixed(arguments)?;
    let (a, b) = if m.variable_first {
        (&m.variable.shape, m.shape)
    } else {
        (m.shape, &m.variable.shape)
    };
    let ((rows, inner), (inner_b, cols)) = (factor(a, true)?, factor(b, false)?);
    if inner != inner_b {
        return Err(format!(
            "shapes {:?} and {:?} do not fit",
            a.dims(),
            b.dims()
        ));
    }
    let mut dims = a.dims()[..a.dims().len().saturating_sub(1)].to_vec();
    if b.dims().len() > 1 {
        dims.push(cols);
    }
    let shape = Shape::from_dims(dims)
        .filter(|s| s.size() == rows * cols)
        .ok_or("gives a shape that is not supported")?;
    let product = Product::new((inner, 1), (cols, 1), inner, &shape)?;
    builder
        .map(m.variable, shape, |flat| {
            (product.terms(&m, flat / cols, flat % cols), 0.0)
        })
        .map(Value::Variable)
}

/// How to walk the two factors of a matrix product: strides of (row, inner) of the left and
/// (inner, column) of the right one.
struct Product {
    rows_step: (usize, usize),
    cols_step: (usize, usize),
    inner: usize,
}

impl Product {
    fn new(
        rows_step: (usize, usize),
        cols_step: (usize, usize),
        inner: usize,
        whole: &Shape,
    ) -> Result<Self, String> {
        let terms = whole.size().checked_mul(inner);
        let small = terms.is_some_and(|terms| terms <= tensor::MOST_ELEMENTS);
        if small {
            Ok(Self {
                rows_step,
                cols_step,
                inner,
            })
        } else {
            Err("is too large".to_owned())
        }
    }

    /// The terms of one element: indices into the variable factor and coefficients.
    fn terms(&self, m: &Mixed<'_>, row: usize, col: usize) -> Vec<(usize, f64)> {
        let left = |k: usize| row * self.rows_step.0 + k * self.rows_step.1;
        let right = |k: usize| k * self.cols_step.0 + col * self.cols_step.1;
        let term = |k| {
            if m.variable_first {
                (left(k), m.values[right(k)])
            } else {
                (right(k), m.values[left(k)])
            }
        };
        (0..self.inner).map(term).collect()
    }
}

fn gemm(arguments: &Arguments<'_>, builder: &mut Builder) -> Result<Value, String> {
    let m = mixed(arguments)?;
    let flag = |name| arguments.integer(name, 0) != 0;
    let real = |name| arguments.attribute(name).map_or(1.0, |a| f64::from(a.f));
    let (alpha, beta) = (real("alpha"), real("beta"));
    let (a, b) = if m.variable_first {
        (&m.variable.shape, m.shape)
    } else {
        (m.shape, &m.variable.shape)
    };
    let (&[a0, a1], &[b0, b1]) = (a.dims(), b.dims()) else {
        return Err(format!(
            "shapes {:?} and {:?} are not matrices",
            a.dims(),
            b.dims()
        ));
    };
    if !alpha.is_finite() || !beta.is_finite() {
        return Err("alpha or beta is not finite".to_owned());
    }
    let (rows, inner, rows_step) = if flag("transA") {
        (a1, a0, (1, a1))
    } else {
        (a0, a1, (a1, 1))
    };
    let (inner_b, cols, cols_step) = if flag("transB") {
        (b1, b0, (1, b1))
    } else {
        (b0, b1, (b1, 1))
    };
    if inner != inner_b {
        return Err(format!(
            "shapes {:?} and {:?} do not fit",
            a.dims(),
            b.dims()
        ));
    }
    let shape = Shape::from_dims(vec![rows, cols]).ok_or("is too large")?;
    let bias = bias(arguments, &shape)?;
    let product = Product::new(rows_step, cols_step, inner, &shape)?;
    let scaled = |factor: f64, value: &Variable, builder: &mut Builder| {
        if factor == 1.0 {
            return Ok(value.clone());
        }
        builder.map(value, value.shape.clone(), |i| (vec![(i, factor)], 0.0))
    };
    let unbiased = |flat: usize| (product.terms(&m, flat / cols, flat % cols), 0.0);
    let value = builder.map(m.variable, shape.clone(), unbiased)?;
    let value = scaled(alpha, &value, builder)?;
    if beta != 1.0
        && !bias
            .iter()
            .all(|&c| crate::rounding::exact_product(beta, c).is_some())
    {
        return Err(format!("beta {beta} is not supported"));
    }
    builder
        .map(&value, shape, |i| (vec![(i, 1.0)], beta * bias[i]))
        .map(Value::Variable)
}

/// Gemm's third input, broadcast to the result's shape.
fn bias(arguments: &Arguments<'_>, whole: &Shape) -> Result<Vec<f64>, String> {
    if !arguments.given(2) {
        return Ok(vec![0.0; whole.size()]);
    }
    match arguments.value(2)? {
        Value::Constant(Constant {
            shape,
            data: Values::Real(values),
        }) if shape.broadcast(whole).as_ref() == Some(whole) => Ok((0..whole.size())
            .map(|i| values[shape.index_in(whole, i)])
            .collect()),
        _ => Err("its third input must be a real constant that fits the result".to_owned()),
    }
}
