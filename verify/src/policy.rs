//! Properties of our own policy, over the state of an encounter.
//!
//! A property is about all states (ego's distance and speed, other's distance and speed) of a box.
//! The features that the network is told are enclosed by linear functions of the state, so bounds
//! are propagated from the state to the acceleration, and the search cuts boxes of states.
//!
//! **What a proof is about**: the acceleration that the controller computes in `f32`. It is found
//! for real numbers, with a stated margin for the `f32` rounding of features and network; a
//! refutation is a state at which the controller itself was run. A slope is one of the exact
//! function; what the controller computes differs from that by no more than the stated rounding.

mod check;
mod departure;
mod enclosure;
mod features;
mod gradient;
mod response;
mod search;

pub use departure::{Departure, NotItsOwn};
pub(crate) use response::Response;
pub use search::{Finding, Settled};

use cede_controller::{FeatureSet, Perspective, Weights};
use cede_formats::property::Setting;
use cede_nnv_check::{Activation, AffineEnclosure, InputBox, Layer, Matrix, Network};
use features::Enclosed;

/// A policy as the verifier sees it: the network that gives the ego's mean, and its features.
pub struct Subject<'a> {
    weights: Weights<'a>,
    network: Network,
    normalisation: Vec<(f32, f32)>,
}

/// Nothing can be proved of a policy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unsupported {
    /// Its features are not functions of the state that properties speak of.
    #[error(
        "properties need a network over the features `route`, `traffic`, `scene` or `rights`, not `raw`"
    )]
    Features,
    /// Its network is one of integers.
    #[error(
        "properties are proved of networks in f32; `cede verify departure` says how far one of integers is from its own"
    )]
    Integers,
}

impl<'a> Subject<'a> {
    /// The policy of a weights file, in the part of the left-turner where it is a joint one.
    ///
    /// # Errors
    /// If its features are not of the route, as the paper's raw ones are not, or its network is one of integers.
    pub fn new(weights: Weights<'a>) -> Result<Self, Unsupported> {
        let (FeatureSet::Route | FeatureSet::Traffic | FeatureSet::Scene | FeatureSet::Rights) =
            weights.features()
        else {
            return Err(Unsupported::Features);
        };
        let network = weights.network().as_f32();
        let dense = network.ok_or(Unsupported::Integers)?.layers();
        let layers = dense.iter().enumerate().map(|(index, layer)| {
            let last = index + 1 == dense.len();
            let (biases, columns): (Vec<f32>, Vec<f32>) =
                (layer.biases().collect(), layer.weights().collect());
            // Of the outputs only the first is the ego's mean.
            let outputs = if last { 1 } else { biases.len() };
            let inputs = columns.len() / biases.len();
            let mut matrix = Matrix::zeros(outputs, inputs);
            for i in 0..outputs {
                for (j, weight) in matrix.row_mut(i).iter_mut().enumerate() {
                    *weight = f64::from(columns[j * biases.len() + i]);
                }
            }
            Layer {
                weights: matrix,
                bias: biases[..outputs].iter().copied().map(f64::from).collect(),
                activation: if last {
                    Activation::Identity
                } else {
                    Activation::Relu
                },
                uncertainty: 0.0,
            }
        });
        let layers = layers.collect();
        let network =
            Network::new(weights.features().count(), layers).map_err(|_| Unsupported::Features)?;
        let normalisation = weights.normalisation().collect();
        Ok(Self {
            weights,
            network,
            normalisation,
        })
    }

    /// Whose commands the network gives.
    #[must_use]
    pub fn perspective(&self) -> Perspective {
        self.weights.perspective()
    }

    /// The linear functions and radii of the features on a box of states.
    fn front(&self, region: &InputBox, setting: &Setting) -> Vec<AffineEnclosure> {
        let enclosed = self.features(region, setting);
        enclosed.into_iter().map(|e| e.feature).collect()
    }

    /// The enclosed features on a box of states.
    fn features(&self, region: &InputBox, setting: &Setting) -> Vec<Enclosed> {
        // The feature set was checked when the subject was made.
        features::enclose(
            self.weights.features(),
            &self.normalisation,
            region,
            setting,
        )
        .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
