//! Branch and bound over the inputs.
//!
//! Work goes out in rounds: every task takes one box and searches below it, depth first, for a
//! fixed number of boxes; what it leaves open comes back in order. So the answer, the witness and
//! the count of boxes depend on the seed alone, not on the number of threads, and no more than
//! the open ends of the running tasks are in memory.

use super::attack::{confirmed, worst};
use super::forward::Runner;
use super::model::Network;
use super::objective::Ascent;
use super::propagation::{Interval, Prepared, Workspace};
use super::property::{Halfspace, InputBox, Property, Query};
use rayon::prelude::*;
use std::ops::Range;
use std::time::Instant;

/// How a search ended.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Found {
    /// No point of any box is in the unsafe set.
    Nothing,
    /// This point is, confirmed in exact arithmetic.
    Witness(Vec<f64>),
    /// The deadline passed.
    TimeOut,
    /// A box could not be split any further and was neither refuted nor confirmed.
    Stuck,
}

/// Boxes that one task may bound before it hands back.
const TASK: usize = 200;
/// Tasks of one round.
const ROUND: usize = 64;

/// A box, what is known of it, and the conjunctions still to be refuted on it.
struct Node {
    region: InputBox,
    bounds: Box<[Interval]>,
    open: Box<[u32]>,
}

/// Searches one query. Adds the number of boxes bounded to `boxes`.
pub(super) fn search(network: &Network, property: &Property, query: &Query, deadline: Instant, boxes: &mut u64) -> Found {
    let atoms: Vec<&Halfspace> = query.unsafe_set.iter().flatten().collect();
    let problem = Problem { network, property, query, prepared: Prepared::new(network, &atoms), deadline };
    let mut stack = vec![Node {
        region: query.region.clone(),
        bounds: vec![(f64::NEG_INFINITY, f64::INFINITY); problem.prepared.neurons].into(),
        open: (0..query.unsafe_set.len()).map(|i| i as u32).collect(),
    }];
    while !stack.is_empty() {
        let batch = stack.split_off(stack.len().saturating_sub(ROUND));
        let done: Vec<Done> = batch.into_par_iter().map_init(|| Worker::new(&problem), |worker, node| worker.work(node)).collect();
        *boxes += done.iter().map(|d| d.boxes).sum::<u64>();
        for task in done {
            match task.end {
                Found::Nothing => stack.extend(task.left),
                other => return other,
            }
        }
    }
    Found::Nothing
}

struct Problem<'a> {
    network: &'a Network,
    property: &'a Property,
    query: &'a Query,
    prepared: Prepared,
    deadline: Instant,
}

impl Problem<'_> {
    /// Where the atoms of each conjunction lie among all atoms.
    fn atoms_of(&self, conjunction: u32) -> Range<usize> {
        let before: usize = self.query.unsafe_set[..conjunction as usize].iter().map(Vec::len).sum();
        before..before + self.query.unsafe_set[conjunction as usize].len()
    }
}

/// What a task brings back.
struct Done {
    end: Found,
    left: Vec<Node>,
    boxes: u64,
}

struct Worker<'a> {
    problem: &'a Problem<'a>,
    workspace: Workspace,
    ascent: Ascent,
    runner: Runner<'a>,
    scores: Vec<f64>,
}

impl<'a> Worker<'a> {
    fn new(problem: &'a Problem<'a>) -> Self {
        Self {
            problem,
            workspace: Workspace::default(),
            ascent: Ascent::default(),
            runner: Runner::new(problem.network),
            scores: Vec::new(),
        }
    }

    /// Searches below a node until nothing is left or the task is used up.
    fn work(&mut self, node: Node) -> Done {
        let mut left = vec![node];
        let mut boxes = 0;
        let arch = pulp::Arch::new();
        while let Some(node) = left.pop() {
            if Instant::now() > self.problem.deadline {
                return Done { end: Found::TimeOut, left, boxes };
            }
            boxes += 1;
            match arch.dispatch(|| self.step(node)) {
                Step::Refuted => {}
                Step::Split(children) => left.extend(children),
                Step::End(end) => return Done { end, left, boxes },
            }
            if boxes as usize >= TASK {
                break;
            }
        }
        Done { end: Found::Nothing, left, boxes }
    }

    /// Bounds one box, and splits it if that does not settle it.
    #[inline(always)]
    fn step(&mut self, mut node: Node) -> Step {
        let atoms: Vec<usize> = node.open.iter().flat_map(|&c| self.problem.atoms_of(c)).collect();
        if self.workspace.bound(&self.problem.prepared, &node.region, &mut node.bounds, &atoms).is_err() {
            return Step::Refuted;
        }
        self.scores.clear();
        self.scores.resize(node.region.lower.len(), 0.0);
        let mut open = Vec::new();
        let mut first = 0;
        for &conjunction in &node.open {
            let count = self.problem.atoms_of(conjunction).len();
            let (refuted, _) = self.ascent.refutes(&self.workspace, &node.region, first..first + count);
            first += count;
            if refuted {
                continue;
            }
            let point = self.ascent.minimiser(node.region.lower.len());
            let y = self.runner.run(point);
            if worst(&self.problem.query.unsafe_set[conjunction as usize], y).0 < 0.0
                && let Some(witness) = confirmed(self.problem.network, self.problem.property, point)
            {
                return Step::End(Found::Witness(witness));
            }
            self.ascent.blame(&self.workspace, &mut self.scores);
            open.push(conjunction);
        }
        if open.is_empty() {
            return Step::Refuted;
        }
        node.open = open.into();
        match split(node, &self.scores) {
            Some(children) => Step::Split(children),
            None => Step::End(Found::Stuck),
        }
    }
}

enum Step {
    Refuted,
    Split([Node; 2]),
    End(Found),
}

/// Halves the box across the input with the highest score (the widest one, if nothing is blamed).
fn split(node: Node, scores: &[f64]) -> Option<[Node; 2]> {
    let InputBox { lower, upper } = &node.region;
    let middle = |i: usize| 0.5 * (lower[i] + upper[i]);
    let divisible = |&i: &usize| lower[i] < middle(i) && middle(i) < upper[i];
    let better = |&a: &usize, &b: &usize| {
        let width = |i: usize| upper[i] - lower[i];
        scores[a].total_cmp(&scores[b]).then(width(a).total_cmp(&width(b))).then(b.cmp(&a))
    };
    let input = (0..lower.len()).filter(divisible).max_by(better)?;
    let at = middle(input);
    let mut other = Node { region: node.region.clone(), bounds: node.bounds.clone(), open: node.open.clone() };
    let mut one = node;
    one.region.upper[input] = at;
    other.region.lower[input] = at;
    Some([one, other])
}
