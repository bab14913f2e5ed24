//! Soft actor-critic's networks, losses and updates (Haarnoja et al., 2018; the paper's Eqs. 13 to 15).

use crate::driving::replay::Batch;
use crate::nn::adam::Adam;
use crate::nn::gaussian::Sample;
use crate::nn::network::{Delta, Network, Tape};
use rand::RngExt;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// How a [`Learner`] learns. The defaults are the paper's Table I.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rates {
    /// λ_π: learning rate of the policy network.
    pub policy: f32,
    /// λ_Q: learning rate of the two Q-value networks.
    pub critic: f32,
    /// λ: learning rate of the temperature (on its logarithm, so that it stays positive).
    pub temperature: f32,
    /// γ: discount of the next step's value, in [0, 1].
    pub discount: f32,
    /// τ: share by which the target networks approach the Q-value networks at each update.
    pub softness: f32,
    /// Share by which the driver, a running average of the policy, approaches it at each update; 1:
    /// the driver is the policy as it is.
    pub averaging: f32,
    /// H₀: the entropy that the temperature steers to, in nats, for actions in (−1, 1).
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

/// The networks, their optimisers and the temperature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Learner {
    actor: Network,
    driver: Network,
    critics: [Network; 2],
    targets: [Network; 2],
    log_temperature: f32,
    actor_adam: Adam,
    critic_adams: [Adam; 2],
    temperature_adam: Adam,
    #[serde(skip)]
    scratch: Scratch,
}

/// Buffers that keep an update from allocating.
#[derive(Clone, Debug, Default)]
struct Scratch {
    actor: Tape,
    critics: [Tape; 2],
    delta: Delta,
    gradient: Vec<f32>,
    samples: Vec<Sample>,
    inputs: Vec<f32>,
    labels: Vec<f32>,
}

impl PartialEq for Scratch {
    /// Buffers carry nothing from one update to the next.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// What an update saw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Losses {
    /// Mean of the two critics' losses (Eq. 13).
    pub critic: f32,
    /// The policy's loss (Eq. 14).
    pub policy: f32,
    /// Estimated entropy of the policy in nats.
    pub entropy: f32,
    /// α after the update.
    pub temperature: f32,
}

impl Learner {
    /// A learner for `observation` features and `action` actions, three hidden layers of `width`.
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

    /// A learner whose policy begins as `actor` (one that was trained by imitation, say).
    ///
    /// # Panics
    /// If the actor has an odd number of outputs.
    #[must_use]
    pub fn from_actor(actor: Network, width: usize, rates: &Rates, random: &mut Pcg64) -> Self {
        let (observation, outputs) = (actor.sizes()[0], actor.sizes()[actor.sizes().len() - 1]);
        assert!(outputs % 2 == 0, "a mean and a deviation for each action");
        let sizes = [observation + outputs / 2, width, width, width, 1];
        let critics = [(); 2].map(|()| Network::new(&sizes, random));
        Self {
            actor_adam: Adam::new(actor.parameters().len()),
            critic_adams: critics.each_ref().map(|c| Adam::new(c.parameters().len())),
            temperature_adam: Adam::new(1),
            targets: critics.clone(),
            critics,
            driver: actor.clone(),
            actor,
            log_temperature: libm::logf(rates.initial_temperature),
            scratch: Scratch::default(),
        }
    }

    /// The policy network: means, then raw deviations.
    #[must_use]
    pub fn actor(&self) -> &Network {
        &self.actor
    }

    /// The running average of the policy network: what drives when all is done.
    #[must_use]
    pub fn driver(&self) -> &Network {
        &self.driver
    }

    fn actions(&self) -> usize {
        self.actor.sizes()[self.actor.sizes().len() - 1] / 2
    }

    /// Actions in (−1, 1) sampled for `observations`, one row a sample.
    pub fn act(&mut self, observations: &[f32], random: &mut Pcg64) -> Vec<f32> {
        let rows = observations.len() / self.actor.sizes()[0];
        let noise = normals(rows * self.actions(), random);
        self.sample(observations, &noise);
        self.scratch.samples.iter().map(|s| s.action).collect()
    }

