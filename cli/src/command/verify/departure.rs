//! `cede verify departure`.

use super::checked::open;
use super::policy::{policy_words, properties_of, subject};
use super::seconds;
use crate::drivers::WEIGHTS;
use crate::failure::Failure;
use crate::input::{self, unusable};
use crate::threads::Threads;
use cede_controller::Weights;
use cede_controller::policy::{embedded, weights::words};
use cede_formats::property::StateProperty;
use clap::Args;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The text below the options in `cede help verify departure`.
const HELP: &str = "\
The bound is proved: no state of a property's region has a larger departure, whatever the rounding. Exit code 1 if it
is larger than the bar.";

/// Options of `cede verify departure`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Departure {
    /// The policy in f32 (`.cede`); by default the embedded one.
    #[arg(long, value_name = "FILE", requires = "integers")]
    weights: Option<PathBuf>,
    /// The policy of integers that was made of it (`.cede`); by default the embedded one.
    #[arg(long, value_name = "FILE")]
    integers: Option<PathBuf>,
    /// The properties (TOML) on whose regions the policies are compared; by default those of `docs/safety/policy.toml`
    /// at the time of the build.
    #[arg(long, value_name = "FILE")]
    properties: Option<PathBuf>,
    /// Only the regions of the properties with these identifiers, separated by commas.
    #[arg(long, value_name = "ID[,ID…]", value_delimiter = ',')]
    only: Vec<String>,
    /// The largest departure (m/s²) that is to be proved.
    #[arg(long, value_name = "M/S2", default_value_t = 0.07)]
    bar: f64,
    /// Time limit per property and combination of its lists, in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 10, value_parser = seconds())]
    timeout: u64,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

impl Departure {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        let (place, own) = policy_words(self.weights.as_deref())?;
        let subject = subject(place, &own)?;
        let (path, words) = self.integers()?;
        let integers = Weights::parse(&words).map_err(|error| unusable(path, error, WEIGHTS))?;
        let limit = Duration::from_secs(self.timeout);
        let mut larger = Vec::new();
        let mut objects = Vec::new();
        for property in self.properties()? {
            let found = subject
                .departure(integers, std::slice::from_ref(&property), self.bar, limit)
                .map_err(|error| {
                    unusable(
                        path,
                        error,
                        "the policy of integers that was made of the other",
                    )
                })?;
            if found.bound > self.bar {
                larger.push(property.id.clone());
            }
            if !self.json {
                println!(
                    "{:<6} at most {:.4} m/s² ({} boxes; largest in their middles {:.4})",
                    property.id, found.bound, found.boxes, found.sampled
                );
            }
            objects.push(serde_json::json!({
                "id": property.id, "at_most": found.bound, "sampled": found.sampled, "boxes": found.boxes,
            }));
        }
        if self.json {
            println!(
                "{}",
                serde_json::json!({ "bar": self.bar, "departures": objects })
            );
        }
        let larger = larger.iter().map(String::as_str);
        let what = format!("not shown to be at most {} m/s²", self.bar);
        open(&what, larger).map_or(Ok(()), |open| Err(Failure::Check(open)))
    }

    fn integers(&self) -> Result<(&Path, Vec<u32>), Failure> {
        let Some(path) = &self.integers else {
            let embedded = embedded::words_i16().to_vec();
            return Ok((Path::new("the embedded policy of integers"), embedded));
        };
        Ok((path, words(&input::bytes(path, WEIGHTS)?).collect()))
    }

    fn properties(&self) -> Result<Vec<StateProperty>, Failure> {
        let mut all = properties_of(self.properties.as_deref())?;
        let unknown = |id: &&String| all.iter().all(|property| property.id != **id);
        if let Some(id) = self.only.iter().find(unknown) {
            return Err(Failure::input(
                format!("there is no property {id}"),
                "`--only` takes identifiers of the file, such as SR-22",
            ));
        }
        all.retain(|property| self.only.is_empty() || self.only.contains(&property.id));
        Ok(all)
    }
}
