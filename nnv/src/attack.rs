//! Looks for a counterexample by projected gradient descent with restarts.

use super::forward::Runner;
use cede_nnv_check::Network;
use cede_nnv_check::{Conjunction, Halfspace, InputBox, Property};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Random starting points for each conjunction.
const RESTARTS: usize = 40;
/// Steps from each.
const STEPS: usize = 40;

/// A point of the property that exact arithmetic confirms as a counterexample, if one is found.
/// The same seed tries the same points.
pub(super) fn attack(network: &Network, property: &Property, seed: u64) -> Option<Vec<f64>> {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut runner = Runner::new(network);
    for query in &property.queries {
        for conjunction in &query.unsafe_set {
            for restart in 0..RESTARTS {
                let start = start(&query.region, restart, &mut random);
                let found = pulp::Arch::new()
                    .dispatch(|| descend(&mut runner, &query.region, conjunction, start));
                if let Some(witness) = found.and_then(|point| confirmed(network, property, &point))
                {
                    return Some(witness);
                }
            }
        }
    }
    None
}

/// The point itself or its nearest `f32` neighbour, if exact arithmetic confirms it. The `f32`
/// point is preferred: an `f32` runtime can be given exactly that.
pub(super) fn confirmed(network: &Network, property: &Property, point: &[f64]) -> Option<Vec<f64>> {
    let single: Vec<f64> = point.iter().map(|&x| f64::from(x as f32)).collect();
    let holds = |x: &Vec<f64>| property.certainly_violated(x, &network.run(x));
    [single, point.to_vec()].into_iter().find(holds)
}

fn start(region: &InputBox, restart: usize, random: &mut Pcg64) -> Vec<f64> {
    let sides = region.lower.iter().zip(&region.upper);
    sides
        .map(|(lo, hi)| {
            if restart == 0 {
                0.5 * (lo + hi)
            } else {
                lo + random.random::<f64>() * (hi - lo)
            }
        })
        .collect()
}

/// The atom that is violated the most, and by how much.
pub(super) fn worst<'a>(conjunction: &'a Conjunction, y: &[f64]) -> (f64, Option<&'a Halfspace>) {
    conjunction
        .iter()
        .map(|atom| (atom.excess(y), Some(atom)))
        .fold(
            (f64::NEG_INFINITY, None),
            |a, b| if b.0 > a.0 { b } else { a },
        )
}

#[inline(always)]
fn descend(
    runner: &mut Runner<'_>,
    region: &InputBox,
    conjunction: &Conjunction,
    mut point: Vec<f64>,
) -> Option<Vec<f64>> {
    for step in 0..STEPS {
        let (excess, atom) = worst(conjunction, runner.run(&point));
        // A little inside the set, so that rounding cannot take the confirmation away.
        if excess < -1e-9 || atom.is_none() {
            return Some(point);
        }
        let length = 0.3 * (1.0 - step as f64 / STEPS as f64);
        let gradient = runner.gradient(atom?);
        for (((x, g), lo), hi) in point
            .iter_mut()
            .zip(gradient)
            .zip(&region.lower)
            .zip(&region.upper)
        {
            if *g != 0.0 {
                *x = (*x - length * (hi - lo) * g.signum()).clamp(*lo, *hi);
            }
        }
    }
    (worst(conjunction, runner.run(&point)).0 < 0.0).then_some(point)
}
