//! The independent checker of proofs.
//!
//! It shares no bound propagation with the prover: it walks a proof's tree and bounds every
//! neuron of every region by the textbook backward pass of DeepPoly (Singh et al. 2019), layer by
//! layer with dense matrices, takes nothing from the proof but the cuts, which bounds of a larger region to keep, and the choice of
//! weights, multipliers and slopes (any choice is sound, so a wrong one can only fail), and insists on a
//! bound that contradicts the conjunction.
//!
//! The pass is written once, for intervals rounded outward and for exact numbers. Where intervals
//! leave a recorded refutation open, exact numbers decide; where those do, too, it halves the box
//! itself, a number of times at most.

mod bounds;
mod number;

use super::dyadic::Dyadic;
use super::enclosure::AffineEnclosure;
use super::interval::Interval;
use super::model::Network;
use super::proof::{Cell, Proof, Refutation, Split, Tightening};
use super::property::{Halfspace, InputBox, Query};
use bounds::{Bounds, Choice, Form, Layers, Least, Range, Side, assume};
use num_bigint::BigInt;
use num_integer::Integer as _;
use num_rational::BigRational;
use num_traits::One as _;
use number::Number;
use std::cmp::Ordering;

/// Why a proof does not convince.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
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
        "region {cell}: conjunction {conjunction} is only bounded by {bound:e}, which does not refute it"
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

/// How often a box may be halved in the attempt to confirm a refutation, and how many boxes.
const HALVINGS: u32 = 30;
const MOST_HALVES: u32 = 1000;
/// Products of large integers that an exact pass may take.
const MOST_EXACT: usize = 1 << 20;
/// Bits of the common denominator of a box's exact limits.
const MOST_BITS: u64 = 1 << 13;

/// Checks that a proof shows that the query has no solution; gives the number of regions.
///
/// Cost: a dense backward pass for every neuron of every region, far more than the prover's.
///
/// # Errors
/// The first region that does not convince.
pub fn check(network: &Network, query: &Query, proof: &Proof) -> Result<usize, CheckError> {
    check_composed(network, None, query, proof)
}

/// Encloses each of a network's inputs on a box of other variables by linear functions of those.
pub type InputMap<'a> = &'a dyn Fn(&InputBox) -> Vec<AffineEnclosure>;

