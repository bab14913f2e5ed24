//! Branch and bound over boxes of states.

use super::Subject;
use super::check::slopes_hold;
use super::enclosure::Interval;
use super::gradient::gradient;
use cede_controller::Policy;
use cede_formats::property::{Claim, Place, Setting, StateProperty, Variable};
use cede_nnv::{Bounder, Worker};
use cede_nnv_check::check::{self, CheckError};
use cede_nnv_check::proof::{Cell, Proof, Split};
use cede_nnv_check::{AffineEnclosure, Halfspace, InputBox, Network, Query};
use rayon::prelude::*;
use std::time::Instant;

/// How a property was settled.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// Proved on the whole region.
    Proved,
    /// The controller, run at this state, breaks the claim.
    Refuted {
        /// Ego's distance and speed, other's distance and speed.
        state: Place,
        /// What did not vary.
        setting: Setting,
        /// The acceleration that the controller proposed there (m/s²).
        acceleration: f64,
    },
    /// Neither, in time.
    Unsettled,
}

/// A finding and what it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// How it ended.
    pub finding: Finding,
    /// Regions that were bounded.
    pub regions: u64,
    /// Regions that the independent checker confirmed: 0 if it was not asked.
    pub checked: usize,
    /// For a claim about slopes: by how much (m/s²) a difference of two accelerations that the
    /// controller computes in `f32` may be off the exact one. Other proofs have it deducted.
    pub rounding: f64,
}

/// Largest acceleration of any policy: 3·tanh.
pub(super) const MOST: f64 = cede_controller::policy::MAX_ACCELERATION as f64;
/// Allowance for the rounding of `tanhf` and the factor 3, relative to 1.
pub(super) const TANH: f64 = 1e-6;
/// A difference quotient is taken over this step (m or m/s) when a slope is to be refuted.
const STEP: f64 = 0.05;
/// What `f32` rounding may do to such a difference.
const DIFFERENCE: f64 = 1e-4;
/// Boxes bounded side by side.
const ROUND: usize = 256;

struct Node {
    region: InputBox,
    bounds: Box<[(f64, f64)]>,
    cell: usize,
}

enum Step {
    Proved(Cell),
    Split(Split, [Node; 2]),
    Broken(Place, f64),
    Stuck,
}

impl Subject<'_> {
    /// Settles a property; with `checked`, the independent checker goes over every proof, and one
    /// that it refuses counts as unsettled.
    ///
    /// The same on any number of threads, as long as the time suffices.
    #[must_use]
    pub fn settle(&self, property: &StateProperty, deadline: Instant, checked: bool) -> Settled {
        let mut settled = Settled {
            finding: Finding::Proved,
            regions: 0,
            checked: 0,
            rounding: 0.0,
        };
        for setting in property.settings() {
            let task = Task::new(self, property, setting);
            let (finding, proof) = task.search(deadline, &mut settled.regions);
            settled.finding = finding;
            if settled.finding != Finding::Proved {
                break;
            }
            settled.rounding = settled.rounding.max(task.rounding);
            if checked {
                match task.check(&proof) {
                    Ok(regions) => settled.checked += regions,
                    Err(_) => settled.finding = Finding::Unsettled,
                }
            }
        }
        settled
    }
}

/// Largest scale that is tried.
const LARGEST_SCALE: f64 = 3.0;
/// Halvings of the interval of scales.
const SCALES: u32 = 7;

impl Subject<'_> {
    /// The largest factor (at most 3, found by bisection to about 0.02) by which the region's
    /// widths can be scaled about its centre, speeds kept from falling below 0, with the property
    /// proved: 0 if not even close to the centre.
    #[must_use]
    pub fn largest_scale(&self, property: &StateProperty, deadline: Instant) -> f64 {
        let (mut proved, mut open) = (0.0, LARGEST_SCALE);
        for round in 0..SCALES {
            let scale = 0.5 * (proved + open);
            let left = deadline.saturating_duration_since(Instant::now());
            let share = Instant::now() + left / (SCALES - round);
            let settled = self.settle(&property.scaled(scale), share, false);
            *(if settled.finding == Finding::Proved {
                &mut proved
            } else {
                &mut open
            }) = scale;
        }
        proved
    }
}

