//! The trivial rule: the vehicle that is nearer to its conflict point goes, the other stops.

use super::right_of_way::CRUISE;
use super::{Driver, DriverFactory, View, right_of_way};
use crate::meeting::Meeting;
use cede_data::encounter::{Encounter, Role};

/// Whoever is nearer to its conflict point at the start goes; the other stops and waits.
#[derive(Clone, Copy, Debug)]
pub struct NearerFirst;

impl DriverFactory for NearerFirst {
    fn name(&self) -> &str {
        "nearer-first"
    }

    fn driver<'m>(&self, meeting: &'m Meeting<'_>, _: usize, _: u64) -> Box<dyn Driver + 'm> {
        Box::new(Decided {
            first: nearer(meeting.encounter),
            cruise: CRUISE,
        })
    }
}

/// The nearer of the two at the start; the left-turner if they are equally near.
fn nearer(encounter: &Encounter) -> Role {
    let distance = |role| {
        let vehicle = encounter.judged(role);
        vehicle.conflict_s - vehicle.record.first().map_or(0.0, |sample| sample.s)
    };
    if distance(Role::Left) <= distance(Role::Other) {
        Role::Left
    } else {
        Role::Other
    }
}

/// Drives as one who knows from the start who goes first.
pub(super) struct Decided {
    pub(super) first: Role,
    /// Speed (m/s) that a vehicle takes up where it may.
    pub(super) cruise: f32,
}

impl Driver for Decided {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        right_of_way::accelerate(view, self.first, self.cruise)
    }
}
