//! What the contract expects of others: C6 in lanes and C7 where a rule of precedence holds.
//!
//! Who is behind whom in a lane, and by which gap, is measured where the vehicles are ([`Shared`]), and read from the lanes
//! that the junction publishes, which is where the contract has C6: a human keeps both. C7 is about the zones of the
//! junction: there the controller's zones and lines are what everybody keeps to.

use crate::motion::{State, TICK};
use crate::numbers::{Numbers, Rule};
use crate::shared::{EARLY, Shared};
use crate::site::Area;
use cede_controller::Priority;

/// What one human owes one shielded vehicle, and what it remembers for that.
#[derive(Clone, Debug, Default)]
pub struct Duty {
    /// In each lane, as it is measured and as the junction has it: what is owed to an ego that is ahead.
    distances: Vec<Distance>,
    /// When the ego arrived at its line at the earliest, in s.
    ego_arrived: Option<f64>,
    /// When the human arrived at its own at the latest, in s.
    arrived: Option<f64>,
    /// Both were seen at rest: the ego may have the turn.
    waited: bool,
    /// In each zone: whether the ego may hold it.
    stands: Vec<Stands>,
}

/// Whether the ego may hold a zone in which it stands: from when both have rested for a while until it has left.
#[derive(Clone, Copy, Debug, Default)]
struct Stands {
    /// For how long both have been at rest with the ego inside, in s.
    rested: f64,
    /// That was long enough for the ego to hold the zone.
    held: bool,
}

impl Stands {
    /// The least number of periods after which a shield counts on it, less one for each end.
    const PERIODS: f64 = 2.0;

    /// Notes a tick: whether the ego is inside, and whether both rest.
    fn note(&mut self, numbers: &Numbers, inside: bool, both_rest: bool) {
        if !inside {
            *self = Self::default();
        } else if both_rest {
            self.rested += TICK;
            self.held |= self.rested >= Self::PERIODS * numbers.period;
        } else {
            self.rested = 0.0;
        }
    }
}

/// What one owes an ego that is ahead in one lane.
#[derive(Clone, Copy, Debug, Default)]
struct Distance {
    /// The ego has had the safe gap since it came to be ahead: one who cuts in has no claim to be spared.
    owed: bool,
    /// For how long the gap has been less than that, in s.
    unsafe_for: f64,
    /// Ticks in which nothing can change.
    calm: u32,
}

/// So many ticks are looked ahead, in which no two vehicles come nearer than this (m).
const CALM: u32 = 10;
const NEARER: f64 = 3.0;

impl Distance {
    /// Whether `me` has to brake in the tick that begins, in which it wants to accelerate by `wanted`; `gap` (m) is how far
    /// it is behind the ego, or for how many ticks it will not be.
    fn must_brake(
        &mut self,
        numbers: &Numbers,
        (ego, me): (State, State),
        gap: Result<f64, u32>,
        wanted: f64,
    ) -> bool {
        let gap = match gap {
            Ok(gap) => gap,
            Err(calm) => {
                *self = Self {
                    calm,
                    ..Self::default()
                };
                return false;
            }
        };
        self.owed |= gap >= numbers.safe_gap(me.v, ego.v);
        // One tick early, because a tick is the shortest time in which it can react.
        let next = me.after(wanted, TICK, numbers.other.speed);
        let needs = numbers.safe_gap(next.v, ego.v) + next.s - me.s;
        if self.owed && gap <= needs {
            self.unsafe_for += TICK;
        } else {
            self.unsafe_for = 0.0;
            self.calm = if gap > needs + NEARER { CALM } else { 0 };
        }
        self.unsafe_for > numbers.reaction - TICK
    }
}

/// How far (m) `me` is behind the ego where their lanes are one, by the attacker's own geometry; if it is not, for how many
/// ticks it will not be.
fn measured(shared: &Shared, ego: State, me: State) -> Result<f64, u32> {
    let relation = shared.relation(ego.s, me.s, EARLY + NEARER).ok_or(CALM)?;
    let entered = ego.s >= shared.span()[0] - EARLY;
    let behind = relation.behind && entered;
    if behind { Ok(relation.gap) } else { Err(0) }
}

