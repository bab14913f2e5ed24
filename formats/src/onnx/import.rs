//! From a graph to a policy.

use super::chain::Chain;
use super::graph::{self, GraphError};
use crate::description::{self, FEATURES, PERSPECTIVE};
use crate::layers::Layer;
use cede_controller::policy::features::LIMIT;
use cede_controller::policy::mlp::{LANES, MAX_WIDTH, OUTPUTS};
use cede_controller::policy::weights::{Draft, MAX_WEIGHT};
use cede_controller::{FeatureSet, Perspective, WeightsError};
use sha2::{Digest, Sha256};

/// What a graph is told and whose commands it gives, where its file does not say so or is not to be believed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Told {
    /// Its features; by default those that the file's metadata name.
    pub features: Option<FeatureSet>,
    /// Whose commands it gives; by default what the file's metadata say, else [`Perspective::Ego`].
    pub perspective: Option<Perspective>,
}

/// Why a graph cannot become a policy.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// It computes something else.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// Nobody says which features it is told.
    #[error("the file does not say which features the network is told")]
    Unstated,
    /// It takes another number of features.
    #[error("the network takes {inputs} features, `{}` has {}", .features.name(), .features.count())]
    Inputs {
        /// What it is said to be told.
        features: FeatureSet,
        /// What it takes.
        inputs: usize,
    },
    /// It has too few or too many layers.
    #[error("{0} hidden layers; from 1 to 3 are supported")]
    Depth(usize),
    /// A hidden layer is too wide.
    #[error("hidden layer {layer} has {width} neurons; at most {MAX_WIDTH} are supported")]
    Width {
        /// Which, counted from 1.
        layer: usize,
        /// Its neurons.
        width: usize,
    },
    /// It gives something else than commands.
    #[error("{outputs} outputs; supported are {wanted}")]
    Outputs {
        /// How many it gives.
        outputs: usize,
        /// What it may give.
        wanted: &'static str,
    },
    /// Its numbers are too large.
    #[error(transparent)]
    Weights(#[from] WeightsError),
}

/// The words of a weights file that drives as the graph does; their provenance is the SHA-256 of `bytes`.
///
/// Understood is a chain of: Sub, Add, Mul, Div with constants and one Clip to ± L (normalisation, all
/// optional); one to three hidden layers of up to 128 neurons, Gemm or MatMul and Add, each with ReLU; an output
/// layer; Tanh and Mul by 3 (either may be left out: accelerations are always 3·tanh). Identity, Dropout
/// and what changes the shape alone may stand anywhere. Outputs: the first vehicle's command, the second's (an ego
/// policy may lack it: it then expects the other to keep its speed), and two that are ignored.
///
/// Exact: the controller's accelerations have the bits of its own arithmetic over the graph's numbers, where these
/// are `f32`, the normalisation is one Sub and one Mul, and L is 8 times a power of two. Otherwise each
/// constant is rounded once. Narrower layers are filled up with zeros, and missing ones pass
/// their inputs on. A graph without Clip gets one at 1024 times the controller's ± 8 (less where weights
/// over 0.9 leave less room): beyond it the two differ.
///
/// Never panics on any bytes.
///
/// # Errors
/// See [`ImportError`]; a node that does not fit is named.
pub fn import(bytes: &[u8], told: Told) -> Result<Vec<u32>, ImportError> {
    let graph = graph::read(bytes)?;
    let chain = Chain::of(&graph)?;
    let stated = |key| graph.metadata.get(key).map(String::as_str);
    let features = told
        .features
        .or_else(|| stated(FEATURES).and_then(description::features_named))
        .ok_or(ImportError::Unstated)?;
    let perspective = told
        .perspective
        .or_else(|| stated(PERSPECTIVE).and_then(description::perspective_named))
        .unwrap_or(Perspective::Ego);
    let inputs = chain.centres.len();
    if inputs != features.count() {
        return Err(ImportError::Inputs { features, inputs });
    }
    let chain = within_limit(chain);
    let (layers, width) = shaped(&chain.layers, perspective)?;
    let parameters: Vec<f32> = layers
        .iter()
        .flat_map(|layer| layer.biases.iter().chain(&layer.weights))
        .copied()
        .collect();
    let narrow = |values: Vec<f64>| values.into_iter().map(|v| v as f32).collect::<Vec<_>>();
    let draft = Draft {
        features,
        perspective,
        width,
        provenance: Sha256::digest(bytes).into(),
        centres: &narrow(chain.centres),
        scales: &narrow(chain.scales),
        parameters: &parameters,
    };
    let mut words = vec![0; draft.words()];
    draft.encode(&mut words)?;
    Ok(words)
}

/// Room beyond the controller's limit for a graph that has none.
const ROOM: f64 = 1024.0;

/// The same chain with the controller's limit on what the network is told: inputs are scaled down by
/// what the first layer's weights are scaled up.
fn within_limit(mut chain: Chain) -> Chain {
    let Some(first) = chain.layers.first_mut() else {
        return chain;
    };
    let outputs = first.outputs();
    let rows = first.weights.chunks_exact_mut(outputs);
    for (row, scale) in rows.zip(&mut chain.scales) {
        let factor = chain
            .limit
            .map_or_else(|| room(row), |limit| limit / f64::from(LIMIT));
        *scale /= factor;
        for weight in row {
            *weight = (f64::from(*weight) * factor) as f32;
        }
    }
    chain.limit = Some(f64::from(LIMIT));
    chain
}

/// The largest power of two up to [`ROOM`] by which the weights can be multiplied.
fn room(weights: &[f32]) -> f64 {
    let largest = weights.iter().fold(0.0, |most: f32, w| most.max(w.abs()));
    let fits = |factor: &f64| f64::from(largest) * factor <= f64::from(MAX_WEIGHT);
    let factors = std::iter::successors(Some(ROOM), |f| (*f > 1.0).then_some(f / 2.0));
    factors.into_iter().find(fits).unwrap_or(1.0)
}

/// The layers in the controller's shape: three hidden ones of one width, and four outputs.
fn shaped(layers: &[Layer], perspective: Perspective) -> Result<(Vec<Layer>, usize), ImportError> {
    let (last, hidden) = match layers.split_last() {
        Some((last, hidden)) if (1..=3).contains(&hidden.len()) => (last, hidden),
        _ => return Err(ImportError::Depth(layers.len().saturating_sub(1))),
    };
    let outputs = last.outputs();
    let wanted = match perspective {
        Perspective::Joint => "2 or 4",
        Perspective::Ego => "1, 2 or 4",
    };
    if !(matches!(outputs, 2 | OUTPUTS) || outputs == 1 && perspective == Perspective::Ego) {
        return Err(ImportError::Outputs { outputs, wanted });
    }
    let widths = hidden.iter().map(Layer::outputs);
    if let Some((i, width)) = widths.clone().enumerate().find(|(_, w)| *w > MAX_WIDTH) {
        let layer = i + 1;
        return Err(ImportError::Width { layer, width });
    }
    let width = widths.max().unwrap_or(0).next_multiple_of(LANES);
    let mut inputs = hidden.first().map_or(0, Layer::inputs);
    let mut shaped = Vec::new();
    for layer in hidden {
        shaped.push(layer.padded(inputs, width));
        inputs = width;
    }
    shaped.resize_with(3, || Layer::identity(width));
    shaped.push(last.padded(width, OUTPUTS));
    Ok((shaped, width))
}
