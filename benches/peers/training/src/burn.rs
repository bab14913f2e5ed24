//! burn: its tensors, derivatives, dense layers and Adam, on its CPU device, flex.

use crate::{ACTIONS, BATCH, DENSITY, FEATURES, LOG_SIGMA, Update, batch, layers};
use burn::optim::{Adam, AdamConfig, AdamState, Optimizer};
use burn::tensor::activation::{relu, softplus};
use burn::tensor::module::linear;
use burn::tensor::{Device, Distribution, Gradients, Tensor, TensorData};
use cede_train::algorithm::sac::Rates;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use std::mem::take;

/// A dense layer's weights and biases.
type Layer = (Tensor<2>, Tensor<1>);

/// Layers whose parameters derivatives are taken to.
fn learning(layers: &[Layer]) -> Vec<Layer> {
    let leaves = layers.iter().cloned();
    leaves
        .map(|(w, b)| (w.autodiff().require_grad(), b.autodiff().require_grad()))
        .collect()
}

fn network(inputs: usize, width: usize, outputs: usize, random: &mut Pcg64) -> Vec<Layer> {
    let device = Device::flex();
    layers(inputs, width, outputs, random)
        .into_iter()
        .map(|layer| {
            let biases = TensorData::new(layer.biases, [layer.shape[1]]);
            let weights = TensorData::new(layer.weights, layer.shape);
            (
                Tensor::from_data(weights, &device),
                Tensor::from_data(biases, &device),
            )
        })
        .collect()
}

fn run(layers: &[Layer], mut x: Tensor<2>) -> Tensor<2> {
    for (i, (weights, biases)) in layers.iter().enumerate() {
        x = linear(x, weights.clone(), Some(biases.clone()));
        if i + 1 < layers.len() {
            x = relu(x);
        }
    }
    x
}

/// Actions, and their log-densities.
fn sample(actor: &[Layer], seen: &Tensor<2>) -> (Tensor<2>, Tensor<2>) {
    let output = run(actor, seen.clone());
    let mean = output.clone().narrow(1, 0, ACTIONS);
    let raw = output.narrow(1, ACTIONS, ACTIONS);
    let log_sigma = raw.tanh() * LOG_SIGMA[0] + LOG_SIGMA[1];
    let shape = [BATCH, ACTIONS];
    let noise = Tensor::<2>::random(shape, Distribution::Normal(0.0, 1.0), &Device::flex());
    let u = mean + log_sigma.clone().exp() * noise.clone();
    let normal = noise.square() * -0.5 - log_sigma;
    let squashing = (u.clone() + softplus(u.clone() * -2.0, 1.0)) * 2.0;
    let density = normal + squashing - DENSITY;
    (u.tanh(), density.sum_dim(1))
}

fn smaller(critics: &[Vec<Layer>; 2], seen: &Tensor<2>, actions: Tensor<2>) -> Tensor<2> {
    let joined = Tensor::cat(vec![seen.clone(), actions], 1);
    run(&critics[0], joined.clone()).min_pair(run(&critics[1], joined))
}

fn approach(target: &mut Vec<Layer>, critic: &[Layer], share: f32) {
    let pairs = take(target).into_iter().zip(critic.iter().cloned());
    let moved = pairs.map(|((w, b), (weights, biases))| {
        (
            w * (1.0 - share) + weights * share,
            b * (1.0 - share) + biases * share,
        )
    });
    *target = moved.collect();
}

/// burn's Adam, and what it keeps for each layer of a network.
struct Steps {
    adam: Adam,
    rate: f64,
    states: Vec<(Option<AdamState<2>>, Option<AdamState<1>>)>,
}

impl Steps {
    fn new(layers: usize, rate: f32) -> Self {
        Self {
            adam: AdamConfig::new().with_epsilon(1e-8).build(),
            rate: f64::from(rate),
            states: vec![(None, None); layers],
        }
    }

