//! The one reader of ONNX graphs: what a graph computes, as a list of a few typed operations.
//!
//! Understood: Gemm, MatMul and Conv with constants; Add and Sub; Mul and Div with constants; Relu,
//! LeakyRelu, Sigmoid, Tanh, Clip; MaxPool, AveragePool, GlobalAveragePool, BatchNormalization;
//! Flatten, Reshape, Transpose, Squeeze, Unsqueeze, Concat, Slice, Split, Gather, Identity, Dropout,
//! Constant; `f32` and `f64` tensors, raw or typed. A symbolic dimension (a batch) counts as 1. Shapes are checked, constants
//! are resolved and moved, and nothing is computed: every number of the file keeps its exact value.

mod arguments;
mod elementwise;
mod linear;
mod moves;
mod parts;
mod windows;

use super::proto;
use super::shape::{MOST_ELEMENTS, MOST_WEIGHTS, Shape};
use super::tensor::Values;
use arguments::Arguments;
pub use linear::Linear;
use prost::Message;
use std::collections::HashMap;

/// What a file's graph computes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Graph {
    /// The inputs, in the order of the file; values 0 and up.
    pub inputs: Vec<Input>,
    /// The operations, in an order in which they can be run. Each gives one value, numbered on
    /// from the inputs.
    pub steps: Vec<Step>,
    /// Which value the graph gives.
    pub output: usize,
    /// What the file says about itself.
    pub metadata: HashMap<String, String>,
}

/// An input of a graph.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Input {
    /// Its name.
    pub name: String,
    /// Its shape, symbolic dimensions counted as 1.
    pub shape: Shape,
}

/// An operation of a graph. One node may give several.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// The node's name, or the name of what it gives.
    pub node: String,
    /// The node's operator.
    pub operator: String,
    /// The values that it takes, by number: one, but for [`Operation::Join`] and [`Operation::Sum`].
    pub from: Vec<usize>,
    /// What is computed.
    pub operation: Operation,
}

impl Step {
    /// An error that names the step's node.
    #[must_use]
    pub fn fault(&self, what: String) -> GraphError {
        GraphError::Node {
            node: self.node.clone(),
            operator: self.operator.clone(),
            what,
        }
    }
}

/// What a step computes, element by element of a value x in row-major order.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Operation {
    /// Element i is element `.0[i]` of x.
    Move(Vec<usize>),
    /// Element i is element `.0[i].1` of the `.0[i].0`-th value that is taken.
    Join(Vec<(usize, usize)>),
    /// own·x + other·constant; `own` is 1 or −1.
    Add {
        /// The factor of x.
        own: f64,
        /// The factor of the constant.
        other: f64,
        /// A number for each element.
        constant: Vec<f64>,
    },
    /// x times a number for each element.
    Scale(Vec<f64>),
    /// x divided by a number other than 0 for each element.
    Divide(Vec<f64>),
    /// A matrix product with a constant.
    Linear(Linear),
    /// Two values of one size: the first plus a sign times the second.
    Sum {
        /// 1 or −1.
        sign: f64,
    },
    /// x divided by a number greater than 0 for each element, which is within 4 units in the last
    /// place of the given one.
    DivideNearly(Vec<f64>),
    /// A sum of elements, each times a number, for each element of the result.
    Map(Vec<Vec<(usize, f64)>>),
    /// The largest of some elements, for each element of the result.
    Largest(Vec<Vec<usize>>),
    /// max(0, x) + slope·min(0, x).
    LeakyRelu {
        /// The slope below 0.
        slope: f64,
    },
    /// 1 / (1 + e⁻ˣ).
    Sigmoid,
    /// max(0, x).
    Relu,
    /// tanh x.
    Tanh,
    /// min(high, max(low, x)), where there is a limit.
    Clip {
        /// The lower limit.
        low: Option<f64>,
        /// The upper limit.
        high: Option<f64>,
    },
}

/// Why a graph cannot be read or used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GraphError {
    /// Not an ONNX file, or a damaged one.
    #[error("not an ONNX model: {0}")]
    Encoding(String),
    /// The graph as a whole.
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
    /// The first node that does not fit.
    #[error("node {node:?}, operator {operator}: {what}")]
    Node {
        /// The node's name, or the name of what it gives.
        node: String,
        /// The operator's type.
        operator: String,
        /// What does not fit.
        what: String,
    },
}

/// The most elements that all nodes of a graph give together.
const MOST_IN_ALL: usize = 1 << 25;
/// The most elements that all constants of its nodes have together.
const MOST_CONSTANT: usize = 1 << 27;

