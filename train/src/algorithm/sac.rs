//! Soft actor-critic with the paper's rewards: SACER-SVO, SACER-V, and SAC without replayed reward.
//!
//! The paper's Algorithm 1: an episode is driven with the present policy; when
//! it ends, its rewards are computed again with what its length tells, and only
//! then do its transitions enter the replay buffer, from which batches are drawn.
//! Several episodes are under way at a time, so that the policy acts on them together.

pub mod learner;

use crate::algorithm::sac::learner::{Learner, Losses, Rates};
use crate::driving::episodes::{Course, Episode, Reward};
use crate::driving::inputs::Inputs;
use crate::driving::policy_view::PolicyView;
use crate::driving::replay::{Batch, Replay};
use crate::nn::network::Network;
use cede_controller::{FeatureSet, Perspective};
use cede_sim::ObservationModel;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// How a run goes. Defaults are the paper's Table I where it says something.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// What the networks are told; the paper's eight numbers by default.
    #[serde(with = "crate::driving::inputs::by_name")]
    pub features: FeatureSet,
    /// What is rewarded.
    pub reward: Reward,
    /// Training episodes.
    pub episodes: u64,
    /// Steps of episodes for each update: 1 is the paper's Algorithm 1.
    pub steps_per_update: u32,
    /// Episodes under way at a time.
    pub parallel: usize,
    /// Width of the three hidden layers of all networks: a multiple of 16 up to 128.
    pub width: usize,
    /// Capacity of the replay buffer, in steps.
    pub buffer: usize,
    /// Steps in the buffer before learning begins.
    pub buffer_minimum: usize,
    /// Steps in a batch.
    pub batch: usize,
    /// Whether a step's reward is counted from what its course has usually earned a step. Rewards
    /// are negative nearly everywhere: counted from 0, an early end would spare costs.
    pub centred: bool,
    /// Learning rates and constants of the algorithm.
    pub rates: Rates,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            features: FeatureSet::Raw,
            reward: Reward::SacerSvo,
            episodes: 35_000,
            steps_per_update: 1,
            parallel: 16,
            width: 128,
            buffer: 100_000,
            buffer_minimum: 1_000,
            batch: 512,
            centred: false,
            rates: Rates::default(),
        }
    }
}

/// Share by which a course's running mean reward approaches that of an episode that has ended.
const MEAN_RATE: f32 = 0.1;

/// What a run carries from one update to the next: networks, targets, moments, temperature, replay
/// buffer, episodes under way and the generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    settings: Settings,
    inputs: Inputs,
    learner: Learner,
    replay: Replay,
    random: Pcg64,
    running: Vec<Episode>,
    episodes: u64,
    updates: u64,
    /// Steps since the last update that was due.
    owed: u32,
    /// Of each course, the running mean of its episodes' mean reward a step, once there was one.
    usual: Vec<Option<f32>>,
}

/// A training run.
pub struct Sac<'e> {
    progress: Progress,
    courses: &'e [Course<'e>],
    batch: Batch,
}

/// What one round of steps brought.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Round {
    /// Episodes that ended.
    pub episodes: u64,
    /// Sum over them of the mean reward per step.
    pub reward: f32,
    /// Updates done.
    pub updates: u64,
    /// What the last update saw.
    pub losses: Option<Losses>,
}

