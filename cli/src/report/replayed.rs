//! Encounters to be replayed on the page.

use super::around::{Bystander, around, in_the_way};
use super::called::called;
use super::digits::{centi, route};
use super::why::{Class, words};
use cede_controller::ConflictKind;
use cede_controller::kinematics::State;
use cede_data::{Encounter, EncounterId, Role};
use cede_sim::episode::{End, Episode};
use cede_sim::evaluate::Drive;
use cede_sim::metrics::{recorded_states, svo_series};
use serde::Serialize;

/// An encounter to be replayed.
#[derive(Serialize)]
pub(super) struct Case {
    name: String,
    /// What the two vehicles are called.
    called: [String; 2],
    point: [f64; 2],
    vehicles: [Vehicle; 2],
    record: Motion,
    drives: Vec<Driven>,
    around: Vec<Bystander>,
    /// Whether it is shown for a bad moment of one driver alone.
    found: bool,
}

#[derive(Serialize)]
struct Vehicle {
    route: Vec<[f64; 2]>,
    conflict_s: f64,
}

/// The motion of both vehicles along their routes, step by step.
#[derive(Serialize)]
struct Motion {
    first: Option<&'static str>,
    length: u32,
    s: [Vec<f64>; 2],
    v: [Vec<f64>; 2],
    /// That of the vehicle in the role `left`, in rad, until the first arrival.
    svo: Vec<f64>,
}

#[derive(Serialize)]
struct Driven {
    driver: String,
    end: &'static str,
    #[serde(flatten)]
    motion: Motion,
    /// Those in [`Case::around`] that are in the way, and not shown.
    left_out: Vec<usize>,
    /// The steps in which the shield overruled each vehicle's driver, and why.
    shielded: [Vec<(usize, Class, String)>; 2],
}

impl Case {
    pub(super) fn of(encounter: &Encounter) -> Self {
        let shown = shown(encounter);
        let states: Vec<[State; 2]> = recorded_states(encounter)
            .take(shown as usize + 1)
            .collect();
        let point = encounter.conflict_point;
        Self {
            name: case_name(encounter),
            called: Role::BOTH.map(|role| called(encounter, role)),
            point: [point.x, point.y].map(|c| centi(f64::from(c))),
            vehicles: Role::BOTH.map(|role| Vehicle {
                route: route(encounter.judged(role)),
                conflict_s: centi(f64::from(encounter.judged(role).conflict_s)),
            }),
            record: Motion::of(encounter, &states, Some(encounter.first), encounter.steps),
            drives: Vec::new(),
            around: around(encounter, shown),
            found: false,
        }
    }

    /// Adds an episode, unless the driver has one already.
    pub(super) fn add(&mut self, driver: String, drive: &Drive<'_>) {
        if self.drives.iter().any(|driven| driven.driver == driver) {
            return;
        }
        let episode = &drive.episode;
        let overruled = |role: Role| {
            let steps = episode.actions.iter().enumerate();
            steps
                .filter_map(|(i, both)| {
                    let cause = both[role as usize].cause;
                    Some((i, Class::of(cause)?, words(drive.encounter, role, cause)))
                })
                .collect()
        };
        self.drives.push(Driven {
            driver,
            end: end(episode),
            motion: Motion::of(
                drive.encounter,
                &episode.states,
                episode.first(),
                drive.measures.length,
            ),
            left_out: in_the_way(drive.encounter, shown(drive.encounter), &episode.states),
            shielded: Role::BOTH.map(overruled),
        });
    }

    /// The case as one that is shown for a bad moment alone.
    pub(super) fn found(self) -> Self {
        Self {
            found: true,
            ..self
        }
    }

    /// Adds the episodes of the same encounter in `other` of drivers that have none here.
    pub(super) fn merge(&mut self, other: Self) {
        for driven in other.drives {
            if self
                .drives
                .iter()
                .all(|known| known.driver != driven.driver)
            {
                self.drives.push(driven);
            }
        }
    }

    pub(super) fn was_driven(&self) -> bool {
        !self.drives.is_empty()
    }
}

/// Steps that a replay shows at most: the longest episode takes twice as long as the record.
fn shown(encounter: &Encounter) -> u32 {
    2 * encounter.steps
}

fn case_name(encounter: &Encounter) -> String {
    let EncounterId {
        file, left, other, ..
    } = encounter.id;
    let kind = match encounter.kind {
        ConflictKind::Merging => "merging",
        _ => "crossing",
    };
    let first = called(encounter, encounter.first);
    format!("({file}, {left}, {other}): {kind}, {first} first")
}

fn end(episode: &Episode) -> &'static str {
    match episode.end {
        End::Finished => "finished",
        End::Collision => "collision",
        End::TimeOut => "time-out",
    }
}

impl Motion {
    fn of(encounter: &Encounter, states: &[[State; 2]], first: Option<Role>, length: u32) -> Self {
        let series = |value: fn(State) -> f32| {
            [0, 1].map(|i| {
                states
                    .iter()
                    .map(|both| centi(f64::from(value(both[i]))))
                    .collect()
            })
        };
        let svo = svo_series(encounter, states.iter().copied());
        Self {
            first: first.map(|role| match role {
                Role::Left => "left",
                Role::Other => "other",
            }),
            length,
            s: series(|state| state.s),
            v: series(|state| state.v),
            svo: svo.map(|phi| centi(f64::from(phi))).collect(),
        }
    }
}
