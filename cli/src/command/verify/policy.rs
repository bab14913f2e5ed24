//! `cede verify policy`.

use super::checked::{Check, Checked, Finding, open};
use super::seconds;
use crate::drivers::WEIGHTS;
use crate::failure::Failure;
use crate::input::{self, unusable};
use crate::safety::Kind;
use crate::threads::Threads;
use cede_controller::policy::weights::words;
use cede_controller::{Perspective, Weights};
use cede_formats::property::{Properties, StateProperty};
use cede_verify::policy::{self, Settled, Subject};
use clap::Args;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The text below the options in `cede help verify policy`.
const HELP: &str = "\
A proof is about the controller's f32 arithmetic; a refutation is a state at which the controller was run.
Exit code 1 if a property is not proved.";

/// The claimed properties of the embedded policy.
pub(super) const PROPERTIES: &str = include_str!("../../../../docs/safety/policy.toml");

/// What the file of `--properties` should be.
const PROPERTY: &str = "properties as docs/safety/policy.toml has them";

/// Options of `cede verify policy`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Policy {
    /// The policy (`.cede`); by default the embedded one.
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// The properties (TOML); by default those of `docs/safety/policy.toml` at the time of the build.
    #[arg(long, value_name = "FILE")]
    properties: Option<PathBuf>,
    /// Time limit per property in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = seconds())]
    timeout: u64,
    /// Check every proof with the independent checker.
    #[arg(long)]
    check: bool,
    /// Also find the largest region, scaled about its centre, on which each property is proved.
    #[arg(long)]
    sweep: bool,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

impl Policy {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        self.check()?.tell(self.json)
    }

    fn row<'p>(&self, subject: &Subject<'_>, property: &'p StateProperty) -> PropertyRow<'p> {
        let limit = Duration::from_secs(self.timeout);
        let deadline = Instant::now() + limit;
        let settled = subject.settle(property, deadline, self.check);
        let late = settled.finding == policy::Finding::Unsettled && Instant::now() >= deadline;
        let largest = self
            .sweep
            .then(|| subject.largest_scale(property, Instant::now() + limit));
        PropertyRow {
            property,
            settled,
            out_of_time: late.then_some(self.timeout),
            largest,
        }
    }
}

impl Check for Policy {
    fn check(&self) -> Result<Checked, Failure> {
        let (place, words) = policy_words(self.weights.as_deref())?;
        let subject = subject(place, &words)?;
        let perspective = match subject.perspective() {
            Perspective::Joint => "joint",
            Perspective::Ego => "ego",
        };
        let properties = properties_of(self.properties.as_deref())?;
        let rows: Vec<PropertyRow<'_>> = properties.iter().map(|p| self.row(&subject, p)).collect();
        let unproved = rows.iter().filter(|row| !row.proved());
        let objects: Vec<_> = rows.iter().map(PropertyRow::json).collect();
        let texts: Vec<_> = rows.iter().map(PropertyRow::text).collect();
        let checked: usize = rows.iter().map(|row| row.settled.checked).sum();
        Ok(Checked {
            text: texts.join("\n"),
            json: serde_json::json!({ "semantics": "f32", "perspective": perspective, "properties": objects }),
            summary: format!(
                "{} of {} properties proved, {checked} regions checked independently",
                rows.iter().filter(|row| row.proved()).count(),
                rows.len()
            ),
            findings: rows.iter().map(PropertyRow::finding).collect(),
            open: open("not proved", unproved.map(|row| row.property.id.as_str())),
        })
    }
}

/// The words of a weights file with its name; without a `path` those of the embedded policy.
pub(super) fn policy_words(path: Option<&Path>) -> Result<(&Path, Vec<u32>), Failure> {
    let Some(path) = path else {
        let embedded = cede_controller::policy::embedded::words().to_vec();
        return Ok((Path::new("the embedded policy"), embedded));
    };
    Ok((path, words(&input::bytes(path, WEIGHTS)?).collect()))
}

/// The policy of the `words` of a weights file.
pub(super) fn subject<'w>(path: &Path, words: &'w [u32]) -> Result<Subject<'w>, Failure> {
    let weights = Weights::parse(words).map_err(|error| unusable(path, error, WEIGHTS))?;
    Subject::new(weights).map_err(|error| unusable(path, error, "another policy"))
}

/// The properties of a file; without a `path` those of the embedded policy.
pub(crate) fn properties_of(path: Option<&Path>) -> Result<Vec<StateProperty>, Failure> {
    let Some(path) = path else {
        return properties(Path::new("docs/safety/policy.toml"), PROPERTIES);
    };
    properties(path, &input::text(path, PROPERTY)?)
}

fn properties(path: &Path, text: &str) -> Result<Vec<StateProperty>, Failure> {
    let properties = Properties::read(text);
    Ok(properties
        .map_err(|error| unusable(path, error, PROPERTY))?
        .property)
}

/// A property with its result.
struct PropertyRow<'p> {
    property: &'p StateProperty,
    settled: Settled,
    /// The seconds that were not enough.
    out_of_time: Option<u64>,
    largest: Option<f64>,
}

impl PropertyRow<'_> {
    fn word(&self) -> &'static str {
        match self.settled.finding {
            policy::Finding::Proved => "proved",
            policy::Finding::Refuted { .. } => "refuted",
            policy::Finding::Unsettled => "unsettled",
        }
    }

    fn proved(&self) -> bool {
        self.settled.finding == policy::Finding::Proved
    }

    fn finding(&self) -> Finding {
        let Settled {
            regions, checked, ..
        } = self.settled;
        let said = format!(
            "{}: {regions} regions, {checked} checked independently",
            self.word()
        );
        Finding::new(Kind::Property, &self.property.id, self.proved(), said)
    }

    fn text(&self) -> String {
        let Settled {
            finding,
            regions,
            checked,
            rounding,
        } = &self.settled;
        let mut line = format!(
            "{:<6} {:<9} {} ({regions} regions",
            self.property.id,
            self.word(),
            self.property.title
        );
        if *checked > 0 {
            line += &format!(", {checked} checked independently");
        }
        if *rounding > 0.0 {
            line += &format!(", differences up to {rounding:.0e} m/s² of rounding");
        }
        line.push(')');
        if let policy::Finding::Refuted {
            state: [d, v, other_d, other_v],
            setting,
            acceleration,
        } = finding
        {
            line += &format!(
                "\n       ego {d} m at {v} m/s, other {other_d} m at {other_v} m/s, {:?}, right of way {:?}: {acceleration} m/s²",
                setting.kind, setting.right_of_way
            );
        }
        if let Some(seconds) = self.out_of_time {
            line += &format!("\n       {seconds} s ran out: give it more with --timeout SECONDS");
        }
        if let Some(scale) = self.largest {
            line += &format!(
                "\n       proved on {:.0} % of the region's widths about its centre",
                100.0 * scale
            );
        }
        line
    }

    fn json(&self) -> serde_json::Value {
        let witness = match &self.settled.finding {
            policy::Finding::Refuted {
                state,
                setting,
                acceleration,
            } => serde_json::json!({
                "state": state, "acceleration": acceleration,
                "conflict": format!("{:?}", setting.kind), "right_of_way": format!("{:?}", setting.right_of_way),
            }),
            _ => serde_json::Value::Null,
        };
        serde_json::json!({
            "id": self.property.id, "title": self.property.title, "finding": self.word(), "witness": witness,
            "regions": self.settled.regions, "checked": self.settled.checked,
            "rounding": self.settled.rounding, "largest_scale": self.largest,
        })
    }
}
