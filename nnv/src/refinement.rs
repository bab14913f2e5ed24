//! Bounds of the neurons on a part of a query's box, each side by the best choice of slopes and
//! multipliers: far tighter than one pass each, and far dearer.

use super::backward::Frame;
use super::dual::{Dual, Effort, Part};
use super::propagation::{NeuronBounds, Phase, Unbounded, is_unstable};
use super::side::{Refinement, Side};
use cede_nnv_check::{Activation, InputBox};
use rayon::prelude::*;
use std::time::Instant;

/// Passes for a side from the choice that is best on the whole box, and without one.
const AGAIN: Effort = Effort::again(4);
const AFRESH: Effort = Effort::afresh(16);
/// If more than so large a part of a layer stays unstable, the layers behind it are as loose.
const LOOSE: f64 = 0.5;

/// Tightens the bounds, layer by layer, until a layer stays loose, or nothing is left.
///
/// # Errors
/// If the deadline passed.
pub(super) fn refine(
    frame: &Frame<'_>,
    (region, phases): (&InputBox, &[Phase]),
    bounds: &mut [NeuronBounds],
    record: bool,
    deadline: Instant,
) -> Result<Refinement, Unbounded> {
    let mut done = Refinement::default();
    let last = frame
        .layers()
        .iter()
        .rposition(|l| l.activation == Activation::Relu);
    // What the first layer takes is the box: its bounds are exact.
    for (index, layer) in frame.layers().iter().enumerate().skip(1) {
        if layer.activation != Activation::Relu {
            continue;
        }
        let open = (layer.first..layer.first + layer.outputs).filter(|&n| is_unstable(bounds[n]));
        let mut wanted: Vec<(usize, bool)> = open.flat_map(|n| [(n, false), (n, true)]).collect();
        // Where an assumed phase cannot be, there is nothing.
        let assumed = phases.iter().map(|&(n, on)| (n as usize, on));
        wanted.extend(
            assumed.filter(|(n, _)| (layer.first..layer.first + layer.outputs).contains(n)),
        );
        let part = Part {
            region,
            bounds,
            phases,
        };
        let bound = |dual: &mut Dual, &(neuron, upper): &(usize, bool)| {
            let i = neuron - layer.first;
            let sign = if upper { -1.0 } else { 1.0 };
            let start = frame.start(neuron, upper);
            dual.enter(frame, part, start, std::iter::once(sign));
            let effort = if start.is_some() { AGAIN } else { AFRESH };
            let least = dual.bound(frame, part, &(index, i..i + 1), effort, deadline)?;
            let (l, u) = bounds[neuron];
            let better = if upper {
                -least.bound < u
            } else {
                least.bound > l
            };
            let side = Side {
                neuron,
                upper,
                record: (record && better).then(|| dual.tightening(part, neuron, upper)),
                choice: dual.choice.clone(),
                costs: dual.costs(frame, index, bounds),
            };
            Ok((least.bound, side))
        };
        let found: Vec<Result<_, Unbounded>> =
            wanted.par_iter().map_init(Dual::default, bound).collect();
        for found in found {
            let (bound, side) = found?;
            let (l, u) = &mut bounds[side.neuron];
            if side.upper {
                *u = u.min(-bound);
            } else {
                *l = l.max(bound);
            }
            done.empty |= *l > *u;
            done.sides.push(side);
        }
        if done.empty {
            break;
        }
        let own = layer.first..layer.first + layer.outputs;
        let unstable = bounds[own.clone()]
            .iter()
            .filter(|&&b| is_unstable(b))
            .count();
        if unstable as f64 > LOOSE * layer.outputs as f64 && last != Some(index) {
            done.loose = Some(own);
            break;
        }
    }
    Ok(done)
}

/// Shares out what the relaxation of each neuron costs among those before it that make its range so
/// wide; gives the neuron whose phase would save others the most.
pub(super) fn most_blamed(costs: &[(usize, f64)], sides: &[Side], neurons: usize) -> Option<usize> {
    let (mut own, mut received) = (vec![0.0; neurons], vec![0.0; neurons]);
    for &(neuron, cost) in costs {
        own[neuron] = cost;
    }
    for side in sides.iter().rev() {
        let total: f64 = side.costs.iter().map(|(_, cost)| cost).sum();
        let share = 0.5 * (own[side.neuron] + received[side.neuron]) / total;
        for &(neuron, cost) in &side.costs {
            received[neuron] += share * cost;
        }
    }
    let most = (0..neurons).filter(|&n| received[n] > 0.0);
    most.max_by(|&a, &b| (own[a] + received[a]).total_cmp(&(own[b] + received[b])))
}
