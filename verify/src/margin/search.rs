//! Branch and bound over the inputs: the box with the largest error is cut first.

use super::predicate::{Predicate, Region};
use super::rounded::Rounded;
use crate::interval::Interval;
use cede_controller::shield::Contract;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Boxes that are cut side by side: fixed, so that the result does not depend on the number of threads.
const ROUND: usize = 256;

/// How far a predicate's margin, as `f32` computes it, is from the real one, wherever that can turn a no into a yes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// For all inputs of the domain: at most so much (m). Shown.
    pub error: f64,
    /// The largest difference (m) that was met when single inputs were executed. Tested.
    pub seen: f64,
    /// The inputs for which no smaller bound was shown.
    pub worst: Region,
    /// Boxes of inputs that were bounded.
    pub boxes: u64,
}

impl Bound {
    /// Whether a margin that `f32` finds not negative is not negative in the reals before `slack` (m) is taken off it.
    #[must_use]
    pub fn covered_by(&self, slack: f32) -> bool {
        self.error <= slack.into()
    }
}

/// Bounds what rounding does to `predicate` on its whole domain, with about so many `boxes`.
///
/// The same on any number of threads. Cost: some microseconds a box. Never panics.
#[must_use]
pub fn bound(predicate: Predicate, contract: &Contract, boxes: u64) -> Bound {
    let domain = predicate.domain(contract);
    let subject = Subject {
        predicate,
        contract,
    };
    let mut bounded = 1;
    let mut seen = subject.executed(domain);
    let mut open = BinaryHeap::from_iter(subject.piece(domain));
    // Pieces that cannot be cut; one is enough.
    let mut settled: Option<Piece> = None;
    while bounded < boxes && !open.is_empty() {
        let round: Vec<Piece> = (0..ROUND).filter_map(|_| open.pop()).collect();
        let cuts: Vec<Cut> = round.into_par_iter().map(|p| subject.cut(p)).collect();
        for cut in cuts {
            bounded += cut.bounded;
            seen = seen.max(cut.seen);
            match cut.pieces {
                Some(pieces) => open.extend(pieces.into_iter().flatten()),
                None => settled = settled.max(Some(cut.whole)),
            }
        }
    }
    let worst = settled.max(open.pop());
    Bound {
        error: worst.map_or(0.0, |piece| piece.error),
        seen,
        worst: worst.map_or(domain, |piece| piece.region),
        boxes: bounded,
    }
}

/// A box on which rounding may matter, and the largest error there.
#[derive(Clone, Copy, Debug)]
struct Piece {
    error: f64,
    region: Region,
}

impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        let ends = self.region.as_flattened().iter();
        let by_place = || {
            let pairs = ends.zip(other.region.as_flattened());
            pairs.fold(Ordering::Equal, |o, (a, b)| o.then(a.total_cmp(b)))
        };
        self.error.total_cmp(&other.error).then_with(by_place)
    }
}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Piece {}

/// A half of a piece, and the piece that it is if rounding may matter on it.
type Half = (Region, Option<Piece>);

/// What became of a piece.
struct Cut {
    whole: Piece,
    /// Its halves, those on which rounding may matter; none if it cannot be cut.
    pieces: Option<[Option<Piece>; 2]>,
    bounded: u64,
    seen: f64,
}

struct Subject<'c> {
    predicate: Predicate,
    contract: &'c Contract,
}

impl Subject<'_> {
    fn margin(&self, region: Region) -> Rounded {
        let inputs = region.map(Rounded::input);
        self.predicate.margin(self.contract, inputs)
    }

    /// The box, unless rounding cannot matter on it: `f32` certainly says no, or yes is certainly right.
    fn piece(&self, region: Region) -> Option<Piece> {
        let margin = self.margin(region);
        let refused = (margin.exact.hi + margin.error).next_up() < 0.0;
        let without_slack = margin.exact.lo + f64::from(self.contract.slack());
        let right = without_slack.next_down() >= 0.0;
        let matters = !(refused || right);
        matters.then_some(Piece {
            error: margin.error,
            region,
        })
    }

    /// Cuts a piece in two, across the input for which the errors of the two halves are least together; one without a
    /// bound across the input that is in its way.
    fn cut(&self, whole: Piece) -> Cut {
        let inputs = match self.in_the_way(&whole) {
            Some(input) => input..input + 1,
            None => 0..self.predicate.inputs().len(),
        };
        let cuts: Vec<[Half; 2]> = inputs
            .filter_map(|input| halves(whole.region, input))
            .map(|halves| halves.map(|region| (region, self.piece(region))))
            .collect();
        let error = |(_, piece): &Half| piece.map_or(0.0, |piece| piece.error);
        let both = |halves: &[Half; 2]| error(&halves[0]) + error(&halves[1]);
        let best = cuts.iter().min_by(|a, b| both(a).total_cmp(&both(b)));
        let matter = best.iter().flat_map(|halves| halves.iter());
        let matter = matter.filter(|(_, piece)| piece.is_some());
        Cut {
            whole,
            pieces: best.map(|halves| halves.map(|(_, piece)| piece)),
            bounded: 2 * cuts.len() as u64,
            seen: matter.fold(0.0, |most, (region, _)| self.executed(*region).max(most)),
        }
    }

    /// Of a piece without a bound: the input that takes it away, if the ranges of the inputs are let in one by one, the
    /// narrowest beside its domain first. None if its middle has no bound, or that input cannot be cut.
    ///
    /// The errors of the halves tell nothing here: one half of an input may not be enough.
    fn in_the_way(&self, whole: &Piece) -> Option<usize> {
        if whole.error.is_finite() {
            return None;
        }
        let (region, domain) = (whole.region, self.predicate.domain(self.contract));
        let width = |[lo, hi]: [f32; 2]| hi - lo;
        let share = |&input: &usize| width(region[input]) / width(domain[input]);
        let mut inputs: Vec<usize> = (0..self.predicate.inputs().len()).collect();
        inputs.sort_by(|a, b| share(a).total_cmp(&share(b)));
        let mut let_in = region.map(|range| [middle(range); 2]);
        let bounded = |region| self.margin(region).error.is_finite();
        if !bounded(let_in) {
            return None;
        }
        let found = inputs.into_iter().find(|&input| {
            let_in[input] = region[input];
            !bounded(let_in)
        });
        found.filter(|&input| halves(region, input).is_some())
    }

    /// How far `f32` is from the reals in the middle of the box.
    fn executed(&self, region: Region) -> f64 {
        let at = region.map(middle);
        let computed = f64::from(self.predicate.margin(self.contract, at));
        let points = at.map(|x| Interval::point(x.into()));
        let exact = self.predicate.margin(self.contract, points);
        (exact.lo - computed).max(computed - exact.hi).max(0.0)
    }
}

fn middle([lo, hi]: [f32; 2]) -> f32 {
    0.5 * lo + 0.5 * hi
}

/// The halves of a box across one input, unless there is no number between its ends.
fn halves(region: Region, input: usize) -> Option<[Region; 2]> {
    let at = middle(region[input]);
    let [lo, hi] = region[input];
    (lo < at && at < hi).then(|| {
        let (mut below, mut above) = (region, region);
        below[input] = [lo, at];
        above[input] = [at, hi];
        [below, above]
    })
}