/// A property in one setting.
struct Task<'a> {
    subject: &'a Subject<'a>,
    property: &'a StateProperty,
    setting: Setting,
    /// The unsafe side of an acceleration claim, `f32` margin included.
    atom: Option<Halfspace>,
    /// See [`Settled::rounding`].
    rounding: f64,
    bounder: Bounder,
    root: Box<[(f64, f64)]>,
}

impl<'a> Task<'a> {
    fn new(subject: &'a Subject<'a>, property: &'a StateProperty, setting: Setting) -> Self {
        let region = region(property);
        let enclosed = subject.features(&region, &setting);
        let roundings: Vec<f64> = enclosed.iter().map(|e| e.rounding).collect();
        let features: Vec<AffineEnclosure> = enclosed.into_iter().map(|e| e.feature).collect();
        let mut root = Bounder::new(&subject.network, None).unbounded();
        Bounder::new(&subject.network, None)
            .worker()
            .tighten(&region, &features, &mut root);
        let margin = |inputs: Vec<f64>| {
            single_precision_margin(&subject.network, &features, &region, &root, inputs)
        };
        // The features' own rounding is in their radii already, but not in their slopes.
        let atom = unsafe_side(property.claim, margin(vec![0.0; features.len()]));
        let rounding = match atom {
            Some(_) => 0.0,
            None => 2.0 * MOST * (margin(roundings) + TANH),
        };
        let bounder = Bounder::new(&subject.network, atom.as_ref());
        Self {
            subject,
            property,
            setting,
            atom,
            rounding,
            bounder,
            root,
        }
    }

    fn search(&self, deadline: Instant, regions: &mut u64) -> (Finding, Proof) {
        let mut proof = Proof {
            cells: vec![Cell::default()],
        };
        let mut finding = Finding::Proved;
        let mut stack = vec![Node {
            region: region(self.property),
            bounds: self.root.clone(),
            cell: 0,
        }];
        while !stack.is_empty() {
            if Instant::now() > deadline {
                return (Finding::Unsettled, proof);
            }
            let batch = stack.split_off(stack.len().saturating_sub(ROUND));
            *regions += batch.len() as u64;
            let cells: Vec<usize> = batch.iter().map(|node| node.cell).collect();
            let step = |worker: &mut _, node| self.step(worker, node);
            let steps: Vec<Step> = batch
                .into_par_iter()
                .with_min_len(8)
                .map_init(|| self.bounder.worker(), step)
                .collect();
            for (step, place) in steps.into_iter().zip(cells) {
                match step {
                    Step::Proved(cell) => proof.cells[place] = cell,
                    Step::Split(split, mut halves) => {
                        let first = proof.cells.len();
                        proof.cells.extend([Cell::default(), Cell::default()]);
                        proof.cells[place].split =
                            u32::try_from(first).ok().map(|first| (split, first));
                        halves
                            .iter_mut()
                            .enumerate()
                            .for_each(|(i, half)| half.cell = first + i);
                        stack.extend(halves);
                    }
                    Step::Broken(state, acceleration) => {
                        let finding = Finding::Refuted {
                            state,
                            setting: self.setting,
                            acceleration,
                        };
                        return (finding, proof);
                    }
                    Step::Stuck => finding = Finding::Unsettled,
                }
            }
        }
        (finding, proof)
    }

