//! The independent check of proofs about slopes.
//!
//! Of the prover's work it takes the cuts alone. On each leaf it bounds the neurons by the
//! checker's own dense pass, and carries the ranges of the features' derivatives *forwards*
//! through the layers in plain interval arithmetic, where the prover goes backwards. Where that is
//! too coarse, it halves the box itself, a few times at most.

use super::Subject;
use super::enclosure::{Interval, STATE};
use cede_formats::property::Setting;
use cede_nnv_check::check::{CheckError, neuron_bounds};
use cede_nnv_check::proof::{Proof, Split};
use cede_nnv_check::{Activation, InputBox};
use rayon::prelude::*;

/// How often a leaf may be halved in the attempt to confirm it.
const HALVINGS: u32 = 20;

/// Checks that on every leaf of the proof's tree the slopes of the mean are such that the claim
/// `holds`; gives the number of leaves.
pub(super) fn slopes_hold(
    subject: &Subject<'_>,
    setting: &Setting,
    region: InputBox,
    holds: impl Fn([Interval; STATE]) -> bool + Sync,
    proof: &Proof,
) -> Result<usize, CheckError> {
    let leaves = leaves(region, proof)?;
    let check = |(cell, leaf): &(usize, InputBox)| {
        if confirmed(subject, setting, leaf, &holds, HALVINGS) {
            Ok(())
        } else {
            let what = "has slopes that break the claim";
            Err(CheckError::Malformed { cell: *cell, what })
        }
    };
    leaves.par_iter().try_for_each(check)?;
    Ok(leaves.len())
}

/// The boxes of the tree's leaves, with the indices of their cells.
fn leaves(region: InputBox, proof: &Proof) -> Result<Vec<(usize, InputBox)>, CheckError> {
    let (mut leaves, mut pending) = (Vec::new(), vec![(0, region)]);
    while let Some((cell, region)) = pending.pop() {
        let malformed = |what| CheckError::Malformed { cell, what };
        let here = proof.cells.get(cell).ok_or(malformed("is missing"))?;
        let Some((split, first)) = here.split else {
            leaves.push((cell, region));
            continue;
        };
        let (Split::Input { input, at }, first) = (split, first as usize) else {
            return Err(malformed("is cut across a phase"));
        };
        let input = input as usize;
        let sides = region.lower.get(input).zip(region.upper.get(input));
        // Children stand behind their parent, so the walk ends.
        if first <= cell || !sides.is_some_and(|(&lo, &hi)| lo <= at && at <= hi) {
            return Err(malformed("has a split that does not fit"));
        }
        let [below, above] = halves(&region, input, at);
        pending.extend([(first, below), (first + 1, above)]);
    }
    Ok(leaves)
}

fn halves(region: &InputBox, input: usize, at: f64) -> [InputBox; 2] {
    let (mut below, mut above) = (region.clone(), region.clone());
    below.upper[input] = at;
    above.lower[input] = at;
    [below, above]
}

fn confirmed(
    subject: &Subject<'_>,
    setting: &Setting,
    region: &InputBox,
    holds: &impl Fn([Interval; STATE]) -> bool,
    halvings: u32,
) -> bool {
    if holds(slopes(subject, setting, region)) {
        return true;
    }
    let share = |&a: &usize| {
        let whole = [100.0, 10.0, 100.0, 10.0];
        (region.upper[a] - region.lower[a]) / whole[a]
    };
    let widest = (0..STATE).max_by(|a, b| share(a).total_cmp(&share(b)));
    let Some(input) = widest.filter(|_| halvings > 0) else {
        return false;
    };
    let at = 0.5 * (region.lower[input] + region.upper[input]);
    halves(region, input, at)
        .iter()
        .all(|half| confirmed(subject, setting, half, holds, halvings - 1))
}

/// The ranges of the derivatives of the mean by the state.
fn slopes(subject: &Subject<'_>, setting: &Setting, region: &InputBox) -> [Interval; STATE] {
    let network = &subject.network;
    let front = |region: &InputBox| subject.front(region, setting);
    let bounds = neuron_bounds(network, Some(&front), region.clone());
    let features = subject.features(region, setting);
    let mut columns: Vec<[Interval; STATE]> = features.iter().map(|e| e.slopes).collect();
    for (layer, known) in network.layers().iter().zip(&bounds) {
        let sum = |i: usize| -> [Interval; STATE] {
            std::array::from_fn(|k| {
                let terms = layer.weights.row(i).iter().zip(&columns);
                terms.fold(Interval::ZERO, |sum, (&w, column)| {
                    if w == 0.0 || column[k] == Interval::ZERO {
                        return sum;
                    }
                    sum.add(Interval::point(w).mul(column[k]))
                })
            })
        };
        let after = |i: usize| match (layer.activation, known[i]) {
            (Activation::Relu, (_, u)) if u <= 0.0 => [Interval::ZERO; STATE],
            (Activation::Relu, (l, _)) if l < 0.0 => sum(i).map(|s| s.hull(Interval::ZERO)),
            _ => sum(i),
        };
        columns = (0..layer.outputs()).map(after).collect();
    }
    columns[0]
}
