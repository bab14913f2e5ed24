//! A training under way: its run, its learning curve, and its checkpoints.

use crate::failure::Failure;
use crate::interrupt;
use cede_train::run::checkpoint::{Checkpoint, CheckpointError};
use cede_train::run::curve::{Curve, Panel, Point};
use cede_train::run::{Algorithm, Lessons, Report, Run, Settings};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Time between two checkpoints.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(30);

/// What tells one training from another.
#[derive(Clone, PartialEq)]
pub(crate) struct Identity {
    /// SHA-256 of what it learns from.
    pub(crate) data: [u8; 32],
    /// How it learns.
    pub(crate) algorithm: Algorithm,
    /// Seed of every random choice.
    pub(crate) seed: u64,
    /// Its settings.
    pub(crate) settings: Settings,
}

/// A training under way.
pub(crate) struct Training<'e> {
    identity: Identity,
    /// Where checkpoints go.
    checkpoint: PathBuf,
    /// Where there is none, no curve is kept.
    panel: Option<Panel<'e>>,
    pub(crate) run: Run<'e>,
    pub(crate) curve: Curve,
}

impl<'e> Training<'e> {
    /// A training that has not yet begun.
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
    /// The checkpoint cannot be used, or another training left it.
    pub(crate) fn resume(
        identity: Identity,
        lessons: &'e Lessons<'e>,
        panel: Option<Panel<'e>>,
        checkpoint: PathBuf,
    ) -> Result<Self, Failure> {
        let saved = Checkpoint::load(&checkpoint).map_err(|error| {
            let mend = match error {
                CheckpointError::Read { .. } => "leave out --resume to begin anew",
                CheckpointError::Content { .. } => "delete it, or leave out --resume to begin anew",
            };
            Failure::input(error, mend)
        })?;
        let same = saved.data == identity.data
            && saved.algorithm == identity.algorithm.name()
            && saved.seed == identity.seed
            && saved.settings == identity.settings.text();
        if !same {
            return Err(Failure::input(
                format!("{} belongs to another run", checkpoint.display()),
                "give the same algorithm, data, seed and settings, or leave out --resume",
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

    /// Goes on to the end; `each` sees every slice of work, and the point of the curve that is due
    /// after it. What was done is saved now and then, and where the user asks to stop.
    ///
    /// # Errors
    /// A checkpoint cannot be written, `each` fails, or the user has asked to stop.
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

    /// Saves what was done.
    ///
    /// # Errors
    /// The checkpoint cannot be written.
    pub(crate) fn save(&self) -> Result<(), Failure> {
        let checkpoint = Checkpoint {
            data: self.identity.data,
            algorithm: self.identity.algorithm.name().to_owned(),
            seed: self.identity.seed,
            settings: self.identity.settings.text(),
            progress: self.run.progress(),
            curve: self.curve.clone(),
        };
        Ok(checkpoint.save(&self.checkpoint)?)
    }

    /// Deletes the checkpoint of a run that is over: it has served.
    pub(crate) fn clean(&self) {
        let _ = std::fs::remove_file(&self.checkpoint);
    }
}
