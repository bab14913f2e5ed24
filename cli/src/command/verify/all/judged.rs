//! What the findings mean for each requirement and assumption.

use super::super::checked::Finding;
use super::steps::{Outcome, Step};
use crate::safety::{Assumption, Evidence, Kind, Requirement};
use serde::Serialize;

/// Where a requirement or an assumption stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Status {
    /// All of its proofs hold.
    Proved,
    /// All of its tests pass; nothing of it is proved.
    Tested,
    /// It is for others to keep.
    Assumed,
    /// What would show it was not done here.
    Skipped,
    /// It is not shown: something failed, or there is nothing that shows it.
    Open,
}

impl Status {
    pub(super) const ALL: [Self; 5] = [
        Self::Proved,
        Self::Tested,
        Self::Assumed,
        Self::Skipped,
        Self::Open,
    ];

    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Proved => "proved",
            Self::Tested => "tested",
            Self::Assumed => "assumed",
            Self::Skipped => "skipped",
            Self::Open => "open",
        }
    }
}

/// What became of a piece of evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum State {
    Shown,
    NotShown,
    /// No check has looked at it.
    NotDone,
    /// A command of its own shows it.
    Elsewhere,
}

/// A piece of evidence with what became of it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Item {
    #[serde(serialize_with = "in_words")]
    pub(super) kind: Kind,
    pub(super) name: String,
    pub(super) state: State,
    pub(super) said: String,
}

fn in_words<S: serde::Serializer>(kind: &Kind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(kind)
}

/// A requirement with where it stands.
#[derive(Clone, Debug, Serialize)]
pub(super) struct JudgedRequirement {
    pub(super) id: String,
    pub(super) says: String,
    pub(super) status: Status,
    pub(super) goals: Vec<String>,
    pub(super) sources: Vec<String>,
    pub(super) rests_on: Vec<String>,
    pub(super) code: Vec<String>,
    pub(super) diagnostics: Vec<String>,
    pub(super) evidence: Vec<Item>,
    pub(super) open: Option<String>,
}

/// An assumption of use with what monitors it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct JudgedAssumption {
    pub(super) id: String,
    pub(super) says: String,
    pub(super) status: Status,
    pub(super) sources: Vec<String>,
    pub(super) keep: String,
    pub(super) monitors: Vec<String>,
    pub(super) tests: Vec<Item>,
    pub(super) unseen: Option<String>,
}

impl JudgedRequirement {
    /// Whether something that should show it does not.
    pub(super) fn failed(&self) -> bool {
        self.evidence
            .iter()
            .any(|item| item.state == State::NotShown)
    }
}

/// All that was found.
pub(super) struct Findings<'s>(Vec<&'s Finding>);

impl<'s> Findings<'s> {
    pub(super) fn of(steps: &'s [Step]) -> Self {
        // What was not done has found nothing.
        let done = steps
            .iter()
            .filter(|step| matches!(step.outcome, Outcome::Passed | Outcome::Failed(_)));
        Self(done.flat_map(|step| &step.findings).collect())
    }

    pub(super) fn requirement(&self, requirement: &Requirement) -> JudgedRequirement {
        let evidence: Vec<Item> = requirement
            .evidence
            .each()
            .map(|it| self.item(it))
            .collect();
        JudgedRequirement {
            id: requirement.id.clone(),
            says: requirement.says.clone(),
            status: status(&evidence),
            goals: requirement.goals.clone(),
            sources: requirement.sources.clone(),
            rests_on: requirement.rests_on.clone(),
            code: requirement.code.clone(),
            diagnostics: requirement.diagnostics.clone(),
            evidence,
            open: requirement.open.clone(),
        }
    }

    pub(super) fn assumption(&self, assumption: &Assumption) -> JudgedAssumption {
        let test = |name: &String| {
            self.item(Evidence {
                kind: Kind::Test,
                name,
            })
        };
        JudgedAssumption {
            id: assumption.id.clone(),
            says: assumption.says.clone(),
            status: Status::Assumed,
            sources: assumption.sources.clone(),
            keep: assumption.keep.clone(),
            monitors: assumption.monitors.clone(),
            tests: assumption.tests.iter().map(test).collect(),
            unseen: assumption.unseen.clone(),
        }
    }

    fn item(&self, Evidence { kind, name }: Evidence<'_>) -> Item {
        let all = self.0.iter();
        let about: Vec<&&Finding> = all
            .filter(|it| it.kind == kind && it.name == name)
            .collect();
        let said: Vec<&str> = about.iter().map(|finding| finding.said.as_str()).collect();
        let state = match () {
            () if kind == Kind::Record => State::Elsewhere,
            () if about.is_empty() => State::NotDone,
            () if about.iter().all(|finding| finding.shown) => State::Shown,
            () => State::NotShown,
        };
        Item {
            kind,
            name: name.to_owned(),
            state,
            said: said.join("; "),
        }
    }
}

/// Proofs count before tests; what is recorded elsewhere does not count.
fn status(evidence: &[Item]) -> Status {
    if evidence.is_empty() || evidence.iter().any(|item| item.state == State::NotShown) {
        return Status::Open;
    }
    let counted = evidence
        .iter()
        .filter(|item| item.state != State::Elsewhere);
    let (proofs, tests): (Vec<&Item>, Vec<&Item>) = counted.partition(|item| item.kind.is_proof());
    let (decisive, status) = match proofs.is_empty() {
        true => (tests, Status::Tested),
        false => (proofs, Status::Proved),
    };
    let done = !decisive.is_empty() && decisive.iter().all(|item| item.state == State::Shown);
    if done { status } else { Status::Skipped }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(kind: Kind, state: State) -> Item {
        Item {
            kind,
            name: "name".to_owned(),
            state,
            said: String::new(),
        }
    }

    #[test]
    fn the_weakest_of_the_strongest_kind_decides() {
        use Kind::{Campaign, Lemma, Record, Test, Theorem};
        use State::{Elsewhere, NotDone, NotShown, Shown};
        for (evidence, expected) in [
            (&[][..], Status::Open),
            (&[(Lemma, Shown), (Test, Shown)], Status::Proved),
            (&[(Lemma, Shown), (Test, NotDone)], Status::Proved),
            (&[(Lemma, Shown), (Theorem, NotDone)], Status::Skipped),
            (&[(Lemma, Shown), (Test, NotShown)], Status::Open),
            (
                &[(Campaign, Shown), (Test, Shown), (Record, Elsewhere)],
                Status::Tested,
            ),
            (&[(Campaign, Shown), (Test, NotDone)], Status::Skipped),
            (&[(Record, Elsewhere)], Status::Skipped),
        ] {
            let evidence: Vec<Item> = evidence
                .iter()
                .map(|(kind, state)| item(*kind, *state))
                .collect();
            assert_eq!(status(&evidence), expected, "{evidence:?}");
        }
    }
}
