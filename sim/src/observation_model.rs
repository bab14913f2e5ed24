//! What the two judged vehicles of an encounter see, while its bystanders do what they did.

use crate::meeting::{conflict, crossroads, recorded};
use cede_controller::RouteConflict;
use cede_controller::kinematics::State;
use cede_controller::{ConflictKind, Footprint, NearbyVehicle, Pair, TrafficContext, UnitVector};
use cede_controller::{Part, RightOfWay, VehicleState};
use cede_data::encounter::Encounter;
use core::f32::consts::{FRAC_PI_2, FRAC_PI_4};
use core::ops::Range;

/// Who may go first, as judged vehicle `ego` sees it; unsettled at an all-way stop.
#[must_use]
pub fn right_of_way(encounter: &Encounter, ego: usize) -> RightOfWay {
    match encounter.rights.settled() {
        Some(first) if first as usize == ego => RightOfWay::Ego,
        Some(_) => RightOfWay::Other,
        None => RightOfWay::Unsettled,
    }
}

/// The bystanders of an encounter whose routes meet that of one of its judged vehicles.
#[derive(Clone, Debug)]
pub struct Bystanders {
    meetings: Vec<Bystander>,
}

/// A bystander whose route meets that of the judged vehicle.
#[derive(Clone, Debug)]
struct Bystander {
    /// Steps during which it is there: most are not, most of the time, and nothing else of those is read.
    there: Range<usize>,
    /// Its number among the participants.
    index: usize,
    conflict: RouteConflict,
}

impl Bystanders {
    /// The bystanders whose routes meet that of judged vehicle `ego`; one whose route is no path of a junction is left out.
    ///
    /// Cost: about 0.1 ms a bystander.
    #[must_use]
    pub fn new(encounter: &Encounter, ego: usize) -> Self {
        let conflict = |index: usize| {
            let (own, other) = (
                encounter.participants.get(ego)?,
                encounter.participants.get(index)?,
            );
            let routes = [
                (&own.route, Footprint::PAPER),
                (&other.route, other.footprint),
            ];
            let conflict = conflict(&crossroads(routes).ok()?, 0).copied()?;
            conflict.zones().next()?;
            let appears = other.appears as usize;
            Some(Bystander {
                there: appears..appears + other.record.len(),
                index,
                conflict,
            })
        };
        Self {
            meetings: (2..encounter.participants.len())
                .filter_map(conflict)
                .collect(),
        }
    }

    /// What they are, at `step` of their record, to the judged vehicle at arc length `s` (m).
    #[must_use]
    pub fn around(&self, encounter: &Encounter, step: usize, s: f32) -> TrafficContext {
        let meetings = self.meetings.iter();
        let there = meetings.filter(|meeting| meeting.there.contains(&step));
        let nearby = there.filter_map(|meeting| {
            let record = &encounter.participants.get(meeting.index)?.record;
            let sample = record.get(step - meeting.there.start)?;
            Some(NearbyVehicle {
                conflict: &meeting.conflict,
                s: sample.s,
                speed: sample.v,
            })
        });
        TrafficContext::new(s, nearby)
    }
}

/// An encounter, prepared so that what a vehicle sees at any step costs little: the very
/// [`Pair`]s that the controller would show its policy.
#[derive(Clone, Debug)]
pub struct ObservationModel<'e> {
    /// The encounter.
    pub encounter: &'e Encounter,
    kind: ConflictKind,
    conflicts: [f32; 2],
    exits: [UnitVector; 2],
    bystanders: [Bystanders; 2],
}

impl<'e> ObservationModel<'e> {
    /// Prepares `encounter`: how the judged vehicles' routes meet each other's and the bystanders'.
    ///
    /// Cost: about 0.2 ms a bystander.
    #[must_use]
    pub fn new(encounter: &'e Encounter) -> Self {
        let participants = &encounter.participants;
        let junction = recorded(encounter, |_| Footprint::PAPER).ok();
        let rival = junction.as_ref().and_then(|junction| conflict(junction, 0));
        let rival = rival.filter(|conflict| conflict.zones().next().is_some());
        let recorded = [0, 1].map(|i| participants[i].conflict_s);
        Self {
            encounter,
            kind: rival.map_or(encounter.kind, |conflict| conflict.kind),
            conflicts: rival.map_or(recorded, |m| [m.ego_conflict, m.other_conflict]),
            exits: [0, 1].map(|i| {
                let route = &participants[i].route;
                route.pose(route.length()).direction
            }),
            bystanders: [0, 1].map(|i| Bystanders::new(encounter, i)),
        }
    }

