//! Operators that change shapes and order. A new shape alone takes no step.

use super::arguments::{Arguments, axis};
use super::{Constant, Operation, Recorder, Value, Variable};
use crate::onnx::shape::Shape;
use crate::onnx::tensor::Values;

/// The same elements in another shape.
fn reshaped(value: &Value, dims: Vec<usize>) -> Result<Value, String> {
    let size = value.shape().size();
    let shape = Shape::new(dims).filter(|shape| shape.size() == size);
    let shape = shape.ok_or_else(|| format!("shape {:?} does not fit", value.shape().dims()))?;
    let mut value = value.clone();
    match &mut value {
        Value::Constant(constant) => constant.shape = shape,
        Value::Variable(variable) => variable.shape = shape,
    }
    Ok(value)
}

pub(super) fn flatten(arguments: &Arguments<'_>) -> Result<Value, String> {
    let value = arguments.value(0)?;
    let dims = value.shape().dims();
    let (left, right) = dims.split_at(arguments.axis(1, dims.len(), dims.len())?);
    reshaped(value, vec![left.iter().product(), right.iter().product()])
}

pub(super) fn reshape(arguments: &Arguments<'_>) -> Result<Value, String> {
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

fn counted(axes: &[i64], rank: usize) -> Result<Vec<usize>, String> {
    axes.iter().map(|&a| axis(a, rank, rank)).collect()
}

pub(super) fn squeeze(arguments: &Arguments<'_>) -> Result<Value, String> {
    let value = arguments.value(0)?;
    let dims = value.shape().dims();
    let chosen = match axes(arguments)? {
        Some(axes) => counted(&axes, dims.len())?,
        None => (0..dims.len()).filter(|&i| dims[i] == 1).collect(),
    };
    let kept = (0..dims.len()).filter(|i| !chosen.contains(i));
    reshaped(value, kept.map(|i| dims[i]).collect())
}

pub(super) fn unsqueeze(arguments: &Arguments<'_>) -> Result<Value, String> {
    let value = arguments.value(0)?;
    let added = axes(arguments)?.ok_or("has no axes")?;
    let rank = value.shape().dims().len() + added.len();
    let added = counted(&added, rank)?;
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

pub(super) fn transpose(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
) -> Result<Value, String> {
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
    let shape = Shape::new(new.clone()).ok_or("has more than 2²⁶ elements")?;
    let from = |mut flat: usize| {
        let mut index = 0;
        for (&d, &p) in new.iter().zip(&order).rev() {
            index += flat % d * strides[p];
            flat /= d;
        }
        index
    };
    let pick: Vec<usize> = (0..shape.size()).map(from).collect();
    match value {
        Value::Variable(x) => recorder
            .push(arguments, vec![x.index], Operation::Move(pick), shape)
            .map(Value::Variable),
        Value::Constant(constant) => {
            let values = match &constant.values {
                Values::Real(values) => Values::Real(picked(values, &pick)),
                Values::Integer(values) => Values::Integer(picked(values, &pick)),
            };
            Ok(Value::Constant(Constant { shape, values }))
        }
    }
}

fn picked<T: Copy>(values: &[T], pick: &[usize]) -> Vec<T> {
    pick.iter().map(|&i| values[i]).collect()
}

pub(super) fn concat(arguments: &Arguments<'_>, recorder: &mut Recorder) -> Result<Value, String> {
    let mut parts: Vec<&Variable> = Vec::new();
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
    let shape = Shape::new(dims).ok_or("has more than 2²⁶ elements")?;
    let width = |part: usize| parts[part].shape.dims()[along] * inner;
    let from = |flat: usize| {
        let (outer, mut within) = (flat / whole, flat % whole);
        let mut part = 0;
        while within >= width(part) {
            within -= width(part);
            part += 1;
        }
        (part, outer * width(part) + within)
    };
    let join = Operation::Join((0..shape.size()).map(from).collect());
    let from = parts.iter().map(|part| part.index).collect();
    recorder
        .push(arguments, from, join, shape)
        .map(Value::Variable)
}
