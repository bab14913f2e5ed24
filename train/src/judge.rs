//! A quick judgement in the paper's protocol, for progress and early stopping; `cede_sim` has the last word.

use cede_controller::{Footprint, Pair};
use cede_sim::Sight;
use cede_sim::kinematics::advance;
use cede_sim::overlap::OrientedBox;
use cede_sim::{Role, State};

/// The paper's three figures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
}

/// Drives every encounter from its start in joint mode until its end.
#[must_use]
pub fn judge(sights: &[Sight<'_>], mut drive: impl FnMut(&[[Pair; 2]]) -> Vec<[f32; 2]>) -> Score {
    let mut running: Vec<Running> = (0..sights.len())
        .map(|i| Running::new(i, &sights[i]))
        .collect();
    let mut score = Score {
        n: sights.len(),
        ..Score::default()
    };
    let mut step = 0;
    while !running.is_empty() {
        let pairs: Vec<_> = running.iter_mut().map(|r| r.see(sights, step)).collect();
        let commands = drive(&pairs);
        step += 1;
        for (r, command) in running.iter_mut().zip(commands) {
            r.states = [0, 1].map(|i| advance(r.states[i], command[i]));
        }
        running.retain(|r| !r.ends(sights, step, &mut score));
    }
    let n = sights.len().max(1) as f32;
    score.priority_accuracy /= n;
    score.length_error /= n;
    score
}

struct Running {
    encounter: usize,
    states: [State; 2],
    svo: f32,
}

impl Running {
    fn new(encounter: usize, sight: &Sight<'_>) -> Self {
        let state = |i: usize| {
            let sample = sight.encounter.participants[i].record[0];
            State {
                s: sample.s,
                v: sample.v,
            }
        };
        Self {
            encounter,
            states: [state(0), state(1)],
            svo: Sight::FIRST_SVO,
        }
    }

    fn see(&mut self, sights: &[Sight<'_>], step: usize) -> [Pair; 2] {
        let pairs = sights[self.encounter].pairs(step, self.states, self.svo);
        self.svo = pairs[0].svo();
        pairs
    }

    /// Whether the episode is over after `step` steps; if so, it is counted.
    fn ends(&self, sights: &[Sight<'_>], step: usize, score: &mut Score) -> bool {
        let encounter = sights[self.encounter].encounter;
        let past = |i: usize| self.states[i].s - encounter.participants[i].conflict_s;
        let area = |i: usize| {
            let pose = encounter.participants[i].route.pose(self.states[i].s);
            OrientedBox::new(pose, Footprint::PAPER)
        };
        let (left, other) = (past(0), past(1));
        let length = step as f32 / encounter.steps as f32;
        let arrived = left >= 0.0 || other >= 0.0;
        if area(0).overlaps(&area(1)) {
            score.collisions += 1;
        } else if arrived {
            // Within one step, whoever is further past in time was there first.
            let first = if left / self.states[0].v.max(0.1) >= other / self.states[1].v.max(0.1) {
                Role::Left
            } else {
                Role::Other
            };
            let right = first == encounter.first;
            score.priority_accuracy += if right { 1.0 } else { 0.0 };
        } else if step >= 2 * encounter.steps as usize {
            score.time_outs += 1;
        } else {
            return false;
        }
        score.length_error += (length - 1.0).abs();
        true
    }
}
