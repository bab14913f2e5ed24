//! Branch and bound over the inputs, and over the phases of ReLUs where there are many inputs.
//!
//! Work goes out in rounds: every task takes one region and searches below it, depth first, for a
//! fixed number of regions; what it leaves open comes back in order. So the answer, the witness,
//! the proof and the count of regions depend on the problem alone, not on the number of threads,
//! and no more than the open ends of the running tasks are in memory.

mod node;

use super::attack::{confirmed, worst};
use super::forward::Runner;
use super::objective::Ascent;
use super::propagation::{Prepared, Workspace, is_unstable};
use super::{Branching, SearchOptions};
use cede_nnv_check::Network;
use cede_nnv_check::proof::{Cell, Proof, Split};
use cede_nnv_check::{Halfspace, Property, Query};
use node::{Node, split_input, split_phase};
use rayon::prelude::*;
use std::ops::Range;
use std::time::Instant;

/// How a search ended.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Found {
    /// No point of any region is in the unsafe set.
    Nothing,
    /// This point is, confirmed with all rounding accounted for.
    Witness(Vec<f64>),
    /// The deadline passed.
    TimeOut,
    /// No witness was found, but some region could not be split any further nor be refuted.
    Stuck,
}

/// Regions that one task may bound before it hands back.
const TASK: usize = 200;
/// Tasks of one round.
const ROUND: usize = 64;
/// Up to so many inputs, boxes are split across inputs; beyond, across phases of ReLUs.
const FEW_INPUTS: usize = 12;

/// A query to be searched.
pub(super) struct Problem<'a> {
    pub(super) network: &'a Network,
    pub(super) property: &'a Property,
    pub(super) query: &'a Query,
    pub(super) prepared: Prepared,
    pub(super) deadline: Instant,
    pub(super) options: SearchOptions,
}

/// What a search gives.
pub(super) struct Outcome {
    pub(super) found: Found,
    /// Regions that were bounded.
    pub(super) regions: u64,
    /// The tree; empty unless it was to be recorded.
    pub(super) proof: Proof,
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        network: &'a Network,
        property: &'a Property,
        query: &'a Query,
        options: SearchOptions,
        deadline: Instant,
    ) -> Self {
        let atoms: Vec<&Halfspace> = query.unsafe_set.iter().flatten().collect();
        Self {
            network,
            property,
            query,
            prepared: Prepared::new(network, &atoms),
            deadline,
            options,
        }
    }

    /// Searches the query's whole box.
    pub(super) fn search(&self) -> Outcome {
        let mut outcome = Outcome {
            found: Found::Nothing,
            regions: 0,
            proof: Proof::default(),
        };
        outcome.proof.cells.push(Cell::default());
        let mut stack = vec![Node {
            region: self.query.region.clone(),
            bounds: vec![(f64::NEG_INFINITY, f64::INFINITY); self.prepared.neurons].into(),
            phases: Box::default(),
            open: (0_u32..).take(self.query.unsafe_set.len()).collect(),
            cell: 0,
        }];
        while !stack.is_empty() {
            let batch = stack.split_off(stack.len().saturating_sub(ROUND));
            let roots: Vec<usize> = batch.iter().map(|node| node.cell).collect();
            let work = |searcher: &mut Searcher<'_>, node| searcher.work(node);
            let done: Vec<Done> = batch
                .into_par_iter()
                .map_init(|| Searcher::new(self), work)
                .collect();
            outcome.regions += done.iter().map(|d| d.regions).sum::<u64>();
            for (task, root) in done.into_iter().zip(roots) {
                match &task.found {
                    Found::Nothing => {}
                    Found::Stuck => outcome.found = Found::Stuck,
                    end => {
                        outcome.found = end.clone();
                        return outcome;
                    }
                }
                stack.extend(graft(task, root, &mut outcome.proof));
            }
        }
        outcome
    }

    /// Where the atoms of each conjunction lie among all atoms.
    fn atoms_of(&self, conjunction: u32) -> Range<usize> {
        let before: usize = self.query.unsafe_set[..conjunction as usize]
            .iter()
            .map(Vec::len)
            .sum();
        before..before + self.query.unsafe_set[conjunction as usize].len()
    }
}

/// Puts a task's cells in the place of their root, and gives its open nodes.
fn graft(task: Done, root: usize, proof: &mut Proof) -> Vec<Node> {
    // The task's cell 0 is the root; its further cells go to the end.
    let base = proof.cells.len().saturating_sub(1);
    let moved = |local: usize| if local == 0 { root } else { base + local };
    for (local, mut cell) in task.cells.into_iter().enumerate() {
        if let Some((_, first)) = &mut cell.split {
            *first += base as u32;
        }
        if local == 0 {
            proof.cells[root] = cell;
        } else {
            proof.cells.push(cell);
        }
    }
    let mut left = task.left;
    left.iter_mut()
        .for_each(|node| node.cell = moved(node.cell));
    left
}

/// What a task brings back.
struct Done {
    found: Found,
    left: Vec<Node>,
    cells: Vec<Cell>,
    regions: u64,
}

