//! Operators that act on each element alone.

use super::arguments::{Arguments, Mixed};
use super::{Constant, Operation, Recorder, Value, Variable};
use crate::onnx::shape::Shape;
use crate::onnx::tensor::Values;

/// Relu and Tanh.
pub(super) fn activation(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
    operation: Operation,
) -> Result<Value, String> {
    let x = arguments.variable(0)?;
    recorder
        .push(arguments, vec![x.index], operation, x.shape.clone())
        .map(Value::Variable)
}

pub(super) fn clip(arguments: &Arguments<'_>, recorder: &mut Recorder) -> Result<Value, String> {
    let x = arguments.variable(0)?;
    let operation = Operation::Clip {
        low: limit(arguments, "min", 1)?,
        high: limit(arguments, "max", 2)?,
    };
    recorder
        .push(arguments, vec![x.index], operation, x.shape.clone())
        .map(Value::Variable)
}

/// A limit of Clip: an attribute up to operator set 10, an input afterwards, and either may be
/// left out.
fn limit(arguments: &Arguments<'_>, name: &str, index: usize) -> Result<Option<f64>, String> {
    if let Some(attribute) = arguments.attribute(name) {
        let limit = f64::from(attribute.f);
        return if limit.is_finite() {
            Ok(Some(limit))
        } else {
            Err(format!("{name} is not finite"))
        };
    }
    if !arguments.given(index) {
        return Ok(None);
    }
    match arguments.value(index)? {
        Value::Constant(Constant {
            values: Values::Real(values),
            ..
        }) if values.len() == 1 => Ok(Some(values[0])),
        _ => Err(format!("{name} must be a real constant")),
    }
}

/// Add and Sub.
pub(super) fn sum(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
    sign_of_second: f64,
) -> Result<Value, String> {
    if let (Value::Variable(a), Value::Variable(b)) = (arguments.value(0)?, arguments.value(1)?) {
        return sum_of_two(arguments, recorder, [a, b], sign_of_second);
    }
    let Spread { x, constant, mixed } = spread(arguments, recorder)?;
    let (own, other) = if mixed.variable_first {
        (1.0, sign_of_second)
    } else {
        (sign_of_second, 1.0)
    };
    let operation = Operation::Add {
        own,
        other,
        constant,
    };
    recorder
        .push(arguments, vec![x.index], operation, x.shape)
        .map(Value::Variable)
}

/// Two values that depend on the inputs, broadcast to one shape.
fn sum_of_two(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
    values: [&Variable; 2],
    sign: f64,
) -> Result<Value, String> {
    let [a, b] = values.map(|v| &v.shape);
    let whole = a
        .broadcast(b)
        .ok_or_else(|| format!("shapes {:?} and {:?} do not fit", a.dims(), b.dims()))?;
    let mut from = Vec::new();
    for value in values {
        from.push(over_whole(arguments, recorder, value, &whole)?.index);
    }
    recorder
        .push(arguments, from, Operation::Sum { sign }, whole)
        .map(Value::Variable)
}

/// A value broadcast to a shape.
fn over_whole(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
    value: &Variable,
    whole: &Shape,
) -> Result<Variable, String> {
    let (own, index) = (&value.shape, value.index);
    if own.size() == whole.size() {
        let shape = whole.clone();
        return Ok(Variable { index, shape });
    }
    let pick = (0..whole.size()).map(|i| own.index_in(whole, i)).collect();
    recorder.push(arguments, vec![index], Operation::Move(pick), whole.clone())
}

pub(super) fn multiply(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
) -> Result<Value, String> {
    let Spread { x, constant, .. } = spread(arguments, recorder)?;
    let operation = Operation::Scale(constant);
    recorder
        .push(arguments, vec![x.index], operation, x.shape)
        .map(Value::Variable)
}

pub(super) fn divide(arguments: &Arguments<'_>, recorder: &mut Recorder) -> Result<Value, String> {
    let Spread { x, constant, mixed } = spread(arguments, recorder)?;
    if !mixed.variable_first || constant.contains(&0.0) {
        return Err("only by constants other than 0".to_owned());
    }
    let operation = Operation::Divide(constant);
    recorder
        .push(arguments, vec![x.index], operation, x.shape)
        .map(Value::Variable)
}

/// A variable and a constant, both broadcast to one shape.
struct Spread<'a> {
    x: Variable,
    constant: Vec<f64>,
    mixed: Mixed<'a>,
}

fn spread<'a>(arguments: &Arguments<'a>, recorder: &mut Recorder) -> Result<Spread<'a>, String> {
    let mixed = arguments.mixed()?;
    let (own, other) = (&mixed.variable.shape, mixed.shape);
    let whole = own
        .broadcast(other)
        .ok_or_else(|| format!("shapes {:?} and {:?} do not fit", own.dims(), other.dims()))?;
    let constant = over(mixed.values, other, &whole);
    let x = over_whole(arguments, recorder, mixed.variable, &whole)?;
    Ok(Spread { x, constant, mixed })
}

/// A constant broadcast to a shape.
pub(super) fn over(values: &[f64], shape: &Shape, whole: &Shape) -> Vec<f64> {
    (0..whole.size())
        .map(|i| values[shape.index_in(whole, i)])
        .collect()
}
