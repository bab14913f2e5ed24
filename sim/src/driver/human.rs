//! The human driver of the synthetic scenarios, in anybody's encounter.

use super::{Driver, DriverFactory, View, idm};
use crate::meeting::Meeting;
use cede_controller::UnitVector;
use cede_controller::kinematics::STEP;
use cede_controller::kinematics::State;
use cede_data::encounter::{Encounter, Participant};
use cede_data::synthetic::human;
use cede_data::synthetic::human::{Character, Leader, Right, Rival, Situation};
use cede_data::synthetic::profile::SpeedProfile;
use cede_data::synthetic::zone::{Zone, zone};
use rand_pcg::Pcg64;

/// A driver drawn from the population of the synthetic scenarios, as at an all-way stop.
///
/// It follows who is ahead in its lane, stops or rolls up to its line, and goes when
/// its turn has come; how it does so is drawn anew from every seed. Recordings do not
/// say where the lines are: they are laid where the recorded drivers stop, some metres
/// before the routes' shared zone.
#[derive(Clone, Copy, Debug)]
pub struct Human;

/// From the line to the beginning of the shared zone, for the vehicle's centre, in metres.
const SETBACK: f32 = 8.0;
/// Metres of a merge that count as shared zone; beyond it the two follow each other.
const MERGE: f32 = 9.0;
/// Speed that a plain driver likes, in m/s.
const DESIRED: f32 = 8.0;
/// A vehicle this close (m) to its line and slower than [`ARRIVED_SPEED`] (m/s) has come to it.
const ARRIVED: f32 = 3.0;
const ARRIVED_SPEED: f32 = 3.0;
/// Beyond its line by this much (m) a vehicle has entered the intersection: nobody waits there.
const ENTERED: f32 = 2.0;
/// Who comes this much earlier (s) came first.
const TOGETHER: f32 = 0.5;

impl DriverFactory for Human {
    fn name(&self) -> &str {
        "human"
    }

    fn driver<'m>(&self, meeting: &'m Meeting<'_>, ego: usize, seed: u64) -> Box<dyn Driver + 'm> {
        let encounter = meeting.encounter;
        let Some(own) = encounter.participants.get(ego) else {
            return Box::new(Nobody);
        };
        let mut rng = Pcg64::new(u128::from(seed), ego as u128);
        let character = Character::draw(&mut rng);
        let human = human::Human::new(character, rng);
        Box::new(AtCrossing::new(encounter, ego, own, human))
    }
}

/// Drives a vehicle that the encounter does not have.
struct Nobody;

impl Driver for Nobody {
    fn accelerate(&mut self, _: &View<'_>) -> f32 {
        0.0
    }
}

struct AtCrossing {
    human: human::Human,
    profile: SpeedProfile,
    /// Arc length (m) of the driver's own line, for its front bumper; none if nobody crosses its way.
    line: Option<f32>,
    own: Progress,
    others: Vec<Option<Other>>,
}

/// Somebody whose route conflicts.
struct Other {
    zone: Zone,
    /// Whether it comes from the right, or goes straight on while the driver turns left.
    has_right: bool,
    progress: Progress,
}

/// When a vehicle came to its line, and when it crossed it, in steps.
#[derive(Clone, Copy, Default)]
struct Progress {
    arrived: Option<u32>,
    entered: Option<u32>,
}

impl AtCrossing {
    fn new(encounter: &Encounter, ego: usize, own: &Participant, human: human::Human) -> Self {
        let meet = |(i, other)| (i != ego).then(|| meet(own, other, i < ego)).flatten();
        let others: Vec<Option<Other>> = encounter
            .participants
            .iter()
            .enumerate()
            .map(meet)
            .collect();
        let zones = others.iter().flatten().map(|other| other.zone.own.0);
        let start = own.record.first().map_or(0.0, |start| start.s);
        let stands = own.record.first().is_some_and(|start| start.v < 1.0);
        // Who stands at the start, stands at the line.
        let line = zones.min_by(f32::total_cmp).map(|zone| {
            let line = zone - SETBACK;
            if stands { line.max(start) } else { line }
        });
        let past = line.is_none_or(|line| start > line + 0.5);
        Self {
            human: if past { human.under_way() } else { human },
            profile: SpeedProfile::new(&own.route, |_| DESIRED),
            line: line.map(|line| line + 0.5 * own.footprint.length),
            own: Progress::default(),
            others,
        }
    }
}

