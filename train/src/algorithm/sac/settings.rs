//! Settings of soft actor-critic.

use crate::driving::episodes::Reward;
use cede_controller::FeatureSet;
use serde::{Deserialize, Serialize};

/// Settings of soft actor-critic. The defaults are those of the paper's Table I, as far as it gives them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SacSettings {
    /// The networks' inputs; the paper's eight numbers by default.
    pub features: FeatureSet,
    /// The reward.
    pub reward: Reward,
    /// Training episodes.
    pub episodes: u64,
    /// Environment steps per update; 1 in the paper's Algorithm 1.
    pub steps_per_update: u32,
    /// Number of episodes in parallel.
    pub parallel: usize,
    /// Width of the three hidden layers of every network: a multiple of 16 up to 128.
    pub width: usize,
    /// Capacity of the replay buffer, in steps.
    pub buffer: usize,
    /// Number of steps in the buffer before the first update.
    pub buffer_minimum: usize,
    /// Steps in a batch.
    pub batch: usize,
    /// Whether the running mean reward of a course is subtracted from the rewards of its steps. Rewards
    /// are mostly negative, so that without the subtraction a policy gains by ending an episode early.
    pub centred: bool,
    /// Learning rates and constants of the algorithm.
    pub rates: Rates,
}

impl Default for SacSettings {
    fn default() -> Self {
        Self {
            features: FeatureSet::Raw,
            reward: Reward::SacerSvo,
            episodes: 35_000,
            steps_per_update: 1,
            parallel: 16,
            width: 128,
            buffer: 100_000,
            buffer_minimum: 1_000,
            batch: 512,
            centred: false,
            rates: Rates::default(),
        }
    }
}

/// Learning rates and constants of soft actor-critic. The defaults are those of the paper's Table I.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rates {
    /// λ_π: learning rate of the policy network.
    pub policy: f32,
    /// λ_Q: learning rate of the two Q-value networks.
    pub critic: f32,
    /// λ: learning rate of the temperature's logarithm.
    pub temperature: f32,
    /// γ: discount factor, in [0, 1].
    pub discount: f32,
    /// τ: share by which an update moves the target networks towards the Q-value networks.
    pub softness: f32,
    /// Share by which an update moves the averaged policy towards the policy network; with 1 both are
    /// equal.
    pub averaging: f32,
    /// H₀: the target entropy in nats, for actions in (−1, 1).
    pub target_entropy: f32,
    /// α at the start.
    pub initial_temperature: f32,
}

impl Default for Rates {
    fn default() -> Self {
        Self {
            policy: 1e-4,
            critic: 1e-3,
            temperature: 1e-4,
            discount: 0.99,
            softness: 0.005,
            averaging: 1.0,
            target_entropy: -2.0,
            initial_temperature: 0.1,
        }
    }
}
