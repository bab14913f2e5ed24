//! The least value of a linear form where bounds of the neurons are known, by one pass back through
//! the layers (Zhang et al. 2018; Singh et al. 2019), with the choices that a region leaves:
//! weights of the atoms, lower slopes, multipliers of assumed phases.
//!
//! [Relaxations](super::relaxation) keep every neuron's form over the inputs, which pays where all
//! neurons are to be bounded. Here inputs may be many, regions differ in assumed phases only, and
//! one form is to be bounded again and again: a pass costs no more than running the network once.
//!
//! **Rounding.** The float coefficients of each layer are taken as exact, and what they miss of the
//! coefficients that they were computed from is charged at once: at most g·|a| a term of a sum, for
//! each pre-activation of coefficient a together g·|a|·[size](Frame), where size is no less than the
//! sum of its terms' absolute values anywhere on the query's box, and g = γ of the number of all
//! terms. The constant's own sum has the same terms. An offset, and the slope beside it, are off by
//! a rounding of what they were computed from: g·|c|·(offset + largest |pre-activation|).
//!
//! **Underflow and overflow** are those of the relaxations: every product may be off by half of the
//! smallest number, times what it is multiplied by, and a bound that is not finite is none.

use super::kernel::{add_scaled, add_scaled_4, dot};
use super::objective::MARGIN;
use super::propagation::{NeuronBounds, Phase, Prepared, PreparedLayer, Weights};
use super::relaxation::Lines;
use super::side::{Choice, Refinement};
use cede_nnv_check::rounding::{SPARE, gamma, underflow};
use cede_nnv_check::{Activation, Halfspace, InputBox, Network};
use std::collections::HashMap;
use std::sync::Arc;

/// What all regions of a query have in common.
pub(super) struct Frame<'a> {
    network: &'a Network,
    prepared: &'a Prepared,
    atoms: Vec<&'a Halfspace>,
    /// At least Σ|terms| of every pre-activation on the query's box, by layer; the atoms' last.
    sizes: Vec<Vec<f64>>,
    /// Largest absolute value of each input.
    most: Vec<f64>,
    relative_error: f64,
    underflow: f64,
    /// How the neurons were bounded on the whole box, where with care.
    pub(super) refinement: Refinement,
    places: HashMap<(usize, bool), usize>,
}

impl<'a> Frame<'a> {
    /// `prepared` is the network with the atoms, `bounds` hold on the whole box.
    pub(super) fn new(
        network: &'a Network,
        prepared: &'a Prepared,
        atoms: Vec<&'a Halfspace>,
        region: &InputBox,
        bounds: &[NeuronBounds],
    ) -> Self {
        let sides = region.lower.iter().zip(&region.upper);
        let most: Vec<f64> = sides.map(|(lo, hi)| lo.abs().max(hi.abs())).collect();
        let mut frame = Self {
            network,
            prepared,
            atoms,
            sizes: Vec::new(),
            relative_error: 0.0,
            underflow: 0.0,
            refinement: Refinement::default(),
            places: HashMap::new(),
            most: most.clone(),
        };
        let mut values = most;
        let (mut terms, mut reach) = (64 + 2 * values.len(), values.iter().sum::<f64>());
        for (index, layer) in prepared.layers.iter().enumerate() {
            let size = |i: usize| {
                let sum: f64 = match frame.row(index, i) {
                    Row::Dense(row) => row.iter().zip(&values).map(|(w, v)| w.abs() * v).sum(),
                    Row::Sparse(row) => {
                        row.iter().map(|&(j, w)| w.abs() * values[j as usize]).sum()
                    }
                };
                (sum + layer.bias[i].abs()) * SPARE
            };
            let sizes: Vec<f64> = (0..layer.outputs).map(size).collect();
            let value = |(i, &size): (usize, &f64)| match layer.activation {
                Activation::Identity => size,
                Activation::Relu => bounds[layer.first + i].1.max(0.0).min(size),
                Activation::Tanh => 1.0,
            };
            values = sizes.iter().enumerate().map(value).collect();
            terms += 4 * layer.outputs;
            reach += sizes.iter().chain(&values).sum::<f64>();
            frame.sizes.push(sizes);
        }
        frame.relative_error = gamma(terms);
        let products: usize = network
            .layers()
            .iter()
            .map(|l| l.weights.data().len())
            .sum();
        frame.underflow = underflow(2 * products + 8 * terms, reach * SPARE);
        frame
    }

    /// The network's layers, then the atoms.
    pub(super) fn layers(&self) -> &[Arc<PreparedLayer>] {
        &self.prepared.layers
    }

    pub(super) fn set_refinement(&mut self, refinement: Refinement) {
        let places = refinement.sides.iter().enumerate();
        self.places = places
            .map(|(i, side)| ((side.neuron, side.upper), i))
            .collect();
        self.refinement = refinement;
    }

