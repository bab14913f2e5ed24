//! One training of a row, with its files: weights, learning curve and checkpoint.

use crate::failure::Failure;
use crate::interrupt;
use crate::progress;
use crate::settings::RowSettings;
use crate::training::{Identity, Training};
use cede_controller::Policy;
use cede_data::{Encounter, output};
use cede_formats::cede;
use cede_train::driving::episodes::Course;
use cede_train::run::Lessons;
use cede_train::run::curve::{Curve, Panel};
use cede_train::run::provenance::{Provenance, data_hash};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

/// One training, and what its policy is judged on.
pub(super) struct Job<'d> {
    pub(super) row: RowSettings,
    pub(super) seed: u64,
    /// In a cross-validation by file, the round.
    pub(super) round: Option<usize>,
    pub(super) training: Vec<&'d Encounter>,
    /// Auxiliary encounters; the policy is not judged on them.
    pub(super) auxiliary: Vec<&'d Encounter>,
    /// Encounters for the learning curve, in addition to those of the training.
    pub(super) validation: Vec<&'d Encounter>,
    /// The encounters to judge on.
    pub(super) judged: Vec<Judged<'d>>,
}

/// Encounters to judge on.
#[derive(Clone)]
pub(super) struct Judged<'d> {
    /// Name of their site.
    pub(super) site: &'d str,
    /// Name of their selection.
    pub(super) split: &'static str,
    pub(super) encounters: Vec<&'d Encounter>,
}

/// The result of a training.
pub(super) struct Trained {
    pub(super) policy: Policy<'static>,
    pub(super) curve: Curve,
}

/// Trains all `jobs`, as many at a time as there are threads.
///
/// # Errors
/// A training fails, or the user has interrupted the command.
pub(super) fn train_all(
    jobs: &[Job<'_>],
    site: &str,
    folder: &Path,
    resume: bool,
) -> Result<Vec<Trained>, Failure> {
    /// Positions of the bar per training.
    const FINE: f64 = 1e4;
    let length = jobs.len() as u64 * FINE as u64;
    let bar = progress::bar(length, "{bar:30} {percent} % of {msg}, {eta} left");
    bar.set_message(format!("{} trainings", jobs.len()));
    let (done, finished) = (Mutex::new(0.0), AtomicUsize::new(0));
    let progress = |share: f64| {
        if let Ok(mut done) = done.lock() {
            *done += share;
            bar.set_position((*done * FINE) as u64);
        }
    };
    let trained = jobs
        .par_iter()
        .with_max_len(1)
        .map(|job| {
            let begun = Instant::now();
            let trained = job.train(site, folder, resume, &progress)?;
            // Without a terminal there is no bar.
            if bar.is_hidden() {
                let count = finished.fetch_add(1, Relaxed) + 1;
                let (all, seconds) = (jobs.len(), begun.elapsed().as_secs_f64());
                note!("{count} of {all} trainings: {}, {seconds:.1} s", job.name());
            }
            Ok(trained)
        })
        .collect();
    bar.finish_and_clear();
    trained
}

impl Job<'_> {
    /// Name of its files, without extension.
    fn name(&self) -> String {
        let round = self.round.map(|round| format!("-round-{round}"));
        let (row, seed) = (self.row.algorithm.name(), self.seed);
        format!("{row}-{seed}{}", round.unwrap_or_default())
    }

    fn provenance(&self, identity: &Identity, site: &str) -> Provenance {
        Provenance {
            algorithm: self.row.algorithm.name().to_owned(),
            settings: identity.settings.text(),
            seed: self.seed,
            data: format!("recordings of {site}"),
            encounters: self.training.len() + self.auxiliary.len(),
            data_hash: identity.data,
            command: "cede reproduce".to_owned(),
        }
    }

    /// Trains, or with `resume` continues from the files in `folder`. Calls `progress` with the share
    /// of the work that has been done since the last call.
    ///
    /// # Errors
    /// A file cannot be used or written, training diverges, or the user has interrupted the command.
    fn train(
        &self,
        site: &str,
        folder: &Path,
        resume: bool,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Trained, Failure> {
        interrupt::check()?;
        let identity = Identity {
            data: data_hash(self.training.iter().chain(&self.auxiliary).copied(), ""),
            algorithm: self.row.algorithm,
            seed: self.seed,
            settings: self.row.settings.clone(),
        };
        let provenance = self.provenance(&identity, site);
        let file = folder.join(self.name() + ".cede");
        if resume && let Some(trained) = finished(&file, &provenance) {
            progress(1.0);
            return Ok(trained);
        }
        let lessons = Lessons::new(&self.training, &self.auxiliary);
        let panel = self.round.is_none().then(|| Panel {
            train: &lessons.courses,
            validation: self.validation.iter().map(|e| Course::new(e)).collect(),
        });
        let checkpoint = file.with_extension("checkpoint");
        let mut training = if resume && checkpoint.exists() {
            Training::resume(identity, &lessons, panel, checkpoint)?
        } else {
            Training::new(identity, &lessons, panel, checkpoint)
        };
        let mut reported = 0.0;
        training.finish(|report, _, _| {
            let share = report.done as f64 / report.total.max(1) as f64;
            progress(share - reported);
            reported = share;
            Ok(())
        })?;
        let words = training.run.view().weights(provenance.hash());
        let words = words.map_err(|error| self.diverged(&error))?;
        let curve = std::mem::take(&mut training.curve);
        write(&file, &words, &curve)?;
        training.clean();
        let policy = cede::keep(&words).map_err(|error| self.diverged(&error))?;
        Ok(Trained { policy, curve })
    }

    fn diverged(&self, error: &impl std::fmt::Display) -> Failure {
        Failure::input(format!("{}: {error}", self.name()), "try other seeds")
    }
}

/// The result of an earlier run, if it is of the same training.
fn finished(file: &Path, provenance: &Provenance) -> Option<Trained> {
    let policy = cede::load(file).ok()?;
    let curve = serde_json::from_slice(&std::fs::read(curve_file(file)).ok()?).ok()?;
    let same = policy.weights().provenance() == provenance.hash();
    same.then_some(Trained { policy, curve })
}

/// Writes the curve before the weights, so that weights never lack their curve.
fn write(file: &Path, words: &[u32], curve: &Curve) -> Result<(), Failure> {
    output::write(&curve_file(file), |out| {
        serde_json::to_writer(out, curve).map_err(Into::into)
    })?;
    output::write(file, |out| {
        let mut bytes = words.iter().map(|word| word.to_le_bytes());
        bytes.try_for_each(|word| out.write_all(&word))
    })?;
    Ok(())
}

fn curve_file(weights: &Path) -> PathBuf {
    weights.with_extension("curve.json")
}
