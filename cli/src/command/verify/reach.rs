//! `cede verify reach`.

use super::policy::{policy_words, subject};
use super::seconds;
use crate::failure::Failure;
use crate::input::{self, unusable};
use crate::threads::Threads;
use cede_verify::reach::{Finding, Scenario, Scenarios, Settled, settle};
use clap::Args;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The text below the options in `cede help verify reach`.
const HELP: &str = "\
Starts from all states of a region. Exit code 1 if a scenario's claim is not proved.";

/// The claims about the embedded policy with its shield.
const SCENARIOS: &str = include_str!("../../../../docs/safety/reach.toml");

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
        let (place, words) = policy_words(self.weights.as_deref())?;
        let subject = subject(place, &words)?;
        let scenarios = self.read()?.scenario;
        self.threads.start()?;
        let limit = Duration::from_secs(self.timeout);
        let settle = |scenario: Scenario| {
            let settled = settle(&subject, &scenario, Instant::now() + limit);
            (scenario, settled)
        };
        let settled: Vec<(Scenario, Settled)> = scenarios.into_iter().map(settle).collect();
        // A closed pipe (`| head`) is not an error.
        let _ = writeln!(std::io::stdout(), "{}", self.told(&settled));
        let open: Vec<&str> = settled
            .iter()
            .filter(|(_, settled)| settled.finding != Finding::Proved)
            .map(|(scenario, _)| scenario.id.as_str())
            .collect();
        if open.is_empty() {
            Ok(())
        } else {
            Err(Failure::Check(format!("not proved: {}", open.join(", "))))
        }
    }

    fn read(&self) -> Result<Scenarios, Failure> {
        let Some(path) = &self.scenarios else {
            return scenarios(Path::new("docs/safety/reach.toml"), SCENARIOS);
        };
        scenarios(path, &input::text(path, SCENARIO)?)
    }

    fn told(&self, settled: &[(Scenario, Settled)]) -> String {
        if self.json {
            let rows: Vec<_> = settled.iter().map(json).collect();
            return serde_json::json!({ "scenarios": rows }).to_string();
        }
        settled.iter().map(text).collect::<Vec<_>>().join("\n")
    }
}

fn scenarios(path: &Path, text: &str) -> Result<Scenarios, Failure> {
    Scenarios::read(text).map_err(|error| unusable(path, error, SCENARIO))
}

fn word(finding: &Finding) -> &'static str {
    match finding {
        Finding::Proved => "proved",
        Finding::Unsettled(_) => "unsettled",
    }
}

fn text((scenario, settled): &(Scenario, Settled)) -> String {
    let mut line = format!(
        "{:<6} {:<9} {} ({} tubes, at most {:.1} s)",
        scenario.id,
        word(&settled.finding),
        scenario.title,
        settled.tubes,
        settled.latest
    );
    if let Finding::Unsettled([d, v, other_d, other_v]) = settled.finding {
        line += &format!(
            "\n       open for the ego at {d:.2?} m, {v:.2?} m/s, the other at {other_d:.2?} m, {other_v:.2?} m/s"
        );
    }
    line
}

fn json((scenario, settled): &(Scenario, Settled)) -> serde_json::Value {
    let open = match settled.finding {
        Finding::Proved => None,
        Finding::Unsettled(region) => Some(region),
    };
    serde_json::json!({
        "id": scenario.id, "title": scenario.title, "finding": word(&settled.finding), "open": open,
        "tubes": settled.tubes, "latest": settled.latest, "hull": settled.hull,
    })
}