    /// What bounds a side of a neuron best on the whole box.
    pub(super) fn start(&self, neuron: usize, upper: bool) -> Option<&Choice> {
        let place = self.places.get(&(neuron, upper))?;
        Some(&self.refinement.sides[*place].choice)
    }

    /// Layer and place in it of a neuron with an activation.
    pub(super) fn place(&self, neuron: usize) -> (usize, usize) {
        let owns = |layer: &Arc<PreparedLayer>| {
            layer.activation != Activation::Identity && layer.first <= neuron
        };
        let layer = self.layers().iter().rposition(owns).unwrap_or(0);
        (layer, neuron - self.layers()[layer].first)
    }

    /// The weights of a neuron.
    #[inline(always)]
    fn row(&self, layer: usize, neuron: usize) -> Row<'_> {
        match (
            &self.prepared.layers[layer].weights,
            self.network.layers().get(layer),
        ) {
            (Weights::Sparse(rows), _) => Row::Sparse(&rows[neuron]),
            (_, Some(layer)) => Row::Dense(layer.weights.row(neuron)),
            (_, None) => Row::Dense(self.atoms[neuron].coefficients()),
        }
    }

    /// Adds the weighted sum of a layer's rows.
    #[inline(always)]
    fn add_rows(&self, layer: usize, weights: &[f64], sums: &mut [f64]) {
        let mut four: [(f64, &[f64]); 4] = [(0.0, &[]); 4];
        let mut waiting = 0;
        for (neuron, &weight) in weights.iter().enumerate().filter(|(_, w)| **w != 0.0) {
            match self.row(layer, neuron) {
                Row::Sparse(row) => {
                    for &(j, w) in row {
                        sums[j as usize] += weight * w;
                    }
                }
                Row::Dense(row) => {
                    four[waiting] = (weight, row);
                    waiting += 1;
                    if waiting == 4 {
                        add_scaled_4(sums, four);
                        waiting = 0;
                    }
                }
            }
        }
        for (weight, row) in &four[..waiting] {
            add_scaled(sums, row, *weight);
        }
    }
}

enum Row<'a> {
    Dense(&'a [f64]),
    Sparse(&'a [(u32, f64)]),
}

impl Row<'_> {
    #[inline(always)]
    fn dot(&self, values: &[f64]) -> f64 {
        match self {
            Row::Dense(row) => dot(row, values),
            Row::Sparse(row) => row.iter().map(|&(j, w)| w * values[j as usize]).sum(),
        }
    }
}

/// A bound, and what it would be without rounding errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Least {
    pub(super) bound: f64,
    /// Whether rounding may be all that keeps the bound from being positive.
    pub(super) undecided: bool,
}

/// Memory of passes.
#[derive(Default)]
pub(super) struct Pass {
    /// Of every neuron with an activation.
    pub(super) lines: Vec<Lines>,
    /// Largest absolute pre-activation of those between their lines; 0 where the activation is linear.
    reaches: Vec<f64>,
    /// What is added for the assumed phases, by neuron.
    added: Vec<f64>,
    /// Coefficients of the pre-activations and of the activations, by layer.
    before: Vec<Vec<f64>>,
    pub(super) after: Vec<Vec<f64>>,
    inputs: Vec<f64>,
    /// The relaxation's minimiser: the inputs; pre-activations by layer, activations of one layer.
    pub(super) point: Vec<f64>,
    pub(super) values: Vec<Vec<f64>>,
    layer: Vec<f64>,
}

impl Pass {
    /// Takes over what is known of a region's neurons.
    pub(super) fn enter(&mut self, frame: &Frame<'_>, bounds: &[NeuronBounds]) {
        self.lines.clear();
        self.reaches.clear();
        for layer in frame.layers() {
            if layer.activation == Activation::Identity {
                continue;
            }
            for &(l, u) in &bounds[layer.first..layer.first + layer.outputs] {
                let (lines, linear) = match layer.activation {
                    Activation::Relu if u <= 0.0 => (Lines::straight(0.0), true),
                    Activation::Relu if l >= 0.0 => (Lines::straight(1.0), true),
                    Activation::Relu => ((frame.prepared.enclose)(l, u), false),
                    _ => (Lines::tanh(l, u), false),
                };
                self.lines.push(lines);
                self.reaches
                    .push(if linear { 0.0 } else { l.abs().max(u.abs()) });
            }
        }
        let resize = |all: &mut Vec<Vec<f64>>| {
            all.resize_with(frame.sizes.len(), Vec::new);
            for (values, sizes) in all.iter_mut().zip(&frame.sizes) {
                values.clear();
                values.resize(sizes.len(), 0.0);
            }
        };
        resize(&mut self.before);
        resize(&mut self.after);
        resize(&mut self.values);
        self.added.clear();
        self.added.resize(self.lines.len(), 0.0);
    }

