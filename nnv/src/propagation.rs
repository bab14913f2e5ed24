//! Sound bounds for every neuron and for the atoms of a query on a box, layer by layer.

mod composition;
mod prepared;

use super::kernel::{LANES, Lane, padded};
use super::relaxation::{Lines, Symbols};
use cede_nnv_check::rounding::{SPARE, underflow};
use cede_nnv_check::{Activation, AffineEnclosure, InputBox};
pub(crate) use prepared::{Prepared, PreparedLayer, SOME_INPUTS, Weights};
use std::time::Instant;

/// Least and greatest value of a pre-activation.
pub type NeuronBounds = (f64, f64);

/// An assumed phase of a ReLU: which neuron, and whether its pre-activation is ≥ 0 (else ≤ 0).
pub(super) type Phase = (u32, bool);

/// Why a region has no bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Unbounded {
    /// It is empty: two bounds of one neuron contradict each other.
    Empty,
    /// The deadline passed.
    Late,
}

/// Linear forms of some neurons over the symbols, a column of lanes for each symbol.
#[derive(Default)]
struct Forms {
    /// Which neurons of the layer.
    neurons: Vec<usize>,
    /// Coefficients: [column][lane], lanes padded.
    coefficients: Vec<f64>,
    errors: Vec<f64>,
    sizes: Vec<f64>,
}

/// What stands for a neuron's output.
#[derive(Clone, Copy)]
enum Place {
    /// Nothing: it is 0.
    Off,
    /// A form of the layer before, by lane.
    Active(usize),
    /// A symbol, by column.
    Direct(usize),
}

/// All the memory that bounding a box takes, kept between boxes.
#[derive(Default)]
pub(super) struct Workspace {
    /// The symbols of the last box.
    pub(super) symbols: Symbols,
    /// For each symbol, how much of its interval's width each input brings about; sums to 1.
    pub(super) shares: Vec<f64>,
    /// For each assumed phase, the form of ±z that the assumption makes ≤ 0, with error and size.
    pub(super) assumed: Vec<(Phase, Vec<f64>, (f64, f64))>,
    forms: Forms,
    previous: Forms,
    /// What the layer before gives: (neuron, column) of its symbols, lanes of its active forms.
    direct: Vec<(usize, usize)>,
    active: Vec<usize>,
    compact_rows: Vec<f64>,
    compact_weights: Vec<f64>,
    /// Where each neuron of the layer before is, and the products of a sparse layer: lane, lane of
    /// the layer before, weight.
    places: Vec<Place>,
    products: Vec<(usize, usize, f64)>,
    block: Vec<Lane>,
    open: Vec<usize>,
}

