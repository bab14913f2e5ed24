//! Settings of the analytic policy gradient.

use crate::algorithm::apg::cost::Cost;
use cede_controller::FeatureSet;
use serde::{Deserialize, Serialize};

/// Settings of the analytic policy gradient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ApgSettings {
    /// The network's inputs.
    pub features: FeatureSet,
    /// Number of networks to train one after the other and to join to an ensemble.
    pub members: u32,
    /// Number of updates of each network.
    pub updates: u32,
    /// Roll-outs in a batch, each with two vehicles.
    pub batch: usize,
    /// Width of the three hidden layers of each network: a multiple of 16; `members` times `width` is at
    /// most 128.
    pub width: usize,
    /// Learning rate at the start; it decays to zero along a cosine.
    pub rate: f32,
    /// Length of a roll-out in steps.
    pub horizon: usize,
    /// Length of a roll-out in steps in the last third of the updates.
    pub last_horizon: usize,
    /// Probability that a new roll-out begins at the start of its encounter.
    pub from_start: f32,
    /// Probability that a roll-out continues from the last states of the one before it.
    pub carry_on: f32,
    /// Standard deviation (m) of the disturbance of initial positions.
    pub position_jitter: f32,
    /// Standard deviation (m/s) of the disturbance of initial speeds.
    pub speed_jitter: f32,
    /// Maximum norm of the gradient; a longer one is scaled down to it.
    pub clip: f32,
    /// The cost of deviating from the recorded drivers.
    pub cost: Cost,
    /// How the ensemble is trained further.
    pub refinement: Refinement,
    /// How properties are learned, if there are any.
    pub claims: ClaimSettings,
}

/// Settings of the refinement: joint training of the ensemble, with a penalty on deviation from it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Refinement {
    /// Number of updates; 0 disables the refinement.
    pub updates: u32,
    /// Learning rate at the start; it decays to zero along a cosine.
    pub rate: f32,
    /// Roll-outs in a batch in addition to [`ApgSettings::batch`], in auxiliary encounters. There the
    /// network is penalised for deviating from the unrefined ensemble.
    pub places: usize,
    /// Weight of the squared deviation of an acceleration from the unrefined ensemble's, in s⁴/m².
    pub hold: f32,
}

impl Default for Refinement {
    fn default() -> Self {
        Self {
            updates: 0,
            rate: 1e-3,
            places: 64,
            hold: 2.5,
        }
    }
}

impl Default for ApgSettings {
    fn default() -> Self {
        Self {
            features: FeatureSet::Scene,
            members: 1,
            updates: 1000,
            batch: 256,
            width: 64,
            rate: 2e-3,
            horizon: 20,
            last_horizon: 40,
            from_start: 0.3,
            carry_on: 0.5,
            position_jitter: 0.5,
            speed_jitter: 0.15,
            clip: 1.0,
            cost: Cost::default(),
            refinement: Refinement::default(),
            claims: ClaimSettings::default(),
        }
    }
}

/// How properties of the policy are learned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ClaimSettings {
    /// Weight of the properties' cost relative to the cost of driving.
    pub weight: f32,
    /// Margin (m/s²) required beyond a claimed bound on the acceleration, so that the verifier can
    /// prove the bound itself.
    pub margin: f32,
    /// Margin required beyond a claimed bound on a slope (m/s² per metre or per m/s).
    pub slope_margin: f32,
    /// Random states of each claim per update.
    pub fresh: usize,
    /// Adversarial states of each claim, kept from update to update.
    pub hard: usize,
}

impl Default for ClaimSettings {
    fn default() -> Self {
        Self {
            weight: 3.0,
            margin: 0.2,
            slope_margin: 0.1,
            fresh: 16,
            hard: 16,
        }
    }
}

/// The part of the training that an update belongs to: one network's training, or the refinement.
#[derive(Clone, Copy)]
pub(super) struct Stage {
    /// Share of the stage's updates that are done.
    pub(super) done: f32,
    /// Learning rate at its start.
    pub(super) rate: f32,
    /// Roll-outs in auxiliary encounters.
    pub(super) auxiliary: usize,
}

impl ApgSettings {
    /// Number of updates of all networks and of the refinement.
    pub(super) const fn total(&self) -> u32 {
        self.members * self.updates + self.refinement.updates
    }

    /// The stage that `update` belongs to.
    pub(super) fn stage(&self, update: u32) -> Stage {
        let alone = self.members * self.updates;
        if update < alone {
            Stage {
                done: (update % self.updates) as f32 / self.updates as f32,
                rate: self.rate,
                auxiliary: 0,
            }
        } else {
            Stage {
                done: (update - alone) as f32 / self.refinement.updates as f32,
                rate: self.refinement.rate,
                auxiliary: self.refinement.places,
            }
        }
    }
}

/// Settings within a checkpoint: as TOML, because settings at their defaults may be left out, and the
/// checkpoint's own encoding has no names.
pub(super) mod as_text {
    use super::ApgSettings;
    use serde::de::Error as _;
    use serde::ser::Error as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in crate::algorithm::apg) fn serialize<S: Serializer>(
        settings: &ApgSettings,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        let text = toml::to_string(settings).map_err(S::Error::custom)?;
        text.serialize(to)
    }

    pub(in crate::algorithm::apg) fn deserialize<'d, D: Deserializer<'d>>(
        from: D,
    ) -> Result<ApgSettings, D::Error> {
        toml::from_str(&String::deserialize(from)?).map_err(D::Error::custom)
    }
}
