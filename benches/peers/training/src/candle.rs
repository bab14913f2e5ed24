//! candle: its tensors, derivatives, dense layers and Adam, on its CPU device.

use crate::{ACTIONS, BATCH, DENSITY, FEATURES, Failure, LOG_SIGMA, Update, batch, layers};
use candle_core::{Device, Result, Tensor, Var};
use candle_nn::{AdamW, Linear, Module, Optimizer, ParamsAdamW};
use cede_train::algorithm::sac::Rates;
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// A network's parameters, and its layers with and without derivatives to them.
struct Network {
    parameters: Vec<Var>,
    learning: Vec<Linear>,
    frozen: Vec<Linear>,
}

impl Network {
    fn new(inputs: usize, width: usize, outputs: usize, random: &mut Pcg64) -> Result<Self> {
        let (mut parameters, mut learning, mut frozen) = (vec![], vec![], vec![]);
        for layer in layers(inputs, width, outputs, random) {
            // candle's layers keep the weights output by output; random ones are as good in either order.
            let [inputs, outputs] = layer.shape;
            let weights = Var::from_vec(layer.weights, (outputs, inputs), &Device::Cpu)?;
            let biases = Var::from_vec(layer.biases, outputs, &Device::Cpu)?;
            frozen.push(Linear::new(weights.detach(), Some(biases.detach())));
            learning.push(Linear::new(
                weights.as_tensor().clone(),
                Some(biases.as_tensor().clone()),
            ));
            parameters.extend([weights, biases]);
        }
        Ok(Self {
            parameters,
            learning,
            frozen,
        })
    }

    fn approach(&self, other: &Self, share: f64) -> Result<()> {
        for (own, other) in self.parameters.iter().zip(&other.parameters) {
            own.set(&((own.as_tensor() * (1.0 - share))? + (other.as_tensor() * share)?)?)?;
        }
        Ok(())
    }
}

fn run(layers: &[Linear], inputs: &Tensor) -> Result<Tensor> {
    let (last, hidden) = layers.split_last().expect("a network has layers");
    let mut x = inputs.clone();
    for layer in hidden {
        x = layer.forward(&x)?.relu()?;
    }
    last.forward(&x)
}

/// Actions, and their log-densities.
fn sample(actor: &[Linear], seen: &Tensor) -> Result<(Tensor, Tensor)> {
    let output = run(actor, seen)?;
    let mean = output.narrow(1, 0, ACTIONS)?;
    let raw = output.narrow(1, ACTIONS, ACTIONS)?;
    let log_sigma = raw.tanh()?.affine(LOG_SIGMA[0], LOG_SIGMA[1])?;
    let noise = mean.randn_like(0.0, 1.0)?;
    let u = (mean + (log_sigma.exp()? * &noise)?)?;
    let normal = ((noise.sqr()? * -0.5)? - log_sigma)?;
    let squashing = ((&u + softplus(&(&u * -2.0)?)?)? * 2.0)?;
    let density = ((normal + squashing)? - DENSITY)?;
    Ok((u.tanh()?, density.sum_keepdim(1)?))
}

/// ln(1 + eˣ), also where eˣ is too large.
fn softplus(x: &Tensor) -> Result<Tensor> {
    x.relu()? + (x.abs()?.neg()?.exp()? + 1.0)?.log()?
}

fn smaller(critics: [&[Linear]; 2], seen: &Tensor, actions: &Tensor) -> Result<Tensor> {
    let joined = Tensor::cat(&[seen, actions], 1)?;
    run(critics[0], &joined)?.minimum(&run(critics[1], &joined)?)
}

fn adam(parameters: Vec<Var>, rate: f32) -> Result<AdamW> {
    let settings = ParamsAdamW {
        lr: f64::from(rate),
        weight_decay: 0.0,
        ..ParamsAdamW::default()
    };
    AdamW::new(parameters, settings)
}

struct Learner {
    actor: Network,
    critics: [Network; 2],
    targets: [Network; 2],
    log_alpha: Var,
    actor_adam: AdamW,
    critic_adam: AdamW,
    alpha_adam: AdamW,
    rates: Rates,
    observations: Tensor,
    next: Tensor,
    taken: Tensor,
    rewards: Tensor,
}

impl Learner {
    fn new(width: usize) -> Result<Self> {
        let (rates, batch) = (Rates::default(), batch());
        let random = &mut Pcg64::seed_from_u64(2);
        let actor = Network::new(FEATURES, width, 2 * ACTIONS, random)?;
        let mut critic = || Network::new(FEATURES + ACTIONS, width, 1, random);
        let (critics, targets) = ([critic()?, critic()?], [critic()?, critic()?]);
        for (target, critic) in targets.iter().zip(&critics) {
            target.approach(critic, 1.0)?;
        }
        let log_alpha = Var::new(rates.initial_temperature.ln(), &Device::Cpu)?;
        let both = critics.iter().flat_map(|c| c.parameters.clone()).collect();
        let rows = |values, columns| Tensor::from_vec(values, (BATCH, columns), &Device::Cpu);
        Ok(Self {
            actor_adam: adam(actor.parameters.clone(), rates.policy)?,
            critic_adam: adam(both, rates.critic)?,
            alpha_adam: adam(vec![log_alpha.clone()], rates.temperature)?,
            actor,
            critics,
            targets,
            log_alpha,
            rates,
            observations: rows(batch.observations, FEATURES)?,
            next: rows(batch.next, FEATURES)?,
            taken: rows(batch.actions, ACTIONS)?,
            rewards: rows(batch.rewards, 1)?,
        })
    }

    fn update(&mut self) -> Result<f32> {
        let alpha = f64::from(self.log_alpha.to_scalar::<f32>()?.exp());
        let (actions, density) = sample(&self.actor.frozen, &self.next)?;
        let targets = self.targets.each_ref().map(|t| &*t.frozen);
        let value = (smaller(targets, &self.next, &actions)? - (density * alpha)?)?;
        let label = (&self.rewards + (value * f64::from(self.rates.discount))?)?;

        let joined = Tensor::cat(&[&self.observations, &self.taken], 1)?;
        let loss = |critic: &Network| {
            (run(&critic.learning, &joined)? - &label)?
                .sqr()?
                .mean_all()
        };
        let critic_loss = ((loss(&self.critics[0])? + loss(&self.critics[1])?)? * 0.5)?;
        self.critic_adam.backward_step(&critic_loss)?;

        let (actions, density) = sample(&self.actor.learning, &self.observations)?;
        let critics = self.critics.each_ref().map(|c| &*c.frozen);
        let value = smaller(critics, &self.observations, &actions)?;
        let loss = ((&density * alpha)? - value)?.mean_all()?;
        self.actor_adam.backward_step(&loss)?;

        let gap = (density.detach().mean_all()? + f64::from(self.rates.target_entropy))?;
        let loss = (self.log_alpha.exp()? * gap)?.neg()?;
        self.alpha_adam.backward_step(&loss)?;

        for (target, critic) in self.targets.iter().zip(&self.critics) {
            target.approach(critic, f64::from(self.rates.softness))?;
        }
        Ok(0.5 * critic_loss.to_scalar::<f32>()?)
    }
}

/// candle's update with hidden layers of `width`.
///
/// # Errors
/// candle's.
pub fn candle(width: usize) -> std::result::Result<Update, Failure> {
    let mut learner = Learner::new(width)?;
    Ok(Box::new(move || Ok(learner.update()?)))
}
