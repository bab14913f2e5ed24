//! Bound propagation over variables of which a network's inputs are functions, for whoever searches
//! over those.

use super::objective::Ascent;
use super::propagation::{NeuronBounds, Prepared, Workspace};
use cede_nnv_check::proof::Refutation;
use cede_nnv_check::{AffineEnclosure, Halfspace, InputBox, Network};

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
    pub fn unbounded(&self) -> Box<[NeuronBounds]> {
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
    /// Tightens the bounds, which hold on a larger box, to this one, on which the network's inputs
    /// are enclosed as given; none given, the box is the inputs' own. Panics if there are neither
    /// as many enclosures as inputs nor none, or not as many bounds as [`Bounder::unbounded`] gives.
    pub fn tighten(
        &mut self,
        region: &InputBox,
        inputs: &[AffineEnclosure],
        bounds: &mut [NeuronBounds],
    ) {
        let Bounder { prepared, atoms } = self.bounder;
        let workspace = &mut self.workspace;
        // Without assumed phases the bounds cannot contradict each other.
        let _ = pulp::Arch::new()
            .dispatch(|| workspace.bound(prepared, region, inputs, bounds, &[], atoms, None));
    }

    /// Shows that the constraint holds nowhere on the box, which is the one that
    /// [`Self::tighten`] bounded last. `None` if it cannot, or if the bounder has no constraint.
    pub fn refute(&mut self, region: &InputBox) -> Option<Refutation> {
        if self.bounder.atoms.is_empty() {
            return None;
        }
        let (workspace, ascent) = (&self.workspace, &mut self.ascent);
        let bound = pulp::Arch::new().dispatch(|| ascent.bound(workspace, region, 0..1, None));
        let bound = bound.unwrap_or(f64::NEG_INFINITY);
        (bound > 0.0).then(|| ascent.refutation(workspace, 0, bound))
    }

    /// After a failed [`Self::refute`]: the point of the box where the relaxation is least, and
    /// in `scores` how much each variable is to blame. Panics without that call.
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
