//! The algorithms, and the settings that they begin with.

use crate::algorithm::apg::cost::Cost;
use crate::algorithm::apg::{ApgSettings, Refinement};
use crate::algorithm::bc::BcSettings;
use crate::algorithm::sac::{Rates, SacSettings};
use crate::driving::episodes::Reward;
use crate::run::settings::TrainSettings;
use cede_controller::FeatureSet;
use serde::{Deserialize, Serialize};

/// The algorithms. In files they are written as their names on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Algorithm {
    /// Behaviour cloning.
    Bc,
    /// SAC without episode replay of the reward.
    Sac,
    /// SACER with the recorded speeds.
    SacerV,
    /// SACER with the recorded SVO: the paper's method.
    SacerSvo,
    /// Analytic policy gradient: Cede's method.
    Apg,
}

impl Algorithm {
    /// All algorithms.
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

    /// Its default settings.
    #[must_use]
    pub fn settings(self) -> TrainSettings {
        let sac = |reward| {
            TrainSettings::Sac(SacSettings {
                reward,
                ..SacSettings::default()
            })
        };
        match self {
            Self::Bc => TrainSettings::Bc(BcSettings::default()),
            Self::Sac => sac(Reward::Sac),
            Self::SacerV => sac(Reward::SacerV),
            Self::SacerSvo => sac(Reward::SacerSvo),
            Self::Apg => TrainSettings::Apg(ApgSettings::default()),
        }
    }

    /// The settings of `cede reproduce`: the defaults, with fewer and larger updates where the
    /// paper's settings would take hours. See `docs/method.md`.
    #[must_use]
    pub fn reproduction(self) -> TrainSettings {
        match self.settings() {
            TrainSettings::Bc(settings) => TrainSettings::Bc(BcSettings {
                updates: 4_000,
                width: 64,
                rate: 1e-3,
                ..settings
            }),
            TrainSettings::Sac(settings) => TrainSettings::Sac(SacSettings {
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
            // More updates per member would fit the recorded encounters better and generalise worse.
            // The refinement improves the fit instead, with a penalty on deviation from the ensemble.
            TrainSettings::Apg(settings) => TrainSettings::Apg(ApgSettings {
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

    /// The settings for recordings of several sites, where who has the right of way differs from site to site:
    /// the features that say so, and a longer training. Those of [`Algorithm::reproduction`] for all but the
    /// analytic policy gradient. See `docs/method.md`.
    #[must_use]
    pub fn several_sites(self) -> TrainSettings {
        match self.settings() {
            TrainSettings::Apg(settings) => TrainSettings::Apg(ApgSettings {
                features: FeatureSet::Rights,
                members: 2,
                updates: 3000,
                cost: Cost {
                    order: 5.0,
                    late: 12.0,
                    ..settings.cost
                },
                ..settings
            }),
            _ => self.reproduction(),
        }
    }

    /// Whether it uses auxiliary encounters beside those that it imitates.
    #[must_use]
    pub const fn uses_auxiliary_encounters(self) -> bool {
        matches!(self, Self::Apg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_algorithm_is_serialised_as_its_name() {
        for algorithm in Algorithm::ALL {
            let name = toml::Value::String(algorithm.name().to_owned());
            assert_eq!(toml::Value::try_from(algorithm), Ok(name.clone()));
            assert_eq!(name.try_into(), Ok(algorithm));
        }
    }

    #[test]
    fn the_settings_to_begin_with_are_in_range() {
        for algorithm in Algorithm::ALL {
            assert_eq!(algorithm.settings().check(), Ok(()));
            assert_eq!(algorithm.reproduction().check(), Ok(()));
        }
    }

    #[test]
    fn the_defaults_are_those_of_the_papers_table() {
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
}
