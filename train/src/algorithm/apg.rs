//! Analytic policy gradient: imitation of the recorded drivers by gradients through the closed loop.
//!
//! The kinematics, the features and the network are differentiable, so the
//! distance between the simulated and the recorded trajectories has a gradient
//! with respect to the weights. There is no estimated reward and no value
//! function. One network drives both vehicles, each from its own perspective.
//!
//! Each roll-out of a batch begins at a recorded moment, with disturbed states,
//! and takes `horizon` steps. With probability `carry_on` the next update
//! continues the roll-out from its last states, so that the network also learns
//! from states that it reaches itself.
//!
//! Several networks can be trained one after the other and joined to an ensemble,
//! whose output is the mean of theirs. Short trainings generalise well on average
//! but fit some recorded encounters badly. A [`Refinement`] improves the fit: it
//! trains all layers of the ensemble jointly and, in auxiliary encounters,
//! penalises deviation from the unrefined ensemble.

pub mod claims;
pub mod closed_loop;
pub mod cost;
mod progress;
mod settings;

pub use progress::ApgProgress;
pub use settings::{ApgSettings, ClaimSettings, Refinement};

use crate::algorithm::apg::claims::Claims;
use crate::algorithm::apg::closed_loop::{Aim, ClosedLoop, Former, Start};
use crate::driving::inputs::Inputs;
use crate::driving::policy_view::PolicyView;
use crate::nn::adam::clip;
use cede_controller::Perspective;
use cede_controller::kinematics::State;
use cede_formats::property::StateProperty;
use cede_sim::ObservationModel;
use core::f32::consts::PI;
use core::ops::Range;
use rand::RngExt;
use rand_distr::StandardNormal;
use rayon::prelude::*;

/// Roll-outs per unit of parallel work. The number is fixed so that the order of summation does not
/// depend on the number of threads.
const CHUNK: usize = 64;
/// A roll-out is not continued if it ended this many steps after the recorded end, or later.
const OVERTIME: usize = 30;

/// A training run of the analytic policy gradient.
pub struct Apg<'e> {
    progress: ApgProgress,
    claims: Claims,
    models: &'e [ObservationModel<'e>],
    /// The first `own` models are those to imitate, the others are auxiliary.
    own: usize,
    chunks: Vec<Chunk>,
}

/// The buffers and the result of one unit of parallel work.
#[derive(Default)]
struct Chunk {
    buffers: ClosedLoop,
    gradient: Vec<f32>,
    cost: f32,
}

