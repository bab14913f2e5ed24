//! Soft actor-critic's networks: policy, critics and targets, and sampling from the policy.

use crate::algorithm::sac::settings::Rates;
use crate::nn::gaussian::Sample;
use crate::nn::network::{Delta, Network, Tape};
use rand::RngExt;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// The networks and the temperature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Networks {
    /// The policy network: the means of all actions, then their raw deviations.
    pub(super) actor: Network,
    /// The running average of the policy network.
    pub(super) averaged: Network,
    pub(super) critics: [Network; 2],
    pub(super) targets: [Network; 2],
    /// log α.
    pub(super) log_temperature: f32,
    #[serde(skip)]
    pub(super) scratch: Scratch,
}

/// Buffers of an update, so that it does not allocate.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    pub(super) actor: Tape,
    pub(super) critics: [Tape; 2],
    pub(super) delta: Delta,
    pub(super) gradient: Vec<f32>,
    /// The sampled actions, row by row.
    pub(super) samples: Vec<Sample>,
    /// The critics' inputs.
    pub(super) inputs: Vec<f32>,
    /// The critics' targets.
    pub(super) labels: Vec<f32>,
}

impl PartialEq for Scratch {
    /// Buffers are not part of the state.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Networks {
    /// New critics of three hidden layers of `width` for `actor`.
    ///
    /// # Panics
    /// If the actor has an odd number of outputs.
    pub(super) fn new(actor: Network, width: usize, rates: &Rates, random: &mut Pcg64) -> Self {
        let (observation, outputs) = (actor.sizes()[0], actor.sizes()[actor.sizes().len() - 1]);
        assert!(outputs % 2 == 0, "a mean and a deviation for each action");
        let sizes = [observation + outputs / 2, width, width, width, 1];
        let critics = [(); 2].map(|()| Network::new(&sizes, random));
        Self {
            targets: critics.clone(),
            critics,
            averaged: actor.clone(),
            actor,
            log_temperature: libm::logf(rates.initial_temperature),
            scratch: Scratch::default(),
        }
    }

    /// Number of actions.
    pub(super) fn actions(&self) -> usize {
        self.actor.sizes()[self.actor.sizes().len() - 1] / 2
    }

    /// α.
    pub(super) fn temperature(&self) -> f32 {
        libm::expf(self.log_temperature)
    }

    /// Moves the targets towards the critics, and the averaged policy towards the policy.
    pub(super) fn approach(&mut self, rates: &Rates) {
        for (target, critic) in self.targets.iter_mut().zip(&self.critics) {
            target.approach(critic, rates.softness);
        }
        self.averaged.approach(&self.actor, rates.averaging);
    }

    /// Fills `scratch.samples` with the policy's actions for `observations` and `noise`.
    pub(super) fn sample(&mut self, observations: &[f32], noise: &[f32]) {
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

    /// Fills `scratch.inputs` with `observations` and the sampled actions.
    pub(super) fn join_sampled(&mut self, observations: &[f32]) {
        let actions: Vec<f32> = self.scratch.samples.iter().map(|s| s.action).collect();
        let rows = actions.len() / self.actions();
        join(observations, &actions, rows, &mut self.scratch.inputs);
    }

    /// The mean over `rows` of the sampled actions' log-density.
    pub(super) fn mean_log_density(&self, rows: usize) -> f32 {
        log_density(&self.scratch.samples) / rows as f32
    }
}

/// The log-density of one row of actions.
pub(super) fn log_density(samples: &[Sample]) -> f32 {
    samples.iter().map(|s| s.log_density).sum()
}

/// Fills `joined` with rows of features, each followed by its actions.
pub(super) fn join(observations: &[f32], actions: &[f32], rows: usize, joined: &mut Vec<f32>) {
    joined.clear();
    let observations = observations.chunks_exact(observations.len() / rows);
    for (o, a) in observations.zip(actions.chunks_exact(actions.len() / rows)) {
        joined.extend_from_slice(o);
        joined.extend_from_slice(a);
    }
}

/// `count` standard normal deviates.
pub(super) fn normals(count: usize, random: &mut Pcg64) -> Vec<f32> {
    (0..count).map(|_| random.sample(StandardNormal)).collect()
}
