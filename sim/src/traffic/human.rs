//! Who is not driven repeats its record, later if somebody was in its way.

use super::obstacle::Obstacle;
use crate::driver::idm::follow;
use cede_controller::kinematics::{STEP, State};
use cede_data::{Participant, Sample};

/// Acceleration (m/s²) with which it takes up its record again.
const TAKES_UP: f32 = 2.0;
/// Braking (m/s²), at most, for who is in the way.
const HARDEST: f32 = 8.0;

/// How far a vehicle has come in its record.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Human {
    /// Steps into the record.
    at: f32,
    /// It has been driven, so that its place in the record has to be looked for.
    lost: bool,
}

impl Human {
    /// Somebody else decides.
    pub(super) const fn leave(&mut self) {
        self.lost = true;
    }

    /// What keeps a vehicle at `speed` (m/s), that may be `late`, from repeating its record: an acceleration (m/s²), infinite if
    /// nothing does.
    pub(super) fn acceleration(speed: f32, late: bool, obstacle: Option<Obstacle>) -> f32 {
        let free = if late { TAKES_UP } else { f32::INFINITY };
        let Some(obstacle) = obstacle else {
            return free;
        };
        let held = follow(speed, f32::INFINITY, obstacle.gap, obstacle.speed);
        free.min(held.max(-HARDEST))
    }

    /// The record is at its end.
    pub(super) fn is_done(&self, vehicle: &Participant) -> bool {
        self.at as usize + 1 >= vehicle.record.len()
    }

    /// One step after `state`: as recorded, unless `most` (m/s²) does not allow it. Then as much of it as it does.
    pub(super) fn advance(&mut self, vehicle: &Participant, state: State, most: f32) -> State {
        let record = &vehicle.record;
        if self.lost {
            let passed = record
                .iter()
                .take_while(|sample| sample.s <= state.s)
                .count();
            self.at = passed.saturating_sub(1) as f32;
            self.lost = false;
        }
        let here = recorded(record, self.at);
        let next = recorded(record, self.at + 1.0);
        let allowed = (state.v + most * STEP).max(0.0);
        if next.v <= allowed && state.v >= here.v - 1e-3 {
            self.at += 1.0;
            return State {
                s: next.s,
                v: next.v,
            };
        }
        let wanted = next.v.max(here.v);
        let v = wanted.min(allowed);
        let s = state.s + 0.5 * (state.v + v) * STEP;
        // Where it stands in its record time passes; elsewhere it gets as far as it gets.
        if next.s - here.s < 1e-3 {
            self.at += 1.0;
        }
        while (self.at as usize) + 1 < record.len() && recorded(record, self.at.floor() + 1.0).s < s
        {
            self.at = self.at.floor() + 1.0;
        }
        let from = recorded(record, self.at.floor());
        let to = recorded(record, self.at.floor() + 1.0);
        if to.s > from.s && s > from.s {
            self.at = self.at.floor() + ((s - from.s) / (to.s - from.s)).min(0.999);
        }
        State { s, v }
    }
}

/// The record `at` steps after its start; its last sample ever after.
fn recorded(record: &[Sample], at: f32) -> State {
    let (index, share) = (at as usize, at.fract());
    let sample = |index: usize| {
        let last = record.len().saturating_sub(1);
        record
            .get(index.min(last))
            .map_or(State::default(), |sample| State {
                s: sample.s,
                v: sample.v,
            })
    };
    let (a, b) = (sample(index), sample(index + 1));
    State {
        s: a.s + share * (b.s - a.s),
        v: a.v + share * (b.v - a.v),
    }
}
