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
//!
//! Several networks can be trained so, one after the other, and put side by side.
//! What they do on average judges well what they have not seen, because each has
//! learned for a short time only; for the same reason it misjudges some of what they
//! have. A [`Refinement`] mends that: all of their layers learn on together, and where
//! nothing is to be mended they are held to what they did before.

pub mod claims;
pub mod closed_loop;
pub mod cost;

use crate::algorithm::apg::claims::{Claims, Hard};
use crate::algorithm::apg::closed_loop::{Aim, ClosedLoop, Former, Start};
use crate::algorithm::apg::cost::Cost;
use crate::driving::inputs::Inputs;
use crate::driving::policy_view::PolicyView;
use crate::nn::adam::{Adam, clip};
use crate::nn::network::Network;
use cede_controller::kinematics::State;
use cede_controller::{FeatureSet, Perspective};
use cede_formats::property::StateProperty;
use cede_sim::ObservationModel;
use core::f32::consts::PI;
use core::ops::Range;
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
    #[serde(with = "crate::driving::inputs::by_name")]
    pub features: FeatureSet,
    /// Networks to train, one after the other, and to put side by side.
    pub members: u32,
    /// Number of updates of each.
    pub updates: u32,
    /// Places in a batch, each with two vehicles.
    pub batch: usize,
    /// Width of each network's three hidden layers: a multiple of 16, all of them together up to 128.
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
    /// Standard deviation (m) of the disturbance of initial positions.
    pub position_jitter: f32,
    /// Standard deviation (m/s) of the disturbance of initial speeds.
    pub speed_jitter: f32,
    /// Longest gradient; a longer one is scaled down to it.
    pub clip: f32,
    /// What it costs to drive unlike the humans.
    pub cost: Cost,
    /// How the networks learn on when they lie side by side.
    pub refinement: Refinement,
    /// How claims are learned, where there are any.
    pub claims: claims::Settings,
}

/// How a network learns on without departing from what it was.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Refinement {
    /// Number of updates; with 0 there is no refinement.
    pub updates: u32,
    /// Learning rate at the start; it falls to zero along a cosine.
    pub rate: f32,
    /// Places in a batch beside those of [`Settings::batch`], in encounters that were given beside
    /// those to be judged on: there the network is held to what it was.
    pub places: usize,
    /// Weight of the squared departure from what it was, in s⁴/m².
    pub hold: f32,
}

