//! Soft actor-critic's losses and their gradients (Haarnoja et al., 2018; the paper's Eqs. 13 to 15).

use crate::algorithm::sac::networks::{Networks, Scratch, join, log_density};
use crate::algorithm::sac::settings::Rates;
use crate::driving::replay::Batch;

impl Networks {
    /// Fills `scratch.labels` with r + γ·(min Q̄(s′, a′) − α·log π(a′ | s′)), the critics' targets.
    pub(super) fn label(&mut self, batch: &Batch, rates: &Rates, noise: &[f32]) {
        let actions = self.actions();
        self.sample(&batch.next, noise);
        self.join_sampled(&batch.next);
        let alpha = self.temperature();
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

    /// Writes the gradient of critic `i`'s loss (Eq. 13) to `scratch.gradient` and returns the loss.
    pub(super) fn critic_gradient(&mut self, i: usize, batch: &Batch) -> f32 {
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

    /// Writes the gradient of the policy's loss (Eq. 14) to `scratch.gradient` and returns the loss.
    pub(super) fn policy_gradient(&mut self, batch: &Batch, noise: &[f32]) -> f32 {
        let (observation, actions) = (self.actor.sizes()[0], self.actions());
        self.sample(&batch.observations, noise);
        self.join_sampled(&batch.observations);
        let alpha = self.temperature();
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
        // Only the critic with the smaller value contributes to a row's derivative.
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

    /// The derivative of the temperature's loss L(α) = −α·(log π + H₀) (Eq. 15) with respect to log α.
    pub(super) fn temperature_gradient(&self, mean_log_density: f32, target_entropy: f32) -> f32 {
        -self.temperature() * (mean_log_density + target_entropy)
    }
}

fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

fn zero(gradient: &mut Vec<f32>, length: usize) {
    gradient.clear();
    gradient.resize(length, 0.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algorithm::sac::networks::normals;
    use crate::nn::finite_differences::{assert_gradient, differences, reference, wide};
    use crate::nn::network::Network;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    const OBSERVATION: usize = 3;

    fn setting() -> (Networks, Batch, Rates, Pcg64) {
        let mut random = Pcg64::seed_from_u64(5);
        let rates = Rates::default();
        let actor = Network::new(&[OBSERVATION, 8, 8, 8, 4], &mut random);
        let networks = Networks::new(actor, 8, &rates, &mut random);
        let mut draw =
            |n: usize| -> Vec<f32> { (0..n).map(|_| random.random_range(-1.0..1.0)).collect() };
        let batch = Batch {
            observations: draw(6 * OBSERVATION),
            actions: draw(12),
            rewards: draw(6),
            next: draw(6 * OBSERVATION),
            continues: vec![1.0, 1.0, 0.0, 1.0, 1.0, 0.0],
        };
        (networks, batch, rates, random)
    }

    /// Actions and the sum of their log-densities by the definition, in `f64`.
    fn policy(
        networks: &Networks,
        parameters: &[f64],
        row: &[f64],
        noise: &[f32],
    ) -> (Vec<f64>, f64) {
        let output = reference(&networks.actor, parameters, row);
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
    fn the_targets_of_the_critics_follow_equation_13() {
        let (mut networks, batch, rates, mut random) = setting();
        networks.targets[0].parameters_mut()[3] += 0.3; // targets that differ from the critics
        let noise = normals(12, &mut random);
        networks.label(&batch, &rates, &noise);
        let next = wide(&batch.next);
        for k in 0..6 {
            let row = &next[OBSERVATION * k..][..OBSERVATION];
            let parameters = wide(networks.actor.parameters());
            let (actions, density) = policy(&networks, &parameters, row, &noise[2 * k..]);
            let soft = value(&networks.targets, row, &actions) - 0.1 * density;
            let label = f64::from(batch.rewards[k]) + 0.99 * f64::from(batch.continues[k]) * soft;
            assert!((f64::from(networks.scratch.labels[k]) - label).abs() < 1e-5);
        }
    }

    #[test]
    fn the_critics_gradient_agrees_with_finite_differences() {
        let (mut networks, batch, rates, mut random) = setting();
        networks.label(&batch, &rates, &normals(12, &mut random));
        let labels = networks.scratch.labels.clone();
        for i in 0..2 {
            let got = networks.critic_gradient(i, &batch);
            let critic = &networks.critics[i];
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
            assert_gradient(&networks.scratch.gradient, &differences(&parameters, loss));
        }
    }

    #[test]
    fn the_policys_gradient_agrees_with_finite_differences() {
        let (mut networks, batch, _, mut random) = setting();
        networks.log_temperature = -0.5;
        let noise = normals(12, &mut random);
        let got = networks.policy_gradient(&batch, &noise);
        let observations = wide(&batch.observations);
        let loss = |parameters: &[f64]| -> f64 {
            let rows = (0..6).map(|k| {
                let row = &observations[OBSERVATION * k..][..OBSERVATION];
                let (actions, density) = policy(&networks, parameters, row, &noise[2 * k..]);
                ((-0.5_f64).exp() * density - value(&networks.critics, row, &actions)) / 6.0
            });
            rows.sum()
        };
        let parameters = wide(networks.actor.parameters());
        assert!((f64::from(got) - loss(&parameters)).abs() < 1e-5);
        assert_gradient(&networks.scratch.gradient, &differences(&parameters, loss));
    }

    #[test]
    fn the_temperatures_gradient_agrees_with_finite_differences() {
        let (mut networks, ..) = setting();
        for (log_alpha, density) in [(-2.0, 1.5), (0.3, 4.0), (-0.1, -1.0)] {
            let loss = |x: &[f64]| -x[0].exp() * (f64::from(density) - 2.0);
            let expected = differences(&[f64::from(log_alpha)], loss);
            networks.log_temperature = log_alpha;
            let got = networks.temperature_gradient(density, -2.0);
            assert_gradient(&[got], &expected);
        }
    }
}
