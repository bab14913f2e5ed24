//! JUnit XML, as CI systems read it: a case for each check, requirement and assumption.
//!
//! Written by hand: one element a case needs no library.

use super::judged::{JudgedAssumption, JudgedRequirement, Status};
use super::report::Report;
use super::steps::{Outcome, Step};

/// What becomes of a case.
enum Verdict {
    Passed,
    Failed(String),
    Skipped(String),
}

struct Case {
    name: String,
    says: String,
    seconds: f64,
    verdict: Verdict,
}

/// The report as XML.
pub(super) fn write(report: &Report) -> String {
    let checks: Vec<Case> = report.steps.iter().map(Case::of_step).collect();
    let requirements = report.requirements.iter();
    let requirements: Vec<Case> = requirements.map(Case::of_requirement).collect();
    let assumptions = report.assumptions.iter();
    let assumptions: Vec<Case> = assumptions.map(Case::of_assumption).collect();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"cede verify all\">\n{}{}{}</testsuites>\n",
        suite("checks", &checks),
        suite("requirements", &requirements),
        suite("assumptions of use", &assumptions),
    )
}

impl Case {
    fn of_step(step: &Step) -> Self {
        Self {
            name: step.name.to_owned(),
            says: format!("{}\n{}", step.command, step.summary),
            seconds: step.seconds,
            verdict: match &step.outcome {
                Outcome::Passed => Verdict::Passed,
                Outcome::Failed(why) => Verdict::Failed(why.clone()),
                Outcome::Missing(why) => Verdict::Failed(format!("not done: {why}")),
                Outcome::Elsewhere => {
                    Verdict::Skipped(format!("by its own command; {}", step.summary))
                }
            },
        }
    }

    fn of_requirement(requirement: &JudgedRequirement) -> Self {
        let open = requirement.open.clone().unwrap_or_default();
        Self {
            name: requirement.id.clone(),
            says: format!("{}\n{open}", requirement.says),
            seconds: 0.0,
            verdict: match requirement.status {
                _ if requirement.failed() => Verdict::Failed("its evidence failed".to_owned()),
                Status::Proved | Status::Tested => Verdict::Passed,
                status => Verdict::Skipped(format!("{}: {open}", status.word())),
            },
        }
    }

    fn of_assumption(assumption: &JudgedAssumption) -> Self {
        Self {
            name: assumption.id.clone(),
            says: format!("{}\n{}", assumption.says, assumption.keep),
            seconds: 0.0,
            verdict: Verdict::Skipped("assumed: for the integrator to keep".to_owned()),
        }
    }

    fn xml(&self) -> String {
        let body = match &self.verdict {
            Verdict::Passed => String::new(),
            Verdict::Failed(why) => format!("<failure message=\"{}\"/>", escaped(why)),
            Verdict::Skipped(why) => format!("<skipped message=\"{}\"/>", escaped(why)),
        };
        let (name, seconds) = (escaped(&self.name), self.seconds);
        let says = escaped(self.says.trim());
        format!(
            "<testcase classname=\"cede\" name=\"{name}\" time=\"{seconds:.3}\">{body}<system-out>{says}</system-out></testcase>\n"
        )
    }
}

fn suite(name: &str, cases: &[Case]) -> String {
    let failures = cases
        .iter()
        .filter(|case| matches!(case.verdict, Verdict::Failed(_)))
        .count();
    let skipped = cases
        .iter()
        .filter(|case| matches!(case.verdict, Verdict::Skipped(_)))
        .count();
    let time: f64 = cases.iter().map(|case| case.seconds).sum();
    let (tests, body) = (cases.len(), cases.iter().map(Case::xml).collect::<String>());
    format!(
        "<testsuite name=\"{name}\" tests=\"{tests}\" failures=\"{failures}\" errors=\"0\" skipped=\"{skipped}\" time=\"{time:.3}\">\n{body}</testsuite>\n"
    )
}

/// `text` for the inside of an element or of an attribute in double quotes, in XML and in HTML. Characters that XML does
/// not have become `\u{FFFD}`.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push_str("&#10;"),
            '\t' => escaped.push_str("&#9;"),
            c if c < ' ' || c == '\u{FFFE}' || c == '\u{FFFF}' => escaped.push('\u{FFFD}'),
            c => escaped.push(c),
        }
    }
    escaped
}
