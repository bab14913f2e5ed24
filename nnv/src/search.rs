//! Branch and bound over the inputs, and over the phases of ReLUs.
//!
//! Which of the two pays is not known beforehand, so both are tried in turn, with more and more
//! regions: the one that is likelier to pay for the number of inputs gets most of them. The first
//! that settles the query ends it.
//!
//! Work goes out in rounds: every task takes one region and searches below it, depth first, for a
//! fixed number of regions; what it leaves open comes back in order. (Where bounding all neurons is
//! dear, a task is that of [`wide`].) So the answer, the witness,
//! the proof and the count of regions depend on the problem alone, not on the number of threads,
//! and no more than the open ends of the running tasks are in memory.

mod node;
mod phases;
mod wide;

use super::backward::Frame;
use super::dual::Dual;
use super::forward::Runner;
use super::objective::Ascent;
use super::propagation::{NeuronBounds, Prepared, SOME_INPUTS, Unbounded, Workspace};
use super::refinement::refine;
use super::witness::{Witness, is_near};
use super::{Branching, SearchOptions};
use cede_nnv_check::check::{confirms, refutes_exactly};
use cede_nnv_check::proof::{Cell, Proof, Refutation, Split};
use cede_nnv_check::{Halfspace, InputBox, Network, Query};
use node::{Node, split_input};
use rayon::prelude::*;
use std::ops::Range;
use std::time::Instant;

/// How a search ended.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Found {
    /// No point of any region is in the unsafe set.
    Nothing,
    /// This point is.
    Witness(Witness),
    /// The deadline passed.
    TimeOut,
    /// No witness was found, but some region could not be split any further nor be refuted.
    Stuck,
}

/// Regions that one task may bound before it hands back.
const TASK: u64 = 200;
/// Tasks of one round.
const ROUND: usize = 64;
/// Up to so many, it nearly always does.
const FEW_INPUTS: usize = 12;
/// Regions of the likelier way's first turn; they double from turn to turn.
const FIRST_TURN: u64 = 1 << 12;
/// The other way's turn is so many times shorter.
const UNLIKELIER: u64 = 4;

/// A query to be searched.
pub(super) struct Problem<'a> {
    network: &'a Network,
    query: &'a Query,
    prepared: Prepared,
    deadline: Instant,
    options: SearchOptions,
}

/// What a search gives.
pub(super) struct Outcome {
    pub(super) found: Found,
    /// Regions that were bounded.
    pub(super) regions: u64,
    /// The tree; empty unless it was to be recorded.
    pub(super) proof: Proof,
    /// What was cut across by the search that settled it.
    pub(super) branching: Branching,
}

/// A search by one way of branching, as far as it has come.
struct Tree<'p> {
    branching: Branching,
    /// What its regions have in common, where they are cut across phases.
    frame: Option<Frame<'p>>,
    stack: Vec<Node>,
    proof: Proof,
    regions: u64,
    stuck: bool,
}

impl<'a> Problem<'a> {
    /// `prepared` is the network, before any atoms.
    pub(super) fn new(
        network: &'a Network,
        prepared: &Prepared,
        query: &'a Query,
        options: SearchOptions,
        deadline: Instant,
    ) -> Self {
        let atoms: Vec<&Halfspace> = query.unsafe_set.iter().flatten().collect();
        Self {
            network,
            query,
            prepared: prepared.with_atoms(network.outputs(), &atoms),
            deadline,
            options,
        }
    }

    /// Searches the query's whole box.
    pub(super) fn search(&self) -> Outcome {
        let inputs = self.query.region.lower.len();
        let ways: &[Branching] = match self.options.branching {
            Branching::Auto if inputs <= SOME_INPUTS => &[Branching::Inputs, Branching::Phases],
            Branching::Auto => &[Branching::Phases, Branching::Inputs],
            Branching::Inputs => &[Branching::Inputs],
            Branching::Phases => &[Branching::Phases],
        };
        let mut trees: Vec<Tree<'_>> = ways.iter().map(|&way| self.tree(way)).collect();
        let mut turn = if inputs <= FEW_INPUTS {
            8 * FIRST_TURN
        } else {
            FIRST_TURN
        };
        loop {
            let mut open = false;
            for (rank, tree) in trees.iter_mut().enumerate() {
                let regions = if rank == 0 { turn } else { turn / UNLIKELIER };
                let found = self.advance(tree, regions);
                open |= found.is_none() && !tree.stack.is_empty();
                if let Some(found) = found {
                    let (branching, proof) = (tree.branching, std::mem::take(&mut tree.proof));
                    return Outcome {
                        found,
                        regions: trees.iter().map(|tree| tree.regions).sum(),
                        proof,
                        branching,
                    };
                }
            }
            if !open {
                return Outcome {
                    found: Found::Stuck,
                    regions: trees.iter().map(|tree| tree.regions).sum(),
                    proof: Proof::default(),
                    branching: self.options.branching,
                };
            }
            turn *= 2;
        }
    }

