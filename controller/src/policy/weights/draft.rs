//! What a weights file is made from.

use super::Perspective;
use crate::policy::features::FeatureSet;

/// What a weights file is made from.
#[derive(Clone, Copy, Debug)]
pub struct Draft<'a> {
    /// What the network is told; it says how many inputs there are.
    pub features: FeatureSet,
    /// Whose commands it gives.
    pub perspective: Perspective,
    /// Width of the hidden layers: a multiple of 16 up to 128.
    pub width: usize,
    /// SHA-256 of what the network was made from.
    pub provenance: [u8; 32],
    /// Centre of each feature.
    pub centres: &'a [f32],
    /// Scale of each feature.
    pub scales: &'a [f32],
    /// Layer by layer the biases, then the weights of input 0 for each neuron, then those of input 1, …
    pub parameters: &'a [f32],
}