/// As [`check`], for a network whose inputs are functions of the query's variables.
pub fn check_composed(
    network: &Network,
    inputs: Option<InputMap<'_>>,
    query: &Query,
    proof: &Proof,
) -> Result<usize, CheckError> {
    let subject = Subject {
        network,
        inputs,
        query,
    };
    let mut pending = vec![Region {
        subject: &subject,
        cell: 0,
        region: query.region.clone(),
        known: subject.bounds(&query.region).layers,
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
        if region.settle(cell)? {
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

/// Bounds of the pre-activations of all neurons with an activation on a box, layer by layer, by
/// the checker's dense pass; infinite where nothing is known, and for the others.
///
/// `inputs`, if given, encloses the network's inputs on the box; else the box is the inputs'.
#[must_use]
pub fn neuron_bounds(
    network: &Network,
    inputs: Option<InputMap<'_>>,
    region: InputBox,
) -> Vec<Vec<(f64, f64)>> {
    let query = Query::new(region, Vec::new());
    let subject = Subject {
        network,
        inputs,
        query: &query,
    };
    let mut bounds = subject.bounds(&query.region);
    // Without assumed phases the bounds cannot contradict each other.
    let _ = bounds.tighten();
    let ends = |range: &Range<Interval>| {
        let lower = range.lower.map_or(f64::NEG_INFINITY, |l| l.lo);
        (lower, range.upper.map_or(f64::INFINITY, |u| u.hi))
    };
    let layers = bounds.layers.iter();
    layers
        .map(|layer| layer.iter().map(ends).collect())
        .collect()
}

/// Whether exact arithmetic shows that a claim holds on a part of the query's box, on which these
/// phases are assumed (neuron, on or off). Bounds that are met exactly are decided, strict
/// constraints told from closed ones. False where it would take too long, or where the network
/// [is not exact](Network::is_exact).
#[must_use]
pub fn refutes_exactly(
    network: &Network,
    query: &Query,
    region: &InputBox,
    phases: &[(u32, bool)],
    claim: &Refutation,
) -> bool {
    let subject = Subject {
        network,
        inputs: None,
        query,
    };
    let phases: Vec<_> = phases.iter().map(|&(n, on)| (n as usize, on)).collect();
    query
        .unsafe_set
        .get(claim.conjunction as usize)
        .filter(|conjunction| fits(claim, conjunction))
        .is_some_and(|_| subject.refutes_exactly(region, &phases, None, claim))
}

/// Whether [`check`] will confirm a claim on this part of the query's box, whatever else it knows of
/// it; without a claim, that the region is empty. `None` for networks so large that to ask takes
/// long.
#[must_use]
pub fn confirms(
    network: &Network,
    query: &Query,
    region: &InputBox,
    phases: &[(u32, bool)],
    claim: Option<&Refutation>,
) -> Option<bool> {
    let subject = Subject {
        network,
        inputs: None,
        query,
    };
    let phases: Vec<_> = phases.iter().map(|&(n, on)| (n as usize, on)).collect();
    let moderate = subject.products() <= MOST_EXACT;
    moderate.then(|| subject.confirms(region, &phases, claim.unwrap_or(&NOTHING)))
}

/// A claim that refutes nothing but an empty region.
const NOTHING: Refutation = Refutation {
    conjunction: 0,
    weights: Vec::new(),
    multipliers: Vec::new(),
    slopes: Vec::new(),
    bound: 0.0,
};

/// Whether a claim's numbers are such that it proves something.
fn fits(claim: &Refutation, conjunction: &[Halfspace]) -> bool {
    conjunction.len() == claim.weights.len()
        && claim.weights.iter().all(usable)
        && are_sound(&claim.multipliers, &claim.slopes)
}

fn usable(weight: &f64) -> bool {
    weight.is_finite() && *weight >= 0.0
}

fn are_sound(multipliers: &[(u32, f64)], slopes: &[(u32, f64)]) -> bool {
    multipliers.iter().all(|(_, m)| usable(m))
        && slopes.iter().all(|(_, s)| (0.0..=1.0).contains(s))
}

/// What a proof is about.
struct Subject<'a> {
    network: &'a Network,
    inputs: Option<InputMap<'a>>,
    query: &'a Query,
}

impl Subject<'_> {
    /// A box in intervals, before anything is known of the neurons.
    fn bounds(&self, region: &InputBox) -> Bounds<'_, Interval> {
        let side = |value: f64| Side {
            value: Interval::point(value),
            strict: false,
        };
        let sides = region.lower.iter().zip(&region.upper);
        Bounds::new(
            self.network,
            sides.map(|(&lo, &hi)| [side(lo), side(hi)]).collect(),
            Interval::point(1.0),
            self.inputs.map(|inputs| inputs(region)),
        )
    }

    /// A box in exact numbers, with the query's exact limits where it reaches them.
    fn exact_bounds(&self, region: &InputBox) -> Bounds<'_, Dyadic> {
        let InputBox { lower, upper } = &self.query.region;
        let reached = self.query.limits.iter().filter(|limit| {
            let i = limit.input;
            if limit.upper {
                region.upper[i] == upper[i]
            } else {
                region.lower[i] == lower[i]
            }
        });
        let mut unit = BigInt::one();
        let mut limits = Vec::new();
        for limit in reached {
            let common = unit.lcm(limit.value.denom());
            if common.bits() <= MOST_BITS {
                unit = common;
                limits.push(limit);
            }
        }
        let scale = Dyadic::from(unit.clone());
        let side = |&value: &f64| Side {
            value: <Dyadic as Number>::of(value).times(&scale),
            strict: false,
        };
        let sides = region.lower.iter().zip(&region.upper);
        let mut sides: Vec<[Side<Dyadic>; 2]> =
            sides.map(|(lo, hi)| [side(lo), side(hi)]).collect();
        for limit in limits {
            let whole: BigRational = &limit.value * &unit;
            sides[limit.input][usize::from(limit.upper)] = Side {
                value: Dyadic::from(whole.to_integer()),
                strict: limit.strict,
            };
        }
        Bounds::new(self.network, sides, scale, None)
    }

    /// Products that a pass over all neurons takes.
    fn products(&self) -> usize {
        let mut behind = 0;
        let mut products = 0_usize;
        for layer in self.network.layers() {
            products = products.saturating_add(layer.outputs().saturating_mul(behind));
            behind += layer.weights.data().len();
        }
        products
    }

    /// Whether exact numbers can decide, and in reasonable time.
    fn is_exact(&self) -> bool {
        self.inputs.is_none() && self.network.is_exact() && self.products() <= MOST_EXACT
    }

    /// Whether the claim holds by what a pass over this region alone shows.
    fn confirms(&self, region: &InputBox, phases: &[(usize, bool)], claim: &Refutation) -> bool {
        let mut bounds = self.bounds(region);
        for &(neuron, on) in phases {
            if assume(self.network, &mut bounds.layers, neuron, on).is_none() {
                return false;
            }
        }
        !bounds.tighten()
            || self.contradicts(&bounds, phases, claim).is_ok()
            || self.refutes_exactly(region, phases, None, claim)
    }

    /// See [`refutes_exactly`]; what is `known` of the neurons may help.
    fn refutes_exactly(
        &self,
        region: &InputBox,
        phases: &[(usize, bool)],
        known: Option<&Layers<Interval>>,
        claim: &Refutation,
    ) -> bool {
        if !self.is_exact() {
            return false;
        }
        let mut bounds = self.exact_bounds(region);
        for (layer, known) in bounds.layers.iter_mut().zip(known.into_iter().flatten()) {
            let exact =
                |end: Option<f64>| end.and_then(Dyadic::of).map(|end| end.times(&bounds.unit));
            for (range, known) in layer.iter_mut().zip(known) {
                range.lower = exact(known.lower.map(|l| l.lo));
                range.upper = exact(known.upper.map(|u| u.hi));
            }
        }
        for &(neuron, on) in phases {
            if assume(self.network, &mut bounds.layers, neuron, on).is_none() {
                return false;
            }
        }
        !bounds.tighten() || self.contradicts(&bounds, phases, claim).is_ok()
    }

    /// Confirms that the claim's weighted sum of excesses is nowhere what the conjunction asks of
    /// it.
    ///
    /// # Errors
    /// With the bound, if it is not.
    fn contradicts<N: Claimed>(
        &self,
        bounds: &Bounds<'_, N>,
        phases: &[(usize, bool)],
        claim: &Refutation,
    ) -> Result<(), Option<N>> {
        let conjunction = &self.query.unsafe_set[claim.conjunction as usize];
        let mut form = Form::<N>::zero(self.network.outputs());
        let mut strict = false;
        for (atom, &weight) in conjunction.iter().zip(&claim.weights) {
            if weight == 0.0 {
                continue;
            }
            strict |= atom.is_strict();
            let mut terms = N::atom(atom);
            let bound = terms.pop().unwrap_or_else(N::zero);
            let weight = N::of(weight);
            for (sum, c) in form.coefficients.iter_mut().zip(terms) {
                *sum = sum.plus(&weight.times(&c));
            }
            let constant = weight.times(&bound).times(&bounds.unit);
            form.constant = form.constant.plus(&constant.negated());
        }
        let claimed = Chosen {
            slopes: &claim.slopes,
            multipliers: &claim.multipliers,
            phases,
        };
        let Least {
            bound,
            strict: even,
        } = bounds
            .least(self.network.layers().len(), form, &claimed)
            .ok_or(None)?;
        match bound.sign() {
            Some(Ordering::Greater) => Ok(()),
            Some(Ordering::Equal) if strict || even => Ok(()),
            _ => Err(Some(bound)),
        }
    }
}