/// Reads a graph. Never panics on any bytes; memory is bounded by a small multiple of the file's
/// size, plus 2²⁵ elements and 2²⁷ weights.
///
/// # Errors
/// If the bytes are not an ONNX model, or the graph holds more than the operators of the module's
/// text over one chain of values and constants: the first offending node is named.
pub fn read(bytes: &[u8]) -> Result<Graph, GraphError> {
    let model = proto::Model::decode(bytes).map_err(|e| GraphError::Encoding(e.to_string()))?;
    let lines = model.metadata_props.into_iter();
    let metadata = lines.map(|line| (line.key, line.value)).collect();
    let graph = model
        .graph
        .ok_or_else(|| GraphError::Graph("the file holds no graph".to_owned()))?;
    let mut values = HashMap::new();
    for initializer in &graph.initializer {
        let constant = Constant::read(initializer).map_err(|what| GraphError::Tensor {
            name: initializer.name.clone(),
            what,
        })?;
        values.insert(initializer.name.as_str(), Value::Constant(constant));
    }
    let inputs = inputs(&graph, &values)?;
    for (index, (name, shape)) in inputs.iter().enumerate() {
        let shape = shape.clone();
        values.insert(name, Value::Variable(Variable { index, shape }));
    }
    let mut recorder = Recorder {
        next: inputs.len(),
        room: MOST_IN_ALL,
        constants: MOST_CONSTANT,
        steps: Vec::new(),
    };
    for node in &graph.node {
        let fault = |what| GraphError::Node {
            node: node.label(),
            operator: node.op_type.clone(),
            what,
        };
        if node.output.is_empty() {
            return Err(fault("gives nothing".to_owned()));
        }
        let arguments = Arguments::new(node, &values);
        let given = if node.op_type == "Split" {
            parts::split(&arguments, &mut recorder)
        } else {
            apply(&arguments, &mut recorder).map(|value| vec![value])
        };
        for (output, value) in node.output.iter().zip(given.map_err(fault)?) {
            let size = value.shape().size();
            let charged = match value {
                Value::Constant(_) => recorder.charge_constant(size),
                Value::Variable(_) => recorder.charge(size),
            };
            charged.map_err(fault)?;
            values.insert(output, value);
        }
    }
    let output = output(&graph, &values)?;
    let input = |(name, shape): (&str, Shape)| Input {
        name: name.to_owned(),
        shape,
    };
    Ok(Graph {
        inputs: inputs.into_iter().map(input).collect(),
        steps: recorder.steps,
        output,
        metadata,
    })
}

/// A tensor of the graph.
#[derive(Clone, Debug)]
enum Value {
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
}

/// A tensor that depends on the inputs.
#[derive(Clone, Debug)]
struct Variable {
    /// The number of the value that has its elements.
    index: usize,
    shape: Shape,
}

/// A constant tensor.
#[derive(Clone, Debug)]
struct Constant {
    shape: Shape,
    values: Values,
}

impl Constant {
    fn read(tensor: &proto::Tensor) -> Result<Self, String> {
        let shape = Shape::stated(&tensor.dims).ok_or_else(|| {
            let dims = &tensor.dims;
            format!("shape {dims:?} is negative or has more than {MOST_WEIGHTS} (2²⁶) elements")
        })?;
        let values = tensor.values().map_err(|e| e.to_string())?;
        Ok(Self { shape, values })
    }
}

/// The steps so far.
struct Recorder {
    /// The number of the next value.
    next: usize,
    /// Elements that the graph may still give.
    room: usize,
    /// Elements that its nodes' constants may still have.
    constants: usize,
    steps: Vec<Step>,
}

impl Recorder {
    fn charge(&mut self, elements: usize) -> Result<(), String> {
        let room = self.room.checked_sub(elements);
        self.room = room.ok_or_else(|| {
            format!(
                "makes the graph too large: its nodes give more than {MOST_IN_ALL} (2²⁵) elements"
            )
        })?;
        Ok(())
    }

    fn charge_constant(&mut self, elements: usize) -> Result<(), String> {
        let room = self.constants.checked_sub(elements);
        self.constants = room.ok_or_else(|| {
            format!("makes the graph too large: its constants have more than {MOST_CONSTANT} (2²⁷) elements")
        })?;
        Ok(())
    }

    /// Adds a step of a node, and gives its value.
    fn push(
        &mut self,
        arguments: &Arguments<'_>,
        from: Vec<usize>,
        operation: Operation,
        shape: Shape,
    ) -> Result<Variable, String> {
        let size = shape.size();
        if size > MOST_ELEMENTS {
            return Err(format!(
                "gives {size} elements; at most {MOST_ELEMENTS} (2²²) are supported"
            ));
        }
        self.charge(size)?;
        self.steps.push(Step {
            node: arguments.node.label(),
            operator: arguments.node.op_type.clone(),
            from,
            operation,
        });
        self.next += 1;
        Ok(Variable {
            index: self.next - 1,
            shape,
        })
    }
}

