//! The report: every check, requirement and assumption, as text and as JSON.

use super::judged::{Findings, JudgedAssumption, JudgedRequirement, Status};
use super::provenance::Provenance;
use super::steps::{Outcome, Step, Word};
use crate::safety::{Hazards, SafetyFile};
use serde::Serialize;

/// What is said on every form of the report.
pub(super) const NO_CLAIM: &str = "No compliance with ISO 26262, ISO 21448 or UL 4600 is claimed.";

/// What was done, and where everything stands.
#[derive(Clone, Debug)]
pub(super) struct Report {
    pub(super) quick: bool,
    pub(super) hazards: Hazards,
    pub(super) steps: Vec<Step>,
    pub(super) requirements: Vec<JudgedRequirement>,
    pub(super) assumptions: Vec<JudgedAssumption>,
    pub(super) provenance: Provenance,
}

/// A check as JSON.
#[derive(Serialize)]
struct StepObject<'s> {
    name: &'s str,
    command: &'s str,
    outcome: Word,
    why: Option<&'s str>,
    summary: &'s str,
    seconds: f64,
    detail: &'s serde_json::Value,
}

impl Report {
    pub(super) fn new(
        file: &SafetyFile,
        steps: Vec<Step>,
        provenance: Provenance,
        quick: bool,
    ) -> Self {
        let findings = Findings::of(&steps);
        let requirements = file.requirements.iter();
        let requirements = requirements.map(|it| findings.requirement(it)).collect();
        let assumptions = file.assumptions.iter();
        let assumptions = assumptions.map(|it| findings.assumption(it)).collect();
        Self {
            quick,
            hazards: file.hazards.clone(),
            requirements,
            assumptions,
            provenance,
            steps,
        }
    }

    /// Checks that failed or were not done, and requirements of which something failed, in a line; none if there are none.
    pub(super) fn open(&self) -> Option<String> {
        let steps = self.steps.iter().filter_map(|step| {
            let done = match step.outcome {
                Outcome::Failed(_) => "failed",
                Outcome::Missing(_) => "not done",
                Outcome::Passed | Outcome::Elsewhere => return None,
            };
            Some(format!("{} {done}: {}", step.name, step.outcome.why()?))
        });
        let failed = self.requirements.iter().filter(|it| it.failed());
        let failed = failed.map(|it| format!("{} is not shown", it.id));
        let open: Vec<String> = steps.chain(failed).collect();
        (!open.is_empty()).then(|| open.join("\n"))
    }

    /// How many requirements and assumptions have this status.
    pub(super) fn count(&self, status: Status) -> usize {
        let requirements = self.requirements.iter().map(|it| it.status);
        let all = requirements.chain(self.assumptions.iter().map(|it| it.status));
        all.filter(|it| *it == status).count()
    }

    /// The counts in a sentence.
    pub(super) fn counts(&self) -> String {
        let count = |status: Status| format!("{} {}", self.count(status), status.word());
        format!(
            "{} requirements and {} assumptions of use: {}",
            self.requirements.len(),
            self.assumptions.len(),
            Status::ALL.map(count).join(", ")
        )
    }

    pub(super) fn text(&self) -> String {
        let step = |step: &Step| {
            let word = step.outcome.word().text();
            let said = step.outcome.why().unwrap_or(&step.summary);
            let first = said.lines().next().unwrap_or_default();
            format!(
                "{:<40} {word:<9} {:>5.0} s  {first}",
                step.name, step.seconds
            )
        };
        let requirement =
            |it: &JudgedRequirement| format!("{:<7} {:<8} {}", it.id, it.status.word(), it.says);
        let assumption =
            |it: &JudgedAssumption| format!("{:<7} {:<8} {}", it.id, it.status.word(), it.says);
        let steps = self.steps.iter().map(step);
        let requirements = self.requirements.iter().map(requirement);
        let assumptions = self.assumptions.iter().map(assumption);
        let lines: Vec<String> = steps.chain(requirements).chain(assumptions).collect();
        format!("{}\n{}. {NO_CLAIM}", lines.join("\n"), self.counts())
    }

    pub(super) fn json(&self) -> String {
        let steps: Vec<_> = self.steps.iter().map(StepObject::of).collect();
        let counts =
            Status::ALL.map(|status| (status.word().to_owned(), self.count(status).into()));
        serde_json::json!({
            "passed": self.open().is_none(), "quick": self.quick, "provenance": self.provenance,
            "counts": serde_json::Map::from_iter(counts), "checks": steps,
            "requirements": self.requirements, "assumptions": self.assumptions, "claim": NO_CLAIM,
        })
        .to_string()
    }
}

impl<'s> StepObject<'s> {
    fn of(step: &'s Step) -> Self {
        Self {
            name: step.name,
            command: &step.command,
            outcome: step.outcome.word(),
            why: step.outcome.why(),
            summary: &step.summary,
            seconds: step.seconds,
            detail: &step.detail,
        }
    }
}
