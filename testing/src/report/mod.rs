//! What came of the checks: text for people, JUnit and JSON for machines.

mod junit;
mod text;

use serde::Serialize;

/// What came of all checks. Displays as text for people.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// What was checked.
    pub subject: String,
    /// What the cases were drawn from; the same seed gives the same cases.
    pub seed: u64,
    /// Cases that were asked for, for each check that draws them.
    pub cases: u32,
    /// What came of each check.
    pub outcomes: Vec<Outcome>,
}

/// What came of one check.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Outcome {
    /// Its name, as in `no-overlap`.
    pub id: &'static str,
    /// What it demands.
    pub sentence: &'static str,
    /// Whether it is so.
    pub verdict: Verdict,
    /// Cases that were judged.
    pub cases: u32,
    /// Cases that were drawn and did not count, because they do not start within the contract.
    pub skipped_cases: u32,
    /// Measurements, with their units.
    pub numbers: Vec<(String, f64)>,
    /// Seconds that it took.
    pub seconds: f64,
}

/// Whether what a check demands is so.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "is", content = "details", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Verdict {
    /// No case says otherwise.
    Passed,
    /// A case says otherwise.
    Failed(Failure),
    /// It could not be tried, and why.
    Skipped(String),
}

/// Why a check fails.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Failure {
    /// What is wrong.
    pub message: String,
    /// What to change, if that is known.
    pub mend: Option<String>,
    /// The simplest case that was found, in words and as a picture.
    pub case: Option<String>,
}

impl Report {
    /// Whether no check failed. One that was skipped has not failed: see [`Report::skipped`].
    #[must_use]
    pub fn passed(&self) -> bool {
        self.failed().next().is_none()
    }

    /// The checks that failed.
    pub fn failed(&self) -> impl Iterator<Item = &Outcome> {
        self.outcomes
            .iter()
            .filter(|outcome| matches!(outcome.verdict, Verdict::Failed(_)))
    }

    /// The checks that could not be tried.
    pub fn skipped(&self) -> impl Iterator<Item = &Outcome> {
        self.outcomes
            .iter()
            .filter(|outcome| matches!(outcome.verdict, Verdict::Skipped(_)))
    }

    /// The check named `id`.
    #[must_use]
    pub fn outcome(&self, id: &str) -> Option<&Outcome> {
        self.outcomes.iter().find(|outcome| outcome.id == id)
    }

    /// 0 if no check failed, else 1: for [`std::process::exit`].
    #[must_use]
    pub fn exit_code(&self) -> i32 {
        i32::from(!self.passed())
    }

    /// The report as JSON, indented. Numbers that are none are `null`.
    #[must_use]
    pub fn to_json(&self) -> String {
        // A report is plain data: text, numbers and lists of them.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// The report as JUnit XML: one test case a check, named by its id.
    #[must_use]
    pub fn to_junit(&self) -> String {
        junit::write(self)
    }

    /// Panics with the report as text if a check failed: for a test of one's own.
    ///
    /// # Panics
    /// If a check failed.
    #[track_caller]
    pub fn assert_passed(&self) {
        assert!(self.passed(), "{self}");
    }
}

impl Outcome {
    /// Why it failed, if it did.
    #[must_use]
    pub fn failure(&self) -> Option<&Failure> {
        match &self.verdict {
            Verdict::Failed(failure) => Some(failure),
            _ => None,
        }
    }
}

#[cfg(test)]
pub(crate) fn example() -> Report {
    let outcome = |id, verdict| Outcome {
        id,
        sentence: "What \"is\" <demanded>.",
        verdict,
        cases: 7,
        skipped_cases: 2,
        numbers: vec![("share".to_owned(), 0.5)],
        seconds: 0.25,
    };
    let failure = Failure {
        message: "a < b & \"c\"\u{1}".to_owned(),
        mend: Some("change ego.braking".to_owned()),
        case: Some("E ]]> 1\n'".to_owned()),
    };
    Report {
        subject: "a policy".to_owned(),
        seed: 3,
        cases: 7,
        outcomes: vec![
            outcome("good", Verdict::Passed),
            outcome("bad", Verdict::Failed(failure)),
            outcome("left-out", Verdict::Skipped("no rule".to_owned())),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_sets_the_exit_code_and_a_skip_does_not() {
        let mut report = example();
        assert_eq!((report.exit_code(), report.skipped().count()), (1, 1));
        report.outcomes.remove(1);
        assert_eq!(report.exit_code(), 0);
    }

    #[test]
    fn json_has_verdicts_and_numbers() {
        let json: serde_json::Value = serde_json::from_str(&example().to_json()).unwrap();
        assert_eq!(json["outcomes"][1]["verdict"]["is"], "failed");
        assert_eq!(
            json["outcomes"][1]["verdict"]["details"]["mend"],
            "change ego.braking"
        );
        assert_eq!(json["outcomes"][0]["numbers"][0][1], 0.5);
    }
}
