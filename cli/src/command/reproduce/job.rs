//! One training of a row, and what it left: weights and a learning curve.

use super::Trained;
use crate::failure::Failure;
use crate::interrupt;
use crate::training::{Identity, Training};
use cede_data::{Encounter, output};
use cede_formats::cede;
use cede_train::driving::episodes::Course;
use cede_train::run::curve::{Curve, Panel};
use cede_train::run::provenance::{Provenance, data_hash};
use cede_train::run::{Algorithm, Lessons, Settings};
use std::path::{Path, PathBuf};

/// One training and what it is judged on.
pub(super) struct Job<'d> {
    pub(super) algorithm: Algorithm,
    pub(super) settings: Settings,
    pub(super) seed: u64,
    /// The file that it does not learn from, in leave-one-file-out.
    pub(super) without: Option<u16>,
    pub(super) training: Vec<&'d Encounter>,
    /// What it may look at beside them: none of them is judged.
    pub(super) beside: Vec<&'d Encounter>,
    /// What the learning curve is drawn of, beside what it learns from.
    pub(super) validation: Vec<&'d Encounter>,
    /// Encounters by the name of what they are a selection of.
    pub(super) judged: Vec<(String, Vec<&'d Encounter>)>,
}

impl Job<'_> {
    /// Name of its files.
    fn name(&self) -> String {
        let without = self.without.map(|file| format!("-without-{file}"));
        let (row, seed) = (self.algorithm.name(), self.seed);
        format!("{row}-{seed}{}", without.unwrap_or_default())
    }

    fn provenance(&self, identity: &Identity, site: &str) -> Provenance {
        Provenance {
            algorithm: self.algorithm.name().to_owned(),
            settings: identity.settings.text(),
            seed: self.seed,
            data: format!("recordings of {site}"),
            encounters: self.training.len() + self.beside.len(),
            data_hash: identity.data,
            command: "cede reproduce".to_owned(),
        }
    }

    /// Trains, or with `resume` takes up what is in `folder` from an earlier time. `progress` is
    /// told, now and then, which share of the work has been done since it was last told.
    ///
    /// # Errors
    /// A file cannot be used or written, training diverges, or the user has asked to stop.
    pub(super) fn train(
        &self,
        site: &str,
        folder: &Path,
        resume: bool,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Trained, Failure> {
        interrupt::check()?;
        let identity = Identity {
            data: data_hash(self.training.iter().chain(&self.beside).copied(), ""),
            algorithm: self.algorithm,
            seed: self.seed,
            settings: self.settings.clone(),
        };
        let provenance = self.provenance(&identity, site);
        let file = folder.join(self.name() + ".cede");
        if resume && let Some(trained) = finished(&file, &provenance) {
            progress(1.0);
            return Ok(trained);
        }
        let lessons = Lessons::new(&self.training, &self.beside);
        let panel = self.without.is_none().then(|| Panel {
            train: &lessons.courses,
            validation: self.validation.iter().map(|e| Course::new(e)).collect(),
        });
        let checkpoint = file.with_extension("checkpoint");
        let mut training = if resume && checkpoint.exists() {
            Training::resume(identity, &lessons, panel, checkpoint)?
        } else {
            Training::new(identity, &lessons, panel, checkpoint)
        };
        let mut told = 0.0;
        training.finish(|report, _, _| {
            let share = report.done as f64 / report.total.max(1) as f64;
            progress(share - told);
            told = share;
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

/// What an earlier time left, if it is the same training.
fn finished(file: &Path, provenance: &Provenance) -> Option<Trained> {
    let policy = cede::load(file).ok()?;
    let curve = serde_json::from_slice(&std::fs::read(curve_file(file)).ok()?).ok()?;
    let same = policy.weights().provenance() == provenance.hash();
    same.then_some(Trained { policy, curve })
}

/// The curve goes first: where the weights are, it is there.
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