/// Numbers in which a constraint's coefficients can be had.
trait Claimed: Number {
    /// The coefficients, then the bound.
    fn atom(atom: &Halfspace) -> Vec<Self>;
}

impl Claimed for Interval {
    fn atom(atom: &Halfspace) -> Vec<Self> {
        atom.enclosed()
    }
}

impl Claimed for Dyadic {
    fn atom(atom: &Halfspace) -> Vec<Self> {
        atom.exact()
    }
}

/// The choices of a claim.
struct Chosen<'a> {
    slopes: &'a [(u32, f64)],
    multipliers: &'a [(u32, f64)],
    phases: &'a [(usize, bool)],
}

impl Choice for Chosen<'_> {
    fn slope(&self, neuron: usize) -> Option<f64> {
        self.slopes
            .iter()
            .find(|s| s.0 as usize == neuron)
            .map(|s| s.1)
    }

    fn multiplier(&self, neuron: usize) -> f64 {
        let phase = self.phases.iter().find(|p| p.0 == neuron);
        let size = self.multipliers.iter().find(|m| m.0 as usize == neuron);
        match (phase, size) {
            (Some((_, on)), Some((_, size))) => {
                if *on {
                    -size
                } else {
                    *size
                }
            }
            _ => 0.0,
        }
    }
}

#[derive(Clone)]
struct Region<'a> {
    subject: &'a Subject<'a>,
    cell: usize,
    region: InputBox,
    /// What is known of the neurons on a larger region, and of this one after [`Self::tighten`].
    known: Layers<Interval>,
    phases: Vec<(usize, bool)>,
    open: Vec<u32>,
}

