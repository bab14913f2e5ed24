//! The independent checker of proofs.
//!
//! It shares no bound propagation with the prover: it walks a proof's tree and bounds every
//! neuron of every region by the textbook backward pass of DeepPoly (Singh et al. 2019), layer by
//! layer with dense matrices, takes nothing from the proof but the cuts and the choice of weights,
//! multipliers and slopes (any choice is sound, so a wrong one can only fail), and insists on a
//! positive bound. Where rounding or a looser bound leaves a recorded refutation open, it halves
//! the box itself, a few times at most.

use super::feature::Feature;
use super::model::{Activation, Layer, Network};
use super::proof::{Cell, Proof, Refutation, Split};
use super::property::{Conjunction, InputBox, Query};

/// Why a proof does not convince.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CheckError {
    /// The tree refers to something that is not there.
    #[error("region {cell}: {what}")]
    Malformed {
        /// Index of the region.
        cell: usize,
        /// What is wrong.
        what: &'static str,
    },
    /// A conjunction is nowhere refuted on a region.
    #[error("region {cell}: conjunction {conjunction} is not refuted")]
    Unproved {
        /// Index of the region.
        cell: usize,
        /// Index of the conjunction.
        conjunction: u32,
    },
    /// A recorded refutation does not hold.
    #[error(
        "region {cell}: conjunction {conjunction} is only bounded by {bound}, which is not positive"
    )]
    Unsound {
        /// Index of the region.
        cell: usize,
        /// Index of the conjunction.
        conjunction: u32,
        /// The bound that the checker finds.
        bound: f64,
    },
}

/// How often a box may be halved in the attempt to confirm a refutation.
const HALVINGS: u32 = 6;

/// Checks that a proof shows that the query has no solution; gives the number of regions.
///
/// Cost: a dense backward pass for every neuron of every region, far more than the prover's.
///
/// # Errors
/// The first region that does not convince.
pub fn check(network: &Network, query: &Query, proof: &Proof) -> Result<usize, CheckError> {
    check_behind(network, None, query, proof)
}

/// What the network is given on a box of other variables, as linear functions of those.
pub type Front<'a> = &'a dyn Fn(&InputBox) -> Vec<Feature>;

/// As [`check`], for a network whose inputs are features of the query's variables.
pub fn check_behind(
    network: &Network,
    front: Option<Front<'_>>,
    query: &Query,
    proof: &Proof,
) -> Result<usize, CheckError> {
    let mut pending = vec![Region {
        cell: 0,
        bounds: Bounds::new(network, front, query.region.clone()),
        phases: Vec::new(),
        open: (0_u32..).take(query.unsafe_set.len()).collect(),
    }];
    let mut regions = 0;
    while let Some(mut region) = pending.pop() {
        regions += 1;
        let cell = proof.cells.get(region.cell);
        let cell = cell.ok_or(CheckError::Malformed {
            cell: region.cell,
            what: "is missing",
        })?;
        if region.settle(network, query, cell)? {
            continue;
        }
        match cell.split {
            Some((split, first)) => pending.extend(region.halves(split, first as usize)?),
            None => {
                let conjunction = region.open[0];
                return Err(CheckError::Unproved {
                    cell: region.cell,
                    conjunction,
                });
            }
        }
    }
    Ok(regions)
}

#[derive(Clone)]
struct Region<'a> {
    cell: usize,
    bounds: Bounds<'a>,
    phases: Vec<(usize, bool)>,
    open: Vec<u32>,
}

