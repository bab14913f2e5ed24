//! Bound propagation behind a front of features, for whoever searches over something other than
//! the network's own inputs.

use super::objective::Ascent;
use super::propagation::{Interval, Prepared, Workspace};
use cede_nnv_check::Feature;
use cede_nnv_check::Network;
use cede_nnv_check::proof::Refutation;
use cede_nnv_check::{Halfspace, InputBox};

/// A network, and at most one constraint on its outputs, prepared for bounding.
pub struct Bounder {
    prepared: Prepared,
    atoms: Vec<usize>,
}

impl Bounder {
    /// Prepares a network, and the constraint that [`Worker::refute`] is to refute.
    #[must_use]
    pub fn new(network: &Network, atom: Option<&Halfspace>) -> Self {
        let atoms: Vec<&Halfspace> = atom.into_iter().collect();
        Self {
            prepared: Prepared::new(network, &atoms),
            atoms: (0..atoms.len()).collect(),
        }
    }

    /// Bounds of all neurons with an activation before anything is known.
    #[must_use]
    pub fn unbounded(&self) -> Box<[Interval]> {
        vec![(f64::NEG_INFINITY, f64::INFINITY); self.prepared.neurons].into()
    }

    /// Memory to bound with.
    #[must_use]
    pub fn worker(&self) -> Worker<'_> {
        Worker {
            bounder: self,
            workspace: Workspace::default(),
            ascent: Ascent::default(),
        }
    }
}

/// See [`Bounder::worker`].
pub struct Worker<'a> {
    bounder: &'a Bounder,
    workspace: Workspace,
    ascent: Ascent,
}

impl Worker<'_> {
    /// Tightens the bounds, which hold on a larger box, to this one.
    pub fn tighten(&mut self, region: &InputBox, features: &[Feature], bounds: &mut [Interval]) {
        let Bounder { prepared, atoms } = self.bounder;
        let workspace = &mut self.workspace;
        // Without assumed phases the bounds cannot contradict each other.
        let _ = pulp::Arch::new()
            .dispatch(|| workspace.bound(prepared, region, features, bounds, &[], atoms));
    }

    /// Shows that the constraint holds nowhere on the box that was bounded last, if it can.
    pub fn refute(&mut self, region: &InputBox) -> Option<Refutation> {
        let (workspace, ascent) = (&self.workspace, &mut self.ascent);
        let bound = pulp::Arch::new().dispatch(|| ascent.bound(workspace, region, 0..1));
        (bound > 0.0).then(|| ascent.refutation(workspace, 0, bound))
    }

    /// After a failed [`Self::refute`]: the point of the box where the relaxation is least, and
    /// in `scores` how much each variable is to blame.
    #[must_use]
    pub fn minimiser(&self, scores: &mut [f64]) -> Vec<f64> {
        let mut slacks = vec![0.0; self.workspace.symbols.count()];
        self.ascent.blame(&self.workspace, &mut slacks, scores);
        self.ascent.minimiser(scores.len()).to_vec()
    }

    /// Adds to `scores` how much of the unstable neurons' widths each variable brings about.
    pub fn widths(&self, scores: &mut [f64]) {
        for shares in self.workspace.shares.chunks_exact(scores.len()) {
            for (score, share) in scores.iter_mut().zip(shares) {
                *score += share;
            }
        }
    }
}
