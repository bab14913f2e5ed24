//! Soft actor-critic with the paper's rewards: SACER-SVO, SACER-V, and SAC without episode replay.
//!
//! The paper's Algorithm 1: the current policy drives an episode. When the episode
//! ends, its rewards are recomputed with the episode's length, and its transitions
//! enter the replay buffer, from which the updates draw batches. Several episodes
//! run in parallel, so that one forward pass of the policy serves all of them.
//!
//! One update is [`learner::Learner::update`].

pub mod learner;
mod losses;
mod networks;
mod settings;

pub use settings::{Rates, SacSettings};

use crate::algorithm::sac::learner::{Learner, Losses};
use crate::driving::episodes::{Course, Episode};
use crate::driving::inputs::Inputs;
use crate::driving::policy_view::PolicyView;
use crate::driving::replay::{Batch, Replay};
use crate::nn::network::Network;
use cede_controller::Perspective;
use cede_sim::ObservationModel;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// Share by which an episode moves the running mean reward of its course.
const MEAN_RATE: f32 = 0.1;

/// The state of a run between two updates; a checkpoint stores it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SacProgress {
    settings: SacSettings,
    inputs: Inputs,
    learner: Learner,
    replay: Replay,
    random: Pcg64,
    running: Vec<Episode>,
    episodes: u64,
    updates: u64,
    /// Steps since the last update.
    steps_since_update: u32,
    /// For each course the running mean of its episodes' mean reward per step; `None` before the first.
    mean_rewards: Vec<Option<f32>>,
}

/// A training run of soft actor-critic.
pub struct Sac<'e> {
    progress: SacProgress,
    courses: &'e [Course<'e>],
    batch: Batch,
}

/// The result of one round.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Round {
    /// Episodes that ended.
    pub episodes: u64,
    /// Sum of the mean reward per step over these episodes.
    pub reward: f32,
    /// Number of updates.
    pub updates: u64,
    /// The losses of the last update.
    pub losses: Option<Losses>,
}

impl<'e> Sac<'e> {
    /// A new run over `courses`.
    #[must_use]
    pub fn new(settings: SacSettings, courses: &'e [Course<'e>], seed: u64) -> Self {
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

    /// A new run whose policy network begins as `actor`, with `inputs` as its inputs.
    #[must_use]
    pub fn from_actor(
        settings: SacSettings,
        courses: &'e [Course<'e>],
        actor: Network,
        inputs: Inputs,
        mut random: Pcg64,
    ) -> Self {
        let learner = Learner::from_actor(actor, settings.width, &settings.rates, &mut random);
        let replay = Replay::new(settings.buffer, settings.features.count(), 2);
        let progress = SacProgress {
            settings,
            inputs,
            learner,
            replay,
            random,
            running: Vec::new(),
            episodes: 0,
            updates: 0,
            steps_since_update: 0,
            mean_rewards: vec![None; courses.len()],
        };
        Self::resume(progress, courses)
    }

    /// The run that `progress` was taken from, over the same courses.
    #[must_use]
    pub fn resume(progress: SacProgress, courses: &'e [Course<'e>]) -> Self {
        Self {
            progress,
            courses,
            batch: Batch::default(),
        }
    }

    /// The state from which [`Sac::resume`] continues with the same bits.
    #[must_use]
    pub fn progress(&self) -> &SacProgress {
        &self.progress
    }

    /// The current policy: the mean action of the averaged policy network.
    #[must_use]
    pub fn view(&self) -> PolicyView<'_> {
        PolicyView {
            network: self.progress.learner.averaged(),
            inputs: &self.progress.inputs,
            perspective: Perspective::Joint,
        }
    }

    /// Episodes that have ended, and their total number.
    #[must_use]
    pub fn episodes(&self) -> (u64, u64) {
        (self.progress.episodes, self.progress.settings.episodes)
    }

    /// Advances all episodes by one step and does the updates that are then due. Returns `None` if all
    /// episodes are done.
    pub fn round(&mut self) -> Option<Round> {
        if self.progress.episodes >= self.progress.settings.episodes || self.courses.is_empty() {
            return None;
        }
        let mut round = Round::default();
        self.step_all(&mut round);
        let progress = &mut self.progress;
        let ready = progress.replay.len() >= progress.settings.buffer_minimum;
        while progress.steps_since_update >= progress.settings.steps_per_update.max(1) {
            progress.steps_since_update -= progress.settings.steps_per_update.max(1);
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

    /// Advances all episodes by one step; those that end enter the replay buffer and are replaced.
    fn step_all(&mut self, round: &mut Round) {
        let SacProgress {
            settings,
            inputs,
            learner,
            replay,
            random,
            running,
            episodes,
            steps_since_update,
            mean_rewards,
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
            *steps_since_update += 1;
            let Some(mut steps) = episode.step(*action, self.courses, inputs, settings.reward)
            else {
                continue;
            };
            round.episodes += 1;
            let mean = steps.iter().map(|t| t.reward).sum::<f32>() / steps.len() as f32;
            round.reward += mean;
            if settings.centred {
                let usual = mean_rewards[episode.course].get_or_insert(mean);
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
    fn a_resumed_run_has_the_bits_of_an_uninterrupted_one() {
        let dataset = Dataset::synthetic(6, 4);
        let courses: Vec<Course<'_>> = dataset.encounters.iter().take(6).map(Course::new).collect();
        let settings = SacSettings {
            parallel: 4,
            width: 16,
            buffer: 500,
            buffer_minimum: 50,
            batch: 32,
            steps_per_update: 8,
            ..SacSettings::default()
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
