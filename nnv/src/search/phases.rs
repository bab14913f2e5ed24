//! The search across phases: a region's bound is the best that its assumed phases and the choices of
//! slopes allow; the next phase is the one whose two sides gain the most.

use super::node::{split_pairs, split_phase};
use super::{Late, Node, Searcher, Step};
use crate::backward::{Frame, Least};
use crate::dual::Effort;
use crate::propagation::is_unstable;
use crate::relaxation::Lines;
use crate::side::Choice;
use cede_nnv_check::proof::{Cell, Split};
use std::sync::Arc;

/// Passes for a region whose parent leaves a choice to begin with, and for one without.
const PASSES: Effort = Effort {
    patient: false,
    ..Effort::again(24)
};
const FIRST_PASSES: Effort = Effort::afresh(60);
/// Phases that are tried before one is chosen.
const CANDIDATES: usize = 8;
/// What the gain of the better side counts beside that of the worse.
const GREATER: f64 = 0.1;

impl Searcher<'_> {
    /// Bounds one region, and splits it across a phase if that does not settle it.
    ///
    /// # Errors
    /// If the deadline passed.
    #[inline(always)]
    pub(super) fn step_by_phase(
        &mut self,
        frame: &Frame<'_>,
        mut node: Node,
        cell: &mut Cell,
    ) -> Result<Step, Late> {
        let problem = self.problem;
        cell.kept = problem.prepared.wide;
        if !problem.prepared.wide
            && let Some(step) = self.tighten(&mut node, &[], cell)?
        {
            return Ok(step);
        }
        if !node.bounds.iter().copied().any(is_unstable) {
            return self.step(node, cell);
        }
        let (mut open, mut undecided) = (Vec::new(), false);
        let (mut driver, mut worst) = (0, f64::INFINITY);
        for (k, &conjunction) in node.open.iter().enumerate() {
            let from = node.choices.get(k).map(|choice| &**choice);
            let least = self.bound(frame, &node, conjunction, from)?;
            if least.bound > 0.0 {
                if !problem.options.record {
                    continue;
                }
                let claim = self.dual.refutation(node.part(), conjunction, least.bound);
                // What the checker knows of a wide region is in the record.
                if cell.kept || self.is_confirmed(&node, Some(&claim)) {
                    cell.refuted.push(claim);
                    continue;
                }
            }
            undecided |= least.undecided;
            let candidate = self.dual.minimiser().to_vec();
            if let Some(witness) = self.witness_at(&candidate, conjunction) {
                return Ok(Step::Witness(witness));
            }
            if least.bound < worst {
                (worst, driver) = (least.bound, open.len());
            }
            open.push((conjunction, Arc::new(self.dual.choice.clone())));
        }
        (node.open, node.choices) = split_pairs(open);
        if node.open.is_empty() {
            return Ok(Step::Refuted);
        }
        // Where rounding may be all that is left, exact arithmetic may decide.
        if undecided {
            return self.step(node, cell);
        }
        self.enter(frame, &node, driver);
        let conjunction = node.open[driver];
        let Some(neuron) = self.best_phase(frame, &node, conjunction) else {
            return self.step(node, cell);
        };
        Ok(Step::Split(
            Split::Phase { neuron },
            split_phase(node, neuron).into(),
        ))
    }

    /// Returns to the choice that was found for one of the open conjunctions.
    #[inline(always)]
    pub(super) fn enter(&mut self, frame: &Frame<'_>, node: &Node, open: usize) {
        let atoms = self.problem.atoms_of(node.open[open]);
        let form = (frame.layers().len() - 1, atoms);
        self.dual.enter(
            frame,
            node.part(),
            Some(&node.choices[open]),
            std::iter::empty(),
        );
        self.dual.evaluate(frame, node.part(), &form);
    }

    /// The best bound of a conjunction on a region.
    #[inline(always)]
    pub(super) fn bound(
        &mut self,
        frame: &Frame<'_>,
        node: &Node,
        conjunction: u32,
        from: Option<&Choice>,
    ) -> Result<Least, Late> {
        let deadline = self.problem.deadline;
        let (part, atoms) = (node.part(), self.problem.atoms_of(conjunction));
        let form = (frame.layers().len() - 1, atoms.clone());
        let dual = &mut self.dual;
        let alone = |atom| (0..atoms.len()).map(move |i| f64::from(u8::from(i == atom)));
        dual.enter(frame, part, from, alone(0));
        if from.is_some() {
            return dual
                .bound(frame, part, &form, PASSES, deadline)
                .map_err(|_| Late);
        }
        let mut best = (f64::NEG_INFINITY, 0);
        for atom in 0..atoms.len() {
            dual.choice.weights = alone(atom).collect();
            let bound = dual.evaluate(frame, part, &form).bound;
            if bound > best.0 {
                best = (bound, atom);
            }
        }
        dual.choice.weights = alone(best.1).collect();
        dual.bound(frame, part, &form, FIRST_PASSES, deadline)
            .map_err(|_| Late)
    }

    /// Of the unstable ReLUs whose relaxation costs the most, the one whose better-bounded sides
    /// are best.
    #[inline(always)]
    pub(super) fn best_phase(
        &mut self,
        frame: &Frame<'_>,
        node: &Node,
        conjunction: u32,
    ) -> Option<u32> {
        let form = (frame.layers().len() - 1, self.problem.atoms_of(conjunction));
        let dual = &mut self.dual;
        let mut candidates = dual.costs(frame, form.0, &node.bounds);
        if candidates.is_empty() {
            // Only that the assumed phases contradict each other can be shown.
            dual.choice.multipliers.fill(1.0);
            dual.evaluate(frame, node.part(), &form);
            candidates = dual.costs(frame, form.0, &node.bounds);
        }
        candidates.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        candidates.truncate(CANDIDATES);
        let bound = dual.evaluate(frame, node.part(), &form).bound;
        let mut best: Option<(f64, usize)> = None;
        for &(neuron, _) in &candidates {
            let (lines, slope) = (dual.pass.lines[neuron], dual.choice.slopes[neuron]);
            let side = |on: f64| {
                dual.pass.lines[neuron] = Lines::straight(on);
                dual.choice.slopes[neuron] = on;
                dual.evaluate(frame, node.part(), &form).bound
            };
            let [a, b] = [0.0, 1.0].map(side);
            (dual.pass.lines[neuron], dual.choice.slopes[neuron]) = (lines, slope);
            let [a, b] = [a, b].map(|side| (side - bound).max(0.0).min(bound.abs()));
            let value = a.min(b) + GREATER * a.max(b);
            if best.is_none_or(|(most, _)| value > most) {
                best = Some((value, neuron));
            }
        }
        best.and_then(|(_, neuron)| u32::try_from(neuron).ok())
    }
}
