//! The last step on a box: refuting a conjunction of atoms by the best combination of them.
//!
//! For weights w ≥ 0 on the atoms (each an excess a·y − b that is ≤ 0 on the unsafe set), a
//! positive lower bound of Σ wᵢ·excessᵢ shows that the box misses the set. Every choice of
//! weights and of lower slopes in [0, 1] gives a sound bound, and so does every choice of
//! multipliers ≥ 0 on the assumed phases (±z ≤ 0 there). The best choice is found by projected
//! supergradient ascent, which is the dual of the linear programme over the neurons' triangles
//! (Wong and Kolter 2018; α-CROWN, Xu et al. 2021; β-CROWN, Wang et al. 2021). Where rounding is
//! all that is left between a bound and zero, exact arithmetic may decide about the choice.

mod programme;

use super::kernel::{add_scaled, dot};
use super::propagation::{Unbounded, Workspace, in_time};
use super::relaxation::Symbols;
use cede_nnv_check::InputBox;
use cede_nnv_check::proof::Refutation;
use cede_nnv_check::rounding::underflow;
use std::ops::Range;
use std::time::{Duration, Instant};

/// Memory of the ascent, kept between boxes.
#[derive(Default)]
pub(super) struct Ascent {
    forms: Vec<Vec<f64>>,
    sizes: Vec<(f64, f64)>,
    /// The weights of the atoms, then the multipliers of the assumed phases.
    weights: Vec<f64>,
    atoms: usize,
    /// The lower slope of every symbol.
    slopes: Vec<f64>,
    form: Vec<f64>,
    /// The coefficient at which each symbol was replaced.
    coefficients: Vec<f64>,
    /// The relaxation's minimiser: the constant, the inputs, the symbols.
    point: Vec<f64>,
    steps: Vec<f64>,
    /// The choice that came nearest to refuting but for rounding.
    undecided: Option<Undecided>,
}

/// A choice of weights and slopes whose bound is above zero, or not a number, but for rounding.
struct Undecided {
    /// The bound without its errors; NaN where something overflowed.
    least: f64,
    weights: Vec<f64>,
    slopes: Vec<f64>,
}

/// Most steps of the ascent; more where phases are assumed, whose multipliers have no upper limit.
const STEPS: usize = 12;
const STEPS_WITH_PHASES: usize = 80;

/// Rounding errors are charged so many times over, so that a checker that bounds its own rounding
/// more coarsely still finds what is claimed.
pub(super) const MARGIN: f64 = 64.0;

/// Moves weight to the atoms whose excess is greatest, by at most so much of the whole, 1.
#[inline(always)]
pub(super) fn shift_weights(weights: &mut [f64], excesses: &[f64], most: f64) {
    let mean = excesses.iter().sum::<f64>() / excesses.len() as f64;
    let widest = excesses
        .iter()
        .fold(0.0_f64, |w, s| w.max((s - mean).abs()));
    if weights.len() > 1 && widest > 0.0 {
        for (weight, excess) in weights.iter_mut().zip(excesses) {
            *weight = (*weight + most * (excess - mean) / widest).max(0.0);
        }
        let total: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= total);
    }
}

impl Ascent {
    /// The best bound found for the conjunction of the atoms at these positions of the workspace:
    /// if it is positive, the region misses the conjunction, and the weights and slopes are those
    /// that show it. Otherwise they are the last ones tried. There must be an atom.
    ///
    /// # Errors
    /// If the deadline passed.
    #[inline(always)]
    pub(super) fn bound(
        &mut self,
        workspace: &Workspace,
        region: &InputBox,
        atoms: Range<usize>,
        deadline: Option<Instant>,
    ) -> Result<f64, Unbounded> {
        self.undecided = None;
        let symbols = &workspace.symbols;
        self.load(workspace, atoms);
        let mut best = (f64::NEG_INFINITY, 0);
        // Each form alone; an assumption that cannot hold anywhere refutes as well as an atom.
        for form in (0..self.weights.len()).rev() {
            self.weights.fill(0.0);
            self.weights[form] = 1.0;
            let bound = self.evaluate(symbols, region);
            if bound > 0.0 {
                return Ok(bound);
            }
            if form < self.atoms && bound > best.0 {
                best = (bound, form);
            }
        }
        self.weights.fill(0.0);
        self.weights[best.1] = 1.0;
        if self.atoms > 1 {
            self.evaluate(symbols, region);
        }
        let first = best.0;
        let (mut bound, mut last) = (first, first);
        let phases = !workspace.assumed.is_empty();
        for step in 0..if phases { STEPS_WITH_PHASES } else { STEPS } {
            in_time(deadline)?;
            self.climb(symbols, 1.0 / (1.0 + step as f64), last);
            last = self.evaluate(symbols, region);
            bound = bound.max(last);
            if bound > 0.0 {
                return Ok(bound);
            }
            // Not worth more steps if the gain so far, kept up, would not reach zero.
            if !phases && bound - first < 0.08 * (step + 1) as f64 * -first {
                break;
            }
        }
        Ok(bound)
    }