impl Region<'_> {
    /// Confirms what the cell claims; true if nothing is left open.
    fn settle(
        &mut self,
        network: &Network,
        query: &Query,
        cell: &Cell,
    ) -> Result<bool, CheckError> {
        let consistent = self.bounds.tighten(network);
        if cell.empty || !consistent {
            let what = "is said to be empty, but is not";
            return if consistent {
                Err(CheckError::Malformed {
                    cell: self.cell,
                    what,
                })
            } else {
                Ok(true)
            };
        }
        for claim in &cell.refuted {
            let conjunction = query.unsafe_set.get(claim.conjunction as usize);
            let usable = conjunction.is_some_and(|c| c.len() == claim.weights.len())
                && claim
                    .weights
                    .iter()
                    .chain(claim.multipliers.iter().map(|(_, m)| m))
                    .all(|&w| w >= 0.0)
                && claim.slopes.iter().all(|(_, s)| (0.0..=1.0).contains(s));
            let (Some(conjunction), true) = (conjunction, usable) else {
                return Err(CheckError::Malformed {
                    cell: self.cell,
                    what: "has a refutation that does not fit",
                });
            };
            self.confirm(network, conjunction, claim, HALVINGS)?;
            self.open.retain(|&c| c != claim.conjunction);
        }
        Ok(self.open.is_empty())
    }

    /// Confirms a refutation, on the halves of the box if not on the whole.
    fn confirm(
        &self,
        network: &Network,
        conjunction: &Conjunction,
        claim: &Refutation,
        halvings: u32,
    ) -> Result<(), CheckError> {
        let bound = self.refute(network, conjunction, claim);
        if bound > 0.0 {
            return Ok(());
        }
        let InputBox { lower, upper } = &self.bounds.region;
        let widest = (0..lower.len())
            .max_by(|&a, &b| (upper[a] - lower[a]).total_cmp(&(upper[b] - lower[b])));
        let (Some(input), true) = (widest, halvings > 0) else {
            return Err(CheckError::Unsound {
                cell: self.cell,
                conjunction: claim.conjunction,
                bound,
            });
        };
        let at = 0.5 * (lower[input] + upper[input]);
        for above in [false, true] {
            let mut half = self.clone();
            let side = if above {
                &mut half.bounds.region.lower
            } else {
                &mut half.bounds.region.upper
            };
            side[input] = at;
            if half.bounds.tighten(network) {
                half.confirm(network, conjunction, claim, halvings - 1)?;
            }
        }
        Ok(())
    }

    /// A lower bound of the claim's weighted sum of excesses on the region.
    fn refute(&self, network: &Network, conjunction: &Conjunction, claim: &Refutation) -> f64 {
        let mut form = Form::zero(network.outputs());
        for (atom, &weight) in conjunction.iter().zip(&claim.weights) {
            form.add(&atom.coefficients, -atom.bound, weight);
        }
        let multiplier = |neuron: usize| {
            let sign = self
                .phases
                .iter()
                .find(|p| p.0 == neuron)
                .map(|p| if p.1 { -1.0 } else { 1.0 });
            let size = claim
                .multipliers
                .iter()
                .find(|m| m.0 as usize == neuron)
                .map(|m| m.1);
            sign.unwrap_or(0.0) * size.unwrap_or(0.0)
        };
        let slope = |neuron: usize| {
            claim
                .slopes
                .iter()
                .find(|s| s.0 as usize == neuron)
                .map(|s| s.1)
        };
        self.bounds
            .least(network, network.layers().len(), form, slope, multiplier)
    }

    /// The two parts of the region that a split makes.
    fn halves(self, split: Split, first: usize) -> Result<[Self; 2], CheckError> {
        let malformed = CheckError::Malformed {
            cell: self.cell,
            what: "has a split that does not fit",
        };
        // Children stand behind their parent, so the walk ends.
        if first <= self.cell {
            return Err(malformed);
        }
        let (mut one, mut two) = (self.clone(), self);
        (one.cell, two.cell) = (first, first + 1);
        match split {
            Split::Input { input, at } => {
                let index = input as usize;
                let fits = one
                    .bounds
                    .region
                    .lower
                    .get(index)
                    .is_some_and(|&lo| lo <= at)
                    && one
                        .bounds
                        .region
                        .upper
                        .get(index)
                        .is_some_and(|&hi| at <= hi);
                if !fits {
                    return Err(malformed);
                }
                one.bounds.region.upper[index] = at;
                two.bounds.region.lower[index] = at;
            }
            Split::Phase { neuron } => {
                let neuron = neuron as usize;
                if one
                    .bounds
                    .assume(neuron, true)
                    .and(two.bounds.assume(neuron, false))
                    .is_none()
                {
                    return Err(malformed);
                }
                one.phases.push((neuron, true));
                two.phases.push((neuron, false));
            }
        }
        Ok([one, two])
    }
}

/// A linear form c·x + constant, with bounds on what rounding has cost so far.
struct Form {
    coefficients: Vec<f64>,
    /// How far each coefficient may be off; charged where the values it multiplies are known.
    doubts: Vec<f64>,
    constant: f64,
    error: f64,
}

/// Relative error allowed for every operation: eight times the unit roundoff.
const ULP: f64 = 4.0 * f64::EPSILON;
/// Allowance for underflow in each operation.
const TINY: f64 = 1e-290;

impl Form {
    fn zero(length: usize) -> Self {
        Self {
            coefficients: vec![0.0; length],
            doubts: vec![0.0; length],
            constant: 0.0,
            error: 0.0,
        }
    }

