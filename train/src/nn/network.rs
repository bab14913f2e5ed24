//! Dense networks with ReLU between their layers, and their gradients.

use crate::nn::matmul::{Into, Matrix, multiply};
use rand::RngExt;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// A dense network: affine layers, ReLU after each but the last.
///
/// All parameters lie in one flat vector, layer by layer: the weights row by
/// row (`inputs × outputs`, one row per input), then the biases. Optimisers,
/// target networks and checkpoints treat a network as that vector.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Network {
    sizes: Vec<usize>,
    parameters: Vec<f32>,
}

/// One affine layer of a [`Network`].
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// Number of inputs.
    pub inputs: usize,
    /// Number of outputs.
    pub outputs: usize,
    /// `inputs × outputs`, row by row.
    pub weights: &'a [f32],
    /// One per output.
    pub biases: &'a [f32],
}

/// The values at every layer, which the forward pass keeps for the backward pass.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    batch: usize,
    /// The input, then the output of each layer (after ReLU), `batch` rows each.
    values: Vec<Vec<f32>>,
}

impl Tape {
    /// The network's inputs, one row per sample.
    #[must_use]
    pub fn input(&self) -> &[f32] {
        self.values.first().map_or(&[], Vec::as_slice)
    }

    /// The network's outputs, one row per sample.
    #[must_use]
    pub fn output(&self) -> &[f32] {
        self.values.last().map_or(&[], Vec::as_slice)
    }
}

/// Derivatives of a loss during backpropagation.
///
/// Before [`Network::backward`] they are with respect to the outputs, after it
/// with respect to the inputs. One row per sample.
#[derive(Clone, Debug, Default)]
pub struct Delta {
    /// The derivatives.
    pub values: Vec<f32>,
    spare: Vec<f32>,
}

impl Network {
    /// A network with layers of these `sizes` (inputs first, outputs last), weights and biases
    /// uniform in ±1/√inputs of their layer.
    ///
    /// # Panics
    /// If there are fewer than two sizes, or one is zero.
    #[must_use]
    pub fn new(sizes: &[usize], random: &mut Pcg64) -> Self {
        assert!(sizes.len() >= 2 && sizes.iter().all(|&n| n > 0));
        let mut parameters = Vec::new();
        for (inputs, outputs) in pairs(sizes) {
            let bound = 1.0 / (inputs as f32).sqrt();
            let count = (inputs + 1) * outputs;
            parameters.extend((0..count).map(|_| random.random_range(-bound..bound)));
        }
        Self {
            sizes: sizes.to_vec(),
            parameters,
        }
    }

    /// A network of these `sizes` with these `parameters`.
    pub(super) fn from_parts(sizes: Vec<usize>, parameters: Vec<f32>) -> Self {
        debug_assert_eq!(
            pairs(&sizes).map(|(i, o)| (i + 1) * o).sum::<usize>(),
            parameters.len()
        );
        Self { sizes, parameters }
    }

    /// Multiplies the last layer's parameters by `factor`. A small factor makes the initial outputs small.
    #[must_use]
    pub fn with_last_layer_scaled(mut self, factor: f32) -> Self {
        let n = self.sizes.len();
        let last = (self.sizes[n - 2] + 1) * self.sizes[n - 1];
        let start = self.parameters.len() - last;
        self.parameters[start..]
            .iter_mut()
            .for_each(|p| *p *= factor);
        self
    }

    /// Number of values at each layer, inputs first.
    #[must_use]
    pub fn sizes(&self) -> &[usize] {
        &self.sizes
    }

    /// All parameters.
    #[must_use]
    pub fn parameters(&self) -> &[f32] {
        &self.parameters
    }

    /// All parameters, for an optimiser.
    pub fn parameters_mut(&mut self) -> &mut [f32] {
        &mut self.parameters
    }

