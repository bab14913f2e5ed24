//! How far a policy of integers can be from the one in `f32` that it was made of.
//!
//! Both networks are told the same features x. With a the activations in `f32`, â those of the integers, e = â − a, and Ŵ, b̂ the
//! integers' weights as real numbers, each layer gives
//!
//! e_sum = (Ŵ − W)·a + (b̂ − b) + Ŵ·e,  e_next = d·e_sum + ρ,
//!
//! where d, neuron by neuron, is 1 if the neuron is active in both networks, 0 if in neither, and in [0, 1] else, and ρ is what
//! the rounding to the activations' unit and their limit add. On a box of states the network's own bounds say which neurons are
//! active. The departure of the output is then summed backwards, layer by layer, so that what the differences of
//! the weights do to it can cancel. The box is cut until the bound is small enough.

use super::Subject;
use super::enclosure::Interval;
use super::gradient::through;
use super::response::range;
use super::search::{MOST, TANH, halve_region, single_precision_margin};
use cede_controller::{FixedMlp, Policy, Weights};
use cede_formats::property::{Place, Setting, StateProperty};
use cede_nnv::Bounder;
use cede_nnv_check::{AffineEnclosure, InputBox, Matrix};
use rayon::prelude::*;
use std::collections::BinaryHeap;
use std::time::{Duration, Instant};

/// The policy of integers is not one that was made of this policy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotItsOwn {
    /// Its network is not one of integers.
    #[error("the network is not one of integers; make it with `cede export --quantise i16`")]
    NotIntegers,
    /// Other features, normalisation, perspective or widths.
    #[error("the two policies differ in features, normalisation, perspective or widths")]
    Other,
}

/// How far the two policies' proposals for the ego can be apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure {
    /// At most so far (m/s²), anywhere on the region: proved.
    pub bound: f64,
    /// The largest departure (m/s²) among the states at which both were run.
    pub sampled: f64,
    /// How many states these are: the middles of the boxes that were bounded.
    pub boxes: u64,
}

impl Departure {
    fn and(self, other: Self) -> Self {
        Self {
            bound: self.bound.max(other.bound),
            sampled: self.sampled.max(other.sampled),
            boxes: self.boxes + other.boxes,
        }
    }
}

/// A box of states that may have to be cut.
#[derive(Clone)]
struct Node {
    bound: f64,
    region: InputBox,
    /// What is known of the features beside the box. A feature that jumps within every box is cut itself.
    features: Vec<Interval>,
    neurons: Box<[(f64, f64)]>,
    cut: Cut,
}

/// Where to cut a box.
#[derive(Clone)]
enum Cut {
    /// Across a variable, the one with the highest score.
    State(Vec<f64>),
    /// Across this feature's range, here.
    Feature(usize, f64),
}

impl Node {
    fn halves(self) -> Result<[Self; 2], f64> {
        match &self.cut {
            Cut::State(scores) => {
                let halves = halve_region(&self.region, scores).ok_or(self.bound)?;
                Ok(halves.1.map(|region| Self {
                    region,
                    ..self.clone()
                }))
            }
            &Cut::Feature(index, at) => {
                let mut halves = [self.clone(), self];
                halves[0].features[index].hi = at;
                halves[1].features[index].lo = at;
                Ok(halves)
            }
        }
    }
}

impl Subject<'_> {
    /// Bounds how far the policy of `integers` can be from this one on the regions of `properties`: boxes are cut until
    /// the bound is at most `bar` (m/s²), or the `limit` for each setting of a property is over.
    ///
    /// # Errors
    /// If `integers` was not made of this policy.
    pub fn departure(
        &self,
        integers: Weights<'_>,
        properties: &[StateProperty],
        bar: f64,
        limit: Duration,
    ) -> Result<Departure, NotItsOwn> {
        let pair = Twins::new(self, integers)?;
        let each = domains(properties)
            .into_par_iter()
            .map(|(region, setting)| pair.search(region, setting, bar, limit));
        let nothing = || Departure {
            bound: 0.0,
            sampled: 0.0,
            boxes: 0,
        };
        Ok(each.reduce(nothing, Departure::and))
    }
}

/// The boxes and settings that properties speak of, those within others left out.
fn domains(properties: &[StateProperty]) -> Vec<(InputBox, Setting)> {
    let mut domains: Vec<(InputBox, Setting)> = Vec::new();
    for property in properties {
        let region = super::search::region(property);
        for setting in property.settings() {
            let within = |(other, same): &(InputBox, Setting)| {
                *same == setting && other.contains(&region.lower) && other.contains(&region.upper)
            };
            if !domains.iter().any(within) {
                domains.push((region.clone(), setting));
            }
        }
    }
    domains
}

