//! Which trainings `cede reproduce` needs, and on what each policy is judged.

use super::Args;
use super::job::{Job, Judged};
use crate::failure::Failure;
use crate::settings::{self, AlgorithmName, RowSettings};
use crate::source::{self, not_empty};
use cede_data::{Dataset, Encounter, Fold, Split};
use cede_sim::evaluate::Selection;
use cede_train::run::Algorithm;
use std::collections::HashSet;
use std::path::Path;

/// The rows to train at one site or at `several`, each once, with their settings.
///
/// # Errors
/// A setting is out of its range, or its row is not trained.
pub(super) fn rows(args: &Args, several: bool) -> Result<Vec<RowSettings>, Failure> {
    let mut rows: Vec<Algorithm> = Vec::new();
    for AlgorithmName(row) in &args.rows {
        if !rows.contains(row) {
            rows.push(*row);
        }
    }
    settings::of_rows(&rows, several, &args.set)
}

/// The site of `--transfer`.
///
/// # Errors
/// Its recordings cannot be read, or contain no encounters.
pub(super) fn transfer_site(args: &Args) -> Result<Option<Dataset>, Failure> {
    let Some(site) = &args.transfer else {
        return Ok(None);
    };
    let dataset = source::recorded(Path::new(&args.source.data), site)?;
    not_empty(&dataset)?;
    Ok(Some(dataset))
}

/// All pairs of vehicles at each of the `sites`, for algorithms among `rows` that use auxiliary encounters.
pub(super) fn every_pair(rows: &[RowSettings], sites: &[Dataset]) -> Vec<Dataset> {
    if rows
        .iter()
        .any(|row| row.settings.uses_auxiliary_encounters())
    {
        sites.iter().map(Dataset::every_pair).collect()
    } else {
        Vec::new()
    }
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
    pub(super) sites: &'d [Dataset],
    /// All pairs of vehicles in the recordings, for algorithms that use auxiliary encounters.
    pub(super) every_pair: &'d [Dataset],
    /// Another site, for judgement only.
    pub(super) transfer: Option<&'d Dataset>,
}

impl<'d> Data<'d> {
    /// One training per row and seed, and one more for each round of `held_out`.
    pub(super) fn jobs(
        self,
        rows: &[RowSettings],
        seeds: u64,
        held_out: Option<Selection>,
    ) -> Vec<Job<'d>> {
        let judged = self.selections();
        let mut jobs = Vec::new();
        for seed in 0..seeds {
            for row in rows {
                jobs.push(self.on_the_training_split(row, seed, judged.clone()));
                let rounds = held_out.into_iter();
                jobs.extend(rounds.flat_map(|held_out| self.cross_validation(row, seed, held_out)));
            }
        }
        jobs
    }

    /// The encounters to judge on.
    fn selections(self) -> Vec<Judged<'d>> {
        let of_site = |site: &'d Dataset| {
            let split = move |split| Judged {
                site: &site.site.name,
                split: Selection::Split(split).name(),
                encounters: site.split(split).collect(),
            };
            splits(site).into_iter().map(split)
        };
        let transfer = self.transfer.map(|site| Judged {
            site: &site.site.name,
            split: Selection::Split(Split::All).name(),
            encounters: site.encounters.iter().collect(),
        });
        self.sites
            .iter()
            .flat_map(of_site)
            .chain(transfer)
            .collect()
    }

    fn on_the_training_split(
        self,
        row: &RowSettings,
        seed: u64,
        judged: Vec<Judged<'d>>,
    ) -> Job<'d> {
        let of = |split| self.sites.iter().flat_map(move |site| site.split(split));
        let training: Vec<_> = of(Split::Train).collect();
        Job {
            row: row.clone(),
            seed,
            round: None,
            auxiliary: self.auxiliary(row, &training),
            training,
            validation: of(Split::Validation).collect(),
            judged,
        }
    }

    fn cross_validation(
        self,
        row: &RowSettings,
        seed: u64,
        held_out: Selection,
    ) -> impl Iterator<Item = Job<'d>> {
        let rounds = held_out
            .cross_validation(self.sites)
            .into_iter()
            .enumerate();
        rounds.map(move |(round, folds)| {
            let training: Vec<_> = folds.iter().flat_map(|fold| &fold.train).copied().collect();
            let judged = |(site, fold): (&'d Dataset, Fold<'d>)| Judged {
                site: &site.site.name,
                split: held_out.name(),
                encounters: fold.held_out,
            };
            Job {
                row: row.clone(),
                seed,
                round: Some(round),
                auxiliary: self.auxiliary(row, &training),
                training,
                validation: Vec::new(),
                judged: self.sites.iter().zip(folds).map(judged).collect(),
            }
        })
    }

    /// The auxiliary encounters: all pairs of vehicles in the files of `training`.
    fn auxiliary(self, row: &RowSettings, training: &[&Encounter]) -> Vec<&'d Encounter> {
        if !row.settings.uses_auxiliary_encounters() {
            return Vec::new();
        }
        let file = |e: &Encounter| (e.id.site.clone(), e.id.file);
        let files: HashSet<_> = training.iter().map(|e| file(e)).collect();
        let pairs = self.every_pair.iter().flat_map(|pairs| &pairs.encounters);
        pairs.filter(|e| files.contains(&file(e))).collect()
    }
}