impl<'e> Apg<'e> {
    /// A new run over `models`. The first `own` encounters are imitated; the others are auxiliary: only
    /// the refinement uses them.
    ///
    /// # Panics
    /// If `own` is 0 or greater than the number of `models`.
    #[must_use]
    pub fn new(
        settings: ApgSettings,
        models: &'e [ObservationModel<'e>],
        own: usize,
        seed: u64,
    ) -> Self {
        let pairs: Vec<_> = models[..own]
            .iter()
            .flat_map(ObservationModel::recorded)
            .collect();
        let inputs = Inputs::fit(settings.features, &pairs);
        Self::resume(ApgProgress::new(settings, inputs, seed), models, own)
    }

    /// The run that `progress` was taken from, over the same encounters.
    ///
    /// # Panics
    /// If `own` is 0 or greater than the number of `models`.
    #[must_use]
    pub fn resume(progress: ApgProgress, models: &'e [ObservationModel<'e>], own: usize) -> Self {
        assert!((1..=models.len()).contains(&own));
        Self {
            progress,
            claims: Claims::default(),
            models,
            own,
            chunks: Vec::new(),
        }
    }

    /// The same run, with the violation of `properties` as an additional cost.
    #[must_use]
    pub fn with_claims(self, properties: &[StateProperty]) -> Self {
        Self {
            claims: Claims::new(properties),
            ..self
        }
    }

    /// The state from which [`Apg::resume`] continues with the same bits.
    #[must_use]
    pub fn progress(&self) -> &ApgProgress {
        &self.progress
    }

    /// The current policy.
    #[must_use]
    pub fn view(&self) -> PolicyView<'_> {
        PolicyView {
            network: &self.progress.network,
            inputs: &self.progress.inputs,
            perspective: Perspective::Ego,
        }
    }

    /// Updates done, and their total number.
    #[must_use]
    pub fn updates(&self) -> (u64, u64) {
        (
            self.progress.update.into(),
            self.progress.settings.total().into(),
        )
    }

    /// Roll-outs in a batch.
    #[must_use]
    pub fn roll_outs(&self) -> usize {
        self.progress.settings.batch
    }

    /// One update. Returns the mean cost of the batch, or `None` if all updates are done.
    ///
    /// Runs on the threads of the current rayon pool; the bits do not depend on their number.
    pub fn update(&mut self) -> Option<f32> {
        let settings = &self.progress.settings;
        if self.progress.update >= settings.total() {
            return None;
        }
        let stage = settings.stage(self.progress.update);
        let late = stage.done >= 2.0 / 3.0;
        let horizon = if late {
            settings.last_horizon
        } else {
            settings.horizon
        };
        let rate = stage.rate * 0.5 * (1.0 + libm::cosf(PI * stage.done));
        let limit = settings.clip;
        self.choose_places(stage.auxiliary);
        let mut cost = self.roll_out(horizon);
        let gradient = self.chunks.first_mut().map(|chunk| &mut chunk.gradient)?;
        let progress = &mut self.progress;
        cost += self.claims.learn(
            &progress.settings.claims,
            &progress.network,
            &progress.inputs,
            &mut progress.adversarial,
            &mut progress.random,
            gradient,
        );
        clip(gradient, limit);
        progress
            .adam
            .step(progress.network.parameters_mut(), gradient, rate);
        progress.finish_update();
        Some(cost)
    }

    /// Rolls all places out for `horizon` steps and moves each to its last states. Leaves the gradient
    /// of the mean cost in the first chunk and returns that cost.
    fn roll_out(&mut self, horizon: usize) -> f32 {
        let ApgProgress {
            settings,
            inputs,
            network,
            former,
            places,
            ..
        } = &mut self.progress;
        let share = 1.0 / places.len() as f32;
        let (models, parameters) = (self.models, network.parameters().len());
        let aim = Aim {
            cost: &settings.cost,
            own: self.own,
            former: former.as_ref().map(|network| Former {
                network,
                weight: settings.refinement.hold,
            }),
        };
        self.chunks
            .resize_with(places.len().div_ceil(CHUNK), Chunk::default);
        let work = self.chunks.par_iter_mut().zip(places.par_chunks_mut(CHUNK));
        work.for_each(|(chunk, places)| {
            chunk.gradient.clear();
            chunk.gradient.resize(parameters, 0.0);
            chunk
                .buffers
                .drive(network, inputs, models, places, horizon);
            let back =
                chunk
                    .buffers
                    .back(network, inputs, models, places, &aim, &mut chunk.gradient);
            chunk.cost = back;
            for (place, states) in places.iter_mut().zip(chunk.buffers.last()) {
                place.step += horizon;
                place.states = *states;
            }
        });
        let (mut gradient, mut total) = (vec![0.0; parameters], 0.0);
        for chunk in &self.chunks {
            gradient
                .iter_mut()
                .zip(&chunk.gradient)
                .for_each(|(sum, g)| *sum += share * g);
            total += share * chunk.cost;
        }
        self.chunks[0].gradient = gradient;
        total
    }

    /// Chooses where the roll-outs begin; the last `auxiliary` of them are in auxiliary encounters.
    fn choose_places(&mut self, auxiliary: usize) {
        let last: Vec<Start> = std::mem::take(&mut self.progress.places);
        let (own, all) = (self.own, self.models.len());
        let auxiliary = if own < all { auxiliary } else { 0 };
        let batch = self.progress.settings.batch;
        for i in 0..batch + auxiliary {
            let carried = last.get(i).copied().filter(|place| self.carries_on(place));
            let among = if i < batch { 0..own } else { own..all };
            let place = carried.unwrap_or_else(|| self.new_place(among));
            self.progress.places.push(place);
        }
    }

    /// Whether the next roll-out continues from `place`; draws a random number in any case.
    fn carries_on(&mut self, place: &Start) -> bool {
        let end = self.models[place.encounter].encounter.steps as usize;
        let lucky = self.progress.random.random::<f32>() < self.progress.settings.carry_on;
        lucky && place.step < end + OVERTIME
    }

    /// A random recorded moment of an encounter in `among`, disturbed unless it is the start.
    fn new_place(&mut self, among: Range<usize>) -> Start {
        let models = self.models;
        let ApgProgress {
            settings, random, ..
        } = &mut self.progress;
        let encounter = random.random_range(among);
        let recorded = models[encounter].encounter;
        let begin = random.random::<f32>() < settings.from_start;
        let step = if begin {
            0
        } else {
            random.random_range(0..recorded.steps as usize)
        };
        let states = [0, 1].map(|i| {
            let record = &recorded.participants[i].record;
            let sample = record[step.min(record.len() - 1)];
            let mut normal = || random.sample::<f32, _>(StandardNormal);
            let (ds, dv) = (
                settings.position_jitter * normal(),
                settings.speed_jitter * normal(),
            );
            let jitter = if begin { 0.0 } else { 1.0 };
            State {
                s: sample.s + jitter * ds,
                v: (sample.v + jitter * dv).max(0.0),
            }
        });
        Start {
            encounter,
            step,
            states,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nn::network::Tape;
    use cede_controller::Pair;
    use cede_data::Dataset;

    fn small(refinement: Refinement) -> ApgSettings {
        ApgSettings {
            members: 2,
            updates: 5,
            batch: 16,
            width: 16,
            horizon: 5,
            last_horizon: 5,
            refinement,
            ..ApgSettings::default()
        }
    }

    /// The root mean square deviation of the refined from the unrefined network in auxiliary encounters.
    fn deviation(hold: f32) -> f32 {
        let dataset = Dataset::synthetic(20, 6);
        let models: Vec<ObservationModel<'_>> = dataset
            .encounters
            .iter()
            .map(ObservationModel::new)
            .collect();
        let refinement = Refinement {
            updates: 40,
            places: 32,
            hold,
            ..Refinement::default()
        };
        let mut run = Apg::new(small(refinement), &models, 8, 1);
        while run.update().is_some() {}
        let pairs: Vec<[Pair; 2]> = models[8..]
            .iter()
            .flat_map(|model| model.recorded().collect::<Vec<_>>().as_chunks().0.to_vec())
            .collect();
        let view = run.view();
        let now = view.drive(&pairs, &mut Tape::default());
        let network = run.progress.former.as_ref().unwrap();
        let before = PolicyView { network, ..view }.drive(&pairs, &mut Tape::default());
        let both = now.iter().flatten().zip(before.iter().flatten());
        let squares: f32 = both.map(|(a, b)| (a - b) * (a - b)).sum();
        (squares / (2 * pairs.len()) as f32).sqrt()
    }

    #[test]
    fn a_penalty_on_deviation_keeps_the_refined_network_closer_to_the_unrefined_one() {
        let (free, held) = (deviation(0.0), deviation(10.0));
        assert!(held < 0.5 * free, "{held} against {free}");
    }

    #[test]
    fn without_a_refinement_the_run_ends_with_the_ensemble() {
        let dataset = Dataset::synthetic(6, 6);
        let models: Vec<ObservationModel<'_>> = dataset
            .encounters
            .iter()
            .map(ObservationModel::new)
            .collect();
        let settings = small(Refinement::default());
        let count = settings.features.count();
        let mut run = Apg::new(settings, &models, models.len(), 1);
        for _ in 0..9 {
            assert!(run.update().is_some());
            assert_eq!(run.view().network.sizes(), [count, 16, 16, 16, 4]);
        }
        assert!(run.update().is_some());
        assert_eq!(run.view().network.sizes(), [count, 32, 32, 32, 4]);
        assert!(run.update().is_none());
    }
}