/// A layer of integers as real numbers, and how it differs from the one in `f32`.
struct Layer {
    weights: Matrix,
    change: Matrix,
    bias_change: Vec<f64>,
    /// Unit of the activations that it gives.
    unit: f64,
}

/// The two policies.
struct Twins<'a> {
    subject: &'a Subject<'a>,
    integers: Weights<'a>,
    /// Unit of the inputs.
    unit: f64,
    layers: Vec<Layer>,
}

/// How many units an activation is at most.
const LARGEST: f64 = cede_controller::policy::fixed::MAX_ACTIVATION as f64;
/// Units by which an input can be off: half of one, and the rounding of that half's addition in `f32`.
const INPUT: f64 = 0.51;

impl<'a> Twins<'a> {
    fn new(subject: &'a Subject<'a>, integers: Weights<'a>) -> Result<Self, NotItsOwn> {
        let fixed = *integers.network().as_i16().ok_or(NotItsOwn::NotIntegers)?;
        let same = integers.features() == subject.weights.features()
            && integers.perspective() == subject.weights.perspective()
            && integers.normalisation().eq(subject.weights.normalisation())
            && fixed.width() == subject.weights.network().width();
        if !same {
            return Err(NotItsOwn::Other);
        }
        Ok(Self {
            subject,
            integers,
            unit: unit(fixed.bits().activations[0]),
            layers: layers(subject, &fixed),
        })
    }

    fn search(&self, region: InputBox, setting: Setting, bar: f64, limit: Duration) -> Departure {
        let deadline = Instant::now() + limit;
        let task = Task::new(self, &region, setting);
        let anything = Interval::new(f64::NEG_INFINITY, f64::INFINITY);
        let mut found = Departure {
            bound: 0.0,
            sampled: 0.0,
            boxes: 0,
        };
        let mut open = BinaryHeap::new();
        let mut fresh = vec![Node {
            bound: f64::INFINITY,
            features: vec![anything; self.subject.network.inputs()],
            neurons: task.bounder.unbounded(),
            cut: Cut::State(Vec::new()),
            region,
        }];
        loop {
            for mut node in fresh.drain(..) {
                found.boxes += 1;
                found.sampled = found.sampled.max(task.sampled(&node.region));
                task.bound(&mut node);
                if node.bound > bar {
                    open.push(node);
                } else {
                    found.bound = found.bound.max(node.bound);
                }
            }
            let Some(worst) = open.pop() else {
                return found;
            };
            let bound = worst.bound;
            let halves = if Instant::now() < deadline {
                worst.halves()
            } else {
                Err(bound)
            };
            match halves {
                Ok(halves) => fresh.extend(halves),
                // The worst of all that are left.
                Err(bound) => {
                    found.bound = found.bound.max(bound);
                    return found;
                }
            }
        }
    }
}

/// The worst first.
impl Ord for Node {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Node {}

fn unit(bits: u32) -> f64 {
    (-f64::from(bits)).exp2()
}

/// The layers as far as the first output goes.
fn layers(subject: &Subject<'_>, fixed: &FixedMlp<'_>) -> Vec<Layer> {
    let bits = fixed.bits();
    let own = subject.network.layers().iter().zip(fixed.layers());
    let layer = |(index, (own, fixed)): (usize, (&cede_nnv_check::Layer, _))| {
        let fixed: cede_controller::policy::fixed::FixedDense<'_> = fixed;
        let (of_weight, of_sum) = (unit(bits.weights[index]), unit(bits.sum(index)));
        // A hidden layer's bias holds half a unit of its activations, by which the shift rounds.
        let next = bits.activations.get(index + 1).map(|&bits| unit(bits));
        let mut weights = Matrix::zeros(own.outputs(), own.inputs());
        let mut change = weights.clone();
        for i in 0..own.outputs() {
            for j in 0..own.inputs() {
                weights.row_mut(i)[j] = f64::from(fixed.weight(i, j)) * of_weight;
                change.row_mut(i)[j] = weights.row(i)[j] - own.weights.row(i)[j];
            }
        }
        let bias_change = (0..own.outputs())
            .map(|i| f64::from(fixed.bias(i)) * of_sum - 0.5 * next.unwrap_or(0.0) - own.bias[i]);
        Layer {
            weights,
            change,
            bias_change: bias_change.collect(),
            unit: next.unwrap_or(0.0),
        }
    };
    own.enumerate().map(layer).collect()
}

/// Two policies in one setting.
struct Task<'a> {
    twins: &'a Twins<'a>,
    setting: Setting,
    bounder: Bounder,
    /// How far both outputs' computation in `f32` can be off.
    rounding: f64,
}