    /// Adds factor·(row, constant).
    fn add(&mut self, row: &[f64], constant: f64, factor: f64) {
        for ((sum, doubt), c) in self.coefficients.iter_mut().zip(&mut self.doubts).zip(row) {
            *sum += factor * c;
            *doubt += ULP * (sum.abs() + (factor * c).abs());
        }
        self.constant += factor * constant;
        self.error += ULP * (self.constant.abs() + (factor * constant).abs());
    }
}

/// A box and bounds of all pre-activations, layer by layer.
#[derive(Clone)]
pub struct Bounds<'a> {
    /// The box.
    pub region: InputBox,
    front: Option<Front<'a>>,
    /// What the front gives on the region.
    features: Vec<Feature>,
    /// Least and greatest value of each pre-activation.
    pub layers: Vec<Vec<(f64, f64)>>,
    /// Which bounds are assumptions about a ReLU's phase, and stay.
    first: Vec<Option<usize>>,
}

impl<'a> Bounds<'a> {
    /// A box before anything is known of the pre-activations; the network's inputs are features of
    /// its variables where there is a front.
    #[must_use]
    pub fn new(network: &Network, front: Option<Front<'a>>, region: InputBox) -> Self {
        let mut count = 0;
        let first = network.layers().iter().map(|layer| {
            let start = (layer.activation != Activation::Identity).then_some(count);
            count += start.map_or(0, |_| layer.outputs());
            start
        });
        let first = first.collect();
        let unbounded = |layer: &Layer| vec![(f64::NEG_INFINITY, f64::INFINITY); layer.outputs()];
        Self {
            region,
            front,
            features: Vec::new(),
            layers: network.layers().iter().map(unbounded).collect(),
            first,
        }
    }

    /// Assumes a phase of a ReLU.
    fn assume(&mut self, neuron: usize, on: bool) -> Option<()> {
        let (layer, first) = self
            .first
            .iter()
            .enumerate()
            .filter_map(|(i, f)| f.map(|f| (i, f)))
            .rfind(|(_, f)| *f <= neuron)?;
        let (l, u) = self.layers[layer].get_mut(neuron - first)?;
        if on {
            *l = l.max(0.0);
        } else {
            *u = u.min(0.0);
        }
        Some(())
    }

    /// Tightens all bounds to the box; false if they contradict each other.
    pub fn tighten(&mut self, network: &Network) -> bool {
        self.features = self
            .front
            .map_or_else(Vec::new, |front| front(&self.region));
        for (index, layer) in network.layers().iter().enumerate() {
            for i in 0..layer.outputs() {
                let (l, u) = self.layers[index][i];
                if layer.activation == Activation::Relu && (l >= 0.0 || u <= 0.0) {
                    continue;
                }
                let side = |sign: f64| {
                    let mut form = Form::zero(layer.inputs());
                    form.add(layer.weights.row(i), layer.bias[i], sign);
                    // The row is exact but for its own uncertainty.
                    form.error +=
                        layer.uncertainty * self.reach(network, index, layer.weights.row(i));
                    self.least(network, index, form, |_| None, |_| 0.0)
                };
                let (l, u) = (l.max(side(1.0)), u.min(-side(-1.0)));
                if l > u {
                    return false;
                }
                self.layers[index][i] = (l, u);
            }
        }
        true
    }

    /// Largest |row·x| by interval arithmetic over what layer `index` takes.
    fn reach(&self, network: &Network, index: usize, row: &[f64]) -> f64 {
        row.iter()
            .enumerate()
            .map(|(j, w)| w.abs() * self.magnitude(network, index, j))
            .sum::<f64>()
            * (1.0 + 1e-9)
    }

    /// Largest absolute value of input j of layer `index`.
    fn magnitude(&self, network: &Network, index: usize, j: usize) -> f64 {
        if index == 0 {
            return match self.front {
                Some(_) => self.features[j].magnitude(&self.region),
                None => self.region.lower[j].abs().max(self.region.upper[j].abs()),
            };
        }
        let (l, u) = self.layers[index - 1][j];
        match network.layers()[index - 1].activation {
            Activation::Relu => u.max(0.0),
            Activation::Identity => l.abs().max(u.abs()),
            Activation::Tanh => 1.0,
        }
    }

