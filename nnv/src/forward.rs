//! The network in plain `f64`, fast, with gradients: for the search for counterexamples. Nothing
//! here is rounded soundly; what it finds is confirmed by [`Query::is_unsafe`](cede_nnv_check::Query::is_unsafe).

use super::kernel::add_scaled;
use super::propagation::{Prepared, Weights};
use cede_nnv_check::Halfspace;
use cede_nnv_check::{Activation, Network};

/// Memory of runs through a network.
pub(super) struct Runner<'a> {
    network: &'a Network,
    /// The network again, its weights by input neuron.
    prepared: &'a Prepared,
    /// Output of every layer.
    values: Vec<Vec<f64>>,
    gradient: Vec<f64>,
    next: Vec<f64>,
}

impl<'a> Runner<'a> {
    pub(super) fn new(network: &'a Network, prepared: &'a Prepared) -> Self {
        let layers = network.layers().iter();
        Self {
            network,
            prepared,
            values: layers.map(|l| vec![0.0; l.outputs()]).collect(),
            gradient: Vec::new(),
            next: Vec::new(),
        }
    }

    /// The outputs.
    #[inline(always)]
    pub(super) fn run(&mut self, input: &[f64]) -> &[f64] {
        for (index, layer) in self.network.layers().iter().enumerate() {
            let (before, rest) = self.values.split_at_mut(index);
            let from = before.last().map_or(input, Vec::as_slice);
            let sums = &mut rest[0];
            sums.copy_from_slice(&layer.bias);
            match &self.prepared.layers[index].weights {
                Weights::Dense(columns) => {
                    let columns = columns.chunks_exact(layer.outputs());
                    for (&x, column) in from.iter().zip(columns).filter(|(x, _)| **x != 0.0) {
                        add_scaled(sums, column, x);
                    }
                }
                Weights::Sparse(rows) => {
                    for (sum, row) in sums.iter_mut().zip(rows) {
                        *sum += row.iter().map(|&(j, w)| w * from[j as usize]).sum::<f64>();
                    }
                }
            }
            match layer.activation {
                Activation::Identity => {}
                activation => sums.iter_mut().for_each(|z| *z = activation.apply(*z)),
            }
        }
        self.values.last().map_or(&[], Vec::as_slice)
    }

    /// The gradient of an atom's excess at the inputs of the last run.
    #[inline(always)]
    pub(super) fn gradient(&mut self, atom: &Halfspace) -> &[f64] {
        self.gradient.clear();
        self.gradient.extend_from_slice(atom.coefficients());
        let layers = self.network.layers().iter().zip(&self.prepared.layers);
        for ((layer, prepared), values) in layers.zip(&self.values).rev() {
            self.next.clear();
            self.next.resize(layer.inputs(), 0.0);
            for (i, (&g, &y)) in self.gradient.iter().zip(values).enumerate() {
                let g = match layer.activation {
                    Activation::Identity => g,
                    Activation::Relu if y > 0.0 => g,
                    Activation::Relu => 0.0,
                    Activation::Tanh => g * (1.0 - y * y),
                };
                if g == 0.0 {
                    continue;
                }
                match &prepared.weights {
                    Weights::Dense(_) => add_scaled(&mut self.next, layer.weights.row(i), g),
                    Weights::Sparse(rows) => {
                        for &(j, w) in &rows[i] {
                            self.next[j as usize] += g * w;
                        }
                    }
                }
            }
            std::mem::swap(&mut self.gradient, &mut self.next);
        }
        &self.gradient
    }
}
