//! Linear forms over the inputs and the neurons whose activation is not linear on the region.
//!
//! Every neuron's pre-activation is written as a row over *symbols*: the constant 1, the inputs,
//! and the outputs of the unstable neurons before it. Stable neurons are substituted exactly as
//! they come, so a row is as short as the region is simple. A bound is then found by replacing
//! the symbols, last to first, by the line that bounds them from the right side: the same
//! algebra, hence the same bound, as the backward pass of CROWN (Zhang et al. 2018) and DeepPoly
//! (Singh et al. 2019), at a fraction of its cost.
//!
//! **Rounding.** Each row carries a number e such that the neuron's exact value differs from the
//! row's (its float coefficients taken as exact reals, at the exact values of the symbols) by at
//! most e anywhere on the region, and a size m ≥ Σ|coefficient|·max|symbol|. A substitution
//! r += f·row costs at most |f|·e plus a rounding of each coefficient, which over all symbols is
//! at most 3u·(size of r + |f|·m); sizes only add up, so g·(final size) with g = γ of the number
//! of substitutions covers all of them and the last evaluation on the box as well.
//!
//! **Underflow.** A product that is not normal is off by up to 2⁻¹⁰⁷⁵ besides, and what it is
//! multiplied by may be large: a coefficient by its symbol, a slope by its pre-activation. All of
//! these together are at most the [reach](Symbols::underflow) of the region. An offset, or a term
//! of an error, is charged where it is multiplied.
//!
//! **Overflow.** Infinities and NaN stay in the sums, and a bound that is not finite is none.

use super::kernel::{LANES, Lane, add_row};
use cede_nnv_check::rounding::{SPARE, gamma, underflow};
use cede_nnv_check::{AffineEnclosure, InputBox};

/// Two lines that enclose an activation on an interval: below, slope·z + offset ≤ f(z), above
/// likewise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lines {
    pub(super) lower_slope: f64,
    pub(super) lower_offset: f64,
    pub(super) upper_slope: f64,
    pub(super) upper_offset: f64,
    /// Largest |f(z)| on the interval.
    pub(super) most: f64,
    /// Whether any lower slope in [0, 1] is sound (with offset 0).
    pub(super) free: bool,
}

impl Lines {
    /// Of max(0, z) on [l, u], l < 0 < u; the lower slope is whichever of 0 and 1 leaves the
    /// smaller triangle. Any lower slope in [0, 1] is sound.
    pub(super) fn relu(l: f64, u: f64) -> Self {
        let slope = (u / (u - l)).clamp(0.0, 1.0);
        // Sound for every slope in [0, 1]: max(0, z) − slope·z is convex, so largest at an end.
        let offset = (-slope * l).max(u - slope * u);
        Self {
            lower_slope: if u > -l { 1.0 } else { 0.0 },
            lower_offset: 0.0,
            upper_slope: slope,
            upper_offset: offset,
            most: u,
            free: true,
        }
    }

    /// Of an activation that is slope·z.
    pub(super) fn straight(slope: f64) -> Self {
        Self {
            lower_slope: slope,
            lower_offset: 0.0,
            upper_slope: slope,
            upper_offset: 0.0,
            most: f64::INFINITY,
            free: false,
        }
    }

    /// Of an input of the network over the linear part of what encloses it.
    pub(super) fn enclosure(input: &AffineEnclosure, region: &InputBox) -> Self {
        Self {
            lower_slope: 1.0,
            lower_offset: -input.radius,
            upper_slope: 1.0,
            upper_offset: input.radius,
            most: input.magnitude(region),
            free: false,
        }
    }

    /// Of tanh on [l, u]: tanh z − slope·z does not fall if slope ≤ tanh′ everywhere, and tanh′
    /// is least at an end.
    pub(super) fn tanh(l: f64, u: f64) -> Self {
        let (low, high) = (l.tanh(), u.tanh());
        let slope = ((1.0 - low * low).min(1.0 - high * high) - 1e-12).max(0.0);
        let slack = 32.0 * f64::EPSILON;
        Self {
            lower_slope: slope,
            lower_offset: low - slope * l - slack,
            upper_slope: slope,
            upper_offset: high - slope * u + slack,
            most: 1.0,
            free: false,
        }
    }
}

/// The symbols of a region beyond its inputs, in the order of their layers.
#[derive(Default)]
pub(super) struct Symbols {
    /// Columns before the first symbol: the constant and the inputs.
    fixed: usize,
    rows: Vec<f64>,
    ends: Vec<usize>,
    lines: Vec<Lines>,
    /// (e, m) of each row, largest |end| of its interval added to m.
    sizes: Vec<(f64, f64)>,
    /// Largest absolute value of every column's symbol, the constant's and the inputs' included.
    most: Vec<f64>,
    /// Bounds of the pre-activations.
    intervals: Vec<(f64, f64)>,
    /// Which neuron (over all activations of the network) each symbol is.
    neurons: Vec<usize>,
    /// Sum of all of `most` and of the sizes of all rows.
    reach: f64,
}