    fn step(&self, worker: &mut Worker<'_>, mut node: Node) -> Step {
        let enclosed = self.subject.features(&node.region, &self.setting);
        let features: Vec<AffineEnclosure> = enclosed.iter().map(|e| e.feature.clone()).collect();
        worker.tighten(&node.region, &features, &mut node.bounds);
        let mut scores = vec![0.0; node.region.lower.len()];
        let mut candidates = vec![middle(&node.region)];
        if self.atom.is_some() {
            if let Some(refutation) = worker.refute(&node.region) {
                return Step::Proved(Cell {
                    refuted: vec![refutation],
                    ..Cell::default()
                });
            }
            candidates.push(worker.minimiser(&mut scores));
        } else {
            let slopes: Vec<_> = enclosed.iter().map(|e| e.slopes).collect();
            let all = gradient(&self.subject.network, &node.bounds, &slopes);
            if slope_holds(self.property.claim, all) {
                return Step::Proved(Cell::default());
            }
            worker.widths(&mut scores);
        }
        for point in candidates {
            let state: Place = std::array::from_fn(|i| f64::from(point[i] as f32));
            if region(self.property).contains(&state)
                && let Some(acceleration) = self.broken(state)
            {
                return Step::Broken(state, acceleration);
            }
        }
        match halve(&node, &scores) {
            Some((split, halves)) => Step::Split(split, halves),
            None => Step::Stuck,
        }
    }

    /// The controller's acceleration at a state, if it breaks the claim.
    fn broken(&self, state: Place) -> Option<f64> {
        let a = self.drive(state);
        let quotient = |with: Variable| {
            let mut shifted = state;
            shifted[with.index()] = f64::from((state[with.index()] + STEP) as f32);
            let step = shifted[with.index()] - state[with.index()];
            let inside = region(self.property).contains(&shifted);
            inside.then(|| (self.drive(shifted) - a, step))
        };
        let broken = match self.property.claim {
            Claim::AccelerationAtMost(most) => a > most,
            Claim::AccelerationAtLeast(least) => a < least,
            Claim::RisesAtLeast { with, slope } => {
                quotient(with).is_some_and(|(rise, step)| rise < slope * step - DIFFERENCE)
            }
            Claim::ChangesAtMost { with, slope } => {
                quotient(with).is_some_and(|(rise, step)| rise.abs() > slope * step + DIFFERENCE)
            }
        };
        broken.then_some(a)
    }

    /// What the controller proposes at a state.
    fn drive(&self, state: Place) -> f64 {
        f64::from(Policy::from(self.subject.weights).act(&self.setting.pair(state))[0])
    }

    fn check(&self, proof: &Proof) -> Result<usize, CheckError> {
        let region = region(self.property);
        let Some(atom) = &self.atom else {
            let holds = |slopes| slope_holds(self.property.claim, slopes);
            return slopes_hold(self.subject, &self.setting, region, holds, proof);
        };
        let query = Query::new(region, vec![vec![atom.clone()]]);
        let front = |region: &InputBox| self.subject.front(region, &self.setting);
        check::check_composed(&self.subject.network, Some(&front), &query, proof)
    }
}

/// Whether the range of the gradient of the mean settles a claim about slopes. The slope of
/// the acceleration is that of the mean times 3·tanh′, which lies in (0, 3].
pub(super) fn slope_holds(claim: Claim, mean: [Interval; 4]) -> bool {
    let scaled = |slope: f64| (MOST * slope).max(0.0);
    match claim {
        Claim::RisesAtLeast { with, slope } => {
            let least = mean[with.index()].lo;
            // Nothing is known of the smallest tanh′, so a positive slope is never proved.
            slope <= 0.0 && -scaled(-least) >= slope
        }
        Claim::ChangesAtMost { with, slope } => scaled(mean[with.index()].magnitude()) <= slope,
        Claim::AccelerationAtMost(_) | Claim::AccelerationAtLeast(_) => false,
    }
}

/// The box of a property's states.
pub(super) fn region(property: &StateProperty) -> InputBox {
    let sides = property.region();
    InputBox {
        lower: sides.map(|s| s[0]).to_vec(),
        upper: sides.map(|s| s[1]).to_vec(),
    }
}

