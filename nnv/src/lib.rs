//! A complete verifier for feed-forward ReLU networks.
//!
//! [`cede_nnv_check::onnx`] and [`cede_nnv_check::vnnlib`] read a [`Network`] and a [`Property`]; [`verify`] answers whether any
//! input of the property's boxes gives an output in its unsafe set. Answers are about the
//! network's *real-number semantics*: the weights' exact values, no rounding anywhere.
#![forbid(unsafe_code)]

mod attack;
mod bounder;
mod forward;
mod kernel;
mod objective;
mod propagation;
mod relaxation;
mod search;
#[cfg(test)]
mod tests;

pub use bounder::{Bounder, Worker};
pub use propagation::NeuronBounds;

use cede_nnv_check::{Network, Property, proof};
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
    /// Inputs where they are few (at most 12), phases of ReLUs otherwise.
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
    Sat(Vec<f64>),
    /// Not settled in time.
    Timeout,
    /// Not settled by this method (a box shrank to a point).
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
    #[must_use]
    pub fn text(&self, network: &Network) -> String {
        let Self::Sat(x) = self else {
            return self.word().to_owned();
        };
        let pairs = |name: &str, values: &[f64]| -> Vec<String> {
            let pair = |(i, v)| format!("({name}_{i} {v:?})");
            values.iter().enumerate().map(pair).collect()
        };
        let all = [pairs("X", x), pairs("Y", &network.run(x).values)].concat();
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

/// Verifies a property on the threads of the current rayon pool.
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
    let deadline = Instant::now() + options.timeout;
    let mut report = Report {
        answer: Answer::Unsat,
        regions: 0,
        proofs: Vec::new(),
    };
    if let Some(witness) = attack::attack(network, property, options.seed) {
        report.answer = Answer::Sat(witness);
        return Ok(report);
    }
    for query in &property.queries {
        let outcome = search::Problem::new(network, property, query, options, deadline).search();
        report.regions += outcome.regions;
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
    Ok(report)
}