    /// As [`Self::bound`] after it failed on a region on which every ReLU is stable: there the
    /// forms are linear in the inputs, and a linear programme finds the best weights and
    /// multipliers; the bound itself is then evaluated soundly. Failing that, gives an input
    /// that may be a counterexample.
    pub(super) fn finish(
        &mut self,
        workspace: &Workspace,
        region: &InputBox,
        time: Duration,
    ) -> Result<f64, Option<Vec<f64>>> {
        let symbols = &workspace.symbols;
        let forms = &self.forms[..self.weights.len()];
        if let Some(weights) = programme::best_weights(forms, self.atoms, region, time) {
            self.weights = weights;
            let bound = self.evaluate(symbols, region);
            if bound > 0.0 {
                return Ok(bound);
            }
        }
        Err(programme::least_excess(
            &self.forms[..self.weights.len()],
            self.atoms,
            region,
            time,
        ))
    }

    /// Takes over the forms of a conjunction's atoms and of the assumed phases.
    fn load(&mut self, workspace: &Workspace, atoms: Range<usize>) {
        self.atoms = atoms.len();
        let count = self.atoms + workspace.assumed.len();
        self.forms
            .resize_with(count.max(self.forms.len()), Vec::new);
        self.sizes.clear();
        for (form, atom) in self.forms.iter_mut().zip(atoms) {
            self.sizes.push(workspace.atom(atom, form));
        }
        for (form, (_, assumed, size)) in
            self.forms[self.atoms..].iter_mut().zip(&workspace.assumed)
        {
            form.clone_from(assumed);
            self.sizes.push(*size);
        }
        let symbols = &workspace.symbols;
        self.slopes.clear();
        self.slopes
            .extend((0..symbols.count()).map(|s| symbols.lines(s).lower_slope));
        self.weights.clear();
        self.weights.resize(count, 0.0);
    }

    /// The bound for the present weights and slopes.
    #[inline(always)]
    fn evaluate(&mut self, symbols: &Symbols, region: &InputBox) -> f64 {
        let g = symbols.relative_error();
        self.form.clear();
        self.form.resize(symbols.columns(), 0.0);
        let mut errors = symbols.underflow(8 * self.weights.len());
        for ((form, &(error, size)), &weight) in
            self.forms.iter().zip(&self.sizes).zip(&self.weights)
        {
            if weight > 0.0 {
                add_scaled(&mut self.form, form, weight);
                errors += weight * (error + 2.0 * g * size + underflow(4, 1.0));
            }
        }
        self.coefficients.clear();
        self.coefficients.resize(symbols.count(), 0.0);
        for symbol in (0..symbols.count()).rev() {
            let c = self.form[symbols.fixed() + symbol];
            self.coefficients[symbol] = c;
            if c == 0.0 {
                continue;
            }
            let lines = symbols.lines(symbol);
            let (slope, offset) = if c > 0.0 {
                (self.slopes[symbol], lines.lower_offset)
            } else {
                (lines.upper_slope, lines.upper_offset)
            };
            let factor = c * slope;
            let (per_factor, per_coefficient) = symbols.costs(symbol);
            errors += factor.abs() * per_factor + c.abs() * per_coefficient;
            self.form[0] += c * offset;
            if factor != 0.0 {
                add_scaled(&mut self.form, symbols.row(symbol), factor);
            }
        }
        let mut least = self.form[0];
        self.point.clear();
        self.point.push(1.0);
        for ((&c, &lo), &hi) in self.form[1..symbols.fixed()]
            .iter()
            .zip(&region.lower)
            .zip(&region.upper)
        {
            let x = if c > 0.0 { lo } else { hi };
            least += c * x;
            self.point.push(x);
        }
        let bound = least - errors * MARGIN;
        // NaN is undecided as well.
        if !(bound > 0.0 || least + errors * MARGIN < 0.0) {
            let nearer = |old: &Undecided| old.least.is_nan() || least > old.least;
            if self.undecided.as_ref().is_none_or(nearer) {
                self.undecided = Some(Undecided {
                    least,
                    weights: self.weights.clone(),
                    slopes: self.slopes.clone(),
                });
            }
        }
        if bound.is_finite() {
            bound
        } else {
            f64::NEG_INFINITY
        }
    }

    /// After [`Self::bound`] failed: claims that only rounding, or overflow, kept it from making.
    pub(super) fn undecided(&mut self, workspace: &Workspace, conjunction: u32) -> Vec<Refutation> {
        let Some(undecided) = self.undecided.take() else {
            return Vec::new();
        };
        let Undecided {
            least,
            weights,
            slopes,
        } = undecided;
        if least.is_finite() {
            let (weights, slopes) = (
                std::mem::replace(&mut self.weights, weights),
                std::mem::replace(&mut self.slopes, slopes),
            );
            let claim = self.refutation(workspace, conjunction, 0.0);
            (self.weights, self.slopes) = (weights, slopes);
            return vec![claim];
        }
        let alone = |atom| Refutation {
            conjunction,
            weights: (0..self.atoms)
                .map(|i| f64::from(u8::from(i == atom)))
                .collect(),
            multipliers: Vec::new(),
            slopes: Vec::new(),
            bound: 0.0,
        };
        (0..self.atoms).map(alone).collect()
    }

