//! A run of any algorithm.

use crate::algorithm::apg::{Apg, ApgProgress};
use crate::algorithm::bc::{Bc, BcProgress};
use crate::algorithm::sac::{Sac, SacProgress};
use crate::driving::policy_view::PolicyView;
use crate::run::lessons::Lessons;
use crate::run::settings::TrainSettings;
use serde::{Deserialize, Serialize};

/// The state of a run, from which [`Run::resume`] continues with the same bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Progress {
    /// Behaviour cloning.
    Bc(Box<BcProgress>),
    /// SAC and its variants.
    Sac(Box<SacProgress>),
    /// The analytic policy gradient.
    Apg(Box<ApgProgress>),
}

/// A run of any algorithm.
pub enum Run<'e> {
    /// Behaviour cloning.
    Bc(Box<Bc>),
    /// SAC and its variants.
    Sac(Box<Sac<'e>>),
    /// The analytic policy gradient.
    Apg(Box<Apg<'e>>),
}

/// What one slice of work did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Work done so far, in the unit of `total`.
    pub done: u64,
    /// The whole work: updates, or episodes for reinforcement learning.
    pub total: u64,
    /// Episodes or roll-outs that ended in this slice.
    pub episodes: u64,
    /// Updates in this slice.
    pub updates: u64,
    /// Values to plot, by name.
    pub scalars: Vec<(&'static str, f32)>,
}

impl<'e> Run<'e> {
    /// A new run.
    #[must_use]
    pub fn new(settings: TrainSettings, lessons: &'e Lessons<'e>, seed: u64) -> Self {
        match settings {
            TrainSettings::Bc(settings) => Self::Bc(Box::new(Bc::new(
                settings,
                &lessons.models[..lessons.own],
                seed,
            ))),
            TrainSettings::Sac(settings) => {
                Self::Sac(Box::new(Sac::new(settings, &lessons.courses, seed)))
            }
            TrainSettings::Apg(settings) => {
                let run = Apg::new(settings, &lessons.models, lessons.own, seed);
                Self::Apg(Box::new(run.with_claims(&lessons.claims)))
            }
        }
    }

    /// The run that `progress` was taken from, over the same lessons.
    #[must_use]
    pub fn resume(progress: Progress, lessons: &'e Lessons<'e>) -> Self {
        match progress {
            Progress::Bc(progress) => Self::Bc(Box::new(Bc::resume(
                *progress,
                &lessons.models[..lessons.own],
            ))),
            Progress::Sac(progress) => {
                Self::Sac(Box::new(Sac::resume(*progress, &lessons.courses)))
            }
            Progress::Apg(progress) => {
                let run = Apg::resume(*progress, &lessons.models, lessons.own);
                Self::Apg(Box::new(run.with_claims(&lessons.claims)))
            }
        }
    }

    /// The state to save.
    #[must_use]
    pub fn progress(&self) -> Progress {
        match self {
            Self::Bc(run) => Progress::Bc(Box::new(run.progress().clone())),
            Self::Sac(run) => Progress::Sac(Box::new(run.progress().clone())),
            Self::Apg(run) => Progress::Apg(Box::new(run.progress().clone())),
        }
    }

    /// The current policy.
    #[must_use]
    pub fn view(&self) -> PolicyView<'_> {
        match self {
            Self::Bc(run) => run.view(),
            Self::Sac(run) => run.view(),
            Self::Apg(run) => run.view(),
        }
    }

    /// Does a slice of work of some milliseconds. Returns `None` if the work is done.
    pub fn advance(&mut self) -> Option<Report> {
        match self {
            Self::Bc(run) => {
                let loss = run.update()?;
                let (done, total) = run.updates();
                Some(Report {
                    done,
                    total,
                    updates: 1,
                    scalars: vec![("loss", loss)],
                    ..Report::default()
                })
            }
            Self::Apg(run) => {
                let cost = run.update()?;
                let (done, total) = run.updates();
                let episodes = run.roll_outs() as u64;
                Some(Report {
                    done,
                    total,
                    episodes,
                    updates: 1,
                    scalars: vec![("cost", cost)],
                })
            }
            Self::Sac(run) => {
                let round = run.round()?;
                let (done, total) = run.episodes();
                let mut scalars = Vec::new();
                if round.episodes > 0 {
                    scalars.push(("reward per step", round.reward / round.episodes as f32));
                }
                if let Some(losses) = round.losses {
                    scalars.push(("critic loss", losses.critic));
                    scalars.push(("policy loss", losses.policy));
                    scalars.push(("entropy", losses.entropy));
                    scalars.push(("temperature", losses.temperature));
                }
                Some(Report {
                    done,
                    total,
                    episodes: round.episodes,
                    updates: round.updates,
                    scalars,
                })
            }
        }
    }
}
