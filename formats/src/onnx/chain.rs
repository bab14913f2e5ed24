//! A graph as the chain of operations that a policy is.

use super::graph::{Graph, GraphError, Linear, Operation, Step};
use crate::layers::Layer;
use cede_controller::policy::MAX_ACCELERATION;

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

/// What the last step has given.
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

impl Chain {
    /// The chain that a graph is.
    pub(super) fn of(graph: &Graph) -> Result<Self, GraphError> {
        let [input] = graph.inputs.as_slice() else {
            let what = format!("{} inputs instead of one", graph.inputs.len());
            return Err(GraphError::Graph(what));
        };
        let dims = input.shape.dims();
        let count = input.shape.size();
        if dims.last() != Some(&count) {
            let what = format!(
                "input {:?} of shape {dims:?}; export for a batch of one, or of any number",
                input.name
            );
            return Err(GraphError::Graph(what));
        }
        let mut walk = Walk {
            stage: Stage::Features,
            chain: Self {
                centres: vec![0.0; count],
                scales: vec![1.0; count],
                limit: None,
                layers: Vec::new(),
            },
        };
        for (last, step) in graph.steps.iter().enumerate() {
            if step.from != [last] {
                let what = "does not take what the node before it gives: not a chain";
                return Err(step.fault(what.to_owned()));
            }
            walk.stage = walk.apply(step).map_err(|what| step.fault(what))?;
        }
        walk.finish(graph).map_err(GraphError::Graph)
    }
}

struct Walk {
    stage: Stage,
    chain: Chain,
}

impl Walk {
    fn apply(&mut self, step: &Step) -> Result<Stage, String> {
        let open = self.chain.limit.is_none();
        Ok(match (&step.operation, self.stage) {
            (
                Operation::Add {
                    own: 1.0,
                    other,
                    constant,
                },
                Stage::Features,
            ) if open => {
                self.normalise(constant, |centre, scale, k| *centre -= other * k / *scale)?
            }
            (Operation::Scale(factors), Stage::Features) if open => {
                self.normalise(factors, |_, scale, k| *scale *= k)?
            }
            (Operation::Divide(divisors), Stage::Features) if open => {
                self.normalise(divisors, |_, scale, k| *scale /= k)?
            }
            (&Operation::Clip { low, high }, Stage::Features) if open => {
                self.chain.limit = Some(limit(low, high)?);
                Stage::Features
            }
            (Operation::Linear(linear), Stage::Features | Stage::Hidden) => {
                self.chain.layers.push(dense(linear));
                Stage::Sum { biased: false }
            }
            (
                Operation::Add {
                    own: 1.0,
                    other: other @ (1.0 | -1.0),
                    constant,
                },
                Stage::Sum { biased: false },
            ) => {
                if let Some(layer) = self.chain.layers.last_mut() {
                    layer.biases = constant.iter().map(|c| (other * c) as f32).collect();
                }
                Stage::Sum { biased: true }
            }
            (Operation::Relu, Stage::Sum { .. }) => Stage::Hidden,
            (Operation::Tanh, Stage::Sum { .. }) => Stage::Squashed,
            (Operation::Scale(factors), Stage::Squashed) => {
                let most = f64::from(MAX_ACCELERATION);
                if factors.iter().any(|&f| f != most) {
                    return Err(format!("after Tanh only by {most} m/s²"));
                }
                Stage::Acceleration
            }
            (_, stage) => {
                return Err(format!(
                    "is not supported after {}, or not in this form; a policy is [Sub Add Mul Div Clip] (Gemm|MatMul+Add Relu)… Gemm [Tanh [Mul]]",
                    stage.text()
                ));
            }
        })
    }

    /// Has a constant for each feature change its centre and scale.
    fn normalise(
        &mut self,
        constant: &[f64],
        change: impl Fn(&mut f64, &mut f64, f64),
    ) -> Result<Stage, String> {
        let both = self.chain.centres.iter_mut().zip(&mut self.chain.scales);
        for ((centre, scale), &k) in both.zip(constant) {
            change(centre, scale, k);
            if !(centre.is_finite() && scale.is_finite()) {
                return Err("moves a feature beyond all bounds".to_owned());
            }
        }
        Ok(Stage::Features)
    }

    fn finish(self, graph: &Graph) -> Result<Chain, String> {
        if graph.output != graph.steps.len() {
            return Err("the output is not what the chain gives".to_owned());
        }
        match self.stage {
            Stage::Sum { .. } | Stage::Squashed | Stage::Acceleration => Ok(self.chain),
            stage => Err(format!("the graph ends in {}", stage.text())),
        }
    }
}

fn limit(low: Option<f64>, high: Option<f64>) -> Result<f64, String> {
    let (low, high) = (
        low.unwrap_or(f64::NEG_INFINITY),
        high.unwrap_or(f64::INFINITY),
    );
    if low == -high && high.is_normal() && high > 0.0 {
        Ok(high)
    } else {
        Err(format!("to {low} … {high}: only ± a number is supported"))
    }
}

/// A dense layer without biases.
fn dense(linear: &Linear) -> Layer {
    let outputs = linear.outputs();
    let mut weights = vec![0.0; linear.inputs() * outputs];
    for output in 0..outputs {
        for (input, weight) in linear.terms(output) {
            weights[input * outputs + output] = weight as f32;
        }
    }
    let biases = vec![0.0; outputs];
    Layer { weights, biases }
}
