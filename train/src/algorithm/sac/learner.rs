//! Soft actor-critic's update: networks, optimisers and temperature.

use crate::algorithm::sac::networks::{Networks, normals};
use crate::algorithm::sac::settings::Rates;
use crate::driving::replay::Batch;
use crate::nn::adam::Adam;
use crate::nn::network::Network;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// The networks with their optimisers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Learner {
    networks: Networks,
    actor_adam: Adam,
    critic_adams: [Adam; 2],
    temperature_adam: Adam,
}

/// The losses of one update.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Losses {
    /// Mean of the two critics' losses (Eq. 13).
    pub critic: f32,
    /// The policy's loss (Eq. 14).
    pub policy: f32,
    /// The estimated entropy of the policy in nats.
    pub entropy: f32,
    /// α after the update.
    pub temperature: f32,
}

impl Learner {
    /// A learner for `observation` features and `action` actions, with three hidden layers of `width`.
    #[must_use]
    pub fn new(
        observation: usize,
        action: usize,
        width: usize,
        rates: &Rates,
        random: &mut Pcg64,
    ) -> Self {
        let actor = Network::new(&[observation, width, width, width, 2 * action], random);
        Self::from_actor(actor, width, rates, random)
    }

    /// A learner whose policy network begins as `actor`, for example after behaviour cloning.
    ///
    /// # Panics
    /// If the actor has an odd number of outputs.
    #[must_use]
    pub fn from_actor(actor: Network, width: usize, rates: &Rates, random: &mut Pcg64) -> Self {
        let networks = Networks::new(actor, width, rates, random);
        let adam = |network: &Network| Adam::new(network.parameters().len());
        Self {
            actor_adam: adam(&networks.actor),
            critic_adams: networks.critics.each_ref().map(adam),
            temperature_adam: Adam::new(1),
            networks,
        }
    }

    /// The policy network: means, then raw deviations.
    #[must_use]
    pub fn actor(&self) -> &Network {
        &self.networks.actor
    }

    /// The running average of the policy network, which drives after the training.
    #[must_use]
    pub fn averaged(&self) -> &Network {
        &self.networks.averaged
    }

    /// Sampled actions in (−1, 1) for `observations`, one row per sample.
    pub fn act(&mut self, observations: &[f32], random: &mut Pcg64) -> Vec<f32> {
        let networks = &mut self.networks;
        let rows = observations.len() / networks.actor.sizes()[0];
        let noise = normals(rows * networks.actions(), random);
        networks.sample(observations, &noise);
        networks.scratch.samples.iter().map(|s| s.action).collect()
    }

    /// One update of the critics, the policy, the temperature, the targets and the averaged policy.
    pub fn update(&mut self, batch: &Batch, rates: &Rates, random: &mut Pcg64) -> Losses {
        let networks = &mut self.networks;
        let count = batch.len() * networks.actions();
        let mut losses = Losses::default();

        networks.label(batch, rates, &normals(count, random));
        for (i, adam) in self.critic_adams.iter_mut().enumerate() {
            losses.critic += 0.5 * networks.critic_gradient(i, batch);
            let gradient = &networks.scratch.gradient;
            adam.step(networks.critics[i].parameters_mut(), gradient, rates.critic);
        }

        losses.policy = networks.policy_gradient(batch, &normals(count, random));
        let gradient = &networks.scratch.gradient;
        self.actor_adam
            .step(networks.actor.parameters_mut(), gradient, rates.policy);

        let density = networks.mean_log_density(batch.len());
        let slope = networks.temperature_gradient(density, rates.target_entropy);
        let temperature = std::slice::from_mut(&mut networks.log_temperature);
        self.temperature_adam
            .step(temperature, &[slope], rates.temperature);

        networks.approach(rates);
        losses.entropy = -density;
        losses.temperature = networks.temperature();
        losses
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driving::replay::{Replay, Transition};
    use crate::nn::finite_differences::{reference, wide};
    use crate::nn::network::Tape;
    use rand::{RngExt, SeedableRng};

    /// Reward 1 − (a − s)²: for every discount the best action equals the state. States are random, so
    /// the value of the best policy is 1 / (1 − γ), less the cost of its entropy.
    #[test]
    fn learns_a_problem_with_a_known_answer() {
        let mut random = Pcg64::seed_from_u64(7);
        let rates = Rates {
            policy: 3e-3,
            critic: 3e-3,
            temperature: 1e-2,
            discount: 0.5,
            softness: 0.05,
            averaging: 1.0,
            target_entropy: -3.0,
            initial_temperature: 0.1,
        };
        let mut learner = Learner::new(1, 1, 32, &rates, &mut random);
        let mut replay = Replay::new(4000, 1, 1);
        let mut state = 0.0_f32;
        let mut batch = Batch::default();
        for step in 0..1500 {
            let action = learner.act(&[state], &mut random)[0];
            let next = random.random_range(-0.8..0.8_f32);
            replay.push(&Transition {
                observation: vec![state],
                action: vec![action],
                reward: 1.0 - (action - state) * (action - state),
                next: vec![next],
                terminal: false,
            });
            state = next;
            if step > 100 {
                replay.sample(64, &mut random, &mut batch);
                learner.update(&batch, &rates, &mut random);
            }
        }
        let mut tape = Tape::default();
        for s in [-0.6, -0.3, 0.0, 0.3, 0.6_f32] {
            let mean = learner.actor().forward(&[s], &mut tape)[0];
            assert!((mean.tanh() - s).abs() < 0.1, "at {s}: {}", mean.tanh());
            let input = [wide(&[s]), wide(&[mean.tanh()])].concat();
            let critic = &learner.networks.critics[0];
            let q = reference(critic, &wide(critic.parameters()), &input)[0];
            assert!((q - 2.0).abs() < 0.3, "value at {s}: {q}");
        }
    }
}
