//! A graph as the chain of operators that a policy is.

use super::proto::{Graph, Model, Node, Tensor};
use super::tensor::Values;
use crate::layers::Layer;
use cede_controller::policy::MAX_ACCELERATION;
use prost::Message;
use std::collections::HashMap;

/// Why a graph is not a policy.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GraphError {
    /// Not an ONNX file, or a damaged one.
    #[error("not an ONNX model: {0}")]
    Encoding(String),
    /// The graph as a whole.
    #[error("{0}")]
    Graph(String),
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

/// What a policy's graph computes: normalisation, dense layers with ReLU between them, squashing.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chain {
    /// The first layer is told (feature − centre) · scale …
    pub(super) centres: Vec<f64>,
    pub(super) scales: Vec<f64>,
    /// … within ± this, if anything.
    pub(super) limit: Option<f64>,
    pub(super) layers: Vec<Layer>,
}

/// What the last node has given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Features,
    Sum { biased: bool },
    Hidden,
    Squashed,
    Acceleration,
}

impl Stage {
    const fn text(self) -> &'static str {
        match self {
            Self::Features => "the features",
            Self::Sum { .. } => "a dense layer",
            Self::Hidden => "ReLU",
            Self::Squashed => "Tanh, which only the end of the network has",
            Self::Acceleration => "the scaling to accelerations",
        }
    }
}

/// The chain of a file, and the file's metadata.
pub(super) fn read(bytes: &[u8]) -> Result<(Chain, HashMap<String, String>), GraphError> {
    let model = Model::decode(bytes).map_err(|e| GraphError::Encoding(e.to_string()))?;
    let lines = model.metadata_props.into_iter();
    let metadata = lines.map(|line| (line.key, line.value)).collect();
    let graph = model.graph.as_ref();
    let graph = graph.ok_or_else(|| GraphError::Graph("the file holds no graph".to_owned()))?;
    Ok((Walk::through(graph)?, metadata))
}

struct Walk<'g> {
    constants: HashMap<&'g str, &'g Tensor>,
    last: &'g str,
    stage: Stage,
    chain: Chain,
}

impl<'g> Walk<'g> {
    fn through(graph: &'g Graph) -> Result<Chain, GraphError> {
        let constants: HashMap<_, _> = graph
            .initializer
            .iter()
            .map(|tensor| (tensor.name.as_str(), tensor))
            .collect();
        let (input, count) = input(graph, &constants).map_err(GraphError::Graph)?;
        let mut walk = Self {
            constants,
            last: input,
            stage: Stage::Features,
            chain: Chain {
                centres: vec![0.0; count],
                scales: vec![1.0; count],
                limit: None,
                layers: Vec::new(),
            },
        };
        for node in &graph.node {
            walk.pass(node).map_err(|what| GraphError::Node {
                node: node.label(),
                operator: node.op_type.clone(),
                what,
            })?;
        }
        walk.finish(graph).map_err(GraphError::Graph)
    }

    fn pass(&mut self, node: &'g Node) -> Result<(), String> {
        if !matches!(node.domain.as_str(), "" | "ai.onnx") {
            let domain = &node.domain;
            return Err(format!("operators of domain {domain:?} are not supported"));
        }
        let [output, ..] = node.output.as_slice() else {
            return Err("gives nothing".to_owned());
        };
        if node.op_type == "Constant" {
            let value = node.attribute("value").and_then(|a| a.t.as_ref());
            let value = value.ok_or("has no value of a supported kind")?;
            self.constants.insert(output, value);
            return Ok(());
        }
        let place = node.input.iter().position(|input| input == self.last);
        let place = place.ok_or("does not take what the node before it gives: not a chain")?;
        let commutes = matches!(node.op_type.as_str(), "Add" | "Mul");
        if place > usize::from(commutes) {
            return Err("takes what the node before it gives in the wrong place".to_owned());
        }
        self.stage = self.apply(node, 1 - place)?;
        self.last = output;
        Ok(())
    }

    /// What the node gives; its constant, if it has one, is input `other`.
    fn apply(&mut self, node: &Node, other: usize) -> Result<Stage, String> {
        let operator = node.op_type.as_str();
        Ok(match (operator, self.stage) {
            ("Identity" | "Dropout", stage) => stage,
            ("Flatten", stage) if node.attribute("axis").is_none_or(|a| a.i == 1) => stage,
            ("Sub" | "Add" | "Mul" | "Div", Stage::Features) if self.chain.limit.is_none() => {
                let constant = self.vector(node, other, self.chain.centres.len())?;
                self.normalise(operator, &constant)?;
                Stage::Features
            }
            ("Clip", Stage::Features) if self.chain.limit.is_none() => {
                self.chain.limit = Some(self.limit(node)?);
                Stage::Features
            }
            ("Gemm" | "MatMul", Stage::Features | Stage::Hidden) => {
                let layer = self.dense(node)?;
                self.chain.layers.push(layer);
                let biased = operator == "Gemm";
                Stage::Sum { biased }
            }
            ("Add", Stage::Sum { biased: false }) => {
                let width = self.width();
                let biases = narrow(&self.vector(node, other, width)?);
                if let Some(layer) = self.chain.layers.last_mut() {
                    layer.biases = biases;
                }
                Stage::Sum { biased: true }
            }
            ("Relu", Stage::Sum { .. }) => Stage::Hidden,
            ("Tanh", Stage::Sum { .. }) => Stage::Squashed,
            ("Mul", Stage::Squashed) => {
                let most = f64::from(MAX_ACCELERATION);
                let factor = self.vector(node, other, self.width())?;
                if factor.iter().any(|&f| f != most) {
                    return Err(format!("after Tanh only by {most} m/s²"));
                }
                Stage::Acceleration
            }
            (_, stage) => {
                return Err(format!(
                    "is not supported after {}; a policy is [Sub Add Mul Div Clip] (Gemm|MatMul+Add Relu)… Gemm [Tanh [Mul]]",
                    stage.text()
                ));
            }
        })
    }