    /// One update of the critics, the policy, the temperature, the targets and the driver.
    pub fn update(&mut self, batch: &Batch, rates: &Rates, random: &mut Pcg64) -> Losses {
        let count = batch.len() * self.actions();
        self.label(batch, rates, &normals(count, random));
        let mut losses = Losses::default();
        for i in 0..2 {
            losses.critic += 0.5 * self.critic_gradient(i, batch);
            let gradient = &self.scratch.gradient;
            self.critic_adams[i].step(self.critics[i].parameters_mut(), gradient, rates.critic);
        }
        losses.policy = self.policy_gradient(batch, &normals(count, random));
        let gradient = &self.scratch.gradient;
        self.actor_adam
            .step(self.actor.parameters_mut(), gradient, rates.policy);
        let density = self.mean_log_density(batch.len());
        let slope = temperature_gradient(self.log_temperature, density, rates.target_entropy);
        let temperature = std::slice::from_mut(&mut self.log_temperature);
        self.temperature_adam
            .step(temperature, &[slope], rates.temperature);
        for (target, critic) in self.targets.iter_mut().zip(&self.critics) {
            target.approach(critic, rates.softness);
        }
        self.driver.approach(&self.actor, rates.averaging);
        losses.entropy = -density;
        losses.temperature = libm::expf(self.log_temperature);
        losses
    }

    /// Fills `scratch.samples` with the policy's actions for `observations` under `noise`.
    fn sample(&mut self, observations: &[f32], noise: &[f32]) {
        let actions = self.actions();
        let output = self.actor.forward(observations, &mut self.scratch.actor);
        self.scratch.samples.clear();
        for (row, noise) in output
            .chunks_exact(2 * actions)
            .zip(noise.chunks_exact(actions))
        {
            let (means, deviations) = row.split_at(actions);
            let parts = means.iter().zip(deviations).zip(noise);
            let samples = parts.map(|((m, d), e)| Sample::new(*m, *d, *e));
            self.scratch.samples.extend(samples);
        }
    }

    /// Fills `scratch.labels` with r + γ·(min Q̄(s′, a′) − α·log π(a′ | s′)), the critics' targets.
    fn label(&mut self, batch: &Batch, rates: &Rates, noise: &[f32]) {
        let actions = self.actions();
        self.sample(&batch.next, noise);
        self.join_sampled(&batch.next);
        let alpha = libm::expf(self.log_temperature);
        let Scratch {
            critics: tapes,
            samples,
            inputs,
            labels,
            ..
        } = &mut self.scratch;
        for (target, tape) in self.targets.iter().zip(tapes.iter_mut()) {
            target.forward(inputs, tape);
        }
        labels.clear();
        let values = tapes[0].output().iter().zip(tapes[1].output());
        let next = values.zip(samples.chunks_exact(actions));
        let steps = batch.rewards.iter().zip(&batch.continues);
        labels.extend(steps.zip(next).map(|((r, continues), ((a, b), samples))| {
            let value = smaller(*a, *b) - alpha * log_density(samples);
            r + rates.discount * continues * value
        }));
    }

    /// Leaves the gradient of critic `i`'s loss in `scratch.gradient`, and gives the loss.
    fn critic_gradient(&mut self, i: usize, batch: &Batch) -> f32 {
        join(
            &batch.observations,
            &batch.actions,
            batch.len(),
            &mut self.scratch.inputs,
        );
        let Scratch {
            critics: tapes,
            delta,
            gradient,
            inputs,
            labels,
            ..
        } = &mut self.scratch;
        let critic = &self.critics[i];
        let share = 1.0 / batch.len() as f32;
        let values = critic.forward(inputs, &mut tapes[i]);
        delta.values.clear();
        delta
            .values
            .extend(values.iter().zip(&*labels).map(|(q, y)| share * (q - y)));
        let loss = delta.values.iter().map(|d| 0.5 * d * d / share).sum();
        zero(gradient, critic.parameters().len());
        critic.backward(&tapes[i], delta, Some(gradient));
        loss
    }

