//! A training run of any algorithm, as the command line sees it.

pub mod checkpoint;
pub mod curve;
pub mod log;
pub mod provenance;
mod ranges;

use crate::algorithm::apg::cost::Cost;
use crate::algorithm::apg::{self, Apg, Refinement};
use crate::algorithm::bc::{self, Bc};
use crate::algorithm::sac::learner::Rates;
use crate::algorithm::sac::{self, Sac};
use crate::driving::episodes::{Course, Reward};
use crate::driving::policy_view::PolicyView;
use cede_data::Encounter;
use cede_formats::property::StateProperty;
use cede_sim::ObservationModel;
use serde::{Deserialize, Serialize};

/// The algorithms by their names on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Algorithm {
    /// Behaviour cloning.
    Bc,
    /// SAC without replayed reward.
    Sac,
    /// SACER with the recorded speeds.
    SacerV,
    /// SACER with the recorded SVO: the paper's method.
    SacerSvo,
    /// Analytic policy gradient: our own.
    Apg,
}

impl Algorithm {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Bc, Self::Sac, Self::SacerV, Self::SacerSvo, Self::Apg];

    /// Name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bc => "bc",
            Self::Sac => "sac",
            Self::SacerV => "sacer-v",
            Self::SacerSvo => "sacer-svo",
            Self::Apg => "apg",
        }
    }

    /// Its settings, all at their defaults.
    #[must_use]
    pub fn settings(self) -> Settings {
        let sac = |reward| {
            Settings::Sac(sac::Settings {
                reward,
                ..sac::Settings::default()
            })
        };
        match self {
            Self::Bc => Settings::Bc(bc::Settings::default()),
            Self::Sac => sac(Reward::Sac),
            Self::SacerV => sac(Reward::SacerV),
            Self::SacerSvo => sac(Reward::SacerSvo),
            Self::Apg => Settings::Apg(apg::Settings::default()),
        }
    }
}

impl Algorithm {
    /// The settings by which `cede reproduce` trains it: the defaults, but fewer and faster updates
    /// where the paper's would take hours. See `docs/method.md`.
    #[must_use]
    pub fn reproduction(self) -> Settings {
        match self.settings() {
            Settings::Bc(settings) => Settings::Bc(bc::Settings {
                updates: 4_000,
                width: 64,
                rate: 1e-3,
                ..settings
            }),
            Settings::Sac(settings) => Settings::Sac(sac::Settings {
                episodes: 4_500,
                steps_per_update: 48,
                parallel: 48,
                width: 64,
                centred: true,
                rates: Rates {
                    policy: 3e-4,
                    temperature: 1e-3,
                    averaging: 1e-3,
                    ..settings.rates
                },
                ..settings
            }),
            // More updates fit the few recorded encounters better, and those held out worse: that is
            // for the refinement, which is held to what the short trainings agree on.
            Settings::Apg(settings) => Settings::Apg(apg::Settings {
                members: 4,
                updates: 400,
                batch: 128,
                width: 32,
                carry_on: 0.7,
                clip: 10.0,
                cost: Cost {
                    speed: 1.0,
                    gap: 2.0,
                    contact: 50.0,
                    ..settings.cost
                },
                refinement: Refinement {
                    updates: 1600,
                    ..settings.refinement
                },
                ..settings
            }),
        }
    }

    /// Whether it makes use of encounters beside those that it is judged on.
    #[must_use]
    pub const fn looks_beside(self) -> bool {
        matches!(self, Self::Apg)
    }
}

/// The settings of one of the algorithms.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Settings {
    /// Of behaviour cloning.
    Bc(bc::Settings),
    /// Of SAC and its relatives.
    Sac(sac::Settings),
    /// Of the analytic policy gradient.
    Apg(apg::Settings),
}

