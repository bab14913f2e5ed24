//! A complete verifier for feed-forward ReLU networks.
//!
//! [`cede_nnv_check::onnx`] and [`cede_nnv_check::vnnlib`] read a [`Network`] and a [`Property`]; [`verify`] answers whether any
//! input of the property's boxes gives an output in its unsafe set. Answers are about the
//! network's *real-number semantics*: the weights' exact values, no rounding anywhere.
#![forbid(unsafe_code)]

mod attack;
mod backward;
mod bounder;
mod dual;
mod forward;
mod kernel;
mod objective;
mod propagation;
mod refinement;
mod relaxation;
mod search;
mod side;
#[cfg(test)]
mod tests;
mod watchdog;
mod witness;

pub use bounder::{Bounder, Worker};
pub use propagation::NeuronBounds;
pub use watchdog::within;
pub use witness::Witness;

use cede_nnv_check::{Network, Property, proof};
use propagation::Prepared;
use std::time::{Duration, Instant};

/// How to search: 60 s, seed 0, [`Branching::Auto`] and no record, unless it is said otherwise.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct SearchOptions {
    /// Give up after this long.
    pub timeout: Duration,
    /// Seed of every random choice: the same seed gives the same answer on any number of threads,
    /// as long as the time suffices.
    pub seed: u64,
    /// What regions are cut across.
    pub branching: Branching,
    /// Whether to record a proof of [`Answer::Unsat`] for [`cede_nnv_check::check`].
    pub record: bool,
}

impl SearchOptions {
    /// Gives up after this long.
    #[must_use]
    pub const fn timeout(self, timeout: Duration) -> Self {
        Self { timeout, ..self }
    }

    /// Draws every random choice from this seed.
    #[must_use]
    pub const fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Cuts regions across these.
    #[must_use]
    pub const fn branching(self, branching: Branching) -> Self {
        Self { branching, ..self }
    }

    /// Records a proof, or not.
    #[must_use]
    pub const fn record(self, record: bool) -> Self {
        Self { record, ..self }
    }
}

/// What the search cuts regions across.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Branching {
    /// Inputs and phases of ReLUs by turns, until one of the two settles it. Most turns go to inputs
    /// where they are few (at most 20), to phases otherwise.
    #[default]
    Auto,
    /// Inputs.
    Inputs,
    /// Phases of unstable ReLUs; inputs where none is left.
    Phases,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self {
            timeout: Duration::from_secs(60),
            seed: 0,
            branching: Branching::Auto,
            record: false,
        }
    }
}

/// The answer to a property.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Answer {
    /// Proved: no input of the boxes gives an unsafe output.
    Unsat,
    /// Refuted by this input.
    Sat(Witness),
    /// Not settled in time.
    Timeout,
    /// Not settled by this method: a box shrank to neighbouring numbers.
    Unknown,
}

impl Answer {
    /// The answer in one word, as in VNN-COMP: `unsat`, `sat`, `timeout` or `unknown`.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Unsat => "unsat",
            Self::Sat(_) => "sat",
            Self::Timeout => "timeout",
            Self::Unknown => "unknown",
        }
    }

    /// The answer as in VNN-COMP's results: the word, and the witness with the network's outputs.
    /// The inputs are exact, the outputs rounded.
    #[must_use]
    pub fn text(&self) -> String {
        let Self::Sat(witness) = self else {
            return self.word().to_owned();
        };
        let inputs = witness.decimals();
        let inputs = inputs
            .iter()
            .enumerate()
            .map(|(i, x)| format!("(X_{i} {x})"));
        let outputs = witness.outputs().iter().enumerate();
        let outputs = outputs.map(|(i, y)| format!("(Y_{i} {y:?})"));
        let all: Vec<String> = inputs.chain(outputs).collect();
        format!("{}\n({})", self.word(), all.join("\n"))
    }
}

/// An answer and what it took.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// The answer.
    pub answer: Answer,
    /// Regions that were bounded.
    pub regions: u64,
    /// What was cut across by the search that settled the last query.
    pub branching: Branching,
    /// The proof of each query, if [`Answer::Unsat`] was to be recorded.
    pub proofs: Vec<proof::Proof>,
}

/// The property is about a network of another shape.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the property has {} inputs and {} outputs, the network {} and {}",
    property.0, property.1, network.0, network.1
)]
pub struct ShapeError {
    /// Inputs and outputs of the property.
    pub property: (usize, usize),
    /// Inputs and outputs of the network.
    pub network: (usize, usize),
}

/// Verifies a property on the threads of the current rayon pool. Ends within a second of the
/// timeout.
///
/// # Errors
/// If the property does not fit the network.
pub fn verify(
    network: &Network,
    property: &Property,
    options: SearchOptions,
) -> Result<Report, ShapeError> {
    let shapes = ShapeError {
        property: (property.inputs, property.outputs),
        network: (network.inputs(), network.outputs()),
    };
    if shapes.property != shapes.network {
        return Err(shapes);
    }
    let start = Instant::now();
    // A timeout beyond the clock's range is none.
    let deadline = start
        .checked_add(options.timeout)
        .unwrap_or_else(|| start + Duration::from_secs(1 << 32));
    let prepared = Prepared::new(network, &[]);
    Ok(verify_prepared(
        network, &prepared, property, options, deadline,
    ))
}

/// [`verify`] for a property that fits the network, which is prepared.
fn verify_prepared(
    network: &Network,
    prepared: &Prepared,
    property: &Property,
    options: SearchOptions,
    deadline: Instant,
) -> Report {
    let mut report = Report {
        answer: Answer::Unsat,
        regions: 0,
        branching: options.branching,
        proofs: Vec::new(),
    };
    let found = anything(network, property)
        .or_else(|| attack::attack(network, prepared, property, options.seed, deadline));
    if let Some(witness) = found {
        report.answer = Answer::Sat(witness);
        return report;
    }
    for query in &property.queries {
        let problem = search::Problem::new(network, prepared, query, options, deadline);
        let outcome = problem.search();
        report.regions += outcome.regions;
        report.branching = outcome.branching;
        match outcome.found {
            search::Found::Nothing => report.proofs.push(outcome.proof),
            search::Found::Witness(witness) => {
                report.answer = Answer::Sat(witness);
                break;
            }
            search::Found::TimeOut => {
                report.answer = Answer::Timeout;
                break;
            }
            // A later query may still have a witness.
            search::Found::Stuck => report.answer = Answer::Unknown,
        }
    }
    if report.answer != Answer::Unsat || !options.record {
        report.proofs.clear();
    }
    report
}

/// A witness of a query that asks nothing of the outputs: any input.
fn anything(network: &Network, property: &Property) -> Option<Witness> {
    let mut queries = property.queries.iter();
    let query = queries.find(|query| query.unsafe_set.iter().any(Vec::is_empty))?;
    Witness::near(network, query, &query.region.lower)
}