impl<'e> Sac<'e> {
    /// A run over `courses` that has not yet begun.
    #[must_use]
    pub fn new(settings: Settings, courses: &'e [Course<'e>], seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let (i, w) = (settings.features.count(), settings.width);
        let actor = Network::new(&[i, w, w, w, 4], &mut random);
        let models = courses.iter().map(|course| &course.model);
        let lefts: Vec<_> = models
            .flat_map(ObservationModel::recorded)
            .step_by(2)
            .collect();
        let inputs = Inputs::fit(settings.features, &lefts);
        Self::from_actor(settings, courses, actor, inputs, random)
    }

    /// A run whose policy begins as `actor`, which sees `inputs`.
    #[must_use]
    pub fn from_actor(
        settings: Settings,
        courses: &'e [Course<'e>],
        actor: Network,
        inputs: Inputs,
        mut random: Pcg64,
    ) -> Self {
        let learner = Learner::from_actor(actor, settings.width, &settings.rates, &mut random);
        let replay = Replay::new(settings.buffer, settings.features.count(), 2);
        let progress = Progress {
            settings,
            inputs,
            learner,
            replay,
            random,
            running: Vec::new(),
            episodes: 0,
            updates: 0,
            owed: 0,
            usual: vec![None; courses.len()],
        };
        Self::resume(progress, courses)
    }

    /// The run that `progress` was taken from, over the same courses.
    #[must_use]
    pub fn resume(progress: Progress, courses: &'e [Course<'e>]) -> Self {
        Self {
            progress,
            courses,
            batch: Batch::default(),
        }
    }

    /// All that a resumed run needs to go on bit for bit.
    #[must_use]
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// The driver as it is: the averaged policy's mean, without its noise.
    #[must_use]
    pub fn view(&self) -> PolicyView<'_> {
        PolicyView {
            network: self.progress.learner.driver(),
            inputs: &self.progress.inputs,
            perspective: Perspective::Joint,
        }
    }

    /// Episodes that have ended, and all there are to be.
    #[must_use]
    pub fn episodes(&self) -> (u64, u64) {
        (self.progress.episodes, self.progress.settings.episodes)
    }

    /// One step of all episodes under way and the updates that are due for it, or `None` when all
    /// episodes are done.
    pub fn round(&mut self) -> Option<Round> {
        if self.progress.episodes >= self.progress.settings.episodes || self.courses.is_empty() {
            return None;
        }
        let mut round = Round::default();
        self.step_all(&mut round);
        let progress = &mut self.progress;
        let ready = progress.replay.len() >= progress.settings.buffer_minimum;
        while progress.owed >= progress.settings.steps_per_update.max(1) {
            progress.owed -= progress.settings.steps_per_update.max(1);
            if ready {
                progress.replay.sample(
                    progress.settings.batch,
                    &mut progress.random,
                    &mut self.batch,
                );
                let losses = progress.learner.update(
                    &self.batch,
                    &progress.settings.rates,
                    &mut progress.random,
                );
                round.losses = Some(losses);
                round.updates += 1;
            }
        }
        progress.updates += round.updates;
        Some(round)
    }

    fn step_all(&mut self, round: &mut Round) {
        let Progress {
            settings,
            inputs,
            learner,
            replay,
            random,
            running,
            episodes,
            owed,
            usual,
            ..
        } = &mut self.progress;
        while running.len() < settings.parallel {
            let course = random.random_range(0..self.courses.len());
            running.push(Episode::begin(course, self.courses, inputs));
        }
        let seen: Vec<f32> = running
            .iter()
            .flat_map(|e| e.observation().to_vec())
            .collect();
        let actions = learner.act(&seen, random);
        for (episode, action) in running.iter_mut().zip(actions.as_chunks().0) {
            *owed += 1;
            let Some(mut steps) = episode.step(*action, self.courses, inputs, settings.reward)
            else {
                continue;
            };
            round.episodes += 1;
            let mean = steps.iter().map(|t| t.reward).sum::<f32>() / steps.len() as f32;
            round.reward += mean;
            if settings.centred {
                let usual = usual[episode.course].get_or_insert(mean);
                *usual += MEAN_RATE * (mean - *usual);
                steps
                    .iter_mut()
                    .for_each(|transition| transition.reward -= *usual);
            }
            steps.iter().for_each(|transition| replay.push(transition));
            *episodes += 1;
            let course = random.random_range(0..self.courses.len());
            *episode = Episode::begin(course, self.courses, inputs);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_data::Dataset;

    #[test]
    fn a_resumed_run_equals_the_uninterrupted_one_bit_for_bit() {
        let dataset = Dataset::synthetic(6, 4);
        let courses: Vec<Course<'_>> = dataset.encounters.iter().take(6).map(Course::new).collect();
        let settings = Settings {
            parallel: 4,
            width: 16,
            buffer: 500,
            buffer_minimum: 50,
            batch: 32,
            steps_per_update: 8,
            ..Settings::default()
        };
        let mut whole = Sac::new(settings.clone(), &courses, 1);
        let rounds =
            |run: &mut Sac<'_>, n: u32| (0..n).for_each(|_| assert!(run.round().is_some()));
        rounds(&mut whole, 400);
        let mut first = Sac::new(settings, &courses, 1);
        rounds(&mut first, 170);
        let mut second = Sac::resume(first.progress().clone(), &courses);
        rounds(&mut second, 230);
        assert!(second.progress().updates > 50);
        assert!(second.progress() == whole.progress());
    }
}