enum Step {
    Refuted,
    Split(Split, [Node; 2]),
    /// Neither refuted nor divisible.
    Stuck,
    Witness(Vec<f64>),
}

struct Searcher<'a> {
    problem: &'a Problem<'a>,
    workspace: Workspace,
    ascent: Ascent,
    runner: Runner<'a>,
    scores: Vec<f64>,
    slack: Vec<f64>,
}

impl<'a> Searcher<'a> {
    fn new(problem: &'a Problem<'a>) -> Self {
        Self {
            problem,
            workspace: Workspace::default(),
            ascent: Ascent::default(),
            runner: Runner::new(problem.network),
            scores: Vec::new(),
            slack: Vec::new(),
        }
    }

    /// Searches below a node until nothing is left or the task is used up.
    fn work(&mut self, mut node: Node) -> Done {
        node.cell = 0;
        let mut done = Done {
            found: Found::Nothing,
            left: vec![node],
            cells: Vec::new(),
            regions: 0,
        };
        if self.problem.options.record {
            done.cells.push(Cell::default());
        }
        let arch = pulp::Arch::new();
        while done.regions < TASK as u64
            && let Some(node) = done.left.pop()
        {
            if Instant::now() > self.problem.deadline {
                done.found = Found::TimeOut;
                break;
            }
            done.regions += 1;
            let place = node.cell;
            let mut cell = Cell::default();
            match arch.dispatch(|| self.step(node, &mut cell)) {
                Step::Refuted => {}
                Step::Stuck => done.found = Found::Stuck,
                Step::Split(split, mut children) => {
                    if self.problem.options.record {
                        let first = done.cells.len();
                        cell.split = Some((split, first as u32));
                        done.cells.extend([Cell::default(), Cell::default()]);
                        children[0].cell = first + 1;
                        children[1].cell = first;
                    }
                    done.left.extend(children);
                }
                Step::Witness(witness) => {
                    done.found = Found::Witness(witness);
                    break;
                }
            }
            if self.problem.options.record {
                done.cells[place] = cell;
            }
        }
        done
    }

    /// Bounds one region, and splits it if that does not settle it.
    #[inline(always)]
    fn step(&mut self, mut node: Node, cell: &mut Cell) -> Step {
        let problem = self.problem;
        let atoms: Vec<usize> = node
            .open
            .iter()
            .flat_map(|&c| problem.atoms_of(c))
            .collect();
        if self
            .workspace
            .bound(
                &problem.prepared,
                &node.region,
                &[],
                &mut node.bounds,
                &node.phases,
                &atoms,
            )
            .is_err()
        {
            cell.empty = true;
            return Step::Refuted;
        }
        self.scores.clear();
        self.scores.resize(node.region.lower.len(), 0.0);
        self.slack.clear();
        self.slack.resize(self.workspace.symbols.count(), 0.0);
        let mut open = Vec::new();
        let mut first = 0;
        for &conjunction in &node.open {
            let count = problem.atoms_of(conjunction).len();
            let mut bound = self
                .ascent
                .bound(&self.workspace, &node.region, first..first + count);
            first += count;
            let mut candidate = self.ascent.minimiser(node.region.lower.len()).to_vec();
            if bound <= 0.0 && self.workspace.symbols.count() == 0 {
                match self.ascent.finish(&self.workspace, &node.region) {
                    Ok(found) => bound = found,
                    Err(point) => candidate = point.unwrap_or(candidate),
                }
            }
            if bound > 0.0 {
                if problem.options.record {
                    cell.refuted
                        .push(self.ascent.refutation(&self.workspace, conjunction, bound));
                }
                continue;
            }
            let y = self.runner.run(&candidate);
            if worst(&problem.query.unsafe_set[conjunction as usize], y).0 < 0.0
                && let Some(witness) = confirmed(problem.network, problem.property, &candidate)
            {
                return Step::Witness(witness);
            }
            self.ascent
                .blame(&self.workspace, &mut self.slack, &mut self.scores);
            open.push(conjunction);
        }
        if open.is_empty() {
            return Step::Refuted;
        }
        node.open = open.into();
        let by_phase = match problem.options.branching {
            Branching::Auto => self.scores.len() > FEW_INPUTS,
            Branching::Inputs => false,
            Branching::Phases => true,
        };
        let phase = if by_phase {
            self.worst_phase(&node)
        } else {
            None
        };
        match phase {
            Some(neuron) => Step::Split(Split::Phase { neuron }, split_phase(node, neuron)),
            None => match split_input(node, &self.scores) {
                Some((split, children)) => Step::Split(split, children),
                None => Step::Stuck,
            },
        }
    }

    /// The unstable ReLU whose relaxation costs the most.
    fn worst_phase(&self, node: &Node) -> Option<u32> {
        let symbols = &self.workspace.symbols;
        let free =
            |&s: &usize| symbols.lines(s).free && is_unstable(node.bounds[symbols.neuron(s)]);
        let most = (0..symbols.count())
            .filter(free)
            .max_by(|&a, &b| self.slack[a].total_cmp(&self.slack[b]))?;
        u32::try_from(symbols.neuron(most)).ok()
    }
}
