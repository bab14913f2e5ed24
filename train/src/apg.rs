//! Analytic policy gradient: learning to drive like the recorded humans, straight through the closed loop.
//!
//! The kinematics, the features and the network are differentiable, so the
//! distance between what the network drives and what the humans drove has a
//! gradient with respect to the weights. No reward is estimated, no value is
//! learned. One network drives both vehicles, each from its own perspective.
//!
//! Each place in a batch drives a stretch of `horizon` steps from a recorded
//! moment, its state slightly disturbed. With probability `carry_on` the next
//! update takes the place up where the network itself has left it, so that it
//! learns to get out of where it has got itself into.

use crate::adam::{Adam, clip};
use crate::claims::{self, Claims, Hard};
use crate::closed_loop::{ClosedLoop, Cost, Start};
use crate::inputs::Inputs;
use crate::network::Network;
use crate::pilot::Pilot;
use cede_controller::{FeatureSet, Perspective};
use cede_sim::Sight;
use cede_sim::State;
use cede_sim::property::StateProperty;
use core::f32::consts::PI;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How the analytic policy gradient learns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// What the network is told.
    #[serde(with = "crate::inputs::by_name")]
    pub features: FeatureSet,
    /// Number of updates.
    pub updates: u32,
    /// Places in a batch, each with two vehicles.
    pub batch: usize,
    /// Width of the three hidden layers: a multiple of 16 up to 128.
    pub width: usize,
    /// Learning rate at the start; it falls to zero along a cosine.
    pub rate: f32,
    /// Steps driven in an update.
    pub horizon: usize,
    /// Steps driven in an update in the last third of the training.
    pub last_horizon: usize,
    /// Probability that a fresh place begins at its encounter's start.
    pub from_start: f32,
    /// Probability that a place is taken up where the network left it.
    pub carry_on: f32,
    /// Probability that a place is drawn from the first encounters (those to be judged on), not
    /// from the others that were added to learn from.
    pub own_share: f32,
    /// Standard deviation (m) of the disturbance of initial positions.
    pub position_jitter: f32,
    /// Standard deviation (m/s) of the disturbance of initial speeds.
    pub speed_jitter: f32,
    /// Longest gradient; a longer one is scaled down to it.
    pub clip: f32,
    /// What it costs to drive unlike the humans.
    pub cost: Cost,
    /// How claims are learned, where there are any.
    pub claims: claims::Settings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            features: FeatureSet::Scene,
            updates: 1000,
            batch: 256,
            width: 64,
            rate: 2e-3,
            horizon: 20,
            last_horizon: 40,
            from_start: 0.3,
            carry_on: 0.5,
            own_share: 0.5,
            position_jitter: 0.5,
            speed_jitter: 0.15,
            clip: 1.0,
            cost: Cost::default(),
            claims: claims::Settings::default(),
        }
    }
}

/// Places of a batch that one thread takes at a time; fixed, so that sums have one order.
const CHUNK: usize = 64;
/// Steps past the recorded end up to which a place is taken up again.
const OVERTIME: usize = 30;

/// What a run carries from one update to the next; all of it goes into a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    settings: Settings,
    inputs: Inputs,
    network: Network,
    adam: Adam,
    random: Pcg64,
    update: u32,
    places: Vec<Start>,
    hard: Hard,
}

/// A training run over encounters.
pub struct Apg<'e> {
    progress: Progress,
    claims: Claims,
    sights: &'e [Sight<'e>],
    own: usize,
    chunks: Vec<Chunk>,
}

#[derive(Default)]
struct Chunk {
    buffers: ClosedLoop,
    gradient: Vec<f32>,
    cost: f32,
}