    /// A lower bound of a form over what layer `index` takes: back through the layers before it,
    /// each activation replaced by a line, then over the box. `slope` may choose lower slopes of
    /// ReLUs; `multiplier` adds multiples of pre-activations.
    fn least(
        &self,
        network: &Network,
        index: usize,
        mut form: Form,
        slope: impl Fn(usize) -> Option<f64>,
        multiplier: impl Fn(usize) -> f64,
    ) -> f64 {
        let doubts = form.doubts.iter().enumerate();
        form.error += doubts
            .map(|(j, d)| d * self.magnitude(network, index, j))
            .sum::<f64>()
            * (1.0 + 1e-9);
        for (depth, layer) in network.layers()[..index].iter().enumerate().rev() {
            let first = self.first[depth];
            let mut before = Form::zero(layer.inputs());
            (before.constant, before.error) = (form.constant, form.error);
            let mut sizes = vec![0.0; layer.inputs()];
            for (j, &c) in form.coefficients.iter().enumerate() {
                let bounds = self.layers[depth][j];
                let (factor, offset) = line(
                    layer.activation,
                    bounds,
                    c,
                    first.and_then(|f| slope(f + j)),
                );
                let lambda = first.map_or(0.0, |f| multiplier(f + j));
                let total = factor + lambda;
                before.constant += offset + total * layer.bias[j];
                before.error += ULP
                    * (before.constant.abs()
                        + offset.abs()
                        + (total * layer.bias[j]).abs()
                        + (factor.abs() + lambda.abs() + c.abs())
                            * bounds.0.abs().max(bounds.1.abs()));
                if total == 0.0 {
                    continue;
                }
                let row = layer.weights.row(j);
                for ((sum, size), w) in before.coefficients.iter_mut().zip(&mut sizes).zip(row) {
                    *sum += total * w;
                    *size += (total * w).abs();
                }
            }
            // Each coefficient was summed from so many products.
            let terms = form.coefficients.len() as f64 * ULP + layer.uncertainty;
            let reach = sizes
                .iter()
                .enumerate()
                .map(|(i, s)| s * self.magnitude(network, depth, i));
            before.error += terms * reach.sum::<f64>() + TINY;
            form = before;
        }
        if self.front.is_some() {
            form = self.before_features(&form);
        }
        let mut least = form.constant;
        let mut size = least.abs();
        for ((&c, &lo), &hi) in form
            .coefficients
            .iter()
            .zip(&self.region.lower)
            .zip(&self.region.upper)
        {
            let term = (c * lo).min(c * hi);
            least += term;
            size += term.abs();
        }
        let terms = form.coefficients.len() as f64 * ULP;
        least - (form.error + terms * size) * (1.0 + 1e-9) - TINY
    }
}

impl Bounds<'_> {
    /// The form over the variables that bounds a form over the features from below.
    fn before_features(&self, form: &Form) -> Form {
        let mut before = Form::zero(self.region.lower.len());
        before.error = form.error;
        before.constant = form.constant;
        let mut sizes = form.constant.abs();
        for (feature, &c) in self.features.iter().zip(&form.coefficients) {
            before.add(&feature.slopes, feature.constant, c);
            before.constant -= c.abs() * feature.radius;
            sizes += c.abs() * (feature.magnitude(&self.region) + feature.radius);
        }
        let sides = self.region.lower.iter().zip(&self.region.upper);
        let reach = before.doubts.iter().zip(sides);
        let doubt: f64 = reach.map(|(d, (lo, hi))| d * lo.abs().max(hi.abs())).sum();
        before.error += doubt * (1.0 + 1e-9) + self.features.len() as f64 * ULP * sizes;
        before
    }
}

/// For c·f(z) with z in the bounds: (factor, offset) with factor·z + offset ≤ c·f(z).
fn line(activation: Activation, (l, u): (f64, f64), c: f64, slope: Option<f64>) -> (f64, f64) {
    match activation {
        Activation::Identity => (c, 0.0),
        Activation::Relu if u <= 0.0 => (0.0, 0.0),
        Activation::Relu if l >= 0.0 => (c, 0.0),
        Activation::Relu if c >= 0.0 => {
            let usual = if u + l > 0.0 { 1.0 } else { 0.0 };
            (c * slope.unwrap_or(usual), 0.0)
        }
        Activation::Relu => {
            // The chord from (l, 0) to (u, u), raised until it clears both ends.
            let chord = (u / (u - l)).min(1.0);
            (c * chord, c * (-(chord * l)).max(u - chord * u))
        }
        Activation::Tanh => {
            let (low, high) = (l.tanh(), u.tanh());
            let flattest = ((1.0 - low * low).min(1.0 - high * high) - 1e-9).max(0.0);
            let offset = if c >= 0.0 {
                low - flattest * l - 1e-14
            } else {
                high - flattest * u + 1e-14
            };
            (c * flattest, c * offset)
        }
    }
}