    fn tree(&self, branching: Branching) -> Tree<'_> {
        let mut proof = Proof::default();
        proof.cells.push(Cell::default());
        let root = Node {
            region: self.query.region.clone(),
            bounds: vec![(f64::NEG_INFINITY, f64::INFINITY); self.prepared.neurons].into(),
            phases: Box::default(),
            open: (0_u32..).take(self.query.unsafe_set.len()).collect(),
            choices: Box::default(),
            cell: 0,
        };
        Tree {
            branching,
            frame: None,
            stack: vec![root],
            proof,
            regions: 0,
            stuck: false,
        }
    }

    /// Goes on with a search for about so many regions; what settles the query, if anything does.
    fn advance<'p>(&'p self, tree: &mut Tree<'p>, regions: u64) -> Option<Found> {
        if tree.branching == Branching::Phases && tree.frame.is_none() {
            match self.frame(&mut tree.stack[0].bounds) {
                Ok(frame) => tree.frame = Some(frame),
                Err(Late) => return Some(Found::TimeOut),
            }
        }
        let frame = tree.frame.as_ref();
        let end = tree.regions + regions;
        while !tree.stack.is_empty() {
            if tree.regions >= end {
                return None;
            }
            let batch = tree.stack.split_off(tree.stack.len().saturating_sub(ROUND));
            let roots: Vec<usize> = batch.iter().map(|node| node.cell).collect();
            let work = |searcher: &mut Searcher<'_>, node| match searcher.frame {
                Some(frame) if self.prepared.wide => searcher.work_wide(frame, node),
                _ => searcher.work(node, TASK),
            };
            let done: Vec<Done> = batch
                .into_par_iter()
                .map_init(|| Searcher::new(self, frame), work)
                .collect();
            tree.regions += done.iter().map(|d| d.regions).sum::<u64>();
            for (task, root) in done.into_iter().zip(roots) {
                match &task.found {
                    Found::Nothing => {}
                    Found::Stuck => tree.stuck = true,
                    end => return Some(end.clone()),
                }
                tree.stack.extend(graft(task, root, &mut tree.proof));
            }
        }
        (!tree.stuck).then_some(Found::Nothing)
    }

    /// What all regions that are cut across phases have in common, and the bounds of the neurons on
    /// the whole box.
    fn frame(&self, bounds: &mut [NeuronBounds]) -> Result<Frame<'_>, Late> {
        let region = &self.query.region;
        let bounded = pulp::Arch::new().dispatch(|| {
            Workspace::default().bound(
                &self.prepared,
                region,
                &[],
                bounds,
                &[],
                &[],
                Some(self.deadline),
            )
        });
        bounded.map_err(|_| Late)?;
        let atoms = self.query.unsafe_set.iter().flatten().collect();
        let mut frame = Frame::new(self.network, &self.prepared, atoms, region, bounds);
        if self.prepared.wide {
            let part = (region, &[][..]);
            let refinement = refine(&frame, part, bounds, self.options.record, self.deadline);
            frame.set_refinement(refinement.map_err(|_| Late)?);
        }
        Ok(frame)
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

/// The deadline passed.
struct Late;

enum Step {
    Refuted,
    Split(Split, Box<[Node; 2]>),
    /// Neither refuted nor divisible.
    Stuck,
    Witness(Witness),
}

/// A step that is compiled for the machine's vectors: a closure of its size would not be inlined
/// where it has to be for that.
struct OneStep<'s, 'a> {
    searcher: &'s mut Searcher<'a>,
    node: Node,
    cell: &'s mut Cell,
}

impl pulp::NullaryFnOnce for OneStep<'_, '_> {
    type Output = Result<Step, Late>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        match self.searcher.frame {
            Some(frame) => self.searcher.step_by_phase(frame, self.node, self.cell),
            None => self.searcher.step(self.node, self.cell),
        }
    }
}

struct Searcher<'a> {
    problem: &'a Problem<'a>,
    /// There is one if regions are cut across phases.
    frame: Option<&'a Frame<'a>>,
    dual: Dual,
    workspace: Workspace,
    ascent: Ascent,
    runner: Runner<'a>,
    scores: Vec<f64>,
    slack: Vec<f64>,
}

impl<'a> Searcher<'a> {
    fn new(problem: &'a Problem<'a>, frame: Option<&'a Frame<'a>>) -> Self {
        Self {
            problem,
            frame,
            dual: Dual::default(),
            workspace: Workspace::default(),
            ascent: Ascent::default(),
            runner: Runner::new(problem.network, &problem.prepared),
            scores: Vec::new(),
            slack: Vec::new(),
        }
    }

