//! How each side of a neuron's range was bounded best, which is where further bounds start.

use cede_nnv_check::proof::Tightening;
use std::ops::Range;

/// The choices that a bound leaves.
#[derive(Clone, Debug, Default)]
pub(super) struct Choice {
    /// Lower slope of every neuron.
    pub(super) slopes: Vec<f64>,
    /// Of the assumed phases.
    pub(super) multipliers: Vec<f64>,
    /// Of the atoms of one conjunction.
    pub(super) weights: Vec<f64>,
}

/// One side of a neuron's range.
pub(super) struct Side {
    pub(super) neuron: usize,
    pub(super) upper: bool,
    /// What bounds it best.
    pub(super) choice: Choice,
    /// The record of that, if it is better than what was known.
    pub(super) record: Option<Tightening>,
    /// What the relaxation of each unstable neuron before may cost it.
    pub(super) costs: Vec<(usize, f64)>,
}

/// What a refinement leaves.
#[derive(Default)]
pub(super) struct Refinement {
    /// The sides of the neurons that were unstable, layer by layer.
    pub(super) sides: Vec<Side>,
    /// The neurons of the layer behind which it was not worth going on.
    pub(super) loose: Option<Range<usize>>,
    /// Whether the bounds contradict each other.
    pub(super) empty: bool,
}