    /// Moves `network` against the slopes of the loss along `learning`, its copy that the loss was made with.
    fn step(&mut self, network: &mut Vec<Layer>, learning: Vec<Layer>, slopes: &mut Gradients) {
        let layers = take(network).into_iter().zip(learning);
        for (((w, b), leaf), states) in layers.zip(&mut self.states) {
            let slope = leaf.0.grad_remove(slopes).expect("the loss depends on it");
            let (w, state) = self.adam.step(self.rate, w, slope, states.0.take());
            states.0 = state;
            let slope = leaf.1.grad_remove(slopes).expect("the loss depends on it");
            let (b, state) = self.adam.step(self.rate, b, slope, states.1.take());
            states.1 = state;
            network.push((w, b));
        }
    }
}

struct Learner {
    actor: Vec<Layer>,
    critics: [Vec<Layer>; 2],
    targets: [Vec<Layer>; 2],
    log_alpha: Tensor<1>,
    actor_steps: Steps,
    critic_steps: [Steps; 2],
    alpha_state: Option<AdamState<1>>,
    rates: Rates,
    observations: Tensor<2>,
    next: Tensor<2>,
    taken: Tensor<2>,
    rewards: Tensor<2>,
}

impl Learner {
    fn new(width: usize) -> Self {
        let (rates, batch) = (Rates::default(), batch());
        let random = &mut Pcg64::seed_from_u64(2);
        let actor = network(FEATURES, width, 2 * ACTIONS, random);
        let critics = [(); 2].map(|()| network(FEATURES + ACTIONS, width, 1, random));
        let device = Device::flex();
        let rows = |values: Vec<f32>, columns| {
            Tensor::<2>::from_data(TensorData::new(values, [BATCH, columns]), &device)
        };
        Self {
            actor_steps: Steps::new(actor.len(), rates.policy),
            critic_steps: [(); 2].map(|()| Steps::new(actor.len(), rates.critic)),
            alpha_state: None,
            log_alpha: Tensor::from_data([rates.initial_temperature.ln()], &device),
            actor,
            targets: critics.clone(),
            critics,
            observations: rows(batch.observations, FEATURES),
            next: rows(batch.next, FEATURES),
            taken: rows(batch.actions, ACTIONS),
            rewards: rows(batch.rewards, 1),
            rates,
        }
    }

    fn update(&mut self) -> f32 {
        let alpha = self.log_alpha.clone().into_scalar::<f32>().exp();
        let (actions, density) = sample(&self.actor, &self.next);
        let value = smaller(&self.targets, &self.next, actions) - density * alpha;
        let label = self.rewards.clone() + value * self.rates.discount;

        let joined = Tensor::cat(vec![self.observations.clone(), self.taken.clone()], 1);
        let leaves = self.critics.each_ref().map(|c| learning(c));
        let loss = |critic| {
            (run(critic, joined.clone()) - label.clone())
                .square()
                .mean()
        };
        let critic_loss = (loss(&leaves[0]) + loss(&leaves[1])) * 0.5;
        let mut slopes = critic_loss.backward();
        let critics = self.critics.iter_mut().zip(leaves);
        for ((critic, leaves), steps) in critics.zip(&mut self.critic_steps) {
            steps.step(critic, leaves, &mut slopes);
        }

        let leaves = learning(&self.actor);
        let (actions, density) = sample(&leaves, &self.observations);
        let value = smaller(&self.critics, &self.observations, actions);
        let mut slopes = (density.clone() * alpha - value).mean().backward();
        self.actor_steps.step(&mut self.actor, leaves, &mut slopes);

        let log_alpha = self.log_alpha.clone().autodiff().require_grad();
        let gap = density.without_autodiff().mean() + self.rates.target_entropy;
        let mut slopes = (log_alpha.clone().exp() * gap).neg().backward();
        let slope = log_alpha
            .grad_remove(&mut slopes)
            .expect("the loss depends on it");
        (self.log_alpha, self.alpha_state) = self.actor_steps.adam.step(
            f64::from(self.rates.temperature),
            self.log_alpha.clone(),
            slope,
            self.alpha_state.take(),
        );

        for (target, critic) in self.targets.iter_mut().zip(&self.critics) {
            approach(target, critic, self.rates.softness);
        }
        0.5 * critic_loss.into_scalar::<f32>()
    }
}

/// burn's update with hidden layers of `width`.
#[must_use]
pub fn burn(width: usize) -> Update {
    let mut learner = Learner::new(width);
    Box::new(move || Ok(learner.update()))
}