impl Settings {
    /// These settings with those that `table` names replaced.
    ///
    /// # Errors
    /// A name that the algorithm does not have, or a value of the wrong type.
    pub fn with(&self, table: &toml::Table) -> Result<Self, toml::de::Error> {
        let own = toml::Table::try_from(self).map_err(serde::de::Error::custom)?;
        let merged = merge(own, table);
        Ok(match self {
            Self::Bc(_) => Self::Bc(merged.try_into()?),
            Self::Sac(_) => Self::Sac(merged.try_into()?),
            Self::Apg(_) => Self::Apg(merged.try_into()?),
        })
    }

    /// The settings as TOML.
    #[must_use]
    pub fn text(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }
}

fn merge(mut base: toml::Table, over: &toml::Table) -> toml::Table {
    for (name, value) in over {
        let merged = match (base.remove(name), value) {
            (Some(toml::Value::Table(base)), toml::Value::Table(over)) => merge(base, over).into(),
            // A whole number serves where a fraction is wanted.
            (Some(toml::Value::Float(_)), toml::Value::Integer(n)) => (*n as f64).into(),
            _ => value.clone(),
        };
        base.insert(name.clone(), merged);
    }
    base
}

/// What a run learns from, prepared once.
pub struct Lessons<'e> {
    /// The encounters to be judged on, as episodes.
    pub courses: Vec<Course<'e>>,
    /// The encounters as what their vehicles see; the first [`Lessons::own`] are those to be judged on,
    /// and at the others a refinement holds the network to what it was.
    pub models: Vec<ObservationModel<'e>>,
    /// See [`Lessons::models`].
    pub own: usize,
    /// What will be claimed of the policy; only the analytic policy gradient learns it.
    pub claims: Vec<StateProperty>,
}

impl<'e> Lessons<'e> {
    /// Prepares the encounters to be judged on, and those beside them.
    #[must_use]
    pub fn new(own: &[&'e Encounter], beside: &[&'e Encounter]) -> Self {
        let all = own.iter().chain(beside).copied();
        Self {
            courses: own.iter().map(|encounter| Course::new(encounter)).collect(),
            models: all.map(ObservationModel::new).collect(),
            own: own.len(),
            claims: Vec::new(),
        }
    }
}

/// All that a resumed run needs to go on bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Progress {
    /// Of behaviour cloning.
    Bc(Box<bc::Progress>),
    /// Of SAC and its relatives.
    Sac(Box<sac::Progress>),
    /// Of the analytic policy gradient.
    Apg(Box<apg::Progress>),
}

