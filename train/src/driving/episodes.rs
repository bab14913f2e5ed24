//! Episodes for reinforcement learning, and the paper's episode-replay reward.

use crate::driving::inputs::Inputs;
use crate::driving::replay::Transition;
use cede_controller::Pair;
use cede_controller::kinematics::State;
use cede_controller::policy::MAX_ACCELERATION;
use cede_data::Encounter;
use cede_sim::ObservationModel;
use cede_sim::reward::{COLLISION, EpisodeLength, PAST_THE_RECORD, svo_deviation};
use cede_sim::stepper::{End, Stepper};
use serde::{Deserialize, Serialize};

/// What a policy is rewarded for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reward {
    /// SACER-SVO: the recorded SVO, then length and speed, replayed to every step of the episode.
    SacerSvo,
    /// SACER-V: the recorded speeds instead of the SVO.
    SacerV,
    /// SAC: as SACER-SVO, but length and speed are rewarded once, at the episode's last step.
    Sac,
}

/// Deviation of the speeds (m/s, mean of both vehicles) at which SACER-V's r₁ reaches 1.
const SPEED_SCALE: f32 = 3.0;

/// An encounter with what the record says about its SVO.
#[derive(Clone, Debug)]
pub struct Course<'e> {
    /// What the vehicles see.
    pub model: ObservationModel<'e>,
    /// How they move, in the paper's protocol.
    pub stepper: Stepper<'e>,
    /// The left-turner's recorded SVO (rad), step by step up to the one before the conflict point.
    svo: Vec<f32>,
}

impl<'e> Course<'e> {
    /// Prepares `encounter`.
    #[must_use]
    pub fn new(encounter: &'e Encounter) -> Self {
        let model = ObservationModel::new(encounter);
        let svo = model.recorded().step_by(2).map(|pair| pair.svo()).collect();
        let stepper = Stepper::new(encounter, None);
        Self {
            model,
            stepper,
            svo,
        }
    }

    /// r₁ in [0, 1] after `step` steps with the left-turner's `svo` (rad), on the way to the
    /// conflict point.
    #[must_use]
    pub fn deviation(&self, step: usize, svo: f32) -> f32 {
        let recorded = self.svo.get(step);
        recorded.map_or(PAST_THE_RECORD, |recorded| svo_deviation(svo, *recorded))
    }
}

/// An episode under way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Episode {
    /// Which course.
    pub course: usize,
    #[serde(with = "crate::driving::states")]
    states: [State; 2],
    svo: f32,
    /// Steps so far, each with the sum of the speeds after it.
    steps: Vec<(Transition, f32)>,
    observation: Vec<f32>,
}

