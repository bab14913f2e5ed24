//! Behaviour cloning: the recorded accelerations as a function of the recorded observations.
//!
//! The paper's first baseline: a deterministic joint policy, fitted by least
//! squares. It learns from recorded states only, not from states that it reaches itself.

use crate::driving::inputs::Inputs;
use crate::driving::policy_view::PolicyView;
use crate::nn::adam::Adam;
use crate::nn::network::{Delta, Network, Tape};
use cede_controller::policy::MAX_ACCELERATION;
use cede_controller::{FeatureSet, Perspective};
use cede_sim::ObservationModel;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// Settings of behaviour cloning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BcSettings {
    /// The network's inputs; the paper's eight numbers by default.
    pub features: FeatureSet,
    /// Number of updates.
    pub updates: u32,
    /// Recorded steps in a batch.
    pub batch: usize,
    /// Width of the three hidden layers: a multiple of 16 up to 128.
    pub width: usize,
    /// Learning rate.
    pub rate: f32,
}

impl Default for BcSettings {
    fn default() -> Self {
        Self {
            features: FeatureSet::Raw,
            updates: 10_000,
            batch: 512,
            width: 128,
            rate: 1e-4,
        }
    }
}

/// The state of a run between two updates; a checkpoint stores it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BcProgress {
    settings: BcSettings,
    inputs: Inputs,
    network: Network,
    adam: Adam,
    random: Pcg64,
    update: u32,
}

/// A training run of behaviour cloning.
pub struct Bc {
    progress: BcProgress,
    /// For every recorded step the network's inputs and both accelerations (as shares of the limit).
    rows: Vec<(Vec<f32>, [f32; 2])>,
    tape: Tape,
    delta: Delta,
    batch: Vec<f32>,
    gradient: Vec<f32>,
}