/// A run of any algorithm.
pub enum Run<'e> {
    /// Behaviour cloning.
    Bc(Box<Bc>),
    /// SAC and its relatives.
    Sac(Box<Sac<'e>>),
    /// The analytic policy gradient.
    Apg(Box<Apg<'e>>),
}

/// What a slice of work brought.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Work done so far, in the unit of `total`.
    pub done: u64,
    /// All the work there is: updates, or episodes for reinforcement learning.
    pub total: u64,
    /// Episodes (or stretches of them) that ended in this slice.
    pub episodes: u64,
    /// Updates in this slice.
    pub updates: u64,
    /// What there is to plot, by name.
    pub scalars: Vec<(&'static str, f32)>,
}

impl<'e> Run<'e> {
    /// A run that has not yet begun.
    #[must_use]
    pub fn new(settings: Settings, lessons: &'e Lessons<'e>, seed: u64) -> Self {
        match settings {
            Settings::Bc(settings) => Self::Bc(Box::new(Bc::new(
                settings,
                &lessons.models[..lessons.own],
                seed,
            ))),
            Settings::Sac(settings) => {
                Self::Sac(Box::new(Sac::new(settings, &lessons.courses, seed)))
            }
            Settings::Apg(settings) => {
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

    /// What to save.
    #[must_use]
    pub fn progress(&self) -> Progress {
        match self {
            Self::Bc(run) => Progress::Bc(Box::new(run.progress().clone())),
            Self::Sac(run) => Progress::Sac(Box::new(run.progress().clone())),
            Self::Apg(run) => Progress::Apg(Box::new(run.progress().clone())),
        }
    }

    /// The driver as it is.
    #[must_use]
    pub fn view(&self) -> PolicyView<'_> {
        match self {
            Self::Bc(run) => run.view(),
            Self::Sac(run) => run.view(),
            Self::Apg(run) => run.view(),
        }
    }

    /// A slice of work of some milliseconds, or `None` when there is none left.
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
                let episodes = run.places() as u64;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::checkpoint::Checkpoint;
    use crate::run::curve::Curve;
    use cede_data::Dataset;

    #[test]
    fn settings_are_replaced_by_name_and_unknown_names_are_refused() {
        let settings = Algorithm::SacerSvo.settings();
        let table = |text: &str| text.parse::<toml::Table>().unwrap();
        let changed = settings
            .with(&table("episodes = 5\nrates.policy = 1"))
            .unwrap();
        let Settings::Sac(changed) = changed else {
            panic!("another algorithm")
        };
        assert_eq!((changed.episodes, changed.rates.policy), (5, 1.0));
        assert_eq!(changed.rates.critic, 1e-3);
        let error = settings.with(&table("epsiodes = 5")).unwrap_err();
        assert!(error.to_string().contains("epsiodes"), "{error}");
        assert!(settings.with(&table("episodes = \"many\"")).is_err());
    }

    #[test]
    fn the_defaults_are_the_papers_table() {
        let text = Algorithm::SacerSvo.settings().text();
        for line in [
            "episodes = 35000",
            "buffer = 100000",
            "buffer_minimum = 1000",
            "batch = 512",
            "features = \"raw\"",
            "target_entropy = -2.0",
        ] {
            assert!(text.contains(line), "{line} in\n{text}");
        }
    }

    /// Settings with which a run of a hundred slices takes a moment.
    fn small(algorithm: Algorithm) -> Settings {
        let set = match algorithm {
            Algorithm::Bc => "updates = 100\nwidth = 16\nbatch = 64",
            Algorithm::Apg => {
                "updates = 12\nwidth = 16\nbatch = 80\nhorizon = 6\nmembers = 2\n\
                 refinement = { updates = 10, places = 30 }"
            }
            _ => {
                "episodes = 60\nwidth = 16\nbatch = 32\nparallel = 4\nsteps_per_update = 8\n\
                 buffer = 500\nbuffer_minimum = 50\ncentred = true"
            }
        };
        algorithm.settings().with(&set.parse().unwrap()).unwrap()
    }

    #[test]
    fn every_algorithm_goes_on_from_a_checkpoint_bit_for_bit() {
        let dataset = Dataset::synthetic(8, 4);
        let encounters: Vec<&Encounter> = dataset.encounters.iter().take(8).collect();
        let beside: Vec<&Encounter> = dataset.encounters.iter().skip(8).take(4).collect();
        let lessons = Lessons::new(&encounters, &beside);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.checkpoint");
        for algorithm in Algorithm::ALL {
            let mut whole = Run::new(small(algorithm), &lessons, 3);
            while whole.advance().is_some() {}
            let mut first = Run::new(small(algorithm), &lessons, 3);
            (0..27).for_each(|_| assert!(first.advance().is_some()));
            let saved = Checkpoint {
                data: [0; 32],
                algorithm: algorithm.name().to_owned(),
                seed: 3,
                settings: String::new(),
                progress: first.progress(),
                curve: Curve::default(),
            };
            saved.save(&path).unwrap();
            drop(first);
            let loaded = Checkpoint::load(&path).unwrap();
            let mut second = Run::resume(loaded.progress, &lessons);
            while second.advance().is_some() {}
            assert!(
                second.progress() == whole.progress(),
                "{}",
                algorithm.name()
            );
            let weights = |run: &Run<'_>| run.view().weights([0; 32]).unwrap();
            assert_eq!(weights(&second), weights(&whole), "{}", algorithm.name());
        }
    }
}