    /// Leaves the gradient of the policy's loss in `scratch.gradient`, and gives the loss.
    fn policy_gradient(&mut self, batch: &Batch, noise: &[f32]) -> f32 {
        let (observation, actions) = (self.actor.sizes()[0], self.actions());
        self.sample(&batch.observations, noise);
        self.join_sampled(&batch.observations);
        let alpha = libm::expf(self.log_temperature);
        let share = 1.0 / batch.len() as f32;
        let Scratch {
            actor: actor_tape,
            critics: tapes,
            delta,
            gradient,
            samples,
            inputs,
            ..
        } = &mut self.scratch;
        for (critic, tape) in self.critics.iter().zip(tapes.iter_mut()) {
            critic.forward(inputs, tape);
        }
        let mut loss = 0.0;
        // Each row's derivative runs through the critic that gave the smaller value.
        let mut by_action = vec![0.0; samples.len()];
        for (i, critic) in self.critics.iter().enumerate() {
            let (own, other) = (tapes[i].output(), tapes[1 - i].output());
            let chosen = |k: usize| {
                if i == 0 {
                    own[k] <= other[k]
                } else {
                    own[k] < other[k]
                }
            };
            delta.values.clear();
            delta
                .values
                .extend((0..own.len()).map(|k| if chosen(k) { -share } else { 0.0 }));
            loss += own
                .iter()
                .zip(&delta.values)
                .map(|(q, d)| q * d)
                .sum::<f32>();
            critic.backward(&tapes[i], delta, None);
            let rows = delta.values.chunks_exact(observation + actions);
            for (sum, row) in by_action.chunks_exact_mut(actions).zip(rows) {
                sum.iter_mut()
                    .zip(&row[observation..])
                    .for_each(|(s, d)| *s += d);
            }
        }
        delta.values.clear();
        for (samples, by_action) in samples
            .chunks_exact(actions)
            .zip(by_action.chunks_exact(actions))
        {
            loss += share * alpha * log_density(samples);
            let slopes = samples.iter().zip(by_action);
            let slopes: Vec<_> = slopes.map(|(s, d)| s.backward(*d, share * alpha)).collect();
            delta.values.extend(slopes.iter().map(|(mean, _)| mean));
            delta
                .values
                .extend(slopes.iter().map(|(_, deviation)| deviation));
        }
        zero(gradient, self.actor.parameters().len());
        self.actor.backward(actor_tape, delta, Some(gradient));
        loss
    }

    fn join_sampled(&mut self, observations: &[f32]) {
        let actions: Vec<f32> = self.scratch.samples.iter().map(|s| s.action).collect();
        let rows = actions.len() / self.actions();
        join(observations, &actions, rows, &mut self.scratch.inputs);
    }

    fn mean_log_density(&self, rows: usize) -> f32 {
        log_density(&self.scratch.samples) / rows as f32
    }
}

/// d L(α) / d log α for L(α) = −α·(log π + H₀) (Eq. 15).
fn temperature_gradient(log_temperature: f32, mean_log_density: f32, target_entropy: f32) -> f32 {
    -libm::expf(log_temperature) * (mean_log_density + target_entropy)
}

fn log_density(samples: &[Sample]) -> f32 {
    samples.iter().map(|s| s.log_density).sum()
}

fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

fn zero(gradient: &mut Vec<f32>, length: usize) {
    gradient.clear();
    gradient.resize(length, 0.0);
}

/// Rows of features, each followed by its actions.
fn join(observations: &[f32], actions: &[f32], rows: usize, joined: &mut Vec<f32>) {
    joined.clear();
    let observations = observations.chunks_exact(observations.len() / rows);
    for (o, a) in observations.zip(actions.chunks_exact(actions.len() / rows)) {
        joined.extend_from_slice(o);
        joined.extend_from_slice(a);
    }
}

