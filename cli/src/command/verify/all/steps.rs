//! The checks, one after the other.

use super::super::beyond::Beyond;
use super::super::campaign::Campaign;
use super::super::checked::{Check, Checked, Finding};
use super::super::lemmas::Lemmas;
use super::super::margins::Margins;
use super::super::policy::Policy;
use super::super::reach::Reach;
use super::super::zones::Zones;
use crate::failure::Failure;
use clap::Command;
use serde::Serialize;
use std::time::Instant;

/// What came of a check.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    Passed,
    /// What it did not show.
    Failed(String),
    /// Why it was not done.
    Missing(String),
    /// It has a command of its own, and is not done here.
    Elsewhere,
}

/// A check that was run, or not.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) name: &'static str,
    /// The command that does the same.
    pub(super) command: String,
    pub(super) outcome: Outcome,
    /// Its numbers, or where they are.
    pub(super) summary: String,
    pub(super) seconds: f64,
    pub(super) findings: Vec<Finding>,
    pub(super) detail: serde_json::Value,
}

/// A word for each outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Word {
    Passed,
    Failed,
    NotDone,
    Elsewhere,
}

impl Word {
    pub(super) const fn text(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed => "failed",
            Self::NotDone => "not done",
            Self::Elsewhere => "elsewhere",
        }
    }
}

impl Outcome {
    pub(super) const fn word(&self) -> Word {
        match self {
            Self::Passed => Word::Passed,
            Self::Failed(_) => Word::Failed,
            Self::Missing(_) => Word::NotDone,
            Self::Elsewhere => Word::Elsewhere,
        }
    }

    /// What it did not show, or why it was not done.
    pub(super) fn why(&self) -> Option<&str> {
        match self {
            Self::Failed(why) | Self::Missing(why) => Some(why),
            Self::Passed | Self::Elsewhere => None,
        }
    }
}

impl Step {
    /// Runs a check, and says so on stderr.
    pub(super) fn run(
        name: &'static str,
        command: String,
        check: impl FnOnce() -> Result<Checked, Failure>,
    ) -> Self {
        eprintln!("{name}: {command} …");
        let began = Instant::now();
        let checked = check();
        let seconds = began.elapsed().as_secs_f64();
        let step = match checked {
            Ok(checked) => Self {
                outcome: checked.open.map_or(Outcome::Passed, Outcome::Failed),
                summary: checked.summary,
                findings: checked.findings,
                detail: checked.json,
                ..Self::missing(name, command, String::new())
            },
            Err(failure) => Self::missing(name, command, failure.words()),
        };
        let word = step.outcome.why().map_or("passed", |why| why);
        eprintln!("{name}: {word} ({seconds:.0} s)");
        Self { seconds, ..step }
    }

    /// A check that was not done.
    pub(super) fn missing(name: &'static str, command: String, why: String) -> Self {
        Self {
            name,
            command,
            outcome: Outcome::Missing(why),
            summary: String::new(),
            seconds: 0.0,
            findings: Vec::new(),
            detail: serde_json::Value::Null,
        }
    }
}

/// A command of `cede verify` that is to be run.
pub(super) struct Plan {
    name: &'static str,
    line: &'static str,
    check: fn(&str) -> Result<Checked, Failure>,
}

impl Plan {
    /// Its words after `cede verify`.
    #[cfg(test)]
    pub(super) const fn line(&self) -> &'static str {
        self.line
    }

    /// Runs the command.
    pub(super) fn run(&self) -> Step {
        let command = format!("cede verify {}", self.line);
        Step::run(self.name, command, || (self.check)(self.line))
    }
}

/// Runs the command line of a check.
fn check<C: Check>(line: &str) -> Result<Checked, Failure> {
    let words = line.split(' ');
    let matches = C::augment_args(Command::new("check")).try_get_matches_from(words);
    let options = matches.and_then(|matches| C::from_arg_matches(&matches));
    options
        .map_err(|error| Failure::Usage(error.to_string()))?
        .check()
}

/// What is run, in this order.
pub(super) fn plans(quick: bool) -> [Plan; 8] {
    let plan = |name, lines: [&'static str; 2], check| Plan {
        name,
        line: lines[usize::from(quick)],
        check,
    };
    let same = |line| [line, line];
    [
        plan("lemmas", same("lemmas"), check::<Lemmas>),
        plan("policy", same("policy --check"), check::<Policy>),
        plan("closed loop", same("reach"), check::<Reach>),
        plan(
            "rounding",
            ["margins", "margins --boxes 400000"],
            check::<Margins>,
        ),
        plan("zones", same("zones"), check::<Zones>),
        plan(
            "campaign",
            ["campaign --steps 10000000", "campaign --steps 1000000"],
            check::<Campaign>,
        ),
        plan(
            "beyond, worst case",
            ["beyond --encounters 2000", "beyond --encounters 100"],
            check::<Beyond>,
        ),
        plan(
            "beyond, passenger car",
            [
                "beyond --contract passenger-car --encounters 2000",
                "beyond --contract passenger-car --encounters 100",
            ],
            check::<Beyond>,
        ),
    ]
}

/// Checks that are not run here: name, command, and where their results are.
const ELSEWHERE: [(&str, &str, &str); 9] = [
    (
        "attacker",
        "cargo run --release -p cede-attack -- run --steps 2.1e8 --seed 6000000000",
        "docs/evidence.md#the-attacker",
    ),
    (
        "precedence, model checked",
        "cargo run --release -p cede-precedence-model -- --disturbances 1 --seconds 30",
        "docs/evidence.md#at-a-glance",
    ),
    (
        "conformance of an integrator's numbers",
        "cargo run --release -p cede-testing --features cli --bin cede-conformance",
        "CONTRIBUTING.md#attacks-model-checking-mutants",
    ),
    (
        "mutants",
        "tests/mutants.sh",
        "CONTRIBUTING.md#attacks-model-checking-mutants",
    ),
    (
        "recorded humans",
        "cede verify shield --data DIR",
        "docs/evidence.md#transparency",
    ),
    (
        "bare metal",
        "firmware/check.sh",
        "docs/benchmarks.md#cortex-m",
    ),
    (
        "C library",
        "firmware/capi/check.sh",
        "docs/integration.md#integrity",
    ),
    (
        "readers under fuzz",
        "fuzz/run.sh",
        "CONTRIBUTING.md#fuzzing",
    ),
    (
        "public verification instances",
        "cargo bench -p cede-nnv --bench conformance -- FOLDER",
        "docs/benchmarks.md#network-verifier",
    ),
];

/// Where the results of these are.
pub(super) fn records() -> Vec<String> {
    ELSEWHERE.map(|(_, _, record)| record.to_owned()).to_vec()
}

/// Checks that have a command of their own.
pub(super) fn elsewhere() -> impl Iterator<Item = Step> {
    ELSEWHERE.into_iter().map(|(name, command, record)| Step {
        outcome: Outcome::Elsewhere,
        summary: format!("results: {record}"),
        ..Step::missing(name, command.to_owned(), String::new())
    })
}
