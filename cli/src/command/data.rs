//! `cede data`: the content of recordings, and their encounters.

mod extract;
mod inspect;
mod new_site;
mod svo;
mod synthesize;

use crate::failure::Failure;
use cede_data::Dataset;
use clap::Subcommand;

/// What to do with the data.
#[derive(Subcommand)]
pub(crate) enum Data {
    /// Find the encounters in recorded tracks and write them as CSV
    Extract(extract::Args),
    /// Print the content of the recordings and draw the scene
    Inspect(inspect::Args),
    /// Draft a scene description of a site that has none
    NewSite(new_site::Args),
    /// Measure people's social value orientation (SVO): its distribution, and what it tells
    Svo(svo::Args),
    /// Write synthetic recordings, maps and scene descriptions
    Synthesize(synthesize::Args),
}

impl Data {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match self {
            Self::Extract(args) => extract::run(args),
            Self::Inspect(args) => inspect::run(args),
            Self::NewSite(args) => new_site::run(args),
            Self::Svo(args) => svo::run(args),
            Self::Synthesize(args) => synthesize::run(args),
        }
    }
}

/// Lists the files that were not read on stderr.
fn name_passed_over(dataset: &Dataset) {
    for path in &dataset.passed_over {
        note!(
            "skipped, because it contains pedestrians: {}",
            path.display()
        );
    }
}

fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value);
    println!(
        "{}",
        text.map_err(|error| Failure::input(error, "report this as a bug"))?
    );
    Ok(())
}