/// The same in what the junction calls a lane, where the contract has it: a lane begins where the footprints may touch
/// within the tolerance, and there one may come to be beside the ego without touching it.
fn published(area: &Area, ego: State, me: State) -> Result<f64, u32> {
    let lead = ego.s - me.s;
    let there = ego.s >= area.ego[0] && ego.s <= area.ego[1] && me.s <= area.other[1];
    let ahead = lead >= 0.5 * (area.lead[0] + area.lead[1]);
    let behind = area.lane && there && ahead;
    if behind {
        Ok(lead - area.lead[1])
    } else {
        Err(0)
    }
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
    /// Where they are in one lane.
    pub shared: &'a [Shared],
    /// Where the ego waits.
    pub ego_line: f64,
    /// Where the human waits.
    pub line: f64,
    /// Whether the human has the right of way over the ego.
    pub first: Option<bool>,
    /// When that counts.
    pub priority: Priority,
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
            let yields = self.yields(numbers, rule, meeting);
            for (area, stands) in meeting.areas.iter().zip(&self.stands) {
                let waits = yields && (self.ego_arrived.is_some() || !area.lane);
                if waits || stands.held {
                    limit = stay_out(numbers, rule, meeting, area, limit);
                }
            }
        }
        limit
    }

    /// C6: it stops behind an ego that is ahead in its lane. A gap that is not safe is reacted to after the reaction time.
    fn keep_distance(&mut self, numbers: &Numbers, meeting: &Meeting<'_>, wanted: f64) -> f64 {
        let (ego, me) = (meeting.ego, meeting.me);
        let measured = meeting.shared.iter().map(|it| measured(it, ego, me));
        let published = meeting.areas.iter().map(|it| published(it, ego, me));
        self.distances.resize(
            meeting.shared.len() + meeting.areas.len(),
            Distance::default(),
        );
        let mut limit = wanted;
        for (gap, distance) in measured.chain(published).zip(&mut self.distances) {
            if distance.calm > 0 {
                distance.calm -= 1;
            } else if distance.must_brake(numbers, (ego, me), gap, wanted) {
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
        // Between two calls one may start and stop again.
        let (up, down) = (numbers.other.acceleration, numbers.other.braking);
        let unnoticed = slow + (numbers.period + 2.0 * numbers.jitter) * up * down / (up + down);
        let both_rest = ego.v <= unnoticed && me.v <= unnoticed;
        self.stands.resize(meeting.areas.len(), Stands::default());
        for (area, stands) in meeting.areas.iter().zip(&mut self.stands) {
            let inside = !area.lane && ego.s + error > area.ego[0] && ego.s < area.ego[1];
            stands.note(numbers, inside, both_rest);
        }
    }

    /// Whether the ego may have precedence.
    fn yields(&self, numbers: &Numbers, rule: Rule, meeting: &Meeting<'_>) -> bool {
        // Without any order nobody has told the junction anything.
        if let (Some(first), Priority::Unsigned | Priority::Signed) =
            (meeting.first, meeting.priority)
        {
            return self.waited || !first;
        }
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

/// C7: it stays out of a zone before which it can still stop.
fn stay_out(numbers: &Numbers, rule: Rule, meeting: &Meeting<'_>, area: &Area, wanted: f64) -> f64 {
    let (ego, me) = (meeting.ego, meeting.me);
    let over = ego.s >= area.ego[1] || me.s >= area.other[1];
    // Arc lengths of the controller are f32: their places are off by some micrometres.
    let edge = area.other[0] - 1e-3;
    let stops = me.rest(rule.braking) <= edge;
    let next = me.after(wanted, TICK, numbers.other.speed);
    if !over && stops && next.rest(rule.braking) > edge {
        wanted.min(-rule.braking)
    } else {
        wanted
    }
}