    /// Number of values at this point of the chain.
    fn width(&self) -> usize {
        let last = self.chain.layers.last();
        last.map_or(self.chain.centres.len(), Layer::outputs)
    }

    fn normalise(&mut self, operator: &str, constant: &[f64]) -> Result<(), String> {
        let both = self.chain.centres.iter_mut().zip(&mut self.chain.scales);
        for ((centre, scale), k) in both.zip(constant) {
            match operator {
                "Sub" => *centre += k / *scale,
                "Add" => *centre -= k / *scale,
                "Mul" => *scale *= k,
                _ => *scale /= k,
            }
            if !(centre.is_finite() && scale.is_finite()) {
                return Err("moves a feature beyond all bounds".to_owned());
            }
        }
        Ok(())
    }

    fn limit(&self, node: &Node) -> Result<f64, String> {
        let bound = |name: &str, index| match node.attribute(name) {
            Some(attribute) => Ok(f64::from(attribute.f)),
            None => self.vector(node, index, 1).map(|v| v[0]),
        };
        let (low, high) = (bound("min", 1)?, bound("max", 2)?);
        if low == -high && high.is_normal() && high > 0.0 {
            Ok(high)
        } else {
            Err(format!("to {low} … {high}: only ± a number is supported"))
        }
    }

    fn dense(&self, node: &Node) -> Result<Layer, String> {
        let plain = |name, value| node.attribute(name).is_none_or(|a| a.f == value);
        let flag = |name| node.attribute(name).is_some_and(|a| a.i != 0);
        if !plain("alpha", 1.0) || !plain("beta", 1.0) || flag("transA") {
            return Err("alpha, beta and transA must have their defaults".to_owned());
        }
        let (tensor, values) = self.constant(node, 1)?;
        let &[rows, columns] = tensor.dims.as_slice() else {
            return Err(format!("weights of shape {:?}", tensor.dims));
        };
        let size = |n: i64| usize::try_from(n).unwrap_or(0);
        let (rows, columns) = (size(rows), size(columns));
        let values = narrow(&values);
        let (inputs, outputs, weights) = if flag("transB") {
            let transposed = (0..values.len()).map(|at| values[at % rows * columns + at / rows]);
            (columns, rows, transposed.collect())
        } else {
            (rows, columns, values)
        };
        if inputs != self.width() || outputs == 0 {
            let width = self.width();
            return Err(format!("{inputs} × {outputs} weights for {width} inputs"));
        }
        let given = node.input.get(2).is_some_and(|name| !name.is_empty());
        let biases = if given {
            narrow(&self.vector(node, 2, outputs)?)
        } else {
            vec![0.0; outputs]
        };
        Ok(Layer { weights, biases })
    }

    /// A constant for each of `count` values: one for all, or a row.
    fn vector(&self, node: &Node, index: usize, count: usize) -> Result<Vec<f64>, String> {
        let (tensor, values) = self.constant(node, index)?;
        match values.as_slice() {
            &[one] => Ok(vec![one; count]),
            all if all.len() == count && tensor.dims.last() == Some(&(count as i64)) => Ok(values),
            _ => Err(format!(
                "a constant of shape {:?} for {count} values",
                tensor.dims
            )),
        }
    }

    fn constant(&self, node: &Node, index: usize) -> Result<(&'g Tensor, Vec<f64>), String> {
        let name = node.input.get(index).filter(|name| !name.is_empty());
        let name = name.ok_or_else(|| format!("has no input {index}"))?;
        let tensor = self.constants.get(name.as_str());
        let tensor = tensor.ok_or_else(|| format!("input {name:?} is not a constant"))?;
        match tensor.values().map_err(|e| format!("{name:?}: {e}"))? {
            Values::Real(values) => Ok((tensor, values)),
            Values::Integer(_) => Err(format!("{name:?}: integers")),
        }
    }

    fn finish(self, graph: &Graph) -> Result<Chain, String> {
        match graph.output.as_slice() {
            [output] if output.name == self.last => {}
            [output] => return Err(format!("{:?} is not what the chain gives", output.name)),
            outputs => return Err(format!("{} outputs instead of one", outputs.len())),
        }
        match self.stage {
            Stage::Sum { .. } | Stage::Squashed | Stage::Acceleration => Ok(self.chain),
            stage => Err(format!("the graph ends in {}", stage.text())),
        }
    }
}

/// The graph's one input that is no constant, and how many features it takes.
fn input<'g>(
    graph: &'g Graph,
    constants: &HashMap<&str, &Tensor>,
) -> Result<(&'g str, usize), String> {
    let variable: Vec<_> = graph
        .input
        .iter()
        .filter(|input| !constants.contains_key(input.name.as_str()))
        .collect();
    let [input] = variable.as_slice() else {
        return Err(format!("{} inputs instead of one", variable.len()));
    };
    let declared = input.r#type.as_ref().and_then(|t| t.tensor_type.as_ref());
    let row = declared
        .and_then(|t| t.shape.as_ref())
        .and_then(|s| s.dim.last());
    match row.map(|dimension| usize::try_from(dimension.dim_value)) {
        Some(Ok(count @ 1..=MOST_FEATURES)) => Ok((&input.name, count)),
        _ => Err(format!(
            "input {:?} has no usable number of features",
            input.name
        )),
    }
}

/// More features than any set has.
const MOST_FEATURES: usize = 1024;

fn narrow(values: &[f64]) -> Vec<f32> {
    values.iter().map(|&v| v as f32).collect()
}