/// The outputs (the mean) that break an acceleration claim, widened by the margin.
fn unsafe_side(claim: Claim, margin: f64) -> Option<Halfspace> {
    // Beyond ± 3 nothing is left to prove, and atanh is infinite: an unreachable mean stands in.
    let mean = |a: f64| (a.clamp(-MOST, MOST) / MOST).atanh().clamp(-1e6, 1e6);
    // A margin that is not finite is one that no mean reaches.
    let margin = margin.min(f64::MAX / 4.0);
    match claim {
        Claim::AccelerationAtMost(most) => {
            let threshold = mean(most - MOST * TANH * f64::from(u8::from(most < MOST)));
            Some(Halfspace::new(vec![-1.0], margin - threshold + 1e-9))
        }
        Claim::AccelerationAtLeast(least) => {
            let threshold = mean(least + MOST * TANH * f64::from(u8::from(least > -MOST)));
            Some(Halfspace::new(vec![1.0], threshold + margin + 1e-9))
        }
        Claim::RisesAtLeast { .. } | Claim::ChangesAtMost { .. } => None,
    }
}

/// How far the controller's `f32` mean can be from the exact one anywhere on the region, its
/// inputs with their `errors` given: the usual bound for sums of products in any order, carried through the layers.
pub(super) fn single_precision_margin(
    network: &Network,
    features: &[AffineEnclosure],
    region: &InputBox,
    bounds: &[(f64, f64)],
    mut errors: Vec<f64>,
) -> f64 {
    let mut sizes: Vec<f64> = features.iter().map(|f| f.magnitude(region)).collect();
    let mut first = 0;
    for layer in network.layers() {
        let unit = (layer.inputs() + 4) as f64 * f64::from(f32::EPSILON) * 0.5 * 1.001;
        let row = |i: usize| {
            let terms = layer.weights.row(i).iter().zip(&sizes).zip(&errors);
            let (size, carried) = terms.fold(
                (layer.bias[i].abs(), 0.0),
                |(size, carried), ((w, s), e)| (size + w.abs() * (s + e), carried + w.abs() * e),
            );
            (size, carried + unit * size)
        };
        let (all, next): (Vec<f64>, Vec<f64>) = (0..layer.outputs()).map(row).unzip();
        let known = bounds.get(first..first + layer.outputs());
        sizes = all
            .iter()
            .enumerate()
            .map(|(i, &s)| known.map_or(s, |b| b[i].1.clamp(0.0, s)))
            .collect();
        errors = next;
        first += layer.outputs();
    }
    errors.iter().fold(0.0_f64, |a, &b| a.max(b)) * (1.0 + 1e-9)
}

fn middle(region: &InputBox) -> Vec<f64> {
    region
        .lower
        .iter()
        .zip(&region.upper)
        .map(|(lo, hi)| 0.5 * (lo + hi))
        .collect()
}

/// Halves the box across the variable with the highest score. Boxes narrower than a micrometre
/// (or micrometre per second) everywhere are not divided.
fn halve(node: &Node, scores: &[f64]) -> Option<(Split, [Node; 2])> {
    let (split, halves) = halve_region(&node.region, scores)?;
    let half = |region| Node {
        region,
        bounds: node.bounds.clone(),
        cell: 0,
    };
    Some((split, halves.map(half)))
}

/// The cut and the halves' boxes.
pub(super) fn halve_region(region: &InputBox, scores: &[f64]) -> Option<(Split, [InputBox; 2])> {
    let InputBox { lower, upper } = region;
    let width = |i: usize| upper[i] - lower[i];
    let better = |&a: &usize, &b: &usize| {
        scores[a]
            .total_cmp(&scores[b])
            .then(width(a).total_cmp(&width(b)))
            .then(b.cmp(&a))
    };
    let input = (0..lower.len())
        .filter(|&i| width(i) > 1e-6)
        .max_by(better)?;
    let at = 0.5 * (lower[input] + upper[input]);
    let (mut below, mut above) = (region.clone(), region.clone());
    below.upper[input] = at;
    above.lower[input] = at;
    let split = Split::Input {
        input: u32::try_from(input).ok()?,
        at,
    };
    Some((split, [below, above]))
}
