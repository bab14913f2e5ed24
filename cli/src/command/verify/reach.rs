//! `cede verify reach`.

use super::checked::{Check, Checked, Finding, open};
use super::policy::{policy_words, subject};
use super::seconds;
use crate::failure::Failure;
use crate::input::{self, unusable};
use crate::safety::Kind;
use crate::threads::Threads;
use cede_verify::reach::{self, Scenario, Scenarios, Settled, settle};
use clap::Args;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The text below the options in `cede help verify reach`.
const HELP: &str = "\
Starts from all states of a region. Exit code 1 if a scenario's claim is not proved.";

/// The claims about the embedded policy with its shield.
pub(super) const SCENARIOS: &str = include_str!("../../../../docs/safety/reach.toml");

/// What the file should be.
const SCENARIO: &str = "scenarios as docs/safety/reach.toml has them";

/// Options of `cede verify reach`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Reach {
    /// The policy (`.cede`); by default the embedded one.
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// The scenarios (TOML); by default those of `docs/safety/reach.toml` at the time of the build.
    #[arg(long, value_name = "FILE")]
    scenarios: Option<PathBuf>,
    /// Time limit per scenario in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 120, value_parser = seconds())]
    timeout: u64,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

impl Reach {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        self.check()?.tell(self.json)
    }

    fn read(&self) -> Result<Scenarios, Failure> {
        let Some(path) = &self.scenarios else {
            return scenarios(Path::new("docs/safety/reach.toml"), SCENARIOS);
        };
        scenarios(path, &input::text(path, SCENARIO)?)
    }
}

/// A scenario with its result.
type SettledScenario = (Scenario, Settled);

impl Check for Reach {
    fn check(&self) -> Result<Checked, Failure> {
        let (place, words) = policy_words(self.weights.as_deref())?;
        let subject = subject(place, &words)?;
        let limit = Duration::from_secs(self.timeout);
        let settle = |scenario: Scenario| {
            let settled = settle(&subject, &scenario, Instant::now() + limit);
            (scenario, settled)
        };
        let rows: Vec<SettledScenario> = self.read()?.scenario.into_iter().map(settle).collect();
        let unproved = rows.iter().filter(|row| !proved(row));
        Ok(Checked {
            text: rows.iter().map(text).collect::<Vec<_>>().join("\n"),
            json: serde_json::json!({ "scenarios": rows.iter().map(json).collect::<Vec<_>>() }),
            summary: format!(
                "{} of {} claims about the closed loop proved",
                rows.iter().filter(|row| proved(row)).count(),
                rows.len()
            ),
            findings: rows.iter().map(finding).collect(),
            open: open(
                "not proved",
                unproved.map(|(scenario, _)| scenario.id.as_str()),
            ),
        })
    }
}

fn proved((_, settled): &SettledScenario) -> bool {
    settled.finding == reach::Finding::Proved
}

fn finding(row: &SettledScenario) -> Finding {
    let (scenario, settled) = row;
    let said = format!("{}: {} tubes", word(&settled.finding), settled.tubes);
    Finding::new(Kind::Scenario, &scenario.id, proved(row), said)
}

fn scenarios(path: &Path, text: &str) -> Result<Scenarios, Failure> {
    Scenarios::read(text).map_err(|error| unusable(path, error, SCENARIO))
}

fn word(finding: &reach::Finding) -> &'static str {
    match finding {
        reach::Finding::Proved => "proved",
        reach::Finding::Unsettled(_) => "unsettled",
    }
}

fn text((scenario, settled): &SettledScenario) -> String {
    let mut line = format!(
        "{:<6} {:<9} {} ({} tubes, at most {:.1} s)",
        scenario.id,
        word(&settled.finding),
        scenario.title,
        settled.tubes,
        settled.latest
    );
    if let reach::Finding::Unsettled([d, v, other_d, other_v]) = settled.finding {
        line += &format!(
            "\n       open for the ego at {d:.2?} m, {v:.2?} m/s, the other at {other_d:.2?} m, {other_v:.2?} m/s"
        );
    }
    line
}

fn json((scenario, settled): &SettledScenario) -> serde_json::Value {
    let open = match settled.finding {
        reach::Finding::Proved => None,
        reach::Finding::Unsettled(region) => Some(region),
    };
    serde_json::json!({
        "id": scenario.id, "title": scenario.title, "finding": word(&settled.finding), "open": open,
        "tubes": settled.tubes, "latest": settled.latest, "hull": settled.hull,
    })
}
