//! What the contract expects of others: C6 in lanes and C7 where a rule of precedence holds.

use crate::motion::{State, TICK};
use crate::numbers::{Numbers, Rule};
use crate::site::Area;

/// What one human owes one shielded vehicle, and what it remembers for that.
#[derive(Clone, Debug, Default)]
pub struct Duty {
    /// For how long the ego has been ahead in each lane with less than the safe gap, in s.
    unsafe_for: Vec<f64>,
    /// When the ego arrived at its line at the earliest, in s.
    ego_arrived: Option<f64>,
    /// When the human arrived at its own at the latest, in s.
    arrived: Option<f64>,
    /// Both were seen at rest: the ego may have the turn.
    waited: bool,
}

/// Who meets whom, from the human's side.
#[derive(Clone, Copy, Debug)]
pub struct Meeting<'a> {
    /// The shielded vehicle.
    pub ego: State,
    /// The human.
    pub me: State,
    /// Their zones.
    pub areas: &'a [Area],
    /// Where the ego waits.
    pub ego_line: f64,
    /// Where the human waits.
    pub line: f64,
    /// Whether the human goes before the ego in a tie.
    pub first: Option<bool>,
}

impl Duty {
    /// The hardest acceleration that the contract allows the human in the tick that begins at `time` (s); `wanted` if it
    /// owes nothing.
    pub fn limit(
        &mut self,
        numbers: &Numbers,
        meeting: &Meeting<'_>,
        time: f64,
        wanted: f64,
    ) -> f64 {
        let mut limit = self.keep_distance(numbers, meeting, wanted);
        if let Some(rule) = numbers.rule {
            self.note(numbers, rule, meeting, time);
            if self.yields(numbers, rule, meeting) {
                limit = stay_out(numbers, rule, meeting, limit);
            }
        }
        limit
    }

    /// C6: it stops behind an ego that is ahead in its lane. A gap that is not safe is reacted to after the reaction time.
    fn keep_distance(&mut self, numbers: &Numbers, meeting: &Meeting<'_>, wanted: f64) -> f64 {
        let (ego, me) = (meeting.ego, meeting.me);
        self.unsafe_for.resize(meeting.areas.len(), 0.0);
        let mut limit = wanted;
        for (area, unsafe_for) in meeting.areas.iter().zip(&mut self.unsafe_for) {
            let inside = ego.s >= area.ego[0] && ego.s < area.ego[1] && me.s < area.other[1];
            let lead = ego.s - me.s;
            let ahead = area.lane && inside && lead >= 0.5 * (area.lead[0] + area.lead[1]);
            let gap = lead - area.lead[1];
            // One tick early, because a tick is the shortest time in which it can react.
            let next = me.after(wanted, TICK, numbers.other.speed);
            let needs = numbers.safe_gap(next.v, ego.v) + next.s - me.s;
            if ahead && gap <= needs {
                *unsafe_for += TICK;
            } else {
                *unsafe_for = 0.0;
            }
            if *unsafe_for > numbers.reaction - TICK {
                limit = limit.min(-numbers.follower_braking);
            }
        }
        limit
    }

    /// Notes who has arrived, and whether both have rested. What errors may hide counts against the human.
    fn note(&mut self, numbers: &Numbers, rule: Rule, meeting: &Meeting<'_>, time: f64) {
        let error = 2.0 * numbers.position_error + 0.05;
        let (ego, me) = (meeting.ego, meeting.me);
        if ego.s + error >= meeting.ego_line - rule.distance {
            self.ego_arrived.get_or_insert(time);
        }
        if me.s - error >= meeting.line - rule.distance {
            self.arrived.get_or_insert(time);
        }
        let slow = 0.25 * numbers.go * numbers.period + 4.0 * numbers.speed_error + 0.01;
        self.waited |= rule.patience > 0 && ego.v <= slow && me.v <= slow;
    }

    /// Whether the ego may have precedence.
    fn yields(&self, numbers: &Numbers, rule: Rule, meeting: &Meeting<'_>) -> bool {
        let Some(ego) = self.ego_arrived else {
            return false;
        };
        let Some(me) = self.arrived else { return true };
        let tie = (f64::from(rule.tie) + 1.0) * numbers.period;
        let spare = 3.0 * numbers.period + 2.0 * numbers.jitter;
        // With the right of way the ego goes unless it came later by a tie; without, if it came earlier by one.
        let lead = if meeting.first == Some(false) {
            -tie - spare
        } else {
            tie - spare
        };
        self.waited || me > ego + lead
    }
}

/// C7: it stays out of every zone before which it can still stop.
fn stay_out(numbers: &Numbers, rule: Rule, meeting: &Meeting<'_>, wanted: f64) -> f64 {
    let (ego, me) = (meeting.ego, meeting.me);
    let mut limit = wanted;
    for area in meeting.areas {
        let over = ego.s >= area.ego[1] || me.s >= area.other[1];
        // Arc lengths of the controller are f32: their places are off by some micrometres.
        let edge = area.other[0] - 1e-3;
        let stops = me.rest(rule.braking) <= edge;
        let next = me.after(limit, TICK, numbers.other.speed);
        if !over && stops && next.rest(rule.braking) > edge {
            limit = limit.min(-rule.braking);
        }
    }
    limit
}