/// How `other` crosses the way of `own`; `None` if it does not, or drives in the same lane.
fn meet(own: &Participant, other: &Participant, earlier: bool) -> Option<Other> {
    let mut zone = zone(&own.route, &other.route, false)?;
    let directions = |a: f32, b: f32| -> (UnitVector, UnitVector) {
        (own.route.pose(a).direction, other.route.pose(b).direction)
    };
    let (ours, theirs) = directions(zone.own.0, zone.other.0);
    if ours.dot(&theirs) > 0.8 {
        return None;
    }
    let (leaving, theirs_leaving) = directions(zone.own.1, zone.other.1);
    if leaving.dot(&theirs_leaving) > 0.8 {
        zone.own.1 = zone.own.1.min(zone.own.0 + MERGE);
        zone.other.1 = zone.other.1.min(zone.other.0 + MERGE);
    }
    let aside = ours.perp(&theirs);
    // Coming towards each other: the other judged vehicle goes before the left-turner.
    let has_right = aside > 0.5 || (aside > -0.5 && !earlier);
    Some(Other {
        zone,
        has_right,
        progress: Progress::default(),
    })
}

impl Driver for AtCrossing {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        let Some((own, state)) = view.own() else {
            return 0.0;
        };
        let half = 0.5 * own.footprint.length;
        let to_line = self
            .line
            .map_or(f32::NEG_INFINITY, |line| line - state.s - half);
        self.own.note(view.step, to_line, state.v);
        let rivals = self.rivals(view, state);
        let leader = idm::leader(view).map(|(gap, speed)| Leader { gap, speed });
        self.human.accelerate(&Situation {
            speed: state.v,
            profile: self.profile.at(state.s),
            crossing_speed: self.profile.slowest(state.s, state.s + 20.0),
            to_line,
            must_stop: true,
            leader,
            rivals: &rivals,
        })
    }
}

impl AtCrossing {
    fn rivals(&mut self, view: &View<'_>, own: State) -> Vec<Rival> {
        let mine = self.own;
        let mut rivals = Vec::new();
        for (i, other) in self.others.iter_mut().enumerate() {
            let (Some(other), Some(state)) = (other, view.state(i)) else {
                continue;
            };
            let to_line = other.zone.other.0 - SETBACK - state.s;
            other.progress.note(view.step, to_line, state.v);
            let rival = Rival {
                own: (other.zone.own.0 - own.s, other.zone.own.1 - own.s),
                other: (other.zone.other.0 - state.s, other.zone.other.1 - state.s),
                speed: state.v,
                ahead: other.progress.entered.is_some_and(|theirs| {
                    mine.entered
                        .is_none_or(|mine| (theirs, i) < (mine, view.ego))
                }),
                right: right(mine, other),
            };
            if rival.own.1 > 0.0 && rival.other.1 > 0.0 {
                rivals.push(rival);
            }
        }
        rivals
    }
}

fn right(own: Progress, other: &Other) -> Right {
    let Some(theirs) = other.progress.arrived else {
        return Right::Mine;
    };
    let Some(mine) = own.arrived else {
        return Right::FirstCome(f32::INFINITY);
    };
    let lead = (f64::from(mine) - f64::from(theirs)) as f32 * STEP;
    let tie = if other.has_right { TOGETHER } else { -TOGETHER };
    Right::FirstCome(if lead.abs() < TOGETHER { tie } else { lead })
}

impl Progress {
    fn note(&mut self, step: u32, to_line: f32, speed: f32) {
        if (to_line < ARRIVED && speed < ARRIVED_SPEED) || to_line < 0.0 {
            self.arrived.get_or_insert(step);
        }
        if to_line < -ENTERED {
            self.entered.get_or_insert(step);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::{End, Episode};
    use crate::evaluate::clearance;
    use crate::fixture::crossing;

    fn run(left: [f32; 2], other: [f32; 2], seed: u64) -> Episode {
        let mut encounter = crossing(left, other);
        encounter.steps = 300; // People who stop take their time.
        let meeting = Meeting::new(&encounter).unwrap();
        let mut drivers = [0, 1].map(|i| Human.driver(&meeting, i, seed));
        Episode::run(&encounter, &mut drivers, Some(clearance(&meeting)))
    }

    #[test]
    fn humans_neither_collide_nor_wait_for_ever() {
        for seed in 0..200 {
            let episode = run([30.0, 6.0], [32.0, 6.0], seed);
            assert_eq!(episode.end, End::Finished, "seed {seed}");
        }
    }

    #[test]
    fn who_comes_much_earlier_mostly_goes_first() {
        let first = |seed| run([20.0, 6.0], [60.0, 6.0], seed).first();
        let left = (0..50)
            .filter(|&seed| first(seed) == Some(cede_data::Role::Left))
            .count();
        assert!(left >= 45, "{left}");
    }
}
