//! Which trainings `cede reproduce` needs, and on what each policy is judged.

use super::Args;
use super::job::Job;
use crate::failure::Failure;
use crate::settings::{self, AlgorithmName, RowSettings};
use crate::source::not_empty;
use cede_data::{Dataset, Encounter, Split};
use cede_sim::evaluate::Selection;
use cede_train::run::Algorithm;
use std::path::Path;

/// The rows to train, each once, with their settings.
///
/// # Errors
/// A setting is out of its range, or its row is not trained.
pub(super) fn rows(args: &Args) -> Result<Vec<RowSettings>, Failure> {
    let mut rows: Vec<Algorithm> = Vec::new();
    for AlgorithmName(row) in &args.rows {
        if !rows.contains(row) {
            rows.push(*row);
        }
    }
    settings::of_rows(&rows, &args.set)
}

/// The site of `--transfer`.
///
/// # Errors
/// Its recordings cannot be read, or contain no encounters.
pub(super) fn transfer_site(args: &Args) -> Result<Option<Dataset>, Failure> {
    let Some(site) = &args.transfer else {
        return Ok(None);
    };
    let dataset = Dataset::load(Path::new(&args.source.data), site)?;
    not_empty(&dataset)?;
    Ok(Some(dataset))
}

/// The splits that contain encounters.
pub(super) fn splits(dataset: &Dataset) -> Vec<Split> {
    [Split::Train, Split::Validation, Split::Test]
        .into_iter()
        .filter(|&split| dataset.split(split).next().is_some())
        .collect()
}

/// What the policies are trained and judged on.
#[derive(Clone, Copy)]
pub(super) struct Data<'d> {
    pub(super) dataset: &'d Dataset,
    /// All pairs of vehicles in the recordings, for algorithms that use auxiliary encounters.
    pub(super) every_pair: Option<&'d Dataset>,
    /// Another site, for judgement only.
    pub(super) transfer: Option<&'d Dataset>,
}

impl<'d> Data<'d> {
    /// One training per row and seed, and with `leave_one_file_out` one more for each file left out.
    pub(super) fn jobs(
        self,
        rows: &[RowSettings],
        seeds: u64,
        leave_one_file_out: bool,
    ) -> Vec<Job<'d>> {
        let judged = self.selections();
        let mut jobs = Vec::new();
        for seed in 0..seeds {
            for row in rows {
                jobs.push(self.on_the_training_split(row, seed, judged.clone()));
                if leave_one_file_out {
                    jobs.extend(self.without_each_file(row, seed));
                }
            }
        }
        jobs
    }

    /// The encounters to judge on, by the name of their selection.
    fn selections(self) -> Vec<(String, Vec<&'d Encounter>)> {
        let splits = splits(self.dataset).into_iter().map(|split| {
            let name = Selection::Split(split).name().to_owned();
            (name, self.dataset.split(split).collect())
        });
        let transfer = self.transfer.map(|site| {
            let name = format!("{}, all", site.site.name);
            (name, site.encounters.iter().collect())
        });
        splits.chain(transfer).collect()
    }

    fn on_the_training_split(
        self,
        row: &RowSettings,
        seed: u64,
        judged: Vec<(String, Vec<&'d Encounter>)>,
    ) -> Job<'d> {
        let training: Vec<_> = self.dataset.split(Split::Train).collect();
        Job {
            row: row.clone(),
            seed,
            without: None,
            auxiliary: self.auxiliary(row.algorithm, &training),
            training,
            validation: self.dataset.split(Split::Validation).collect(),
            judged,
        }
    }

    fn without_each_file(self, row: &RowSettings, seed: u64) -> impl Iterator<Item = Job<'d>> {
        let folds = self.dataset.folds().into_iter();
        folds.map(move |fold| Job {
            row: row.clone(),
            seed,
            without: Some(fold.file),
            auxiliary: self.auxiliary(row.algorithm, &fold.train),
            training: fold.train,
            validation: Vec::new(),
            judged: vec![(Selection::LeaveOneFileOut.name().to_owned(), fold.held_out)],
        })
    }

    /// The auxiliary encounters: all pairs of vehicles in the files of `training`.
    fn auxiliary(self, algorithm: Algorithm, training: &[&Encounter]) -> Vec<&'d Encounter> {
        let in_training = |file| training.iter().any(|e| e.id.file == file);
        let pairs = self
            .every_pair
            .filter(|_| algorithm.uses_auxiliary_encounters());
        let pairs = pairs.into_iter().flat_map(|pairs| &pairs.encounters);
        pairs.filter(|e| in_training(e.id.file)).collect()
    }
}