/// The value that a node gives.
fn apply(arguments: &Arguments<'_>, recorder: &mut Recorder) -> Result<Value, String> {
    let domain = &arguments.node.domain;
    if !matches!(domain.as_str(), "" | "ai.onnx") {
        return Err(format!("operators of domain {domain:?} are not supported"));
    }
    match arguments.node.op_type.as_str() {
        "Constant" => arguments::constant(arguments),
        "Identity" | "Dropout" => arguments.value(0).cloned(),
        "Relu" => elementwise::activation(arguments, recorder, Operation::Relu),
        "Tanh" => elementwise::activation(arguments, recorder, Operation::Tanh),
        "Sigmoid" => elementwise::activation(arguments, recorder, Operation::Sigmoid),
        "LeakyRelu" => {
            let slope = arguments.attribute("alpha").map_or(0.01_f32, |a| a.f);
            if !slope.is_finite() {
                return Err("alpha is not finite".to_owned());
            }
            let slope = f64::from(slope);
            elementwise::activation(arguments, recorder, Operation::LeakyRelu { slope })
        }
        "Clip" => elementwise::clip(arguments, recorder),
        "Add" => elementwise::sum(arguments, recorder, 1.0),
        "Sub" => elementwise::sum(arguments, recorder, -1.0),
        "Mul" => elementwise::multiply(arguments, recorder),
        "Div" => elementwise::divide(arguments, recorder),
        "Flatten" => moves::flatten(arguments),
        "Reshape" => moves::reshape(arguments),
        "Squeeze" => moves::squeeze(arguments),
        "Unsqueeze" => moves::unsqueeze(arguments),
        "Transpose" => moves::transpose(arguments, recorder),
        "Concat" => moves::concat(arguments, recorder),
        "Slice" => parts::slice(arguments, recorder),
        "Gather" => parts::gather(arguments, recorder),
        "Conv" => windows::convolution(arguments, recorder),
        "MaxPool" => windows::max_pool(arguments, recorder),
        "AveragePool" => windows::average_pool(arguments, recorder, false),
        "GlobalAveragePool" => windows::average_pool(arguments, recorder, true),
        "BatchNormalization" => windows::normalisation(arguments, recorder),
        "MatMul" => linear::matmul(arguments, recorder),
        "Gemm" => linear::gemm(arguments, recorder),
        _ => Err(format!("is not supported; supported are {OPERATORS}")),
    }
}

const OPERATORS: &str = "Gemm, MatMul, Conv, Add, Sub, Mul, Div, Relu, LeakyRelu, Sigmoid, Tanh, Clip, \
    MaxPool, AveragePool, GlobalAveragePool, BatchNormalization, Flatten, Reshape, Transpose, Squeeze, \
    Unsqueeze, Concat, Slice, Split, Gather, Identity, Dropout and Constant";

/// The graph's inputs that are not initialisers, with their shapes.
fn inputs<'a>(
    graph: &'a proto::Graph,
    constants: &HashMap<&str, Value>,
) -> Result<Vec<(&'a str, Shape)>, GraphError> {
    let all = graph.input.iter();
    let inputs = all
        .filter(|input| !constants.contains_key(input.name.as_str()))
        .map(|input| Ok((input.name.as_str(), stated_shape(input)?)))
        .collect::<Result<Vec<_>, GraphError>>()?;
    match inputs.iter().map(|(_, shape)| shape.size()).sum() {
        0 => Err(GraphError::Graph("the graph has no input".to_owned())),
        1..=MOST_ELEMENTS => Ok(inputs),
        many => Err(GraphError::Graph(format!(
            "{many} inputs; at most {MOST_ELEMENTS} (2²²) are supported"
        ))),
    }
}

fn stated_shape(input: &proto::ValueInfo) -> Result<Shape, GraphError> {
    let tensor = input.r#type.as_ref().and_then(|t| t.tensor_type.as_ref());
    let stated = tensor.and_then(|t| t.shape.as_ref());
    let dims = stated.map(|shape| shape.dim.iter().map(|d| d.dim_value.max(1)));
    let shape = dims.and_then(|dims| Shape::stated(&dims.collect::<Vec<_>>()));
    shape.ok_or_else(|| GraphError::Graph(format!("input {:?} has no usable shape", input.name)))
}

/// The number of the value that the graph gives.
fn output(graph: &proto::Graph, values: &HashMap<&str, Value>) -> Result<usize, GraphError> {
    let [output] = graph.output.as_slice() else {
        let count = graph.output.len();
        let what = format!("{count} outputs; exactly one is supported");
        return Err(GraphError::Graph(what));
    };
    match values.get(output.name.as_str()) {
        Some(Value::Variable(value)) => Ok(value.index),
        _ => Err(GraphError::Graph(format!(
            "output {:?} does not depend on an input",
            output.name
        ))),
    }
}

#[cfg(test)]
mod tests;