    /// The layers, first to last.
    pub fn layers(&self) -> impl DoubleEndedIterator<Item = Layer<'_>> + ExactSizeIterator {
        let offsets = self.offsets();
        (0..self.sizes.len() - 1).map(move |i| {
            let (inputs, outputs) = (self.sizes[i], self.sizes[i + 1]);
            let (weights, biases) =
                self.parameters[offsets[i]..offsets[i + 1]].split_at(inputs * outputs);
            Layer {
                inputs,
                outputs,
                weights,
                biases,
            }
        })
    }

    fn offsets(&self) -> Vec<usize> {
        let mut offsets = vec![0];
        let mut end = 0;
        for (inputs, outputs) in pairs(&self.sizes) {
            end += (inputs + 1) * outputs;
            offsets.push(end);
        }
        offsets
    }

    /// Runs the network on `input` (one row per sample) and keeps the layers' values in `tape`.
    ///
    /// # Panics
    /// If `input` is not whole rows.
    pub fn forward<'t>(&self, input: &[f32], tape: &'t mut Tape) -> &'t [f32] {
        let batch = input.len() / self.sizes[0];
        tape.batch = batch;
        tape.values.resize_with(self.sizes.len(), Vec::new);
        tape.values[0].clear();
        tape.values[0].extend_from_slice(input);
        let last = self.sizes.len() - 2;
        for (i, layer) in self.layers().enumerate() {
            let (before, after) = tape.values.split_at_mut(i + 1);
            let output = &mut after[0];
            output.clear();
            for _ in 0..batch {
                output.extend_from_slice(layer.biases);
            }
            let weights = Matrix::new(layer.weights, layer.inputs, layer.outputs);
            multiply(
                output,
                Matrix::new(&before[i], batch, layer.inputs),
                weights,
                Into::Add,
            );
            if i < last {
                output
                    .iter_mut()
                    .for_each(|x| *x = if *x > 0.0 { *x } else { 0.0 });
            }
        }
        tape.output()
    }

    /// Backpropagates `delta` from the outputs to the inputs, and adds the derivatives with respect
    /// to the parameters to `gradient`, if there is one.
    ///
    /// # Panics
    /// If `delta` or `gradient` does not have the shape of the forward pass that filled `tape`.
    pub fn backward(&self, tape: &Tape, delta: &mut Delta, mut gradient: Option<&mut [f32]>) {
        let batch = tape.batch;
        let mut end = self.parameters.len();
        for (i, layer) in self.layers().enumerate().rev() {
            let start = end - (layer.inputs + 1) * layer.outputs;
            let input = Matrix::new(&tape.values[i], batch, layer.inputs);
            let from_output = Matrix::new(&delta.values, batch, layer.outputs);
            if let Some(gradient) = gradient.as_deref_mut() {
                let (weights, biases) =
                    gradient[start..end].split_at_mut(layer.inputs * layer.outputs);
                multiply(weights, input.transpose(), from_output, Into::Add);
                for row in delta.values.chunks_exact(layer.outputs) {
                    biases.iter_mut().zip(row).for_each(|(b, d)| *b += d);
                }
            }
            delta.spare.resize(batch * layer.inputs, 0.0);
            let weights = Matrix::new(layer.weights, layer.inputs, layer.outputs);
            multiply(
                &mut delta.spare,
                from_output,
                weights.transpose(),
                Into::Replace,
            );
            if i > 0 {
                let passes = delta.spare.iter_mut().zip(&tape.values[i]);
                passes.for_each(|(d, x)| *d = if *x > 0.0 { *d } else { 0.0 });
            }
            std::mem::swap(&mut delta.values, &mut delta.spare);
            end = start;
        }
    }

    /// Moves every parameter towards `other`'s by the share `rate`: the soft update of a target network.
    ///
    /// # Panics
    /// If the two networks differ in shape.
    pub fn approach(&mut self, other: &Self, rate: f32) {
        assert_eq!(self.sizes, other.sizes);
        let both = self.parameters.iter_mut().zip(&other.parameters);
        both.for_each(|(target, p)| *target += rate * (p - *target));
    }
}

fn pairs(sizes: &[usize]) -> impl Iterator<Item = (usize, usize)> + '_ {
    sizes.windows(2).map(|w| (w[0], w[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nn::finite_differences::{assert_gradient, differences, reference, wide};
    use rand::SeedableRng;

    #[test]
    fn gradients_of_every_layer_agree_with_finite_differences() {
        let mut random = Pcg64::seed_from_u64(1);
        let network = Network::new(&[5, 7, 6, 4, 3], &mut random);
        let batch = 9;
        let input: Vec<f32> = (0..batch * 5)
            .map(|_| random.random_range(-1.0..1.0))
            .collect();
        let weight: Vec<f32> = (0..batch * 3)
            .map(|_| random.random_range(-1.0..1.0))
            .collect();
        let loss = |parameters: &[f64], input: &[f64]| -> f64 {
            let rows = input.chunks_exact(5);
            let outputs = rows.flat_map(|row| reference(&network, parameters, row));
            outputs.zip(&weight).map(|(y, w)| y * f64::from(*w)).sum()
        };
        let mut tape = Tape::default();
        network.forward(&input, &mut tape);
        let mut delta = Delta {
            values: weight.clone(),
            ..Delta::default()
        };
        let mut gradient = vec![0.0; network.parameters().len()];
        network.backward(&tape, &mut delta, Some(&mut gradient));
        let (p, x) = (wide(network.parameters()), wide(&input));
        assert_gradient(&gradient, &differences(&p, |p| loss(p, &x)));
        assert_gradient(&delta.values, &differences(&x, |x| loss(&p, x)));
    }

    #[test]
    fn a_target_network_approaches_its_source() {
        let mut random = Pcg64::seed_from_u64(2);
        let source = Network::new(&[2, 3, 1], &mut random);
        let mut target = Network::new(&[2, 3, 1], &mut random);
        target.approach(&source, 1.0);
        let gap = |a: &Network, b: &Network| -> f32 {
            let both = a.parameters().iter().zip(b.parameters());
            both.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        assert!(gap(&target, &source) < 1e-6);
    }
}
