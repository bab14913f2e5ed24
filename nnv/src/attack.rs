//! Looks for a counterexample by projected gradient descent with restarts.

use super::forward::Runner;
use super::propagation::{Prepared, in_time};
use super::witness::{Witness, is_near};
use cede_nnv_check::{Conjunction, Halfspace, InputBox, Network, Property};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::time::Instant;

/// Most starting points for each conjunction, and for all of them together.
const RESTARTS: usize = 40;
const RESTARTS_IN_ALL: usize = 4000;
/// Steps from each.
const STEPS: usize = 40;
/// Most products that all steps together may take: a few seconds.
const MOST_PRODUCTS: usize = 1 << 32;

/// A counterexample, confirmed in exact arithmetic, if one is found in time. The same seed tries
/// the same points.
pub(super) fn attack(
    network: &Network,
    prepared: &Prepared,
    property: &Property,
    seed: u64,
    deadline: Instant,
) -> Option<Witness> {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut runner = Runner::new(network, prepared);
    let queries = || property.queries.iter();
    let conjunctions: usize = queries().map(|q| q.unsafe_set.len()).sum();
    // Where there are very many conjunctions, the first few are tried; the search finds its own
    // candidates in each.
    let weights: usize = network
        .layers()
        .iter()
        .map(|l| l.weights.data().len())
        .sum();
    let affordable = MOST_PRODUCTS / (2 * STEPS * weights).max(1);
    let all = RESTARTS_IN_ALL.min(affordable.max(1));
    let restarts = all.div_ceil(conjunctions.max(1)).min(RESTARTS);
    let pairs = queries().flat_map(|q| q.unsafe_set.iter().map(move |c| (q, c)));
    for (query, conjunction) in pairs.take(all) {
        for restart in 0..restarts {
            let start = start(&query.region, restart, &mut random);
            let end = pulp::Arch::new()
                .dispatch(|| descend(&mut runner, &query.region, conjunction, start, deadline))?;
            let near = is_near(conjunction, runner.run(&end));
            let witness = || Witness::near(network, query, &end);
            if let Some(witness) = near.then(witness).flatten() {
                return Some(witness);
            }
        }
    }
    None
}

fn start(region: &InputBox, restart: usize, random: &mut Pcg64) -> Vec<f64> {
    let sides = region.lower.iter().zip(&region.upper);
    sides
        .map(|(&lo, &hi)| {
            if restart == 0 {
                f64::midpoint(lo, hi)
            } else {
                let share = random.random::<f64>();
                (lo * (1.0 - share) + hi * share).clamp(lo, hi)
            }
        })
        .collect()
}

/// The atom that is violated the most, and by how much.
fn worst<'a>(conjunction: &'a Conjunction, y: &[f64]) -> (f64, Option<&'a Halfspace>) {
    conjunction
        .iter()
        .map(|atom| (atom.excess(y), Some(atom)))
        .fold(
            (f64::NEG_INFINITY, None),
            |a, b| if b.0 > a.0 { b } else { a },
        )
}

/// Where the descent ends; `None` if the deadline passed.
#[inline(always)]
pub(super) fn descend(
    runner: &mut Runner<'_>,
    region: &InputBox,
    conjunction: &Conjunction,
    mut point: Vec<f64>,
    deadline: Instant,
) -> Option<Vec<f64>> {
    for step in 0..STEPS {
        in_time(Some(deadline)).ok()?;
        let (excess, atom) = worst(conjunction, runner.run(&point));
        // A little inside the set, so that the point may be rounded to `f32`.
        let Some(atom) = atom.filter(|_| excess >= -1e-9) else {
            break;
        };
        let length = 0.3 * (1.0 - step as f64 / STEPS as f64);
        let gradient = runner.gradient(atom);
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
    Some(point)
}
