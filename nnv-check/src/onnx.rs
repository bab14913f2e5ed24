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
/// If the bytes are not an ONNX model, or the graph holds other operators: the first offending node
/// and operator are named.
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
        Operation::Sum { sign } => builder.sum(x, &values[step.from[1]], *sign),
        Operation::Map(maps) => builder.map(x, maps.len(), |i| (maps[i].clone(), 0.0)),
        Operation::DivideNearly(divisors) => builder.divide_nearly(x, divisors),
        Operation::Largest(sets) => largest(x, sets, builder),
        Operation::LeakyRelu { slope } => leaky(x, *slope, builder),
        Operation::Sigmoid => sigmoid(x, builder),
        Operation::Relu => builder.activate(x, Activation::Relu),
        Operation::Tanh => builder.activate(x, Activation::Tanh),
        Operation::Clip { low, high } => clip(x, *low, *high, builder),
        _ => Err("is not supported in a network that is verified".to_owned()),
    }
}

/// relu(x) − slope·relu(−x).
fn leaky(x: &Variable, slope: f64, builder: &mut Builder) -> Result<Variable, String> {
    let size = x.size();
    let sign = |i: usize| if i < size { 1.0 } else { -1.0 };
    let both = builder.map(x, 2 * size, |i| (vec![(i % size, sign(i))], 0.0))?;
    let both = builder.activate(&both, Activation::Relu)?;
    builder.map(&both, size, |i| (vec![(i, 1.0), (size + i, -slope)], 0.0))
}

/// ½ + ½·tanh(x/2).
fn sigmoid(x: &Variable, builder: &mut Builder) -> Result<Variable, String> {
    let size = x.size();
    let half = builder.map(x, size, |i| (vec![(i, 0.5)], 0.0))?;
    let tanh = builder.activate(&half, Activation::Tanh)?;
    builder.map(&tanh, size, |i| (vec![(i, 0.5)], 0.5))
}

/// The largest of each set of elements: max(a, b) = relu(b − a) + relu(a) − relu(−a), by pairs.
fn largest(x: &Variable, sets: &[Vec<usize>], builder: &mut Builder) -> Result<Variable, String> {
    let pick: Vec<usize> = sets.iter().flatten().copied().collect();
    let mut value = builder.rearranged(x, &pick)?;
    let mut sizes: Vec<usize> = sets.iter().map(Vec::len).collect();
    while sizes.iter().any(|&size| size > 1) {
        // Which elements meet: two, or one that is left over.
        let mut pairs: Vec<(usize, Option<usize>)> = Vec::new();
        let mut first = 0;
        for size in &mut sizes {
            let pair = |i: usize| (first + i, (i + 1 < *size).then_some(first + i + 1));
            pairs.extend((0..*size).step_by(2).map(pair));
            first += *size;
            *size = size.div_ceil(2);
        }
        let terms = |i: usize| {
            let (a, b) = pairs[i / 3];
            match (i % 3, b) {
                (0, Some(b)) => vec![(b, 1.0), (a, -1.0)],
                (0, None) => Vec::new(),
                (1, _) => vec![(a, 1.0)],
                _ => vec![(a, -1.0)],
            }
        };
        let parts = builder.map(&value, 3 * pairs.len(), |i| (terms(i), 0.0))?;
        let parts = builder.activate(&parts, Activation::Relu)?;
        value = builder.map(&parts, pairs.len(), |i| {
            let i = 3 * i;
            (vec![(i, 1.0), (i + 1, 1.0), (i + 2, -1.0)], 0.0)
        })?;
    }
    Ok(value)
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