impl Workspace {
    /// Tightens `bounds` (of all neurons with an activation, sound for a box that contains this
    /// one) to the box where the assumed phases hold, and leaves the forms of the wanted atoms for
    /// [`Self::atom`].
    ///
    /// # Errors
    /// If the bounds show that nothing in the box satisfies what `bounds` assumed, or the deadline
    /// passed.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "a region, and what is asked of it"
    )]
    pub(super) fn bound(
        &mut self,
        network: &Prepared,
        region: &InputBox,
        enclosures: &[AffineEnclosure],
        bounds: &mut [NeuronBounds],
        phases: &[Phase],
        atoms: &[usize],
        deadline: Option<Instant>,
    ) -> Result<(), Unbounded> {
        self.assumed.clear();
        self.symbols.restart(&region.lower, &region.upper);
        self.shares.clear();
        self.direct.clear();
        if enclosures.is_empty() {
            self.direct.extend((0..network.inputs).map(|i| (i, i + 1)));
        }
        for (input, enclosure) in enclosures.iter().enumerate() {
            let column = self.push_input(region, enclosure);
            self.direct.push((input, column));
        }
        self.active.clear();
        for (index, layer) in network.layers.iter().enumerate() {
            std::mem::swap(&mut self.forms, &mut self.previous);
            self.forms.neurons.clear();
            if index + 1 == network.layers.len() {
                self.forms.neurons.extend_from_slice(atoms);
                self.compose_layer(layer, deadline)?;
                break;
            }
            if layer.activation == Activation::Identity {
                self.forms.neurons.extend(0..layer.outputs);
                self.compose_layer(layer, deadline)?;
                self.direct.clear();
                self.active.clear();
                self.active.extend(0..layer.outputs);
                continue;
            }
            let own = &mut bounds[layer.first..layer.first + layer.outputs];
            let is_assumed = |i: usize| phases.iter().any(|p| p.0 as usize == layer.first + i);
            let alive = |i: &usize| {
                layer.activation != Activation::Relu || own[*i].1 > 0.0 || is_assumed(*i)
            };
            self.forms.neurons.extend((0..layer.outputs).filter(alive));
            self.compose_layer(layer, deadline)?;
            self.tighten(layer, region, own, deadline)?;
            self.release(layer, own, phases, network.enclose);
        }
        Ok(())
    }

    /// Adds an input of the network that is enclosed over the region's variables; gives its column.
    fn push_input(&mut self, region: &InputBox, enclosure: &AffineEnclosure) -> usize {
        let row = std::iter::once(enclosure.constant).chain(enclosure.slopes.iter().copied());
        let row_length = enclosure.slopes.len() + 1;
        let size = row
            .clone()
            .zip(self.symbols.most())
            .map(|(c, most)| c.abs() * most)
            .sum::<f64>();
        let sides = region.lower.iter().zip(&region.upper);
        let reach = enclosure.slopes.iter().zip(sides);
        let start = self.shares.len();
        self.shares
            .extend(reach.map(|(s, (lo, hi))| s.abs() * (hi - lo)));
        normalise(&mut self.shares[start..]);
        self.symbols.push(
            NO_NEURON,
            row,
            (0.0, size * SPARE + underflow(row_length, 1.0)),
            enclosure.affine_range(region),
            Lines::enclosure(enclosure, region),
        )
    }

    /// Bounds the neurons of the layer that are not known to be stable.
    #[inline(always)]
    fn tighten(
        &mut self,
        layer: &PreparedLayer,
        region: &InputBox,
        bounds: &mut [NeuronBounds],
        deadline: Option<Instant>,
    ) -> Result<(), Unbounded> {
        let inputs = region.lower.len();
        let open = |i: usize| {
            layer.activation != Activation::Relu || (bounds[i].0 < 0.0 && bounds[i].1 > 0.0)
        };
        let mut lanes = std::mem::take(&mut self.open);
        lanes.clear();
        lanes.extend((0..self.forms.neurons.len()).filter(|&l| open(self.forms.neurons[l])));
        let first_share = self.shares.len();
        // A lane for each lower bound, and one for the lower bound of the negated form.
        for chunk in lanes.chunks(LANES / 2) {
            in_time(deadline)?;
            let least = self.bound_lanes(chunk, region);
            for (k, &lane) in chunk.iter().enumerate() {
                let (l, u) = &mut bounds[self.forms.neurons[lane]];
                *l = l.max(least[2 * k]);
                *u = u.min(-least[2 * k + 1]);
                if *l > *u {
                    return Err(Unbounded::Empty);
                }
                let start = self.shares.len();
                let reach = |i: usize| {
                    (self.block[i + 1][2 * k].abs() + self.block[i + 1][2 * k + 1].abs())
                        * (region.upper[i] - region.lower[i])
                };
                self.shares.extend((0..inputs).map(reach));
                normalise(&mut self.shares[start..]);
            }
        }
        // Shares are kept for those that stay unstable only.
        let mut kept = first_share;
        for (k, &lane) in lanes.iter().enumerate() {
            if layer.activation != Activation::Relu || is_unstable(bounds[self.forms.neurons[lane]])
            {
                let from = first_share + k * inputs;
                self.shares.copy_within(from..from + inputs, kept);
                kept += inputs;
            }
        }
        self.shares.truncate(kept);
        self.open = lanes;
        Ok(())
    }

    /// Lower bounds of up to eight forms (even lanes) and of their negations (odd lanes).
    #[inline(always)]
    fn bound_lanes(&mut self, lanes: &[usize], region: &InputBox) -> Lane {
        let stride = padded(self.forms.neurons.len());
        self.block.clear();
        for row in self.forms.coefficients.chunks_exact(stride) {
            let mut both = [0.0; LANES];
            for (k, &lane) in lanes.iter().enumerate() {
                both[2 * k] = row[lane];
                both[2 * k + 1] = -row[lane];
            }
            self.block.push(both);
        }
        let g = self.symbols.relative_error();
        let mut errors = [0.0; LANES];
        for (k, &lane) in lanes.iter().enumerate() {
            // The underflow of this product is among what the symbols charge.
            let error = self.forms.errors[lane] + g * self.forms.sizes[lane];
            errors[2 * k] = error;
            errors[2 * k + 1] = error;
        }
        self.symbols.substitute(&mut self.block, &mut errors);
        self.symbols
            .least(&self.block, &errors, &region.lower, &region.upper)
    }

    /// Sorts the layer's neurons into active forms and new symbols.
    #[inline(always)]
    fn release(
        &mut self,
        layer: &PreparedLayer,
        bounds: &[NeuronBounds],
        phases: &[Phase],
        enclose: fn(f64, f64) -> Lines,
    ) {
        self.direct.clear();
        self.active.clear();
        let stride = padded(self.forms.neurons.len());
        for (lane, &i) in self.forms.neurons.iter().enumerate() {
            let (l, u) = bounds[i];
            let row = self
                .forms
                .coefficients
                .chunks_exact(stride)
                .map(|row| row[lane]);
            let sizes = (self.forms.errors[lane], self.forms.sizes[lane]);
            if let Some(&phase) = phases.iter().find(|p| p.0 as usize == layer.first + i) {
                let sign = if phase.1 { -1.0 } else { 1.0 };
                self.assumed
                    .push((phase, row.clone().map(|c| sign * c).collect(), sizes));
            }
            let lines = match layer.activation {
                Activation::Relu if u <= 0.0 => continue,
                Activation::Relu if l >= 0.0 => {
                    self.active.push(lane);
                    continue;
                }
                Activation::Relu => enclose(l, u),
                Activation::Tanh => Lines::tanh(l, u),
                Activation::Identity => continue,
            };
            let column = self
                .symbols
                .push(layer.first + i, row, sizes, (l, u), lines);
            self.direct.push((i, column));
        }
    }

    /// The form of the k-th wanted atom, and its error and size.
    pub(super) fn atom(&self, k: usize, form: &mut Vec<f64>) -> (f64, f64) {
        let stride = padded(self.forms.neurons.len());
        form.clear();
        form.extend(
            self.forms
                .coefficients
                .chunks_exact(stride)
                .map(|row| row[k]),
        );
        (self.forms.errors[k], self.forms.sizes[k])
    }
}

/// Fails after the deadline.
pub(super) fn in_time(deadline: Option<Instant>) -> Result<(), Unbounded> {
    if deadline.is_some_and(|deadline| Instant::now() > deadline) {
        Err(Unbounded::Late)
    } else {
        Ok(())
    }
}

/// Stands for the neuron of a symbol that is none.
const NO_NEURON: usize = usize::MAX;

/// Scales the numbers so that they sum to 1, unless all are zero.
fn normalise(shares: &mut [f64]) {
    let total: f64 = shares.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    shares.iter_mut().for_each(|share| *share /= total);
}

/// Whether a ReLU with these bounds is neither always on nor always off.
pub(super) fn is_unstable((l, u): NeuronBounds) -> bool {
    l < 0.0 && u > 0.0
}
