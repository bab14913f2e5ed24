//! A policy's layers as plain matrices.

use cede_controller::Weights;

/// An affine layer: `inputs × outputs` weights, input by input, and a bias for each output.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layer {
    pub(crate) weights: Vec<f32>,
    pub(crate) biases: Vec<f32>,
}

impl Layer {
    pub(crate) fn outputs(&self) -> usize {
        self.biases.len()
    }

    pub(crate) fn inputs(&self) -> usize {
        self.weights.len() / self.biases.len().max(1)
    }

    /// The same layer with its first `count` outputs alone.
    pub(crate) fn narrowed(&self, count: usize) -> Self {
        let rows = self.weights.chunks_exact(self.outputs());
        Self {
            weights: rows.flat_map(|row| &row[..count]).copied().collect(),
            biases: self.biases[..count].to_vec(),
        }
    }

    /// The same layer among `inputs` and `outputs` of which the new ones carry nothing.
    ///
    /// Exact: a new neuron's sum is 0, and what it adds to the next layer's sums is 0.
    pub(crate) fn padded(&self, inputs: usize, outputs: usize) -> Self {
        let mut padded = Self {
            weights: vec![0.0; inputs * outputs],
            biases: vec![0.0; outputs],
        };
        let rows = self.weights.chunks_exact(self.outputs());
        for (to, from) in padded.weights.chunks_exact_mut(outputs).zip(rows) {
            to[..from.len()].copy_from_slice(from);
        }
        padded.biases[..self.outputs()].copy_from_slice(&self.biases);
        padded
    }

    /// The layer that gives back what it gets.
    pub(crate) fn identity(width: usize) -> Self {
        let mut weights = vec![0.0; width * width];
        weights.iter_mut().step_by(width + 1).for_each(|w| *w = 1.0);
        Self {
            weights,
            biases: vec![0.0; width],
        }
    }
}

/// The policy's network computes in integers, and `f32` is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the network is one of integers; give the policy in f32 that it was made of")]
pub struct NotF32;

/// The four layers of a policy, all outputs included.
pub(crate) fn of(weights: &Weights<'_>) -> Result<[Layer; 4], NotF32> {
    let network = weights.network().as_f32().ok_or(NotF32)?;
    Ok(network.layers().map(|layer| Layer {
        weights: layer.weights().collect(),
        biases: layer.biases().collect(),
    }))
}