fn normals(count: usize, random: &mut Pcg64) -> Vec<f32> {
    (0..count).map(|_| random.sample(StandardNormal)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driving::replay::{Replay, Transition};
    use crate::nn::network::tests::{assert_gradient, differences, reference, wide};
    use rand::SeedableRng;

    const OBSERVATION: usize = 3;

    fn setting() -> (Learner, Batch, Rates, Pcg64) {
        let mut random = Pcg64::seed_from_u64(5);
        let rates = Rates::default();
        let learner = Learner::new(OBSERVATION, 2, 8, &rates, &mut random);
        let mut draw =
            |n: usize| -> Vec<f32> { (0..n).map(|_| random.random_range(-1.0..1.0)).collect() };
        let batch = Batch {
            observations: draw(6 * OBSERVATION),
            actions: draw(12),
            rewards: draw(6),
            next: draw(6 * OBSERVATION),
            continues: vec![1.0, 1.0, 0.0, 1.0, 1.0, 0.0],
        };
        (learner, batch, rates, random)
    }

    /// Actions and the sum of their log-densities by the definition, in `f64`.
    fn policy(
        learner: &Learner,
        parameters: &[f64],
        row: &[f64],
        noise: &[f32],
    ) -> (Vec<f64>, f64) {
        let output = reference(&learner.actor, parameters, row);
        let mut density = 0.0;
        let actions = (0..2).map(|i| {
            let log_sigma = -5.0 + 3.5 * (output[2 + i].tanh() + 1.0);
            let e = f64::from(noise[i]);
            let u = output[i] + log_sigma.exp() * e;
            density += -0.5 * e * e - log_sigma - 0.5 * (2.0 * std::f64::consts::PI).ln();
            density += 2.0 * u.cosh().ln();
            u.tanh()
        });
        (actions.collect(), density)
    }

    fn value(critics: &[Network; 2], row: &[f64], actions: &[f64]) -> f64 {
        let input = [row, actions].concat();
        let values = critics
            .each_ref()
            .map(|c| reference(c, &wide(c.parameters()), &input)[0]);
        values[0].min(values[1])
    }

    #[test]
    fn the_critics_labels_follow_equation_13() {
        let (mut learner, batch, rates, mut random) = setting();
        learner.targets[0].parameters_mut()[3] += 0.3; // targets that differ from the critics
        let noise = normals(12, &mut random);
        learner.label(&batch, &rates, &noise);
        let next = wide(&batch.next);
        for k in 0..6 {
            let row = &next[OBSERVATION * k..][..OBSERVATION];
            let parameters = wide(learner.actor.parameters());
            let (actions, density) = policy(&learner, &parameters, row, &noise[2 * k..]);
            let soft = value(&learner.targets, row, &actions) - 0.1 * density;
            let label = f64::from(batch.rewards[k]) + 0.99 * f64::from(batch.continues[k]) * soft;
            assert!((f64::from(learner.scratch.labels[k]) - label).abs() < 1e-5);
        }
    }

    #[test]
    fn the_critics_gradient_agrees_with_finite_differences() {
        let (mut learner, batch, rates, mut random) = setting();
        learner.label(&batch, &rates, &normals(12, &mut random));
        let labels = learner.scratch.labels.clone();
        for i in 0..2 {
            let got = learner.critic_gradient(i, &batch);
            let critic = &learner.critics[i];
            let loss = |parameters: &[f64]| -> f64 {
                let rows = (0..6).map(|k| {
                    let input = [
                        wide(&batch.observations[OBSERVATION * k..][..OBSERVATION]),
                        wide(&batch.actions[2 * k..][..2]),
                    ];
                    let q = reference(critic, parameters, &input.concat())[0];
                    0.5 * (q - f64::from(labels[k])).powi(2) / 6.0
                });
                rows.sum()
            };
            let parameters = wide(critic.parameters());
            assert!((f64::from(got) - loss(&parameters)).abs() < 1e-5);
            assert_gradient(&learner.scratch.gradient, &differences(&parameters, loss));
        }
    }

    #[test]
    fn the_policys_gradient_agrees_with_finite_differences() {
        let (mut learner, batch, _, mut random) = setting();
        learner.log_temperature = -0.5;
        let noise = normals(12, &mut random);
        let got = learner.policy_gradient(&batch, &noise);
        let observations = wide(&batch.observations);
        let loss = |parameters: &[f64]| -> f64 {
            let rows = (0..6).map(|k| {
                let row = &observations[OBSERVATION * k..][..OBSERVATION];
                let (actions, density) = policy(&learner, parameters, row, &noise[2 * k..]);
                ((-0.5_f64).exp() * density - value(&learner.critics, row, &actions)) / 6.0
            });
            rows.sum()
        };
        let parameters = wide(learner.actor.parameters());
        assert!((f64::from(got) - loss(&parameters)).abs() < 1e-5);
        assert_gradient(&learner.scratch.gradient, &differences(&parameters, loss));
    }

    #[test]
    fn the_temperatures_gradient_agrees_with_finite_differences() {
        for (log_alpha, density) in [(-2.0, 1.5), (0.3, 4.0), (-0.1, -1.0)] {
            let loss = |x: &[f64]| -x[0].exp() * (f64::from(density) - 2.0);
            let expected = differences(&[f64::from(log_alpha)], loss);
            let got = temperature_gradient(log_alpha, density, -2.0);
            assert_gradient(&[got], &expected);
        }
    }

    /// Reward 1 − (a − s)²: whatever the discount, the best action is the state itself. States come
    /// at random, so the value of the best policy is 1 / (1 − γ), less what its entropy costs.
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
                done: false,
            });
            state = next;
            if step > 100 {
                replay.sample(64, &mut random, &mut batch);
                learner.update(&batch, &rates, &mut random);
            }
        }
        let mut tape = Tape::default();
        for s in [-0.6, -0.3, 0.0, 0.3, 0.6_f32] {
            let mean = learner.actor.forward(&[s], &mut tape)[0];
            assert!((mean.tanh() - s).abs() < 0.1, "at {s}: {}", mean.tanh());
            let input = [wide(&[s]), wide(&[mean.tanh()])].concat();
            let critic = &learner.critics[0];
            let q = reference(critic, &wide(critic.parameters()), &input)[0];
            assert!((q - 2.0).abs() < 0.3, "value at {s}: {q}");
        }
    }
}
