//! Networks from ONNX files.
//!
//! The graph is read by [`cede_formats::onnx::graph`], which lists the operators that are
//! understood. Weights keep their exact values: where two affine maps in a row cannot be merged
//! without rounding, they stay two layers.

mod affine;

use crate::gzip;
use crate::model::{Activation, ModelError, Network};
use crate::rounding::exact_product;
use affine::{Builder, Variable};
use cede_formats::onnx::graph::{self, Graph, GraphError, Operation, Step};

/// Why a network cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OnnxError {
    /// The graph cannot be read, or is more than a chain of layers.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// The layers do not fit together.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Reads a network, packed with gzip or not. Never panics on any bytes; memory is bounded by a small multiple of the file's
/// size, unpacked (at most 2³⁰ bytes), and of the largest layer (at most 2²⁶ weights).
///
/// # Errors
/// If the bytes are not an ONNX model, or the graph is more than a feed-forward chain: the first
/// offending node and operator are named.
pub fn read(bytes: &[u8]) -> Result<Network, OnnxError> {
    let bytes = gzip::unpacked(bytes).map_err(|e| GraphError::Encoding(e.to_string()))?;
    network(&graph::read(&bytes)?)
}

fn network(graph: &Graph) -> Result<Network, OnnxError> {
    let sizes = graph.inputs.iter().map(|input| input.shape.size());
    let mut builder = Builder::new(sizes.clone().sum());
    let mut values = Vec::new();
    let mut offset = 0;
    for size in sizes {
        values.push(Variable::input(offset..offset + size));
        offset += size;
    }
    for step in &graph.steps {
        let value = apply(step, &values, &mut builder).map_err(|what| step.fault(what))?;
        values.push(value);
    }
    builder.finish(&values[graph.output])
}

/// The value that a step gives.
fn apply(step: &Step, values: &[Variable], builder: &mut Builder) -> Result<Variable, String> {
    let x = &values[step.from[0]];
    match &step.operation {
        Operation::Move(pick) => builder.rearranged(x, pick),
        Operation::Join(pick) => {
            let parts: Vec<_> = step.from.iter().map(|&part| &values[part]).collect();
            builder.joined(&parts, pick)
        }
        Operation::Add {
            own,
            other,
            constant,
        } => {
            let whole = other.abs() == 1.0;
            let exact = |&c: &f64| whole || exact_product(*other, c).is_some();
            if !constant.iter().all(exact) {
                return Err(format!("beta {other} is not supported"));
            }
            builder.map(x, constant.len(), |i| {
                (vec![(i, *own)], other * constant[i])
            })
        }
        Operation::Scale(factors) => {
            builder.map(x, factors.len(), |i| (vec![(i, factors[i])], 0.0))
        }
        Operation::Divide(divisors) => builder.divide(x, divisors),
        Operation::Linear(linear) => builder.map(x, linear.outputs(), |i| {
            let mut terms = linear.terms(i);
            terms.retain(|&(_, c)| c != 0.0);
            (terms, 0.0)
        }),
        Operation::Relu => builder.activate(x, Activation::Relu),
        Operation::Tanh => builder.activate(x, Activation::Tanh),
        Operation::Clip { low, high } => clip(x, *low, *high, builder),
        _ => Err("is not supported in a network that is verified".to_owned()),
    }
}

/// min(high, max(low, x)) as low + relu(x − low) and high − relu(high − x).
fn clip(
    x: &Variable,
    low: Option<f64>,
    high: Option<f64>,
    builder: &mut Builder,
) -> Result<Variable, String> {
    let (mut value, size) = (x.clone(), x.size());
    for (limit, sign) in [(low, 1.0), (high, -1.0)] {
        let Some(limit) = limit else { continue };
        value = builder.map(&value, size, |i| (vec![(i, sign)], -sign * limit))?;
        value = builder.activate(&value, Activation::Relu)?;
        value = builder.map(&value, size, |i| (vec![(i, sign)], limit))?;
    }
    Ok(value)
}

#[cfg(test)]
mod tests;
