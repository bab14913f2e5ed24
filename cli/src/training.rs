//! A training: its run, its learning curve, and its checkpoints.

use crate::failure::Failure;
use crate::interrupt;
use cede_train::run::checkpoint::{Checkpoint, CheckpointError};
use cede_train::run::curve::{Curve, Panel, Point};
use cede_train::run::{Algorithm, Lessons, Report, Run, TrainSettings};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Time between two checkpoints.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(30);

/// What identifies a training.
#[derive(Clone, PartialEq)]
pub(crate) struct Identity {
    /// SHA-256 of the data that it learns from.
    pub(crate) data: [u8; 32],
    /// The algorithm.
    pub(crate) algorithm: Algorithm,
    /// Seed of every random choice.
    pub(crate) seed: u64,
    /// Its settings.
    pub(crate) settings: TrainSettings,
}

/// A training in progress.
pub(crate) struct Training<'e> {
    identity: Identity,
    /// Path of the checkpoint.
    checkpoint: PathBuf,
    /// The encounters for the learning curve; without them there is no curve.
    panel: Option<Panel<'e>>,
    pub(crate) run: Run<'e>,
    pub(crate) curve: Curve,
}

impl<'e> Training<'e> {
    /// A new training.
    pub(crate) fn new(
        identity: Identity,
        lessons: &'e Lessons<'e>,
        panel: Option<Panel<'e>>,
        checkpoint: PathBuf,
    ) -> Self {
        Self {
            run: Run::new(identity.settings.clone(), lessons, identity.seed),
            curve: Curve::default(),
            identity,
            checkpoint,
            panel,
        }
    }

    /// The training that was saved to `checkpoint`.
    ///
    /// # Errors
    /// The checkpoint cannot be used, or belongs to another training.
    pub(crate) fn resume(
        identity: Identity,
        lessons: &'e Lessons<'e>,
        panel: Option<Panel<'e>>,
        checkpoint: PathBuf,
    ) -> Result<Self, Failure> {
        let saved = Checkpoint::load(&checkpoint).map_err(|error| {
            let mend = match error {
                CheckpointError::Version { .. } => {
                    "resume with the program that wrote it, or start again without --resume"
                }
                CheckpointError::Content { .. } => "delete it, or start again without --resume",
                _ => "check the path, or start again without --resume",
            };
            Failure::input(error, mend)
        })?;
        let same = saved.data == identity.data
            && saved.algorithm == identity.algorithm
            && saved.seed == identity.seed
            && saved.settings == identity.settings.text();
        if !same {
            return Err(Failure::input(
                format!("{} belongs to another run", checkpoint.display()),
                "give the same algorithm, data, seed and settings, or start again without --resume",
            ));
        }
        Ok(Self {
            run: Run::resume(saved.progress, lessons),
            curve: saved.curve,
            identity,
            checkpoint,
            panel,
        })
    }

    /// Trains to the end. Calls `each` after every slice of work, with the point of the curve that is
    /// then due. Saves a checkpoint at intervals and when the user interrupts the command.
    ///
    /// # Errors
    /// A checkpoint cannot be written, `each` fails, or the user has interrupted the command.
    pub(crate) fn finish(
        &mut self,
        mut each: impl FnMut(&Report, &Run<'e>, Option<&Point>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        interrupt::defer();
        let mut saved = Instant::now();
        while let Some(report) = self.run.advance() {
            let panel = self.panel.as_ref();
            let point = panel.and_then(|panel| self.curve.follow(&report, &self.run, panel));
            each(&report, &self.run, point.as_ref())?;
            if let Err(stop) = interrupt::check() {
                self.save()?;
                return Err(stop);
            }
            if saved.elapsed() > CHECKPOINT_EVERY {
                self.save()?;
                saved = Instant::now();
            }
        }
        Ok(())
    }

    /// Saves a checkpoint.
    ///
    /// # Errors
    /// The checkpoint cannot be written.
    pub(crate) fn save(&self) -> Result<(), Failure> {
        let checkpoint = Checkpoint {
            data: self.identity.data,
            algorithm: self.identity.algorithm,
            seed: self.identity.seed,
            settings: self.identity.settings.text(),
            progress: self.run.progress(),
            curve: self.curve.clone(),
        };
        Ok(checkpoint.save(&self.checkpoint)?)
    }

    /// Deletes the checkpoint, at the end of the training.
    pub(crate) fn clean(&self) {
        let _ = std::fs::remove_file(&self.checkpoint);
    }
}
