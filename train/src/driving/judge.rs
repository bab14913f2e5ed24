//! A quick judgement in the paper's protocol, for learning curves.

use crate::driving::episodes::Course;
use crate::driving::policy_view::PolicyView;
use crate::nn::network::Tape;
use cede_controller::Pair;
use cede_controller::kinematics::State;
use cede_sim::ObservationModel;
use cede_sim::reward::{COLLISION, EpisodeLength};
use cede_sim::stepper::{End, Step, first};
use serde::{Deserialize, Serialize};

/// The paper's three figures, and its reward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// Episodes.
    pub n: usize,
    /// Share of episodes in which the vehicle that arrives first is the recorded one.
    pub priority_accuracy: f32,
    /// Mean |l − l_GT| / l_GT.
    pub length_error: f32,
    /// Episodes that ended in a collision.
    pub collisions: usize,
    /// Episodes that ran out of time.
    pub time_outs: usize,
    /// SACER-SVO's reward a step, whatever the driver was trained with: mean of the episodes' means.
    pub reward: f32,
}

/// Lets `view` drive every encounter from its start in joint mode until its end.
#[must_use]
pub fn judge(courses: &[Course<'_>], view: PolicyView<'_>) -> Score {
    let mut tape = Tape::default();
    drive(courses, |pairs| view.drive(pairs, &mut tape))
}

fn drive(courses: &[Course<'_>], mut act: impl FnMut(&[[Pair; 2]]) -> Vec<[f32; 2]>) -> Score {
    let mut running: Vec<Running<'_>> = courses.iter().map(Running::new).collect();
    let mut score = Score {
        n: courses.len(),
        ..Score::default()
    };
    let mut step = 0;
    while !running.is_empty() {
        let pairs: Vec<_> = running.iter().map(|r| r.seen).collect();
        let mut commands = act(&pairs).into_iter();
        running.retain_mut(|r| {
            let stepped = r.advance(step, commands.next().unwrap_or_default());
            !r.ends(&stepped, &mut score)
        });
        step += 1;
    }
    let n = courses.len().max(1) as f32;
    score.priority_accuracy /= n;
    score.length_error /= n;
    score.reward /= n;
    score
}

struct Running<'c> {
    course: &'c Course<'c>,
    states: [State; 2],
    seen: [Pair; 2],
    /// Sum of what the steps have earned at once.
    earned: f32,
    /// Sum of both speeds over the steps.
    speeds: f32,
}

impl<'c> Running<'c> {
    fn new(course: &'c Course<'c>) -> Self {
        let states = course.stepper.start();
        Self {
            course,
            states,
            seen: course.model.pairs(0, states, ObservationModel::FIRST_SVO),
            earned: 0.0,
            speeds: 0.0,
        }
    }

    /// One step, after `taken` of them.
    fn advance(&mut self, taken: usize, commands: [f32; 2]) -> Step {
        let stepped = self.course.stepper.step(taken, self.states, commands);
        let svo = self.seen[0].svo();
        self.states = stepped.states;
        self.seen = self.course.model.pairs(taken + 1, self.states, svo);
        self.speeds += self.states[0].v + self.states[1].v;
        // At the conflict point itself the SVO is pinned to an end of its range.
        if !stepped.arrived() {
            self.earned -= self.course.deviation(taken + 1, self.seen[0].svo());
        }
        if stepped.touching() {
            self.earned += COLLISION;
        }
        stepped
    }

    /// Whether the episode is over after a step; if so, it is counted.
    fn ends(&self, stepped: &Step, score: &mut Score) -> bool {
        let encounter = self.course.model.encounter;
        match stepped.end() {
            None => return false,
            Some(End::Collision) => score.collisions += 1,
            Some(End::TimeOut) => score.time_outs += 1,
            Some(End::Finished) => {
                let right = first(stepped.arrivals()) == Some(encounter.first);
                score.priority_accuracy += if right { 1.0 } else { 0.0 };
            }
        }
        let length = EpisodeLength {
            steps: stepped.taken as u32,
            recorded: encounter.steps,
        };
        score.length_error += length.error().abs();
        score.reward += (self.earned + length.replayed_total(self.speeds)) / stepped.taken;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driving::episodes::{Episode, Reward};
    use crate::driving::inputs::Inputs;
    use cede_controller::FeatureSet;
    use cede_controller::policy::MAX_ACCELERATION;
    use cede_data::Dataset;

    /// Both drive off, then ease: every encounter ends, at one time or another.
    fn command(step: usize) -> [f32; 2] {
        if step < 30 { [0.5, 0.2] } else { [0.1, -0.1] }
    }

    #[test]
    fn the_reward_is_that_of_the_episodes_that_are_learned_from() {
        let dataset = Dataset::synthetic(30, 2);
        let courses: Vec<Course<'_>> = dataset
            .encounters
            .iter()
            .take(30)
            .map(Course::new)
            .collect();
        let mut step = 0;
        let score = drive(&courses, |pairs| {
            step += 1;
            let accelerations = command(step).map(|share| share * MAX_ACCELERATION);
            vec![accelerations; pairs.len()]
        });
        let pairs: Vec<Pair> = courses.iter().flat_map(|c| c.model.recorded()).collect();
        let inputs = Inputs::fit(FeatureSet::Raw, &pairs);
        let mut total = 0.0;
        for course in 0..courses.len() {
            let mut episode = Episode::begin(course, &courses, &inputs);
            let steps = (1..)
                .find_map(|step| episode.step(command(step), &courses, &inputs, Reward::SacerSvo));
            let rewards: Vec<f32> = steps.unwrap().iter().map(|t| t.reward).collect();
            total += rewards.iter().sum::<f32>() / rewards.len() as f32;
        }
        let mean = total / courses.len() as f32;
        assert!(
            (score.reward - mean).abs() < 1e-4,
            "{} {mean}",
            score.reward
        );
        assert!(score.collisions < courses.len() && score.length_error > 0.0);
    }

    #[test]
    fn standing_still_runs_out_of_time_everywhere() {
        let dataset = Dataset::synthetic(10, 2);
        let courses: Vec<Course<'_>> = dataset
            .encounters
            .iter()
            .take(10)
            .map(Course::new)
            .collect();
        let score = drive(&courses, |pairs| vec![[-3.0; 2]; pairs.len()]);
        let (timed_out, wrong) = (score.time_outs, 1.0 - score.priority_accuracy);
        assert!(
            timed_out > 5 && wrong * 10.0 >= timed_out as f32,
            "{score:?}"
        );
        assert!(score.reward < -1.5, "{score:?}");
    }
}