impl Episode {
    /// The episode at the start of course number `course`.
    #[must_use]
    pub fn begin(course: usize, courses: &[Course<'_>], inputs: &Inputs) -> Self {
        let mut episode = Self {
            course,
            states: courses[course].stepper.start(),
            svo: ObservationModel::FIRST_SVO,
            steps: Vec::new(),
            observation: Vec::new(),
        };
        let pair = episode.look(&courses[course]);
        inputs.append(&pair, &mut episode.observation);
        episode
    }

    /// What the policy sees: the left-turner's view, normalised.
    #[must_use]
    pub fn observation(&self) -> &[f32] {
        &self.observation
    }

    fn look(&self, course: &Course<'_>) -> Pair {
        let [left, _] = course.model.pairs(self.steps.len(), self.states, self.svo);
        left
    }

    /// One step with `actions` in (−1, 1) for both vehicles. When it was the last, the episode's
    /// transitions come back with their final rewards (Algorithm 1), and the episode is spent.
    pub fn step(
        &mut self,
        actions: [f32; 2],
        courses: &[Course<'_>],
        inputs: &Inputs,
        reward: Reward,
    ) -> Option<Vec<Transition>> {
        let course = &courses[self.course];
        let encounter = course.model.encounter;
        let accelerations = actions.map(|action| MAX_ACCELERATION * action);
        let stepped = course
            .stepper
            .step(self.steps.len(), self.states, accelerations);
        self.states = stepped.states;
        let steps = self.steps.len() + 1;
        let mut next = Vec::new();
        let [view, _] = course.model.pairs(steps, self.states, self.svo);
        self.svo = view.svo();
        inputs.append(&view, &mut next);
        let mut earned = -self.deviation(course, steps, stepped.arrived(), reward);
        if stepped.touching() {
            earned += COLLISION;
        }
        let end = stepped.end();
        let transition = Transition {
            observation: std::mem::replace(&mut self.observation, next.clone()),
            action: actions.to_vec(),
            reward: earned,
            next,
            terminal: end.is_some_and(|end| end != End::TimeOut),
        };
        let speeds = self.states[0].v + self.states[1].v;
        self.steps.push((transition, speeds));
        end.map(|_| self.replayed(encounter, reward))
    }

    /// r₁: how far the last step has left the record, in [0, 1].
    fn deviation(&self, course: &Course<'_>, step: usize, arrived: bool, reward: Reward) -> f32 {
        match reward {
            // The step at the conflict point itself is left out: there the SVO is pinned to an end.
            Reward::SacerSvo | Reward::Sac if arrived => 0.0,
            Reward::SacerSvo | Reward::Sac => course.deviation(step, self.svo),
            Reward::SacerV => {
                if step > course.model.encounter.steps as usize {
                    return PAST_THE_RECORD;
                }
                let off = |i: usize| {
                    let record = &course.model.encounter.participants[i].record;
                    record
                        .get(step)
                        .map_or(0.0, |r| (r.v - self.states[i].v).abs())
                };
                (0.5 * (off(0) + off(1)) / SPEED_SCALE).min(1.0)
            }
        }
    }

    /// The transitions, with what the episode's length earns.
    fn replayed(&mut self, encounter: &Encounter, reward: Reward) -> Vec<Transition> {
        let steps = std::mem::take(&mut self.steps);
        let length = EpisodeLength {
            steps: u32::try_from(steps.len()).unwrap_or(u32::MAX),
            recorded: encounter.steps,
        };
        let last = steps.len().saturating_sub(1);
        let replayed = steps
            .into_iter()
            .enumerate()
            .map(|(i, (mut transition, speeds))| {
                if reward != Reward::Sac || i == last {
                    transition.reward += length.replayed(speeds);
                }
                transition
            });
        replayed.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::FeatureSet;
    use cede_data::Dataset;

    /// Drives a course as its record did.
    fn replay(
        course: usize,
        courses: &[Course<'_>],
        inputs: &Inputs,
        reward: Reward,
    ) -> Vec<Transition> {
        let mut episode = Episode::begin(course, courses, inputs);
        let participants = &courses[course].model.encounter.participants;
        for step in 0.. {
            let action = |i: usize| {
                let sample = participants[i].record.get(step);
                (sample.map_or(0.0, |s| s.a) / MAX_ACCELERATION).clamp(-1.0, 1.0)
            };
            if let Some(steps) = episode.step([action(0), action(1)], courses, inputs, reward) {
                return steps;
            }
        }
        unreachable!("an episode ends at twice its recorded length")
    }

    #[test]
    fn driving_as_recorded_earns_nearly_the_most_there_is() {
        let dataset = Dataset::synthetic(20, 2);
        let courses: Vec<Course<'_>> = dataset
            .encounters
            .iter()
            .take(20)
            .map(Course::new)
            .collect();
        let pairs: Vec<Pair> = courses.iter().flat_map(|c| c.model.recorded()).collect();
        let inputs = Inputs::fit(FeatureSet::Raw, &pairs);
        for reward in [Reward::SacerSvo, Reward::SacerV, Reward::Sac] {
            for course in 0..courses.len() {
                let steps = replay(course, &courses, &inputs, reward);
                let mean = steps.iter().map(|t| t.reward).sum::<f32>() / steps.len() as f32;
                assert!(mean > -0.3, "{reward:?} {course}: {mean}");
                assert!(steps.last().is_some_and(|t| t.terminal));
                assert_eq!(steps.iter().filter(|t| t.terminal).count(), 1);
            }
        }
    }

    #[test]
    fn standing_still_is_punished_at_every_step_only_where_the_reward_is_replayed() {
        let dataset = Dataset::synthetic(5, 2);
        let courses: Vec<Course<'_>> = dataset.encounters.iter().take(5).map(Course::new).collect();
        let pairs: Vec<Pair> = courses.iter().flat_map(|c| c.model.recorded()).collect();
        let inputs = Inputs::fit(FeatureSet::Raw, &pairs);
        for (reward, early) in [(Reward::SacerSvo, true), (Reward::Sac, false)] {
            let mut episode = Episode::begin(0, &courses, &inputs);
            let steps = loop {
                if let Some(steps) = episode.step([-1.0, -1.0], &courses, &inputs, reward) {
                    break steps;
                }
            };
            assert_eq!(steps.len(), 2 * courses[0].model.encounter.steps as usize);
            let (first, last) = (steps[0].reward, steps[steps.len() - 1].reward);
            assert!(last < -1.4, "{last}");
            assert_eq!(first < -1.4, early, "{reward:?}: {first}");
        }
    }

    #[test]
    fn a_time_out_is_a_truncation_and_an_arrival_is_terminal() {
        let dataset = Dataset::synthetic(5, 2);
        let courses: Vec<Course<'_>> = dataset.encounters.iter().take(1).map(Course::new).collect();
        let pairs: Vec<Pair> = courses[0].model.recorded().collect();
        let inputs = Inputs::fit(FeatureSet::Raw, &pairs);
        for (action, terminal) in [(-1.0, false), (1.0, true)] {
            let mut episode = Episode::begin(0, &courses, &inputs);
            let steps = loop {
                let actions = [action, -1.0];
                if let Some(steps) = episode.step(actions, &courses, &inputs, Reward::SacerSvo) {
                    break steps;
                }
            };
            let (last, before) = steps.split_last().unwrap();
            assert_eq!(last.terminal, terminal);
            assert!(before.iter().all(|transition| !transition.terminal));
        }
    }
}
