//! The network as the propagation wants it.

use crate::relaxation::Lines;
use cede_nnv_check::rounding::gamma;
use cede_nnv_check::{Activation, Halfspace, Matrix, Network};
use std::sync::Arc;

/// Up to so many inputs, cutting across them is the likelier to pay, and bounds are cheap; beyond,
/// across phases.
pub(crate) const SOME_INPUTS: usize = 20;

/// A network and the atoms of a query as the propagation wants them.
pub(crate) struct Prepared {
    pub(crate) inputs: usize,
    /// The network's layers, then one for the atoms.
    pub(crate) layers: Vec<Arc<PreparedLayer>>,
    /// Neurons with an activation, over all layers.
    pub(crate) neurons: usize,
    /// Whether bounding all neurons anew in each region is dear: there are many inputs.
    pub(crate) wide: bool,
    /// How an unstable ReLU is enclosed: [`Lines::relu`]; tests plant unsound lines here.
    pub(crate) enclose: fn(f64, f64) -> Lines,
}

/// The weights of a layer, as it is quickest to go over them.
pub(crate) enum Weights {
    /// One row for each *input* of the layer.
    Dense(Vec<f64>),
    /// For each *output*, which inputs count and by how much.
    Sparse(Vec<Vec<(u32, f64)>>),
}

/// A layer with fewer weights is dense.
const FEW: usize = 1 << 12;
/// So many in one are not zero, at most, in a sparse layer.
const SPARSE: usize = 8;

impl Weights {
    fn new(weights: &Matrix) -> Self {
        let (inputs, outputs) = (weights.cols(), weights.rows());
        let row = |i: usize| {
            let all = (0_u32..).zip(weights.row(i));
            all.filter(|(_, w)| **w != 0.0).map(|(j, &w)| (j, w))
        };
        let nonzero: usize = (0..outputs).map(|i| row(i).count()).sum();
        if inputs * outputs > FEW && nonzero * SPARSE <= inputs * outputs {
            return Self::Sparse((0..outputs).map(|i| row(i).collect()).collect());
        }
        let columns = (0..inputs).flat_map(|j| (0..outputs).map(move |i| weights.row(i)[j]));
        Self::Dense(columns.collect())
    }
}

pub(crate) struct PreparedLayer {
    pub(super) inputs: usize,
    pub(crate) outputs: usize,
    pub(crate) weights: Weights,
    pub(crate) bias: Vec<f64>,
    pub(crate) activation: Activation,
    pub(super) relative_error: f64,
    pub(crate) uncertainty: f64,
    /// Index of its first neuron among all neurons with an activation.
    pub(crate) first: usize,
}

impl Prepared {
    /// Prepares the network followed by one more layer, the atoms coefficients · y − bound.
    pub(crate) fn new(network: &Network, atoms: &[&Halfspace]) -> Self {
        let mut layers = Vec::new();
        let mut neurons = 0;
        for layer in network.layers() {
            let outputs = layer.outputs();
            layers.push(Arc::new(PreparedLayer {
                inputs: layer.inputs(),
                outputs,
                weights: Weights::new(&layer.weights),
                bias: layer.bias.clone(),
                activation: layer.activation,
                relative_error: layer.relative_error(),
                uncertainty: 2.0 * layer.uncertainty,
                first: neurons,
            }));
            neurons += if layer.activation == Activation::Identity {
                0
            } else {
                outputs
            };
        }
        let prepared = Self {
            inputs: network.inputs(),
            layers,
            neurons,
            wide: network.inputs() > SOME_INPUTS,
            enclose: Lines::relu,
        };
        prepared.followed_by(network.outputs(), atoms)
    }

    /// The same network with other atoms.
    pub(crate) fn with_atoms(&self, outputs: usize, atoms: &[&Halfspace]) -> Self {
        let own = self.layers.len().saturating_sub(1);
        let network = Self {
            layers: self.layers[..own].to_vec(),
            ..*self
        };
        network.followed_by(outputs, atoms)
    }

    fn followed_by(mut self, outputs: usize, atoms: &[&Halfspace]) -> Self {
        // A coefficient that is rounded is off by one rounding.
        let rounded = atoms.iter().any(|atom| atom.is_rounded());
        let columns = (0..outputs).flat_map(|j| atoms.iter().map(move |a| a.coefficients()[j]));
        self.layers.push(Arc::new(PreparedLayer {
            inputs: outputs,
            outputs: atoms.len(),
            weights: Weights::Dense(columns.collect()),
            bias: atoms.iter().map(|a| -a.bound()).collect(),
            activation: Activation::Identity,
            relative_error: gamma(outputs + 8),
            uncertainty: if rounded { 2.0 * f64::EPSILON } else { 0.0 },
            first: self.neurons,
        }));
        self
    }
}