impl<'e> Apg<'e> {
    /// A run over `sights` that has not yet begun; the first `own` of them are those to be judged on.
    ///
    /// # Panics
    /// If `own` is 0 or more than there are.
    #[must_use]
    pub fn new(settings: Settings, sights: &'e [Sight<'e>], own: usize, seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let pairs: Vec<_> = sights[..own].iter().flat_map(Sight::recorded).collect();
        let inputs = Inputs::fit(settings.features, &pairs);
        let (i, w) = (settings.features.count(), settings.width);
        let network = Network::new(&[i, w, w, w, 4], &mut random).with_last_layer_scaled(0.1);
        let progress = Progress {
            adam: Adam::new(network.parameters().len()),
            settings,
            inputs,
            network,
            random,
            update: 0,
            places: Vec::new(),
            hard: Hard::new(),
        };
        Self::resume(progress, sights, own)
    }

    /// The run that `progress` was taken from, over the same encounters.
    ///
    /// # Panics
    /// If `own` is 0 or more than there are.
    #[must_use]
    pub fn resume(progress: Progress, sights: &'e [Sight<'e>], own: usize) -> Self {
        assert!((1..=sights.len()).contains(&own));
        Self {
            progress,
            claims: Claims::default(),
            sights,
            own,
            chunks: Vec::new(),
        }
    }

    /// The same run, which also learns what `properties` claim.
    #[must_use]
    pub fn with_claims(self, properties: &[StateProperty]) -> Self {
        Self {
            claims: Claims::new(properties),
            ..self
        }
    }

    /// All that a resumed run needs to go on bit for bit.
    #[must_use]
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// The driver as it is.
    #[must_use]
    pub fn pilot(&self) -> Pilot<'_> {
        Pilot {
            network: &self.progress.network,
            inputs: &self.progress.inputs,
            perspective: Perspective::Ego,
        }
    }

    /// Updates done, and all there are.
    #[must_use]
    pub fn updates(&self) -> (u64, u64) {
        (
            self.progress.update.into(),
            self.progress.settings.updates.into(),
        )
    }

    /// Places in a batch.
    #[must_use]
    pub fn places(&self) -> usize {
        self.progress.places.len()
    }

    /// One update; the mean cost of the batch, or `None` when all updates are done.
    ///
    /// Runs on the threads of the current rayon pool, with the same bits on any number of them.
    pub fn update(&mut self) -> Option<f32> {
        let settings = &self.progress.settings;
        if self.progress.update >= settings.updates {
            return None;
        }
        let done = self.progress.update as f32 / settings.updates as f32;
        let late = done >= 2.0 / 3.0;
        let horizon = if late {
            settings.last_horizon
        } else {
            settings.horizon
        };
        let rate = settings.rate * 0.5 * (1.0 + libm::cosf(PI * done));
        let limit = settings.clip;
        self.place();
        let mut cost = self.drive(horizon);
        let gradient = self.chunks.first_mut().map(|chunk| &mut chunk.gradient)?;
        let progress = &mut self.progress;
        cost += self.claims.learn(
            &progress.settings.claims,
            &progress.network,
            &progress.inputs,
            &mut progress.hard,
            &mut progress.random,
            gradient,
        );
        clip(gradient, limit);
        progress
            .adam
            .step(progress.network.parameters_mut(), gradient, rate);
        progress.update += 1;
        Some(cost)
    }

    /// Drives all places for `horizon` steps and moves them on; leaves the gradient of the mean
    /// cost in the first chunk, and returns that cost.
    fn drive(&mut self, horizon: usize) -> f32 {
        let Progress {
            settings,
            inputs,
            network,
            places,
            ..
        } = &mut self.progress;
        let share = 1.0 / places.len() as f32;
        let (sights, cost, parameters) = (self.sights, &settings.cost, network.parameters().len());
        self.chunks
            .resize_with(places.len().div_ceil(CHUNK), Chunk::default);
        let work = self.chunks.par_iter_mut().zip(places.par_chunks_mut(CHUNK));
        work.for_each(|(chunk, places)| {
            chunk.gradient.clear();
            chunk.gradient.resize(parameters, 0.0);
            chunk
                .buffers
                .drive(network, inputs, sights, places, horizon);
            let back =
                chunk
                    .buffers
                    .back(network, inputs, sights, places, cost, &mut chunk.gradient);
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

    /// Chooses where each place begins.
    fn place(&mut self) {
        let taken: Vec<Start> = std::mem::take(&mut self.progress.places);
        for i in 0..self.progress.settings.batch {
            let carried = taken.get(i).copied().filter(|place| self.carries_on(place));
            let place = carried.unwrap_or_else(|| self.fresh());
            self.progress.places.push(place);
        }
    }

    fn carries_on(&mut self, place: &Start) -> bool {
        let end = self.sights[place.encounter].encounter.steps as usize;
        let lucky = self.progress.random.random::<f32>() < self.progress.settings.carry_on;
        lucky && place.step < end + OVERTIME
    }

    /// A recorded moment, disturbed unless it is the encounter's start.
    fn fresh(&mut self) -> Start {
        let (sights, own) = (self.sights, self.own);
        let Progress {
            settings, random, ..
        } = &mut self.progress;
        let any_own = own == sights.len() || random.random::<f32>() < settings.own_share;
        let among = if any_own { 0..own } else { own..sights.len() };
        let encounter = random.random_range(among);
        let recorded = sights[encounter].encounter;
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