    /// Searches below a node until nothing is left or so many regions are bounded.
    fn work(&mut self, mut node: Node, most: u64) -> Done {
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
        while done.regions < most
            && let Some(node) = done.left.pop()
        {
            done.regions += 1;
            let place = node.cell;
            let mut cell = Cell::default();
            let step = arch.dispatch(OneStep {
                searcher: self,
                node,
                cell: &mut cell,
            });
            let Ok(step) = step else {
                done.found = Found::TimeOut;
                break;
            };
            match step {
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
                    done.left.extend(*children);
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
    ///
    /// # Errors
    /// If the deadline passed.
    #[inline(always)]
    fn step(&mut self, mut node: Node, cell: &mut Cell) -> Result<Step, Late> {
        let problem = self.problem;
        cell.kept = false;
        let deadline = Some(problem.deadline);
        let atoms: Vec<usize> = node
            .open
            .iter()
            .flat_map(|&c| problem.atoms_of(c))
            .collect();
        let record = problem.options.record;
        if let Some(step) = self.tighten(&mut node, &atoms, cell)? {
            return Ok(step);
        }
        self.scores.clear();
        self.scores.resize(node.region.lower.len(), 0.0);
        self.slack.clear();
        self.slack.resize(self.workspace.symbols.count(), 0.0);
        let mut open = Vec::new();
        let mut candidates = Vec::new();
        let mut first = 0;
        for &conjunction in &node.open {
            let count = problem.atoms_of(conjunction).len();
            let mut bound = self
                .ascent
                .bound(
                    &self.workspace,
                    &node.region,
                    first..first + count,
                    deadline,
                )
                .map_err(|_| Late)?;
            first += count;
            let mut candidate = self.ascent.minimiser(node.region.lower.len()).to_vec();
            if bound <= 0.0 && self.workspace.symbols.count() == 0 {
                let time = problem.deadline.saturating_duration_since(Instant::now());
                match self.ascent.finish(&self.workspace, &node.region, time) {
                    Ok(found) => bound = found,
                    Err(point) => candidate = point.unwrap_or(candidate),
                }
            }
            if bound > 0.0 {
                if !record {
                    continue;
                }
                let claim = self.ascent.refutation(&self.workspace, conjunction, bound);
                if self.is_confirmed(&node, Some(&claim)) {
                    cell.refuted.push(claim);
                    continue;
                }
            }
            if let Some(witness) = self.witness_at(&candidate, conjunction) {
                return Ok(Step::Witness(witness));
            }
            let exactly = |claim: &Refutation| {
                let Node { region, phases, .. } = &node;
                refutes_exactly(problem.network, problem.query, region, phases, claim)
            };
            let claims = self.ascent.undecided(&self.workspace, conjunction);
            if let Some(claim) = claims.into_iter().find(exactly) {
                if record {
                    cell.refuted.push(claim);
                }
                continue;
            }
            self.ascent
                .blame(&self.workspace, &mut self.slack, &mut self.scores);
            open.push(conjunction);
            candidates.push(candidate);
        }
        if open.is_empty() {
            return Ok(Step::Refuted);
        }
        node.open = open.into();
        node.choices = Box::default();
        let InputBox { lower, upper } = node.region.clone();
        if let Some((split, children)) = split_input(node, &self.scores) {
            return Ok(Step::Split(split, children.into()));
        }
        // Nothing can be cut any further: the corners are all that there is to try.
        candidates.extend([lower, upper]);
        let mut corners = candidates.iter();
        let witness =
            corners.find_map(|point| Witness::near(problem.network, problem.query, point));
        Ok(witness.map_or(Step::Stuck, Step::Witness))
    }

    /// Bounds the neurons of a region, and the forms of these atoms; what that leads to, if the
    /// region turns out to be empty.
    ///
    /// # Errors
    /// If the deadline passed.
    #[inline(always)]
    fn tighten(
        &mut self,
        node: &mut Node,
        atoms: &[usize],
        cell: &mut Cell,
    ) -> Result<Option<Step>, Late> {
        let problem = self.problem;
        let record = problem.options.record;
        let before = (record && !node.phases.is_empty()).then(|| node.bounds.clone());
        let bounded = self.workspace.bound(
            &problem.prepared,
            &node.region,
            &[],
            &mut node.bounds,
            &node.phases,
            atoms,
            Some(problem.deadline),
        );
        match bounded {
            Ok(()) => Ok(None),
            Err(Unbounded::Late) => Err(Late),
            Err(Unbounded::Empty) => {
                if let Some(before) = before
                    && !self.is_confirmed(node, None)
                {
                    node.bounds = before;
                    let halves = split_input(node.copy(), &[]);
                    let halves = halves.map(|(split, two)| Step::Split(split, two.into()));
                    return Ok(Some(halves.unwrap_or(Step::Stuck)));
                }
                cell.empty = true;
                Ok(Some(Step::Refuted))
            }
        }
    }

    /// The point, or one next to it, if its output is in the conjunction.
    #[inline(always)]
    fn witness_at(&mut self, point: &[f64], conjunction: u32) -> Option<Witness> {
        let Problem { network, query, .. } = self.problem;
        let set = &query.unsafe_set[conjunction as usize];
        is_near(set, self.runner.run(point))
            .then(|| Witness::near(network, query, point))
            .flatten()
    }

    /// Whether the checker will confirm a claim, or that the region is empty. It is not asked about
    /// networks so large that asking takes long.
    fn is_confirmed(&self, node: &Node, claim: Option<&Refutation>) -> bool {
        let Problem { network, query, .. } = self.problem;
        confirms(network, query, &node.region, &node.phases, claim).unwrap_or(true)
    }
}
