//! Reads feed-forward networks from ONNX files into the normal form.
//!
//! Understood: Gemm, MatMul, Add, Sub, Mul and Div with constants, Relu, Tanh, Clip, Flatten, Reshape,
//! Transpose, Squeeze, Unsqueeze, Identity, Constant, Concat; `f32` and `f64` tensors, raw or
//! typed. A symbolic dimension (a batch) counts as 1. Weights keep their exact values: where two
//! affine maps in a row cannot be merged without rounding, they stay two layers.

mod affine;
mod operators;
mod tensor;

use super::model::{ModelError, Network};
use affine::Builder;
use cede_formats::onnx::proto;
use operators::Value;
use prost::Message;
use std::collections::HashMap;
use tensor::Shape;

/// Why a network cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OnnxError {
    /// Not an ONNX file, or a damaged one.
    #[error("not an ONNX model: {0}")]
    Encoding(String),
    /// The file has no graph, no input or not exactly one output.
    #[error("{0}")]
    Graph(String),
    /// A tensor that cannot be read.
    #[error("tensor {name:?}: {what}")]
    Tensor {
        /// The tensor's name.
        name: String,
        /// What is wrong with it.
        what: String,
    },
    /// The first operator that is not supported, or that is used in a way that is not.
    #[error("node {node:?}, operator {operator}: {what}")]
    Operator {
        /// The node's name, or the name of what it gives.
        node: String,
        /// The operator's type.
        operator: String,
        /// What is not supported.
        what: String,
    },
    /// The layers do not fit together.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Reads a network. Never panics on any bytes; memory is bounded by a small multiple of the file's
/// size and of the largest layer (at most 2²² weights).
///
/// # Errors
/// If the bytes are not an ONNX model, or the graph is more than a feed-forward chain of the
/// operators above: the first offending node and operator are named.
pub fn read(bytes: &[u8]) -> Result<Network, OnnxError> {
    let model = proto::Model::decode(bytes).map_err(|e| OnnxError::Encoding(e.to_string()))?;
    let graph = model
        .graph
        .ok_or_else(|| OnnxError::Graph("the file holds no graph".to_owned()))?;
    let mut values: HashMap<&str, Value> = HashMap::new();
    for initializer in &graph.initializer {
        values.insert(
            &initializer.name,
            Value::Constant(tensor::read(initializer)?),
        );
    }
    let inputs = graph_inputs(&graph, &values)?;
    let mut builder = Builder::new(inputs.iter().map(|(_, shape)| shape.size()).sum());
    let mut offset = 0;
    for (name, shape) in inputs {
        let end = offset + shape.size();
        values.insert(name, Value::Variable(builder.input(offset..end, shape)));
        offset = end;
    }
    for node in &graph.node {
        let value =
            operators::apply(node, &values, &mut builder).map_err(|what| OnnxError::Operator {
                node: node.label(),
                operator: node.op_type.clone(),
                what,
            })?;
        if let Some(output) = node.output.first() {
            values.insert(output, value);
        }
    }
    let [output] = graph.output.as_slice() else {
        return Err(OnnxError::Graph(format!(
            "{} outputs; exactly one is supported",
            graph.output.len()
        )));
    };
    let Some(Value::Variable(value)) = values.remove(output.name.as_str()) else {
        return Err(OnnxError::Graph(format!(
            "output {:?} does not depend on an input",
            output.name
        )));
    };
    builder.finish(&value).map_err(OnnxError::Graph)
}

/// The graph's inputs that are not initialisers, with their shapes.
fn graph_inputs<'a>(
    graph: &'a proto::Graph,
    constants: &HashMap<&str, Value>,
) -> Result<Vec<(&'a str, Shape)>, OnnxError> {
    let variable = graph
        .input
        .iter()
        .filter(|input| !constants.contains_key(input.name.as_str()));
    let inputs = variable
        .map(|input| {
            let declared = input
                .r#type
                .as_ref()
                .and_then(|t| t.tensor_type.as_ref())
                .and_then(|t| t.shape.as_ref());
            let dims = declared.map(|shape| {
                shape
                    .dim
                    .iter()
                    .map(|d| d.dim_value.max(1))
                    .collect::<Vec<_>>()
            });
            let shape = dims.and_then(|dims| Shape::new(&dims));
            let shape = shape.ok_or_else(|| {
                OnnxError::Graph(format!("input {:?} has no usable shape", input.name))
            })?;
            Ok((input.name.as_str(), shape))
        })
        .collect::<Result<Vec<_>, OnnxError>>()?;
    match inputs.iter().map(|(_, shape)| shape.size()).sum() {
        0 => Err(OnnxError::Graph("the graph has no input".to_owned())),
        1..=tensor::MOST_ELEMENTS => Ok(inputs),
        many => Err(OnnxError::Graph(format!("{many} inputs are too many"))),
    }
}

#[cfg(test)]
mod tests;
