//! The search across phases where bounding all neurons anew is dear: a region is first searched as it
//! is, for about as long as that takes. If that does not settle it, it is cut where the bounds of
//! other neurons gain the most, and those are found anew on both sides.

use super::node::{Node, split_input, split_pairs, split_phase};
use super::{Done, Found, Late, Problem, Searcher, Witness, graft};
use crate::attack::descend;
use crate::backward::Frame;
use crate::propagation::is_unstable;
use crate::refinement::{most_blamed, refine};
use cede_nnv_check::proof::{Cell, Proof, Split};
use std::sync::Arc;

/// Regions for a search with the bounds as they are.
const TRIAL: u64 = 60;

impl Searcher<'_> {
    /// Searches a region with the bounds as they are, and cuts it in two if that is not enough.
    pub(super) fn work_wide(&mut self, frame: &Frame<'_>, node: Node) -> Done {
        let mut done = Done {
            found: Found::Nothing,
            left: Vec::new(),
            cells: vec![Cell::default()],
            regions: 1,
        };
        if self.try_wide(frame, node, &mut done).is_err() {
            done.found = Found::TimeOut;
        }
        if !self.problem.options.record {
            done.cells.clear();
        }
        done
    }

    fn try_wide(&mut self, frame: &Frame<'_>, mut node: Node, done: &mut Done) -> Result<(), Late> {
        let problem = self.problem;
        let record = problem.options.record;
        let found;
        let mut refinement = &frame.refinement;
        if !node.phases.is_empty() {
            let part = (&node.region, &*node.phases);
            let refined = refine(frame, part, &mut node.bounds, record, problem.deadline);
            found = refined.map_err(|_| Late)?;
            refinement = &found;
            done.cells[0].kept = true;
        }
        let tightened = refinement
            .sides
            .iter()
            .filter_map(|side| side.record.clone());
        done.cells[0].tightened = tightened.collect();
        if refinement.empty {
            done.cells[0].empty = true;
            return Ok(());
        }
        // The ones that are nearest to being refuted first.
        let mut open = Vec::new();
        for (i, &conjunction) in node.open.iter().enumerate() {
            let from = node.choices.get(i).map(|choice| &**choice);
            let least = self.bound(frame, &node, conjunction, from)?;
            if least.bound <= 0.0
                && let Some(witness) = self.descend(&node, conjunction)?
            {
                done.found = Found::Witness(witness);
                return Ok(());
            }
            open.push((least.bound, conjunction, Arc::new(self.dual.choice.clone())));
        }
        open.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut cell = 0;
        let mut settled = 0;
        let hopeless = refinement.loose.is_some();
        for (bound, conjunction, choice) in &open {
            if hopeless && *bound <= 0.0 {
                break;
            }
            let mut alone = node.copy();
            alone.open = [*conjunction].into();
            alone.choices = [choice.clone()].into();
            let tried = self.work(alone, TRIAL);
            done.regions += tried.regions;
            match tried.found {
                Found::Nothing if tried.left.is_empty() => {}
                Found::Nothing | Found::Stuck => break,
                end => {
                    done.found = end;
                    return Ok(());
                }
            }
            settled += 1;
            if record {
                cell = self.settle(done, cell, *conjunction, tried, settled == open.len());
            }
        }
        open.drain(..settled);
        let Some((_, conjunction, _)) = open.first().cloned() else {
            return Ok(());
        };
        open.sort_by_key(|(_, conjunction, _)| *conjunction);
        let pairs = open
            .into_iter()
            .map(|(_, conjunction, choice)| (conjunction, choice));
        (node.open, node.choices) = split_pairs(pairs.collect());
        let driver = node
            .open
            .iter()
            .position(|&c| c == conjunction)
            .unwrap_or(0);
        self.enter(frame, &node, driver);
        let mut costs = self
            .dual
            .costs(frame, frame.layers().len() - 1, &node.bounds);
        if let Some(loose) = &refinement.loose {
            let open = loose.clone().filter(|&n| is_unstable(node.bounds[n]));
            costs = open.map(|n| (n, 1.0)).collect();
        } else if costs.is_empty() {
            costs = node.phases.iter().map(|p| (p.0 as usize, 1.0)).collect();
        }
        let neuron = most_blamed(&costs, &refinement.sides, node.bounds.len())
            .and_then(|n| u32::try_from(n).ok())
            .or_else(|| self.best_phase(frame, &node, conjunction));
        let cut = match neuron {
            Some(neuron) => Some((Split::Phase { neuron }, split_phase(node, neuron))),
            None => split_input(node, &[]),
        };
        let Some((split, mut children)) = cut else {
            done.found = Found::Stuck;
            return Ok(());
        };
        let first = done.cells.len();
        done.cells[cell].split = Some((split, first as u32));
        done.cells.extend([Cell::default(), Cell::default()]);
        children[0].cell = first + 1;
        children[1].cell = first;
        done.left.extend(children);
        Ok(())
    }

    /// Looks for a counterexample from the relaxation's minimiser on.
    fn descend(&mut self, node: &Node, conjunction: u32) -> Result<Option<Witness>, Late> {
        let Problem {
            query, deadline, ..
        } = *self.problem;
        let set = &query.unsafe_set[conjunction as usize];
        let (runner, start) = (&mut self.runner, self.dual.minimiser().to_vec());
        let end = pulp::Arch::new()
            .dispatch(|| descend(runner, &node.region, set, start, deadline))
            .ok_or(Late)?;
        Ok(self.witness_at(&end, conjunction))
    }

    /// Records how one conjunction was settled; the cell where the record goes on.
    fn settle(
        &self,
        done: &mut Done,
        cell: usize,
        index: u32,
        mut tried: Done,
        last: bool,
    ) -> usize {
        let mut proof = Proof {
            cells: std::mem::take(&mut done.cells),
        };
        let (mut place, mut next) = (cell, cell);
        if last {
            // The region's own bounds stay.
            let Cell {
                kept, tightened, ..
            } = &mut proof.cells[cell];
            tried.cells[0].kept = *kept;
            tried.cells[0].tightened = std::mem::take(tightened);
        } else {
            place = proof.cells.len();
            next = place + 1;
            proof.cells[cell].split = Some((Split::Conjunction { index }, place as u32));
            let kept = Cell {
                kept: true,
                ..Cell::default()
            };
            proof.cells.extend([kept.clone(), kept]);
        }
        graft(tried, place, &mut proof);
        done.cells = proof.cells;
        next
    }
}