    /// Lower slopes to begin with.
    pub(super) fn usual_slopes(&self) -> Vec<f64> {
        self.lines.iter().map(|lines| lines.lower_slope).collect()
    }

    /// Adds the multiples of the assumed phases.
    pub(super) fn assume(&mut self, phases: &[Phase], multipliers: &[f64]) {
        for (&(neuron, on), &multiplier) in phases.iter().zip(multipliers) {
            self.added[neuron as usize] = if on { -multiplier } else { multiplier };
        }
    }

    /// The coefficients of the form to bound, over the pre-activations of this layer.
    pub(super) fn form(&mut self, layer: usize) -> &mut [f64] {
        self.before[layer].fill(0.0);
        &mut self.before[layer]
    }

    /// The form's bound on a region, for these lower slopes.
    #[inline(always)]
    pub(super) fn least(
        &mut self,
        frame: &Frame<'_>,
        region: &InputBox,
        top: usize,
        slopes: &[f64],
    ) -> Least {
        let g = frame.relative_error;
        let (mut least, mut errors) = (0.0, 0.0);
        for index in (0..=top).rev() {
            let layer = &frame.prepared.layers[index];
            let before = &self.before[index];
            let mut size = 0.0;
            for ((a, b), most) in before.iter().zip(&layer.bias).zip(&frame.sizes[index]) {
                if *a != 0.0 {
                    least += a * b;
                    size += a.abs() * most;
                }
            }
            errors += (g + layer.uncertainty) * size;
            let Some(previous) = index.checked_sub(1) else {
                break;
            };
            let after = &mut self.after[previous];
            after.fill(0.0);
            frame.add_rows(index, before, after);
            let layer = &frame.prepared.layers[previous];
            let before = &mut self.before[previous];
            if layer.activation == Activation::Identity {
                before.copy_from_slice(after);
                continue;
            }
            let own = layer.first..layer.first + layer.outputs;
            let choices = self.lines[own.clone()].iter().zip(&slopes[own.clone()]);
            let others = self.reaches[own.clone()].iter().zip(&self.added[own]);
            for (((a, &c), (lines, &chosen)), (&reach, &added)) in
                before.iter_mut().zip(&*after).zip(choices).zip(others)
            {
                let (slope, offset) = if c > 0.0 {
                    (chosen, lines.lower_offset)
                } else {
                    (lines.upper_slope, lines.upper_offset)
                };
                *a = c * slope + added;
                least += c * offset;
                errors += g * c.abs() * (offset.abs() + reach);
            }
        }
        self.inputs.clear();
        self.inputs.resize(frame.most.len(), 0.0);
        frame.add_rows(0, &self.before[0], &mut self.inputs);
        self.point.clear();
        let mut size = 0.0;
        let sides = region.lower.iter().zip(&region.upper);
        for ((&c, (&lo, &hi)), most) in self.inputs.iter().zip(sides).zip(&frame.most) {
            let x = if c > 0.0 { lo } else { hi };
            least += c * x;
            size += c.abs() * most;
            self.point.push(x);
        }
        errors = (errors + g * size + frame.underflow) * MARGIN;
        let bound = least - errors;
        Least {
            bound: if bound.is_finite() {
                bound
            } else {
                f64::NEG_INFINITY
            },
            // NaN is undecided as well.
            undecided: !(bound > 0.0 || least + errors < 0.0),
        }
    }

    /// Finds the pre-activations at the relaxation's minimiser of the last pass, up to this layer.
    #[inline(always)]
    pub(super) fn descend(&mut self, frame: &Frame<'_>, top: usize, slopes: &[f64]) {
        self.layer.clone_from(&self.point);
        for index in 0..=top {
            let layer = &frame.prepared.layers[index];
            let (after, values) = (&self.after[index], &mut self.values[index]);
            let linear = layer.activation == Activation::Identity || index == top;
            for (i, z) in values.iter_mut().enumerate() {
                // Where neither the activation nor a multiplier counts, neither does the value.
                let counts = linear || after[i] != 0.0 || self.added[layer.first + i] != 0.0;
                *z = if counts {
                    frame.row(index, i).dot(&self.layer) + layer.bias[i]
                } else {
                    0.0
                };
            }
            self.layer.clone_from(values);
            if linear {
                continue;
            }
            for (i, z) in self.layer.iter_mut().enumerate() {
                let (lines, c) = (&self.lines[layer.first + i], after[i]);
                *z = if c > 0.0 {
                    slopes[layer.first + i] * *z + lines.lower_offset
                } else {
                    lines.upper_slope * *z + lines.upper_offset
                };
            }
        }
    }
}