impl<'a> Region<'a> {
    /// The bounds of the neurons on the region; `None` if they contradict each other.
    fn tighten(&mut self) -> Option<Bounds<'a, Interval>> {
        self.tighten_as(false, &[])
    }

    /// As [`Self::tighten`], or with those of the larger region `kept`, and then these.
    fn tighten_as(&mut self, kept: bool, tightened: &[Tightening]) -> Option<Bounds<'a, Interval>> {
        let mut bounds = self.subject.bounds(&self.region);
        bounds.layers.clone_from(&self.known);
        let phases = &self.phases;
        let consistent = (kept || bounds.tighten())
            && tightened.iter().all(|t| {
                let choice = Chosen {
                    slopes: &t.slopes,
                    multipliers: &t.multipliers,
                    phases,
                };
                bounds.tighten_side(t.neuron as usize, t.upper, &choice)
            });
        self.known.clone_from(&bounds.layers);
        consistent.then_some(bounds)
    }

    /// Confirms what the cell claims; true if nothing is left open.
    fn settle(&mut self, cell: &Cell) -> Result<bool, CheckError> {
        let malformed = |cell, what| CheckError::Malformed { cell, what };
        let sound = |t: &Tightening| are_sound(&t.multipliers, &t.slopes);
        if !cell.tightened.iter().all(sound) {
            return Err(malformed(self.cell, "has a bound that does not fit"));
        }
        let Some(bounds) = self.tighten_as(cell.kept, &cell.tightened) else {
            return Ok(true);
        };
        if cell.empty {
            let conjunctions = &self.subject.query.unsafe_set;
            let empty = |room| self.confirm(&bounds, &NOTHING, HALVINGS, room).is_ok();
            return if conjunctions.is_empty() || !empty(&mut { MOST_HALVES }) {
                Err(malformed(self.cell, "is said to be empty, but is not"))
            } else {
                Ok(true)
            };
        }
        for claim in &cell.refuted {
            let conjunction = self
                .subject
                .query
                .unsafe_set
                .get(claim.conjunction as usize);
            if !conjunction.is_some_and(|c| fits(claim, c)) {
                return Err(malformed(self.cell, "has a refutation that does not fit"));
            }
            self.confirm(&bounds, claim, HALVINGS, &mut { MOST_HALVES })?;
            self.open.retain(|&c| c != claim.conjunction);
        }
        Ok(self.open.is_empty())
    }

    /// Confirms a refutation, on the halves of the box if not on the whole: so deep at most, and so
    /// many in all.
    fn confirm(
        &self,
        bounds: &Bounds<'_, Interval>,
        claim: &Refutation,
        halvings: u32,
        room: &mut u32,
    ) -> Result<(), CheckError> {
        let Err(bound) = self.subject.contradicts(bounds, &self.phases, claim) else {
            return Ok(());
        };
        let Self {
            subject,
            region,
            known,
            phases,
            ..
        } = self;
        // Tighter bounds come to other slopes, which need not be better.
        if subject.refutes_exactly(region, phases, Some(known), claim)
            || subject.confirms(region, phases, claim)
        {
            return Ok(());
        }
        let (Some(input), true, Some(left)) = (self.widest(), halvings > 0, room.checked_sub(1))
        else {
            return Err(CheckError::Unsound {
                cell: self.cell,
                conjunction: claim.conjunction,
                bound: bound.map_or(f64::NEG_INFINITY, |b| b.lo),
            });
        };
        *room = left;
        let at = f64::midpoint(self.region.lower[input], self.region.upper[input]);
        for above in [false, true] {
            let mut half = self.clone();
            let side = if above {
                &mut half.region.lower
            } else {
                &mut half.region.upper
            };
            side[input] = at;
            if let Some(bounds) = half.tighten() {
                half.confirm(&bounds, claim, halvings - 1, room)?;
            }
        }
        Ok(())
    }

    /// The input whose side is the longest, compared with that of the query's box.
    fn widest(&self) -> Option<usize> {
        let InputBox { lower, upper } = &self.region;
        let whole = &self.subject.query.region;
        let share = |&i: &usize| {
            let share = (upper[i] - lower[i]) / (whole.upper[i] - whole.lower[i]);
            // A side without length, or of infinite length.
            if share.is_nan() { 0.0 } else { share }
        };
        (0..lower.len()).max_by(|a, b| share(a).total_cmp(&share(b)))
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
                let InputBox { lower, upper } = &one.region;
                let sides = lower.get(index).zip(upper.get(index));
                if !sides.is_some_and(|(&lo, &hi)| lo <= at && at <= hi) {
                    return Err(malformed);
                }
                one.region.upper[index] = at;
                two.region.lower[index] = at;
            }
            Split::Conjunction { index } => {
                one.open.retain(|&c| c == index);
                two.open.retain(|&c| c != index);
            }
            Split::Phase { neuron } => {
                let neuron = neuron as usize;
                for (half, on) in [(&mut one, true), (&mut two, false)] {
                    assume(half.subject.network, &mut half.known, neuron, on)
                        .ok_or(malformed.clone())?;
                    half.phases.push((neuron, on));
                }
            }
        }
        Ok([one, two])
    }
}
