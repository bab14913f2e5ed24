//! From a policy to a graph.

use super::proto::{
    Dimension, Entry, Graph, Model, Node, OperatorSet, Shape, Tensor, TensorType, Type, ValueInfo,
};
use super::tensor::FLOAT;
use crate::layers::NotF32;
use crate::{description, layers};
use cede_controller::Weights;
use cede_controller::policy::MAX_ACCELERATION;
use cede_controller::policy::features::LIMIT;
use prost::Message;

/// Operators of the year 2020, which every runtime in use knows.
const OPERATORS: i64 = 13;
/// The file format that came with them.
const FORMAT: i64 = 8;
/// The commands; the network's other outputs are training's.
const COMMANDS: usize = 2;

const DOC: &str = "Accelerations (m/s²) within ± 3 from the raw features that the metadata name, \
    SI units. A feature that is not a number is not caught here, as Cede's controller does.";

/// The file's bytes; the same policy gives the same bytes. Never panics.
///
/// # Errors
/// If the network is one of integers.
pub fn export(weights: &Weights<'_>) -> Result<Vec<u8>, NotF32> {
    let entry = |(key, value): (&str, String)| Entry {
        key: key.to_owned(),
        value,
    };
    let model = Model {
        ir_version: FORMAT,
        producer_name: "cede".to_owned(),
        producer_version: env!("CARGO_PKG_VERSION").to_owned(),
        doc_string: DOC.to_owned(),
        graph: Some(graph(weights)?),
        opset_import: vec![OperatorSet {
            domain: String::new(),
            version: OPERATORS,
        }],
        metadata_props: description::of(weights).map(entry).into(),
    };
    Ok(model.encode_to_vec())
}

fn graph(weights: &Weights<'_>) -> Result<Graph, NotF32> {
    let (centres, scales): (Vec<f32>, Vec<f32>) = weights.normalisation().unzip();
    let inputs = centres.len();
    let mut chain = Chain::from("features");
    chain.apply("Sub", "centred", [tensor("centre", &[inputs], &centres)]);
    chain.apply("Mul", "scaled", [tensor("scale", &[inputs], &scales)]);
    let limits = [tensor("low", &[], &[-LIMIT]), tensor("high", &[], &[LIMIT])];
    chain.apply("Clip", "limited", limits);
    let [first, second, third, last] = layers::of(weights)?;
    for (i, layer) in [first, second, third, last.narrowed(COMMANDS)]
        .iter()
        .enumerate()
    {
        let (weight, bias) = (format!("weight{i}"), format!("bias{i}"));
        let shape = [layer.inputs(), layer.outputs()];
        let weight = tensor(&weight, &shape, &layer.weights);
        let bias = tensor(&bias, &shape[1..], &layer.biases);
        chain.apply("Gemm", &format!("sum{i}"), [weight, bias]);
        if i < 3 {
            chain.apply("Relu", &format!("hidden{i}"), []);
        }
    }
    chain.apply("Tanh", "squashed", []);
    let most = tensor("largest", &[], &[MAX_ACCELERATION]);
    chain.apply("Mul", "acceleration", [most]);

    let labels: Vec<_> = weights.features().labels().collect();
    Ok(Graph {
        name: "policy".to_owned(),
        node: chain.nodes,
        initializer: chain.constants,
        input: vec![value("features", inputs, labels.join(", "))],
        output: vec![value("acceleration", COMMANDS, "m/s²".to_owned())],
    })
}

/// Nodes, each of which takes what the one before it gives.
struct Chain {
    last: String,
    nodes: Vec<Node>,
    constants: Vec<Tensor>,
}

impl Chain {
    fn from(input: &str) -> Self {
        Self {
            last: input.to_owned(),
            nodes: Vec::new(),
            constants: Vec::new(),
        }
    }

    fn apply(&mut self, operator: &str, output: &str, constants: impl IntoIterator<Item = Tensor>) {
        let mut input = vec![std::mem::replace(&mut self.last, output.to_owned())];
        for constant in constants {
            input.push(constant.name.clone());
            self.constants.push(constant);
        }
        self.nodes.push(Node {
            op_type: operator.to_owned(),
            name: format!("{operator}_{output}"),
            input,
            output: vec![output.to_owned()],
            ..Node::default()
        });
    }
}

fn tensor(name: &str, shape: &[usize], values: &[f32]) -> Tensor {
    Tensor {
        name: name.to_owned(),
        dims: shape.iter().map(|&n| n as i64).collect(),
        data_type: FLOAT,
        raw_data: values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        ..Tensor::default()
    }
}

/// `[batch, length]` of `f32`.
fn value(name: &str, length: usize, doc_string: String) -> ValueInfo {
    let batch = Dimension {
        dim_param: "batch".to_owned(),
        ..Dimension::default()
    };
    let row = Dimension {
        dim_value: length as i64,
        ..Dimension::default()
    };
    let tensor_type = Some(TensorType {
        elem_type: FLOAT,
        shape: Some(Shape {
            dim: vec![batch, row],
        }),
    });
    ValueInfo {
        name: name.to_owned(),
        r#type: Some(Type { tensor_type }),
        doc_string,
    }
}
