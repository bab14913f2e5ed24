//! The settings of a run as TOML.

use crate::algorithm::apg::ApgSettings;
use crate::algorithm::bc::BcSettings;
use crate::algorithm::sac::SacSettings;
use crate::run::ranges::{self, OutOfRange};
use serde::Serialize;

/// The settings of one algorithm.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum TrainSettings {
    /// Behaviour cloning.
    Bc(BcSettings),
    /// SAC and its variants.
    Sac(SacSettings),
    /// The analytic policy gradient.
    Apg(ApgSettings),
}

impl TrainSettings {
    /// These settings, with the values in `table` replacing those of the same names.
    ///
    /// # Errors
    /// The algorithm has no setting of that name, or the value has the wrong type.
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

    /// Whether auxiliary encounters are used beside those that are imitated: in a refinement.
    #[must_use]
    pub const fn uses_auxiliary_encounters(&self) -> bool {
        match self {
            Self::Bc(_) | Self::Sac(_) => false,
            Self::Apg(settings) => settings.refinement.updates > 0,
        }
    }

    /// Checks that every setting is in its range.
    ///
    /// # Errors
    /// The first setting that is out of its range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        match self {
            Self::Bc(settings) => ranges::check_bc(settings),
            Self::Sac(settings) => ranges::check_sac(settings),
            Self::Apg(settings) => ranges::check_apg(settings),
        }
    }
}

fn merge(mut base: toml::Table, over: &toml::Table) -> toml::Table {
    for (name, value) in over {
        let merged = match (base.remove(name), value) {
            (Some(toml::Value::Table(base)), toml::Value::Table(over)) => merge(base, over).into(),
            // An integer is accepted where a float is expected.
            (Some(toml::Value::Float(_)), toml::Value::Integer(n)) => (*n as f64).into(),
            _ => value.clone(),
        };
        base.insert(name.clone(), merged);
    }
    base
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algorithm::apg::Refinement;

    fn table(text: &str) -> toml::Table {
        text.parse().unwrap()
    }

    #[test]
    fn settings_are_replaced_by_name_and_unknown_names_are_refused() {
        let settings = TrainSettings::Sac(SacSettings::default());
        let changed = settings
            .with(&table("episodes = 5\nrates.policy = 1"))
            .unwrap();
        let TrainSettings::Sac(changed) = changed else {
            panic!("another algorithm")
        };
        assert_eq!((changed.episodes, changed.rates.policy), (5, 1.0));
        assert_eq!(changed.rates.critic, 1e-3);
        let error = settings.with(&table("epsiodes = 5")).unwrap_err();
        assert!(error.to_string().contains("epsiodes"), "{error}");
        assert!(settings.with(&table("episodes = \"many\"")).is_err());
    }

    #[test]
    fn nested_settings_are_replaced_one_by_one() {
        let settings = TrainSettings::Apg(ApgSettings::default());
        let changed = settings.with(&table("refinement = { updates = 3 }"));
        let expected = ApgSettings {
            refinement: Refinement {
                updates: 3,
                ..Refinement::default()
            },
            ..ApgSettings::default()
        };
        assert_eq!(changed, Ok(TrainSettings::Apg(expected)));
    }
}