    /// The left-turner's SVO at the start, before anyone moved.
    pub const FIRST_SVO: f32 = FRAC_PI_4;

    /// What the left-turner and what the other sees at `step`, if the two are in `states` and the
    /// left-turner's SVO was `last_svo`. Each knows its own traffic, not the other's.
    #[must_use]
    pub fn pairs(&self, step: usize, states: [State; 2], last_svo: f32) -> [Pair; 2] {
        let bare = [0, 1].map(|i| self.vehicle_state(i, states[i]));
        [0, 1].map(|i| {
            let seen = self.bystanders[i].around(self.encounter, step, states[i].s);
            Pair {
                ego: VehicleState {
                    leader: seen.leader,
                    crosser: seen.crosser,
                    ..bare[i]
                },
                other: bare[1 - i],
                kind: self.kind,
                right_of_way: right_of_way(self.encounter, i),
                part: if i == 0 { Part::Left } else { Part::Other },
                last_svo: if i == 0 {
                    last_svo
                } else {
                    FRAC_PI_2 - last_svo
                },
            }
        })
    }

    /// What the two saw at each recorded step up to the encounter's end: the left-turner, then the other.
    pub fn recorded(&self) -> impl Iterator<Item = Pair> + '_ {
        let mut svo = Self::FIRST_SVO;
        (0..self.encounter.steps as usize).flat_map(move |step| {
            let state = |i: usize| {
                let sample = self.encounter.participants[i].record.get(step)?;
                Some(State {
                    s: sample.s,
                    v: sample.v,
                })
            };
            let pairs = state(0).zip(state(1));
            let pairs = pairs.map(|(a, b)| self.pairs(step, [a, b], svo));
            svo = pairs.as_ref().map_or(svo, |pairs| pairs[0].svo());
            pairs.into_iter().flatten()
        })
    }

    fn vehicle_state(&self, i: usize, state: State) -> VehicleState {
        VehicleState {
            pose: self.encounter.participants[i].route.pose(state.s),
            exit: self.exits[i],
            speed: state.v,
            distance: self.conflicts[i] - state.s,
            footprint: Footprint::PAPER,
            leader: None,
            crosser: None,
            control: self.encounter.participants[i].entry.control,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::crossing;
    use crate::meeting::{Meeting, path};
    use cede_controller::Control;
    use cede_data::encounter::Role;
    use cede_data::{Rights, Rule};

    /// What the two are told in training, and what the controller is told.
    fn told(rule: Rule) -> [[RightOfWay; 2]; 2] {
        let mut encounter = crossing([20.0, 8.0], [30.0, 8.0]);
        encounter.rights = Rights {
            first: Some(Role::Other),
            rule,
        };
        encounter.participants[0].entry.control = Control::Stop;
        let states = [State { s: 60.0, v: 5.0 }; 2];
        let pairs = ObservationModel::new(&encounter).pairs(0, states, FRAC_PI_4);
        let junction = Meeting::new(&encounter).unwrap().junction;
        for i in 0..2 {
            assert_eq!(
                junction.path(path(i)).unwrap().control(),
                pairs[i].ego.control
            );
            assert_eq!(pairs[i].ego.control, pairs[1 - i].other.control);
        }
        assert_eq!(pairs[0].ego.control, Control::Stop);
        let conflict = |i: usize| junction.conflict(path(i), path(1 - i)).unwrap();
        [
            pairs.map(|pair| pair.right_of_way),
            [0, 1].map(|i| conflict(i).right_of_way),
        ]
    }

    #[test]
    fn training_and_controller_are_told_the_same_right_of_way() {
        let settled = [RightOfWay::Other, RightOfWay::Ego];
        assert_eq!(told(Rule::LeftTurn), [settled; 2]);
        assert_eq!(told(Rule::AllWayStop), [[RightOfWay::Unsettled; 2]; 2]);
    }
}
