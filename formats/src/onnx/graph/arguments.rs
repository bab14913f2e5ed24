//! What a node is given: values by name, and attributes.

use super::{Constant, Value, Variable};
use crate::onnx::proto::{Attribute, Node};
use crate::onnx::shape::Shape;
use crate::onnx::tensor::Values;
use std::collections::HashMap;

/// The values of a node's inputs, and its attributes.
pub(super) struct Arguments<'a> {
    pub(super) node: &'a Node,
    values: &'a HashMap<&'a str, Value>,
}

impl<'a> Arguments<'a> {
    pub(super) fn new(node: &'a Node, values: &'a HashMap<&'a str, Value>) -> Self {
        Self { node, values }
    }

    pub(super) fn value(&self, index: usize) -> Result<&'a Value, String> {
        let name = self
            .node
            .input
            .get(index)
            .ok_or_else(|| format!("has no input {index}"))?;
        self.values
            .get(name.as_str())
            .ok_or_else(|| format!("takes {name:?}, which no earlier node gives"))
    }

    /// An input that must depend on the graph's inputs.
    pub(super) fn variable(&self, index: usize) -> Result<&'a Variable, String> {
        match self.value(index)? {
            Value::Variable(variable) => Ok(variable),
            Value::Constant(_) => Err("of a constant is not supported".to_owned()),
        }
    }

    /// Whether an optional input is there.
    pub(super) fn given(&self, index: usize) -> bool {
        let name = self.node.input.get(index);
        name.is_some_and(|name| !name.is_empty())
    }

    pub(super) fn integers(&self, index: usize) -> Result<&'a [i64], String> {
        match self.value(index)? {
            Value::Constant(Constant {
                values: Values::Integer(values),
                ..
            }) => Ok(values),
            _ => Err(format!("input {index} must be a constant of integers")),
        }
    }

    pub(super) fn attribute(&self, name: &str) -> Option<&'a Attribute> {
        self.node.attribute(name)
    }

    /// A text; empty if there is none.
    pub(super) fn text(&self, name: &str) -> &'a str {
        let text = self
            .attribute(name)
            .map_or(&[][..], |attribute| &attribute.s);
        std::str::from_utf8(text).unwrap_or_default()
    }

    pub(super) fn integer(&self, name: &str, otherwise: i64) -> i64 {
        self.attribute(name)
            .map_or(otherwise, |attribute| attribute.i)
    }

    /// An axis attribute, counted from the end where negative; at most `most`.
    pub(super) fn axis(&self, otherwise: i64, rank: usize, most: usize) -> Result<usize, String> {
        axis(self.integer("axis", otherwise), rank, most)
    }

    /// A variable and a real constant, in either order.
    pub(super) fn mixed(&self) -> Result<Mixed<'a>, String> {
        let (variable, constant, variable_first) = match (self.value(0)?, self.value(1)?) {
            (Value::Variable(variable), Value::Constant(constant)) => (variable, constant, true),
            (Value::Constant(constant), Value::Variable(variable)) => (variable, constant, false),
            (Value::Variable(_), Value::Variable(_)) => {
                return Err("of two values that depend on the input is not supported".to_owned());
            }
            (Value::Constant(_), Value::Constant(_)) => {
                return Err("of two constants is not supported".to_owned());
            }
        };
        match &constant.values {
            Values::Real(values) => Ok(Mixed {
                variable,
                shape: &constant.shape,
                values,
                variable_first,
            }),
            Values::Integer(_) => Err("with integers is not supported".to_owned()),
        }
    }
}

/// See [`Arguments::mixed`].
pub(super) struct Mixed<'a> {
    pub(super) variable: &'a Variable,
    /// The constant's shape.
    pub(super) shape: &'a Shape,
    /// The constant's values.
    pub(super) values: &'a [f64],
    pub(super) variable_first: bool,
}

/// An axis, counted from the end where negative.
pub(super) fn axis(axis: i64, rank: usize, most: usize) -> Result<usize, String> {
    let counted = if axis < 0 {
        let from_end = usize::try_from(axis.unsigned_abs()).ok();
        from_end.and_then(|a| rank.checked_sub(a))
    } else {
        usize::try_from(axis).ok()
    };
    counted
        .filter(|&a| a <= most)
        .ok_or_else(|| format!("axis {axis} of a tensor of rank {rank}"))
}

/// The value of a node Constant.
pub(super) fn constant(arguments: &Arguments<'_>) -> Result<Value, String> {
    if let Some(tensor) = arguments.attribute("value").and_then(|a| a.t.as_ref()) {
        return Constant::read(tensor).map(Value::Constant);
    }
    let given = |name| arguments.attribute(name);
    let widened = |a: &Attribute| a.floats.iter().copied().map(f64::from).collect();
    let (dims, values) = if let Some(a) = given("value_float") {
        (vec![], Values::Real(vec![f64::from(a.f)]))
    } else if let Some(a) = given("value_floats") {
        (vec![a.floats.len()], Values::Real(widened(a)))
    } else if let Some(a) = given("value_int") {
        (vec![], Values::Integer(vec![a.i]))
    } else if let Some(a) = given("value_ints") {
        (vec![a.ints.len()], Values::Integer(a.ints.clone()))
    } else {
        return Err("has no value of a supported kind".to_owned());
    };
    if matches!(&values, Values::Real(values) if values.iter().any(|v| !v.is_finite())) {
        return Err("holds a number that is not finite".to_owned());
    }
    let shape = Shape::new(dims).ok_or("has more than 2²⁶ elements")?;
    Ok(Value::Constant(Constant { shape, values }))
}