impl Default for Refinement {
    fn default() -> Self {
        Self {
            updates: 0,
            rate: 1e-3,
            places: 64,
            hold: 2.5,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            features: FeatureSet::Scene,
            members: 1,
            updates: 1000,
            batch: 256,
            width: 64,
            rate: 2e-3,
            horizon: 20,
            last_horizon: 40,
            from_start: 0.3,
            carry_on: 0.5,
            position_jitter: 0.5,
            speed_jitter: 0.15,
            clip: 1.0,
            cost: Cost::default(),
            refinement: Refinement::default(),
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
    /// The network that learns.
    network: Network,
    /// Those that have learned and wait for the others.
    members: Vec<Network>,
    /// In a refinement, what the network was before.
    former: Option<Network>,
    adam: Adam,
    random: Pcg64,
    update: u32,
    places: Vec<Start>,
    hard: Hard,
}

/// What is being learned in an update.
#[derive(Clone, Copy)]
struct Stage {
    /// Share of the stage's updates that are done.
    done: f32,
    /// Learning rate at its start.
    rate: f32,
    /// Places that are held to the former network.
    held: usize,
}

impl Settings {
    /// Updates of all networks, and of the refinement.
    const fn total(&self) -> u32 {
        self.members * self.updates + self.refinement.updates
    }

    /// The stage to which an update belongs.
    fn stage(&self, update: u32) -> Stage {
        let alone = self.members * self.updates;
        if update < alone {
            Stage {
                done: (update % self.updates) as f32 / self.updates as f32,
                rate: self.rate,
                held: 0,
            }
        } else {
            Stage {
                done: (update - alone) as f32 / self.refinement.updates as f32,
                rate: self.refinement.rate,
                held: self.refinement.places,
            }
        }
    }
}

impl Progress {
    /// A network of its own, with random weights.
    fn fresh(settings: &Settings, random: &mut Pcg64) -> Network {
        let (i, w) = (settings.features.count(), settings.width);
        Network::new(&[i, w, w, w, 4], random).with_last_layer_scaled(0.1)
    }

    /// Goes on with `network`, which has moved nowhere yet.
    fn begin(&mut self, network: Network) {
        self.adam = Adam::new(network.parameters().len());
        self.network = network;
        self.places.clear();
        self.hard.clear();
    }

    /// After the last update of a network: begins the next one, or puts all of them side by side.
    fn turn(&mut self) {
        let count = self.settings.members;
        let learned = self.update.checked_rem(self.settings.updates) == Some(0);
        if !learned || self.update > count * self.settings.updates {
            return;
        }
        let joint = self.update == count * self.settings.updates;
        let next = if joint {
            self.members.push(self.network.clone());
            let mean = Network::mean(&std::mem::take(&mut self.members));
            self.former = (self.settings.refinement.updates > 0).then(|| mean.clone());
            mean
        } else {
            let next = Self::fresh(&self.settings, &mut self.random);
            self.members
                .push(std::mem::replace(&mut self.network, next.clone()));
            next
        };
        self.begin(next);
    }
}

/// A training run over encounters.
pub struct Apg<'e> {
    progress: Progress,
    claims: Claims,
    models: &'e [ObservationModel<'e>],
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
    /// A run over `models` that has not yet begun; the first `own` of them are those to be judged on.
    ///
    /// # Panics
    /// If `own` is 0 or more than there are.
    #[must_use]
    pub fn new(
        settings: Settings,
        models: &'e [ObservationModel<'e>],
        own: usize,
        seed: u64,
    ) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let pairs: Vec<_> = models[..own]
            .iter()
            .flat_map(ObservationModel::recorded)
            .collect();
        let inputs = Inputs::fit(settings.features, &pairs);
        let network = Progress::fresh(&settings, &mut random);
        let progress = Progress {
            adam: Adam::new(network.parameters().len()),
            settings,
            inputs,
            network,
            members: Vec::new(),
            former: None,
            random,
            update: 0,
            places: Vec::new(),
            hard: Hard::new(),
        };
        Self::resume(progress, models, own)
    }

    /// The run that `progress` was taken from, over the same encounters.
    ///
    /// # Panics
    /// If `own` is 0 or more than there are.
    #[must_use]
    pub fn resume(progress: Progress, models: &'e [ObservationModel<'e>], own: usize) -> Self {
        assert!((1..=models.len()).contains(&own));
        Self {
            progress,
            claims: Claims::default(),
            models,
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
    pub fn view(&self) -> PolicyView<'_> {
        PolicyView {
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
            self.progress.settings.total().into(),
        )
    }

    /// Places in a batch.
    #[must_use]
    pub fn places(&self) -> usize {
        self.progress.settings.batch
    }

    /// One update; the mean cost of the batch, or `None` when all updates are done.
    ///
    /// Runs on the threads of the current rayon pool, with the same bits on any number of them.
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
        self.place(stage.held);
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
        progress.turn();
        Some(cost)
    }

    /// Drives all places for `horizon` steps and moves them on; leaves the gradient of the mean
    /// cost in the first chunk, and returns that cost.
    fn drive(&mut self, horizon: usize) -> f32 {
        let Progress {
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

    /// Chooses where each place begins; the last `held` are in encounters that are not to be judged on.
    fn place(&mut self, held: usize) {
        let taken: Vec<Start> = std::mem::take(&mut self.progress.places);
        let (own, all) = (self.own, self.models.len());
        let held = if own < all { held } else { 0 };
        let batch = self.progress.settings.batch;
        for i in 0..batch + held {
            let carried = taken.get(i).copied().filter(|place| self.carries_on(place));
            let among = if i < batch { 0..own } else { own..all };
            let place = carried.unwrap_or_else(|| self.fresh(among));
            self.progress.places.push(place);
        }
    }

    fn carries_on(&mut self, place: &Start) -> bool {
        let end = self.models[place.encounter].encounter.steps as usize;
        let lucky = self.progress.random.random::<f32>() < self.progress.settings.carry_on;
        lucky && place.step < end + OVERTIME
    }

    /// A recorded moment of an encounter among those, disturbed unless it is its start.
    fn fresh(&mut self, among: Range<usize>) -> Start {
        let models = self.models;
        let Progress {
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

    fn small(refinement: Refinement) -> Settings {
        Settings {
            members: 2,
            updates: 5,
            batch: 16,
            width: 16,
            horizon: 5,
            last_horizon: 5,
            refinement,
            ..Settings::default()
        }
    }

    /// The root mean square by which a refinement departs from what the network was, where it is held.
    fn departure(hold: f32) -> f32 {
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
        let former = run.progress.former.as_ref().unwrap();
        let network = former;
        let before = PolicyView { network, ..view }.drive(&pairs, &mut Tape::default());
        let apart = now.iter().flatten().zip(before.iter().flatten());
        let squares: f32 = apart.map(|(a, b)| (a - b) * (a - b)).sum();
        (squares / (2 * pairs.len()) as f32).sqrt()
    }

    #[test]
    fn a_refinement_departs_less_from_what_the_network_was_if_it_is_held() {
        let (free, held) = (departure(0.0), departure(10.0));
        assert!(held < 0.5 * free, "{held} against {free}");
    }

    #[test]
    fn without_a_refinement_the_members_lie_side_by_side_in_the_end() {
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
