//! Behaviour cloning: what the recorded drivers did, learned as a function of what they saw.
//!
//! The paper's first baseline: a deterministic joint policy, fitted to the
//! recorded accelerations by least squares. It never sees its own mistakes.

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

/// How behaviour cloning learns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// What the network is told; the paper's eight numbers by default.
    #[serde(with = "crate::driving::inputs::by_name")]
    pub features: FeatureSet,
    /// Number of updates.
    pub updates: u32,
    /// Steps of the record in a batch.
    pub batch: usize,
    /// Width of the three hidden layers: a multiple of 16 up to 128.
    pub width: usize,
    /// Learning rate.
    pub rate: f32,
}

impl Default for Settings {
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

/// What a run carries from one update to the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    settings: Settings,
    inputs: Inputs,
    network: Network,
    adam: Adam,
    random: Pcg64,
    update: u32,
}

/// A training run.
pub struct Bc {
    progress: Progress,
    /// Network inputs of every recorded step, and the accelerations of both (share of the limit).
    rows: Vec<(Vec<f32>, [f32; 2])>,
    tape: Tape,
    delta: Delta,
    batch: Vec<f32>,
    gradient: Vec<f32>,
}

impl Bc {
    /// A run over the records of `models` that has not yet begun.
    #[must_use]
    pub fn new(settings: Settings, models: &[ObservationModel<'_>], seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let lefts: Vec<_> = models
            .iter()
            .flat_map(ObservationModel::recorded)
            .step_by(2)
            .collect();
        let inputs = Inputs::fit(settings.features, &lefts);
        let (i, w) = (settings.features.count(), settings.width);
        let network = Network::new(&[i, w, w, w, 4], &mut random);
        let progress = Progress {
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
    pub fn resume(progress: Progress, models: &[ObservationModel<'_>]) -> Self {
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

    /// All that a resumed run needs to go on bit for bit.
    #[must_use]
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Updates done, and all there are.
    #[must_use]
    pub fn updates(&self) -> (u64, u64) {
        (
            self.progress.update.into(),
            self.progress.settings.updates.into(),
        )
    }

    /// The driver as it is.
    #[must_use]
    pub fn view(&self) -> PolicyView<'_> {
        PolicyView {
            network: &self.progress.network,
            inputs: &self.progress.inputs,
            perspective: Perspective::Joint,
        }
    }

    /// One update; the mean squared error of the batch, as a share of the limit's square, or `None`
    /// when all updates are done or there is nothing to learn from.
    pub fn update(&mut self) -> Option<f32> {
        let progress = &mut self.progress;
        let Settings {
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

/// Mean squared error of the squashed means, and its derivatives with respect to the outputs.
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
    use crate::nn::network::tests::{assert_gradient, differences, wide};
    use cede_data::Dataset;

    #[test]
    fn the_losss_gradient_agrees_with_finite_differences() {
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
        let settings = Settings {
            updates: 60,
            batch: 64,
            width: 16,
            rate: 3e-3,
            ..Settings::default()
        };
        let mut whole = Bc::new(settings.clone(), &models, 5);
        let losses: Vec<f32> = std::iter::from_fn(|| whole.update()).collect();
        let mean = |losses: &[f32]| losses.iter().sum::<f32>() / losses.len() as f32;
        assert!(
            mean(&losses[50..]) < 0.7 * mean(&losses[..10]),
            "{losses:?}"
        );

        let mut first = Bc::new(settings, &models, 5);
        (0..25).for_each(|_| assert!(first.update().is_some()));
        let mut second = Bc::resume(first.progress().clone(), &models);
        while second.update().is_some() {}
        assert_eq!(second.progress(), whole.progress());
    }
}