impl Symbols {
    /// Forgets all symbols and starts with the inputs of a box.
    pub(super) fn restart(&mut self, lower: &[f64], upper: &[f64]) {
        self.fixed = 1 + lower.len();
        self.rows.clear();
        self.ends.clear();
        self.lines.clear();
        self.sizes.clear();
        self.intervals.clear();
        self.neurons.clear();
        self.most.clear();
        self.most.push(1.0);
        self.most.extend(
            lower
                .iter()
                .zip(upper)
                .map(|(lo, hi)| lo.abs().max(hi.abs())),
        );
        self.reach = self.most.iter().sum();
    }

    /// Adds a symbol, the output of a neuron that is bounded by `lines` where its pre-activation
    /// lies in `interval`; gives its column.
    pub(super) fn push(
        &mut self,
        neuron: usize,
        row: impl Iterator<Item = f64>,
        (error, size): (f64, f64),
        interval: (f64, f64),
        lines: Lines,
    ) -> usize {
        self.rows.extend(row);
        self.ends.push(self.rows.len());
        let size = size + interval.0.abs().max(interval.1.abs());
        self.sizes.push((error, size));
        self.most.push(lines.most);
        self.reach += size + lines.most;
        self.lines.push(lines);
        self.intervals.push(interval);
        self.neurons.push(neuron);
        self.most.len() - 1
    }

    /// Number of symbols beyond the inputs.
    pub(super) fn count(&self) -> usize {
        self.lines.len()
    }

    /// Number of columns: the constant, the inputs, the symbols.
    pub(super) fn columns(&self) -> usize {
        self.most.len()
    }

    /// Columns before the first symbol.
    pub(super) fn fixed(&self) -> usize {
        self.fixed
    }

    /// The row of a symbol's pre-activation.
    pub(super) fn row(&self, symbol: usize) -> &[f64] {
        let start = if symbol == 0 {
            0
        } else {
            self.ends[symbol - 1]
        };
        &self.rows[start..self.ends[symbol]]
    }

    /// The lines that enclose a symbol.
    pub(super) fn lines(&self, symbol: usize) -> &Lines {
        &self.lines[symbol]
    }

    /// The bounds of a symbol's pre-activation.
    pub(super) fn interval(&self, symbol: usize) -> (f64, f64) {
        self.intervals[symbol]
    }

    /// Which neuron a symbol is the output of.
    pub(super) fn neuron(&self, symbol: usize) -> usize {
        self.neurons[symbol]
    }

    /// Largest absolute value of each column's symbol.
    pub(super) fn most(&self) -> &[f64] {
        &self.most
    }

    /// g of the module's text, for forms over all columns so far.
    pub(super) fn relative_error(&self) -> f64 {
        gamma(2 * self.columns() + 16)
    }

    /// What underflow can cost while so many more products than there are columns are taken, each
    /// multiplied by no more than all symbols and pre-activations together.
    pub(super) fn underflow(&self, products: usize) -> f64 {
        underflow(products + 8 * (self.columns() + 4), self.reach * SPARE)
    }

    /// What replacing a symbol may cost in rounding: for each unit of the factor by which its row is
    /// added, and for each unit of its coefficient.
    #[inline(always)]
    pub(super) fn costs(&self, symbol: usize) -> (f64, f64) {
        let g = self.relative_error();
        let (lines, (error, size)) = (&self.lines[symbol], self.sizes[symbol]);
        let offsets = lines.upper_offset.abs() + lines.lower_offset.abs();
        (
            error + g * size + underflow(2, 1.0),
            g * (offsets + size) + underflow(8, 1.0),
        )
    }

    /// Replaces every symbol of the forms in `block` by its bounding line, last to first, so that
    /// what is left over the constant and the inputs bounds each form from below, up to the
    /// `errors` that are added to.
    #[inline(always)]
    pub(super) fn substitute(&self, block: &mut [Lane], errors: &mut Lane) {
        for symbol in (0..self.count()).rev() {
            let coefficients = block[self.fixed + symbol];
            if coefficients == [0.0; LANES] {
                continue;
            }
            let lines = &self.lines[symbol];
            let (per_factor, per_coefficient) = self.costs(symbol);
            let mut factors = [0.0; LANES];
            for i in 0..LANES {
                let c = coefficients[i];
                let (slope, offset) = if c > 0.0 {
                    (lines.lower_slope, lines.lower_offset)
                } else {
                    (lines.upper_slope, lines.upper_offset)
                };
                factors[i] = c * slope;
                block[0][i] += c * offset;
                errors[i] += factors[i].abs() * per_factor + c.abs() * per_coefficient;
            }
            add_row(block, self.row(symbol), &factors);
        }
    }

    /// The least value of each form over the box, errors subtracted: a sound lower bound, −∞ where
    /// something overflowed.
    #[inline(always)]
    pub(super) fn least(
        &self,
        block: &[Lane],
        errors: &Lane,
        lower: &[f64],
        upper: &[f64],
    ) -> Lane {
        let mut least = block[0];
        for ((coefficients, &lo), &hi) in block[1..].iter().zip(lower).zip(upper) {
            for i in 0..LANES {
                let c = coefficients[i];
                least[i] += if c > 0.0 { c * lo } else { c * hi };
            }
        }
        let underflow = self.underflow(0);
        for i in 0..LANES {
            least[i] -= errors[i] * SPARE + underflow;
            if !least[i].is_finite() {
                least[i] = f64::NEG_INFINITY;
            }
        }
        least
    }
}