/// What is known of a hidden layer on a box.
#[derive(Default)]
struct Hidden {
    /// The activations in `f32`.
    values: Vec<Interval>,
    /// d and ρ of each neuron.
    passes: Vec<Interval>,
    adds: Vec<Interval>,
}

impl<'a> Task<'a> {
    fn new(twins: &'a Twins<'a>, region: &InputBox, setting: Setting) -> Self {
        let network = &twins.subject.network;
        let bounder = Bounder::new(network, None);
        let features = twins.subject.front(region, &setting);
        let mut neurons = bounder.unbounded();
        bounder.worker().tighten(region, &features, &mut neurons);
        let none = vec![0.0; features.len()];
        let margin = single_precision_margin(network, &features, region, &neurons, none);
        Self {
            twins,
            setting,
            bounder,
            // The integers' output is rounded once, when it becomes an `f32`; it is far below 2²⁰.
            rounding: margin + f64::from(f32::EPSILON) * 1e3,
        }
    }

    /// The departure in the middle of a box, by the controller itself.
    fn sampled(&self, region: &InputBox) -> f64 {
        let sides = region.lower.iter().zip(&region.upper);
        let middle: Vec<f64> = sides.map(|(lo, hi)| 0.5 * (lo + hi)).collect();
        let state: Place = std::array::from_fn(|i| middle[i]);
        let pair = self.setting.pair(state);
        let of = |weights| f64::from(Policy::from(weights).act(&pair)[0]);
        (of(self.twins.subject.weights) - of(self.twins.integers)).abs()
    }

    /// Bounds the departure of the acceleration on a box, and says where to cut it.
    fn bound(&self, node: &mut Node) {
        let mut features = self.twins.subject.front(&node.region, &self.setting);
        for (feature, known) in features.iter_mut().zip(&node.features) {
            restrict(feature, *known, &node.region);
        }
        let mut worker = self.bounder.worker();
        worker.tighten(&node.region, &features, &mut node.neurons);
        let mut scores = vec![0.0; node.region.lower.len()];
        worker.widths(&mut scores);
        node.cut = cut(&features, &node.region).unwrap_or(Cut::State(scores));
        let inputs = self.inputs(&features, &node.region);
        let hidden = self.forward(&inputs, &node.neurons);
        let output = self.backward((3, 0), &inputs, &hidden);
        let off = output.magnitude() + self.rounding;
        let bound = MOST * (steepest(self.output(&hidden), off) * off + 2.0 * TANH);
        node.bound = node.bound.min(bound);
    }

    /// The inputs on a box, as a layer that passes nothing on and adds its rounding.
    fn inputs(&self, features: &[AffineEnclosure], region: &InputBox) -> Hidden {
        let values: Vec<Interval> = features.iter().map(|f| range(f, region)).collect();
        let adds = values
            .iter()
            .map(|&x| {
                let limit = LARGEST * self.twins.unit;
                let half = INPUT * self.twins.unit;
                let (above, below) = ((x.hi - limit).max(0.0), (-limit - x.lo).max(0.0));
                Interval::new(-half - above, half + below)
            })
            .collect();
        Hidden {
            values,
            adds,
            passes: Vec::new(),
        }
    }

    /// What each hidden layer passes on and adds.
    fn forward(&self, inputs: &Hidden, neurons: &[(f64, f64)]) -> Vec<Hidden> {
        let mut off = inputs.adds.clone();
        let mut hidden: Vec<Hidden> = Vec::new();
        let mut rest = neurons;
        for (index, layer) in self.twins.layers[..3].iter().enumerate() {
            let before = hidden.last().unwrap_or(inputs);
            let changed = product(&layer.change, &before.values);
            let carried = product(&layer.weights, &off);
            let (own, after) = rest.split_at(layer.bias_change.len());
            rest = after;
            let mut next = Hidden::default();
            off.clear();
            for (i, &(lo, hi)) in own.iter().enumerate() {
                let sum = Interval::new(lo, hi);
                let bias = Interval::point(layer.bias_change[i]);
                let mut apart = changed[i].add(carried[i]).add(bias);
                if sum.wider(apart.magnitude()).contains(0.0) {
                    // Whether it is active depends on the departure: worth a better bound.
                    apart = self.backward((index, i), inputs, &hidden).and(apart);
                }
                let (passes, adds) = neuron(sum, apart, layer.unit);
                off.push(passes.mul(apart).add(adds));
                next.values.push(sum.clamp(0.0, f64::INFINITY));
                next.passes.push(passes);
                next.adds.push(adds);
            }
            hidden.push(next);
        }
        hidden
    }

