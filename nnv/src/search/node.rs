//! A region of the search, and how it is cut in two.

use crate::dual::Part;
use crate::propagation::{NeuronBounds, Phase};
use crate::side::Choice;
use cede_nnv_check::InputBox;
use cede_nnv_check::proof::Split;
use std::sync::Arc;

/// A region: a box and assumed phases, what is known of it, and what is still to be refuted.
pub(super) struct Node {
    pub(super) region: InputBox,
    pub(super) bounds: Box<[NeuronBounds]>,
    pub(super) phases: Box<[Phase]>,
    pub(super) open: Box<[u32]>,
    /// The best that was found for each open conjunction on a larger region, if anything was.
    pub(super) choices: Box<[Arc<Choice>]>,
    /// Its place in the record.
    pub(super) cell: usize,
}

impl Node {
    pub(super) fn copy(&self) -> Self {
        Self {
            region: self.region.clone(),
            bounds: self.bounds.clone(),
            phases: self.phases.clone(),
            open: self.open.clone(),
            choices: self.choices.clone(),
            cell: self.cell,
        }
    }

    pub(super) fn part(&self) -> Part<'_> {
        Part {
            region: &self.region,
            bounds: &self.bounds,
            phases: &self.phases,
        }
    }
}

/// Halves the box across the input with the highest score (the widest one, if nothing is blamed, or without scores).
/// The children are in the order in which they are searched last to first.
pub(super) fn split_input(node: Node, scores: &[f64]) -> Option<(Split, [Node; 2])> {
    let InputBox { lower, upper } = &node.region;
    let middle = |i: usize| f64::midpoint(lower[i], upper[i]);
    let divisible = |&i: &usize| lower[i] < middle(i) && middle(i) < upper[i];
    let better = |&a: &usize, &b: &usize| {
        let width = |i: usize| upper[i] - lower[i];
        let score = |i: usize| scores.get(i).copied().unwrap_or(0.0);
        score(a)
            .total_cmp(&score(b))
            .then(width(a).total_cmp(&width(b)))
            .then(b.cmp(&a))
    };
    let input = (0..lower.len()).filter(divisible).max_by(better)?;
    let at = middle(input);
    let mut below = node.copy();
    let mut above = node;
    below.region.upper[input] = at;
    above.region.lower[input] = at;
    Some((
        Split::Input {
            input: u32::try_from(input).ok()?,
            at,
        },
        [above, below],
    ))
}

/// Assumes the ReLU off, then on.
pub(super) fn split_phase(node: Node, neuron: u32) -> [Node; 2] {
    let assume = |mut node: Node, on: bool| {
        let (l, u) = &mut node.bounds[neuron as usize];
        *(if on { l } else { u }) = 0.0;
        node.phases = node.phases.iter().copied().chain([(neuron, on)]).collect();
        node
    };
    [assume(node.copy(), false), assume(node, true)]
}

/// Open conjunctions and the choices for them.
pub(super) fn split_pairs(pairs: Vec<(u32, Arc<Choice>)>) -> (Box<[u32]>, Box<[Arc<Choice>]>) {
    let (open, choices): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
    (open.into(), choices.into())
}