impl Bc {
    /// A new run over the records of `models`.
    #[must_use]
    pub fn new(settings: BcSettings, models: &[ObservationModel<'_>], seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let lefts: Vec<_> = models
            .iter()
            .flat_map(ObservationModel::recorded)
            .step_by(2)
            .collect();
        let inputs = Inputs::fit(settings.features, &lefts);
        let (i, w) = (settings.features.count(), settings.width);
        let network = Network::new(&[i, w, w, w, 4], &mut random);
        let progress = BcProgress {
            adam: Adam::new(network.parameters().len()),
            settings,
            inputs,
            network,
            random,
            update: 0,
        };
        Self::resume(progress, models)
    }

    /// The run that `progress` was taken from, over the same encounters.
    #[must_use]
    pub fn resume(progress: BcProgress, models: &[ObservationModel<'_>]) -> Self {
        let rows = models
            .iter()
            .flat_map(|model| examples(model, &progress.inputs))
            .collect();
        Self {
            gradient: vec![0.0; progress.network.parameters().len()],
            progress,
            rows,
            tape: Tape::default(),
            delta: Delta::default(),
            batch: Vec::new(),
        }
    }

    /// The state from which [`Bc::resume`] continues with the same bits.
    #[must_use]
    pub fn progress(&self) -> &BcProgress {
        &self.progress
    }

    /// Updates done, and their total number.
    #[must_use]
    pub fn updates(&self) -> (u64, u64) {
        (
            self.progress.update.into(),
            self.progress.settings.updates.into(),
        )
    }

    /// The current policy.
    #[must_use]
    pub fn view(&self) -> PolicyView<'_> {
        PolicyView {
            network: &self.progress.network,
            inputs: &self.progress.inputs,
            perspective: Perspective::Joint,
        }
    }

    /// One update. Returns the mean squared error of the batch, as a share of the square of the
    /// limit, or `None` if all updates are done or there are no records.
    pub fn update(&mut self) -> Option<f32> {
        let progress = &mut self.progress;
        let BcSettings {
            updates,
            batch,
            rate,
            ..
        } = progress.settings;
        if progress.update >= updates || self.rows.is_empty() {
            return None;
        }
        self.batch.clear();
        let mut labels = Vec::with_capacity(batch);
        for _ in 0..batch {
            let (inputs, label) = &self.rows[progress.random.random_range(0..self.rows.len())];
            self.batch.extend_from_slice(inputs);
            labels.push(*label);
        }
        let output = progress.network.forward(&self.batch, &mut self.tape);
        let loss = squared_error(output, &labels, &mut self.delta.values);
        self.gradient.fill(0.0);
        progress
            .network
            .backward(&self.tape, &mut self.delta, Some(&mut self.gradient));
        progress
            .adam
            .step(progress.network.parameters_mut(), &self.gradient, rate);
        progress.update += 1;
        Some(loss)
    }
}

/// The mean squared error of the squashed means; `by_output` receives its derivatives with respect
/// to the outputs.
fn squared_error(output: &[f32], labels: &[[f32; 2]], by_output: &mut Vec<f32>) -> f32 {
    let share = 1.0 / (2 * labels.len()) as f32;
    let mut total = 0.0;
    by_output.clear();
    for (row, label) in output.chunks_exact(output.len() / labels.len()).zip(labels) {
        for (i, mean) in row.iter().enumerate() {
            let Some(label) = label.get(i) else {
                by_output.push(0.0);
                continue;
            };
            let action = libm::tanhf(*mean);
            let off = action - label;
            total += share * off * off;
            by_output.push(share * 2.0 * off * (1.0 - action * action));
        }
    }
    total
}

/// The network's inputs and the labels of every recorded step.
fn examples(model: &ObservationModel<'_>, inputs: &Inputs) -> Vec<(Vec<f32>, [f32; 2])> {
    let lefts = model.recorded().step_by(2).enumerate();
    let rows = lefts.map(|(step, pair)| {
        let mut row = Vec::new();
        inputs.append(&pair, &mut row);
        let action = |i: usize| {
            let a = model.encounter.participants[i].record[step].a;
            (a / MAX_ACCELERATION).clamp(-1.0, 1.0)
        };
        (row, [action(0), action(1)])
    });
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nn::finite_differences::{assert_gradient, differences, wide};
    use cede_data::Dataset;

    #[test]
    fn the_gradient_of_the_loss_agrees_with_finite_differences() {
        let output = [0.3, -0.8, 0.1, 0.2, 1.4, 0.0, -0.5, 0.9];
        let labels = [[0.5, -0.2], [-1.0, 0.4]];
        let mut got = Vec::new();
        squared_error(&output, &labels, &mut got);
        let loss = |y: &[f64]| {
            let off = |row: usize, i: usize| y[4 * row + i].tanh() - f64::from(labels[row][i]);
            let pairs = [(0, 0), (0, 1), (1, 0), (1, 1)];
            pairs.map(|(row, i)| off(row, i).powi(2) / 4.0).iter().sum()
        };
        assert_gradient(&got, &differences(&wide(&output), loss));
    }

    #[test]
    fn cloning_reduces_its_error_and_resumes_bit_for_bit() {
        let dataset = Dataset::synthetic(10, 3);
        let models: Vec<ObservationModel<'_>> = dataset
            .encounters
            .iter()
            .take(10)
            .map(ObservationModel::new)
            .collect();
        let settings = BcSettings {
            updates: 240,
            batch: 64,
            width: 16,
            rate: 3e-3,
            ..BcSettings::default()
        };
        let mut whole = Bc::new(settings.clone(), &models, 5);
        let losses: Vec<f32> = std::iter::from_fn(|| whole.update()).collect();
        let mean = |losses: &[f32]| losses.iter().sum::<f32>() / losses.len() as f32;
        assert!(
            mean(&losses[230..]) < 0.7 * mean(&losses[..10]),
            "{losses:?}"
        );

        let mut first = Bc::new(settings, &models, 5);
        (0..25).for_each(|_| assert!(first.update().is_some()));
        let mut second = Bc::resume(first.progress().clone(), &models);
        while second.update().is_some() {}
        assert_eq!(second.progress(), whole.progress());
    }
}
