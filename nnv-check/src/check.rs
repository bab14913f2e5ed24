//! The independent checker of proofs.
//!
//! It shares no bound propagation with the prover: it walks a proof's tree and bounds every
//! neuron of every region by the textbook backward pass of DeepPoly (Singh et al. 2019), layer by
//! layer with dense matrices, takes nothing from the proof but the cuts and the choice of weights,
//! multipliers and slopes (any choice is sound, so a wrong one can only fail), and insists on a
//! positive bound. Where rounding or a looser bound leaves a recorded refutation open, it halves
//! the box itself, a few times at most.

mod bounds;
mod form;

use super::enclosure::AffineEnclosure;
use super::model::Network;
use super::proof::{Cell, Proof, Refutation, Split};
use super::property::{Conjunction, InputBox, Query};
use bounds::Bounds;
use form::Form;

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
    let mut pending = vec![Region {
        cell: 0,
        bounds: Bounds::new(network, inputs, query.region.clone()),
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

/// Bounds of all pre-activations on a box, layer by layer, by the checker's dense pass.
///
/// `inputs`, if given, encloses the network's inputs on the box; else the box is the inputs'.
#[must_use]
pub fn neuron_bounds(
    network: &Network,
    inputs: Option<InputMap<'_>>,
    region: InputBox,
) -> Vec<Vec<(f64, f64)>> {
    let mut bounds = Bounds::new(network, inputs, region);
    // Without assumed phases the bounds cannot contradict each other.
    let _ = bounds.tighten(network);
    bounds.layers
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
