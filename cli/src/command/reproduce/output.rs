//! The results of `cede reproduce`: printed, and as `rows.json` in the folder.

use super::job::{Job, Trained};
use super::summary::{self, Seeded};
use crate::failure::Failure;
use crate::report::Learned;
use cede_data::output;
use serde::Serialize;
use std::path::Path;

/// The results; `--json` prints them, and `rows.json` stores them.
#[derive(Serialize)]
pub(super) struct Output<'a> {
    pub(super) data: &'a str,
    pub(super) site: &'a str,
    pub(super) rows: &'a [Seeded],
    pub(super) curves: &'a [Learned],
}

impl Output<'_> {
    /// Writes `rows.json` to `folder` and prints the results, as JSON or as a table.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(super) fn write(&self, folder: &Path, json: bool) -> Result<(), Failure> {
        let text = serde_json::to_string_pretty(self)
            .map_err(|error| Failure::input(error, "report this as a bug"))?;
        output::write(&folder.join("rows.json"), |file| {
            file.write_all(text.as_bytes())
        })?;
        if json {
            println!("{text}");
        } else {
            print!("{}", summary::render(self.rows));
            println!(
                "reports, weights and results of every seed: {}",
                folder.display()
            );
        }
        Ok(())
    }
}

/// The learning curves of the trainings on the training split.
pub(super) fn curves(jobs: &[Job<'_>], trained: &[Trained]) -> Vec<Learned> {
    let whole = jobs
        .iter()
        .zip(trained)
        .filter(|(job, _)| job.round.is_none());
    whole
        .map(|(job, trained)| Learned {
            driver: job.row.algorithm.name(),
            seed: job.seed,
            points: trained.curve.points.clone(),
        })
        .collect()
}