    /// One step up the supergradient at the present weights and slopes.
    #[inline(always)]
    fn climb(&mut self, symbols: &Symbols, length: f64, bound: f64) {
        self.steps.clear();
        let mut steepest = 0.0_f64;
        for symbol in 0..symbols.count() {
            let row = symbols.row(symbol);
            let z = dot(row, &self.point[..row.len()]);
            let lines = symbols.lines(symbol);
            let c = self.coefficients[symbol];
            let (value, slope) = if c > 0.0 {
                (
                    self.slopes[symbol] * z + lines.lower_offset,
                    if lines.free { c * z } else { 0.0 },
                )
            } else {
                (lines.upper_slope * z + lines.upper_offset, 0.0)
            };
            self.point.push(value);
            self.steps.push(slope);
            steepest = steepest.max(slope.abs());
        }
        if steepest > 0.0 {
            for (slope, step) in self.slopes.iter_mut().zip(&self.steps) {
                *slope = (*slope + length * step / steepest).clamp(0.0, 1.0);
            }
        }
        let value = |form: &Vec<f64>| dot(form, &self.point[..form.len()]);
        self.steps.clear();
        self.steps
            .extend(self.forms[..self.weights.len()].iter().map(value));
        let (atoms, assumed) = self.weights.split_at_mut(self.atoms);
        let (excesses, breaches) = self.steps.split_at(self.atoms);
        shift_weights(atoms, excesses, 0.5 * length);
        // Polyak's step, to half beyond the bound 0 so that it is passed.
        let norm: f64 = breaches.iter().map(|b| b * b).sum();
        if norm > 0.0 {
            for (multiplier, breach) in assumed.iter_mut().zip(breaches) {
                *multiplier = (*multiplier - 1.5 * bound * breach / norm).max(0.0);
            }
        }
    }

    /// The inputs at the relaxation's minimum of the last evaluation.
    pub(super) fn minimiser(&self, inputs: usize) -> &[f64] {
        &self.point[1..=inputs]
    }

    /// Adds to `slacks` what each symbol's relaxation may have cost the last evaluation, and to
    /// `scores` how much of that each input is answerable for.
    pub(super) fn blame(&self, workspace: &Workspace, slacks: &mut [f64], scores: &mut [f64]) {
        let symbols = &workspace.symbols;
        for (symbol, (sum, shares)) in slacks
            .iter_mut()
            .zip(workspace.shares.chunks_exact(scores.len()))
            .enumerate()
        {
            let slack = self.slack(symbols, symbol);
            *sum += slack;
            for (score, share) in scores.iter_mut().zip(shares) {
                *score += slack * share;
            }
        }
    }

    /// The record of the last evaluation.
    pub(super) fn refutation(
        &self,
        workspace: &Workspace,
        conjunction: u32,
        bound: f64,
    ) -> Refutation {
        let symbols = &workspace.symbols;
        // Where rounding may decide which slope is the usual one, others may come to another.
        let unusual = |&s: &usize| {
            let (lines, (l, u)) = (symbols.lines(s), symbols.interval(s));
            let doubt = 1e-6 * (u - l) + 1e6 * symbols.costs(s).0;
            self.slopes[s] != lines.lower_slope || lines.free && (l + u).abs() <= doubt
        };
        let (weights, multipliers) = self.weights.split_at(self.atoms);
        let assumed = workspace.assumed.iter().zip(multipliers);
        Refutation {
            conjunction,
            weights: weights.to_vec(),
            multipliers: assumed
                .map(|((phase, ..), &m)| (phase.0, m))
                .filter(|&(_, m)| m > 0.0)
                .collect(),
            slopes: (0..symbols.count())
                .filter(unusual)
                .map(|s| (symbols.neuron(s) as u32, self.slopes[s]))
                .collect(),
            bound,
        }
    }

    /// The most that replacing the symbol by a line can have cost the last evaluation.
    fn slack(&self, symbols: &Symbols, symbol: usize) -> f64 {
        let (c, lines, (l, u)) = (
            self.coefficients[symbol],
            symbols.lines(symbol),
            symbols.interval(symbol),
        );
        if !lines.free {
            return c.abs() * (lines.upper_offset - lines.lower_offset);
        }
        let slope = self.slopes[symbol];
        if c > 0.0 {
            c * ((1.0 - slope) * u).max(-slope * l)
        } else {
            -c * lines.upper_offset
        }
    }
}
