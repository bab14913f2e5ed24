//! The traffic around the two judged vehicles: as recorded, and left out of a replay where it would be in the way.

use super::digits::{centi, route};
use cede_controller::kinematics::State;
use cede_controller::separation::OrientedBox;
use cede_controller::{Footprint, Pose};
use cede_data::{Encounter, Participant, Role};
use serde::Serialize;

/// A recorded vehicle that is nearer (m) than this to a judged one in a step is in its way. Between two steps, of 0.1 s,
/// vehicles that pass each other at 10 m/s come at most so much nearer.
const CLEAR: f32 = 0.5;

/// A recorded vehicle.
#[derive(Serialize)]
pub(super) struct Bystander {
    appears: u32,
    size: [f64; 2],
    route: Vec<[f64; 2]>,
    s: Vec<f64>,
}

impl Bystander {
    fn of(vehicle: &Participant, shown: u32) -> Self {
        let steps = shown - vehicle.appears;
        let size = vehicle.footprint;
        Self {
            appears: vehicle.appears,
            size: [size.length, size.width].map(|m| centi(f64::from(m))),
            route: route(vehicle),
            s: vehicle
                .record
                .iter()
                .take(steps as usize + 1)
                .map(|sample| centi(f64::from(sample.s)))
                .collect(),
        }
    }
}

/// The recorded vehicles that appear in the first `shown` steps.
pub(super) fn around(encounter: &Encounter, shown: u32) -> Vec<Bystander> {
    let present = present(encounter, shown);
    present.map(|b| Bystander::of(b, shown)).collect()
}

/// The places in [`around`] of those that are in the way of a judged vehicle in `states`, step by step.
///
/// An episode has the two judged vehicles alone: nobody in it reacts to the traffic around, nor the other way round.
pub(super) fn in_the_way(encounter: &Encounter, shown: u32, states: &[[State; 2]]) -> Vec<usize> {
    let near = |bystander: &Participant| {
        states.iter().zip(0..).any(|(both, step)| {
            let Some(recorded) = bystander.recorded(step) else {
                return false;
            };
            let theirs = OrientedBox::new(bystander.route.pose(recorded.s), bystander.footprint);
            Role::BOTH.iter().zip(both).any(|(&role, state)| {
                let pose: Pose = encounter.judged(role).route.pose(state.s);
                OrientedBox::new(pose, Footprint::PAPER).separation(&theirs) < CLEAR
            })
        })
    };
    let places = present(encounter, shown).enumerate();
    places.filter(|(_, b)| near(b)).map(|(i, _)| i).collect()
}

fn present(encounter: &Encounter, shown: u32) -> impl Iterator<Item = &Participant> {
    let bystanders = encounter.participants.iter().skip(Role::BOTH.len());
    bystanders.filter(move |bystander| bystander.appears <= shown)
}
