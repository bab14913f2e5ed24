//! The replay buffer: a ring of transitions from which batches are drawn uniformly.

use rand::RngExt;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// One step of an episode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Transition {
    /// Features before the step.
    pub observation: Vec<f32>,
    /// Actions in (−1, 1).
    pub action: Vec<f32>,
    /// Reward of the step.
    pub reward: f32,
    /// Features after the step.
    pub next: Vec<f32>,
    /// Whether the episode ended with the step, so that nothing more is to be earned. A time-out only cuts it
    /// off: what would have come after it still counts.
    pub terminal: bool,
}

/// A batch of transitions; each field has one row per sample.
#[derive(Clone, Debug, Default)]
pub struct Batch {
    /// Features before the steps.
    pub observations: Vec<f32>,
    /// Actions in (−1, 1).
    pub actions: Vec<f32>,
    /// Rewards.
    pub rewards: Vec<f32>,
    /// Features after the steps.
    pub next: Vec<f32>,
    /// 0 where the step was [terminal](Transition::terminal), else 1.
    pub continues: Vec<f32>,
}

/// The last `capacity` transitions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Replay {
    observation: usize,
    action: usize,
    capacity: usize,
    /// Transitions pushed so far.
    pushed: usize,
    /// One row per transition: observation, action, next observation, reward, continues.
    rows: Vec<f32>,
}

impl Replay {
    /// An empty buffer for `capacity` transitions of `observation` features and `action` actions.
    #[must_use]
    pub fn new(capacity: usize, observation: usize, action: usize) -> Self {
        Self {
            observation,
            action,
            capacity: capacity.max(1),
            pushed: 0,
            rows: Vec::new(),
        }
    }

    fn stride(&self) -> usize {
        2 * self.observation + self.action + 2
    }

    /// Number of transitions in the buffer.
    #[must_use]
    pub fn len(&self) -> usize {
        self.pushed.min(self.capacity)
    }

    /// Whether the buffer is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.pushed == 0
    }

    /// Adds a transition. In a full buffer it replaces the oldest.
    ///
    /// # Panics
    /// If the transition does not have the buffer's shape.
    pub fn push(&mut self, transition: &Transition) {
        assert_eq!(transition.observation.len(), self.observation);
        assert_eq!(transition.next.len(), self.observation);
        assert_eq!(transition.action.len(), self.action);
        let stride = self.stride();
        let start = self.pushed % self.capacity * stride;
        if start == self.rows.len() {
            self.rows.resize(start + stride, 0.0);
        }
        let continues = if transition.terminal { 0.0 } else { 1.0 };
        let values = transition
            .observation
            .iter()
            .chain(&transition.action)
            .chain(&transition.next);
        let values = values.chain([&transition.reward, &continues]);
        let row = &mut self.rows[start..start + stride];
        row.iter_mut()
            .zip(values)
            .for_each(|(place, value)| *place = *value);
        self.pushed += 1;
    }

    /// Draws `size` transitions with replacement.
    ///
    /// # Panics
    /// If the buffer is empty.
    pub fn sample(&self, size: usize, random: &mut Pcg64, batch: &mut Batch) {
        batch.clear();
        for _ in 0..size {
            let start = random.random_range(0..self.len()) * self.stride();
            let row = &self.rows[start..start + self.stride()];
            let (observation, row) = row.split_at(self.observation);
            let (action, row) = row.split_at(self.action);
            let (next, row) = row.split_at(self.observation);
            batch.observations.extend_from_slice(observation);
            batch.actions.extend_from_slice(action);
            batch.next.extend_from_slice(next);
            batch.rewards.push(row[0]);
            batch.continues.push(row[1]);
        }
    }
}

impl Batch {
    fn clear(&mut self) {
        for values in [
            &mut self.observations,
            &mut self.actions,
            &mut self.rewards,
            &mut self.next,
            &mut self.continues,
        ] {
            values.clear();
        }
    }

    /// Number of transitions.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rewards.len()
    }

    /// Whether the batch is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rewards.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    fn transition(i: u8) -> Transition {
        let x = f32::from(i);
        Transition {
            observation: vec![x, -x],
            action: vec![0.5 * x],
            reward: 10.0 * x,
            next: vec![x + 1.0, -x - 1.0],
            terminal: i % 2 == 1,
        }
    }

    #[test]
    fn new_transitions_replace_the_oldest_and_rows_stay_whole() {
        let mut replay = Replay::new(3, 2, 1);
        (0..5).for_each(|i| replay.push(&transition(i)));
        assert_eq!(replay.len(), 3);
        let mut batch = Batch::default();
        replay.sample(200, &mut Pcg64::seed_from_u64(1), &mut batch);
        let mut seen = [false; 5];
        for k in 0..batch.len() {
            let i = batch.observations[2 * k] as u8;
            seen[usize::from(i)] = true;
            let expected = transition(i);
            assert_eq!(batch.observations[2 * k..2 * k + 2], expected.observation);
            assert_eq!(batch.next[2 * k..2 * k + 2], expected.next);
            assert_eq!(batch.actions[k], expected.action[0]);
            assert_eq!(batch.rewards[k], expected.reward);
            assert_eq!(batch.continues[k] == 0.0, expected.terminal);
        }
        assert_eq!(seen, [false, false, true, true, true]);
    }
}
