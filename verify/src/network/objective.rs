//! The last step on a box: refuting a conjunction of atoms by the best combination of them.
//!
//! For weights w ≥ 0 on the atoms (each an excess a·y − b that is ≤ 0 on the unsafe set), a
//! positive lower bound of Σ wᵢ·excessᵢ shows that the box misses the set. Every choice of
//! weights and of lower slopes in [0, 1] gives a sound bound; the best choice is found by
//! projected supergradient ascent, which is the dual of the linear programme over the neurons'
//! triangles (Wong and Kolter 2018; Xu et al. 2021, α-CROWN).

use super::kernel::{add_scaled, dot};
use super::propagation::Workspace;
use super::property::InputBox;
use super::relaxation::Symbols;
use super::rounding::{SPARE, UNDERFLOW};
use std::ops::Range;

/// Memory of the ascent, kept between boxes.
#[derive(Default)]
pub(super) struct Ascent {
    forms: Vec<Vec<f64>>,
    sizes: Vec<(f64, f64)>,
    /// The weights of the atoms.
    pub(super) weights: Vec<f64>,
    /// The lower slope of every symbol.
    pub(super) slopes: Vec<f64>,
    form: Vec<f64>,
    /// The coefficient at which each symbol was replaced.
    coefficients: Vec<f64>,
    /// The relaxation's minimiser: the constant, the inputs, the symbols.
    point: Vec<f64>,
    steps: Vec<f64>,
}

/// Most steps of the ascent.
const STEPS: usize = 12;

impl Ascent {
    /// Whether the box misses the conjunction of the atoms at these positions of the workspace;
    /// also gives the best bound found.
    #[inline(always)]
    pub(super) fn refutes(&mut self, workspace: &Workspace, region: &InputBox, atoms: Range<usize>) -> (bool, f64) {
        let symbols = &workspace.symbols;
        let count = atoms.len();
        self.forms.resize_with(count.max(self.forms.len()), Vec::new);
        self.sizes.clear();
        for (form, atom) in self.forms.iter_mut().zip(atoms) {
            self.sizes.push(workspace.atom(atom, form));
        }
        self.slopes.clear();
        self.slopes.extend((0..symbols.count()).map(|s| symbols.lines(s).lower_slope));
        self.weights.clear();
        self.weights.resize(count, 0.0);

        let mut best = (f64::NEG_INFINITY, 0);
        for atom in 0..count {
            self.weights.fill(0.0);
            self.weights[atom] = 1.0;
            let bound = self.evaluate(symbols, region);
            if bound > 0.0 {
                return (true, bound);
            }
            if bound > best.0 {
                best = (bound, atom);
            }
        }
        self.weights.fill(0.0);
        if let Some(weight) = self.weights.get_mut(best.1) {
            *weight = 1.0;
        }
        if count > 1 {
            self.evaluate(symbols, region);
        }
        let mut bound = best.0;
        let first = bound;
        for step in 0..STEPS {
            self.climb(symbols, 1.0 / (1.0 + step as f64));
            bound = bound.max(self.evaluate(symbols, region));
            if bound > 0.0 {
                return (true, bound);
            }
            // Not worth more steps if the gain so far, kept up, would not reach zero.
            if bound - first < 0.08 * (step + 1) as f64 * -first {
                break;
            }
        }
        (false, bound)
    }

    /// The bound for the present weights and slopes.
    #[inline(always)]
    fn evaluate(&mut self, symbols: &Symbols, region: &InputBox) -> f64 {
        let g = symbols.relative_error();
        self.form.clear();
        self.form.resize(symbols.columns(), 0.0);
        let mut errors = UNDERFLOW;
        for ((form, &(error, size)), &weight) in self.forms.iter().zip(&self.sizes).zip(&self.weights) {
            if weight > 0.0 {
                add_scaled(&mut self.form, form, weight);
                errors += weight * (error + 2.0 * g * size);
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
            let (slope, offset) =
                if c > 0.0 { (self.slopes[symbol], lines.lower_offset) } else { (lines.upper_slope, lines.upper_offset) };
            let factor = c * slope;
            let (error, size) = symbols.size(symbol);
            errors += factor.abs() * (error + g * size) + c.abs() * g * (offset.abs() + size);
            self.form[0] += c * offset;
            if factor != 0.0 {
                add_scaled(&mut self.form, symbols.row(symbol), factor);
            }
        }
        let mut least = self.form[0];
        self.point.clear();
        self.point.push(1.0);
        for ((&c, &lo), &hi) in self.form[1..symbols.fixed()].iter().zip(&region.lower).zip(&region.upper) {
            let x = if c > 0.0 { lo } else { hi };
            least += c * x;
            self.point.push(x);
        }
        least - errors * SPARE
    }

    /// One step up the supergradient at the present weights and slopes.
    #[inline(always)]
    fn climb(&mut self, symbols: &Symbols, length: f64) {
        self.steps.clear();
        let mut steepest = 0.0_f64;
        for symbol in 0..symbols.count() {
            let row = symbols.row(symbol);
            let z = dot(row, &self.point[..row.len()]);
            let lines = symbols.lines(symbol);
            let c = self.coefficients[symbol];
            let (value, slope) = if c > 0.0 {
                (self.slopes[symbol] * z + lines.lower_offset, if lines.free { c * z } else { 0.0 })
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
        let count = self.weights.len();
        if count > 1 {
            let excess = |form: &Vec<f64>| dot(form, &self.point[..form.len()]);
            self.steps.clear();
            self.steps.extend(self.forms[..count].iter().map(excess));
            let mean = self.steps.iter().sum::<f64>() / count as f64;
            let widest = self.steps.iter().fold(0.0_f64, |w, s| w.max((s - mean).abs()));
            if widest > 0.0 {
                for (weight, step) in self.weights.iter_mut().zip(&self.steps) {
                    *weight = (*weight + 0.5 * length * (step - mean) / widest).max(0.0);
                }
                let total: f64 = self.weights.iter().sum();
                self.weights.iter_mut().for_each(|w| *w /= total);
            }
        }
    }

    /// The inputs at the relaxation's minimum of the last evaluation.
    pub(super) fn minimiser(&self, inputs: usize) -> &[f64] {
        &self.point[1..=inputs]
    }

    /// Adds to `scores` how much of the relaxation's slack each input is answerable for.
    pub(super) fn blame(&self, workspace: &Workspace, scores: &mut [f64]) {
        let symbols = &workspace.symbols;
        for (symbol, shares) in workspace.shares.chunks_exact(scores.len()).enumerate() {
            let slack = self.slack(symbols, symbol);
            for (score, share) in scores.iter_mut().zip(shares) {
                *score += slack * share;
            }
        }
    }

    /// The most that replacing the symbol by a line can have cost the last evaluation.
    pub(super) fn slack(&self, symbols: &Symbols, symbol: usize) -> f64 {
        let (c, lines, (l, u)) = (self.coefficients[symbol], symbols.lines(symbol), symbols.interval(symbol));
        if !lines.free {
            return c.abs() * (lines.upper_offset - lines.lower_offset);
        }
        let slope = self.slopes[symbol];
        if c > 0.0 { c * ((1.0 - slope) * u).max(-slope * l) } else { -c * lines.upper_offset }
    }
}
