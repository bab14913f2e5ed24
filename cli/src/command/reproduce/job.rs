//! One training of a row, and what it left: weights and a learning curve.

use super::Trained;
use crate::failure::Failure;
use crate::interrupt;
use crate::training::{Identity, Training};
use cede_sim::{Encounter, output, weights};
use cede_train::curve::{Curve, Panel};
use cede_train::episodes::Course;
use cede_train::network::Network;
use cede_train::pilot::Pilot;
use cede_train::provenance::{Provenance, data_hash};
use cede_train::run::{Algorithm, Lessons};
use std::path::{Path, PathBuf};

/// From a member's seed to the next one's: more than anyone has seeds.
const MEMBER: u64 = 1 << 32;

/// One training and what it is judged on.
pub(super) struct Job<'d> {
    pub(super) algorithm: Algorithm,
    pub(super) seed: u64,
    /// The file that it does not learn from, in leave-one-file-out.
    pub(super) without: Option<u16>,
    pub(super) training: Vec<&'d Encounter>,
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
            encounters: self.training.len(),
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
            data: data_hash(self.training.iter().copied(), ""),
            algorithm: self.algorithm,
            seed: self.seed,
            settings: self.algorithm.reproduction(),
        };
        let provenance = self.provenance(&identity, site);
        let file = folder.join(self.name() + ".cede");
        if resume && let Some(trained) = finished(&file, &provenance) {
            progress(1.0);
            return Ok(trained);
        }
        let lessons = Lessons::new(&self.training, &[]);
        let panel = self.without.is_none().then(|| Panel {
            train: &lessons.courses,
            validation: self.validation.iter().map(|e| Course::new(e)).collect(),
        });
        let mut members: Vec<Training<'_>> = Vec::new();
        let count = self.algorithm.members();
        for member in 0..count {
            // The first member is what `cede train` makes of this seed.
            let identity = Identity {
                seed: self.seed + member * MEMBER,
                ..identity.clone()
            };
            let panel = panel.clone().filter(|_| member == 0);
            let checkpoint = file.with_extension(format!("{member}.checkpoint"));
            let mut training = if resume && checkpoint.exists() {
                Training::resume(identity, &lessons, panel, checkpoint)?
            } else {
                Training::new(identity, &lessons, panel, checkpoint)
            };
            let mut told = 0.0;
            training.finish(|report, _, _| {
                let share = report.done as f64 / (report.total.max(1) * count) as f64;
                progress(share - told);
                told = share;
                Ok(())
            })?;
            if count > 1 {
                // The next member may be interrupted.
                training.save()?;
            }
            members.push(training);
        }
        let networks: Vec<_> = members
            .iter()
            .map(|m| m.run.pilot().network.clone())
            .collect();
        let pilot = Pilot {
            network: &Network::mean(&networks),
            ..members[0].run.pilot()
        };
        let words = pilot.weights(provenance.hash());
        let words = words.map_err(|error| self.diverged(&error))?;
        let curve = std::mem::take(&mut members[0].curve);
        write(&file, &words, &curve)?;
        members.iter().for_each(Training::clean);
        let policy = weights::keep(&words).map_err(|error| self.diverged(&error))?;
        Ok(Trained { policy, curve })
    }

    fn diverged(&self, error: &impl std::fmt::Display) -> Failure {
        Failure::input(format!("{}: {error}", self.name()), "try other seeds")
    }
}

/// What an earlier time left, if it is the same training.
fn finished(file: &Path, provenance: &Provenance) -> Option<Trained> {
    let policy = weights::load(file).ok()?;
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