    /// The departure of a neuron's sum, from those of the layers before it.
    fn backward(&self, neuron: (usize, usize), inputs: &Hidden, hidden: &[Hidden]) -> Interval {
        let (last, i) = neuron;
        let layer = &self.twins.layers[last];
        let before = |index: usize| index.checked_sub(1).map_or(inputs, |index| &hidden[index]);
        let points = |row: &[f64]| row.iter().map(|&w| Interval::point(w)).collect::<Vec<_>>();
        let mut total = dot(&points(layer.change.row(i)), &before(last).values)
            .add(Interval::point(layer.bias_change[i]));
        let mut row = points(layer.weights.row(i));
        for index in (0..last).rev() {
            let layer = &self.twins.layers[index];
            total = total.add(dot(&row, &hidden[index].adds));
            let passed = row.iter().zip(&hidden[index].passes);
            row = passed.map(|(r, d)| r.mul(*d)).collect();
            let biases = row.iter().zip(&layer.bias_change);
            total = biases.fold(total, |sum, (r, &b)| sum.add(r.scale(b)));
            let change = through(&row, |i| layer.change.row(i), layer.change.cols());
            total = total.add(dot(&change, &before(index).values));
            row = through(&row, |i| layer.weights.row(i), layer.weights.cols());
        }
        total.add(dot(&row, &inputs.adds))
    }

    /// The range of the first output in `f32`.
    fn output(&self, hidden: &[Hidden]) -> Interval {
        let last = &self.twins.subject.network.layers()[3];
        let sum = product(&last.weights, &hidden[2].values);
        sum[0].add(Interval::point(last.bias[0]))
    }
}

/// Makes a feature's enclosure a constant one where more is known of it than the enclosure says.
fn restrict(feature: &mut AffineEnclosure, known: Interval, region: &InputBox) {
    let own = range(feature, region);
    let both = own.and(known);
    if both.radius() < own.radius() {
        feature.constant = both.middle();
        feature.slopes.fill(0.0);
        feature.radius = both.radius();
    }
}

/// Across the feature that is known worst, if cutting the box would tell no more about any.
fn cut(features: &[AffineEnclosure], region: &InputBox) -> Option<Cut> {
    let sides = || region.lower.iter().zip(&region.upper);
    let varies = |f: &AffineEnclosure| {
        let each = f.slopes.iter().zip(sides());
        each.map(|(s, (lo, hi))| s.abs() * (hi - lo)).sum::<f64>()
    };
    let varying = features.iter().map(varies).fold(0.0, f64::max);
    let worst = |a: &(usize, &AffineEnclosure), b: &(usize, &AffineEnclosure)| {
        a.1.radius.total_cmp(&b.1.radius)
    };
    let (index, feature) = features.iter().enumerate().max_by(worst)?;
    (feature.radius > varying).then(|| Cut::Feature(index, range(feature, region).middle()))
}

/// d and ρ of a hidden neuron whose sum is in `sum` in `f32`, and `off` by so much in integers.
fn neuron(sum: Interval, off: Interval, unit: f64) -> (Interval, Interval) {
    let fixed = sum.add(off);
    if sum.hi <= 0.0 && fixed.hi <= 0.0 {
        return (Interval::ZERO, Interval::ZERO);
    }
    let active = sum.lo >= 0.0 && fixed.lo >= 0.0;
    let passes = Interval::new(if active { 1.0 } else { 0.0 }, 1.0);
    let half = 0.5 * unit * (1.0 + 1e-9);
    let limited = (fixed.hi - LARGEST * unit).max(0.0);
    (passes, Interval::new(-half - limited, half))
}

/// The steepest tanh within `off` of `output`.
fn steepest(output: Interval, off: f64) -> f64 {
    let around = output.wider(off);
    let flattest = if around.contains(0.0) {
        0.0
    } else {
        around.lo.abs().min(around.hi.abs())
    };
    (1.0 - flattest.tanh().powi(2)) * (1.0 + 1e-9) + 1e-12
}

fn dot(a: &[Interval], b: &[Interval]) -> Interval {
    let terms = a.iter().zip(b).map(|(a, b)| a.mul(*b));
    terms.fold(Interval::ZERO, Interval::add)
}

/// The matrix times a column of intervals.
fn product(matrix: &Matrix, column: &[Interval]) -> Vec<Interval> {
    let rounding = (2 * column.len() + 8) as f64 * f64::EPSILON;
    let sum = |row: &[f64]| {
        let (mut middle, mut radius) = (0.0, 0.0);
        for (w, x) in row.iter().zip(column) {
            middle += w * x.middle();
            radius += w.abs() * (x.radius() + rounding * x.magnitude());
        }
        Interval::point(middle).wider(radius * (1.0 + 1e-9))
    };
    (0..matrix.rows()).map(|i| sum(matrix.row(i))).collect()
}
