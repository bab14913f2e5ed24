//! An encounter: two vehicles whose routes conflict, as recorded, and the traffic around them.

use crate::rights::{Entry, Rights};
pub use crate::role::{Manoeuvre, Role};
use cede_controller::{ConflictKind, Footprint, Point, Route};

/// A route in simulation; recorded tracks are simplified to fit (tolerance 1 cm).
pub type SimRoute = Route<128>;

/// Names an encounter within a data set.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EncounterId {
    /// The site, as in `EP0`; synthetic sites have names of their own.
    pub site: String,
    /// Number of the recording file.
    pub file: u16,
    /// Track of the left-turner.
    pub left: u32,
    /// Track of the other.
    pub other: u32,
}

/// A recorded state along the route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Arc length in metres.
    pub s: f32,
    /// Speed in m/s, never negative.
    pub v: f32,
    /// Acceleration over the step that follows, in m/s².
    pub a: f32,
}

/// A vehicle of an encounter, with what it did in the recording.
#[derive(Clone, Debug)]
pub struct Participant {
    /// Its number in the recording.
    pub track: u32,
    /// What it does at the intersection.
    pub manoeuvre: Manoeuvre,
    /// What it finds where it enters the intersection; unknown for bystanders.
    pub entry: Entry,
    /// Its path.
    pub route: SimRoute,
    /// Its recorded size.
    pub footprint: Footprint,
    /// Arc length (m) at which it has reached the conflict point (5 m rule); infinite for bystanders.
    pub conflict_s: f32,
    /// Step, counted from the encounter's start, of `record[0]`; 0 for the two judged vehicles.
    pub appears: u32,
    /// One sample a step from `appears` to the end of its track.
    pub record: Vec<Sample>,
}

impl Participant {
    /// What was recorded at `step` of the encounter; `None` before it appears and after its track's end.
    #[must_use]
    pub fn recorded(&self, step: u32) -> Option<Sample> {
        let index = step.checked_sub(self.appears)?;
        self.record.get(index as usize).copied()
    }
}

/// Two vehicles whose routes conflict, as recorded, and the traffic around them.
#[derive(Clone, Debug)]
pub struct Encounter {
    /// Its name.
    pub id: EncounterId,
    /// How the two routes conflict.
    pub kind: ConflictKind,
    /// Time of step 0 in the recording, in milliseconds.
    pub start_ms: u64,
    /// Recorded length l_GT in steps, at least 1: until the first of the two reached its conflict point.
    pub steps: u32,
    /// First crossing of the two recorded polylines.
    pub conflict_point: Point,
    /// Who reached the conflict point first.
    pub first: Role,
    /// Who goes first by the rules of the road.
    pub rights: Rights,
    /// Time between the two arrivals at the conflict point in seconds.
    pub pet: f32,
    /// The two judged vehicles, [`Role::Left`] first, then the bystanders.
    pub participants: Vec<Participant>,
}

impl Encounter {
    /// The judged vehicle in `role`.
    #[must_use]
    pub fn judged(&self, role: Role) -> &Participant {
        &self.participants[role as usize]
    }
}
