//! What the sensors report.

use crate::geometry::Pose;
use crate::junction::{Class, PathId};

/// A vehicle as it is sensed on a route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vehicle {
    /// Arc length (m) of its footprint's centre along its route, from the route's start to its end.
    pub s: f32,
    /// Speed along its route in m/s, in [−[`Vehicle::REVERSING`], [`Vehicle::MAX_SPEED`]]; what is below 0 counts as 0.
    pub speed: f32,
    /// Where it is and where it points; the direction is a unit vector to within 10 %
    /// ([`crate::geometry::unit`] takes it as it is sensed).
    pub pose: Pose,
}

impl Vehicle {
    /// Highest speed in m/s.
    pub const MAX_SPEED: f32 = 100.0;
    /// A vehicle at rest may be sensed to roll backwards at this speed (m/s) at most.
    pub const REVERSING: f32 = 1.0;
}

/// Most paths between which a track may be undecided.
pub const MAX_CANDIDATES: usize = 4;

/// A path that a tracked vehicle may be on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The path.
    pub path: PathId,
    /// Arc length (m) of the footprint's centre along that path.
    pub s: f32,
}

/// Another vehicle, as tracking reports it.
///
/// It is known by its number from one observation to the next. Nobody knows where it will turn: all
/// its candidate paths count until the caller leaves one out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// The number that tracking gave it.
    pub number: u16,
    /// What it is; its candidates are paths of this class.
    pub class: Class,
    /// Speed in m/s; see [`Vehicle::speed`].
    pub speed: f32,
    /// Where it is and where it points.
    pub pose: Pose,
    candidates: [Option<Candidate>; MAX_CANDIDATES],
}

impl Track {
    /// A car with one candidate, `path`, on which it is at `vehicle.s`.
    #[must_use]
    pub const fn on(number: u16, path: PathId, vehicle: Vehicle) -> Self {
        let Vehicle { s, speed, pose } = vehicle;
        Self {
            number,
            class: Class::Car,
            speed,
            pose,
            candidates: [Some(Candidate { path, s }), None, None, None],
        }
    }

    /// The same track of another class.
    #[must_use]
    pub const fn class(mut self, class: Class) -> Self {
        self.class = class;
        self
    }

    /// The same track that may also be on `path`, at arc length `s` (m) there; `None` if it has
    /// [`MAX_CANDIDATES`] candidates already.
    #[must_use]
    pub fn or(mut self, path: PathId, s: f32) -> Option<Self> {
        let free = self.candidates.iter_mut().find(|place| place.is_none())?;
        *free = Some(Candidate { path, s });
        Some(self)
    }

    /// The paths that it may be on.
    pub fn candidates(&self) -> impl Iterator<Item = Candidate> + '_ {
        self.candidates.iter().flatten().copied()
    }

    /// Whether `path` is one of them.
    pub(crate) fn may_be_on(&self, path: PathId) -> bool {
        self.candidates().any(|candidate| candidate.path == path)
    }

    /// As a vehicle on one of its candidates.
    pub(crate) const fn vehicle(&self, candidate: Candidate) -> Vehicle {
        Vehicle {
            s: candidate.s,
            speed: self.speed,
            pose: self.pose,
        }
    }
}

/// How much of a path the sensors see at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// The path.
    pub path: PathId,
    /// Arc length (m) from which they see it, in [0, length]: whoever has its centre there or beyond, towards the path's end, is
    /// certainly among the tracks. Before it somebody may be.
    pub from: f32,
    /// Nobody out of sight is faster than this (m/s), in (0, [`Vehicle::MAX_SPEED`]], nor than the contract's `other.max_speed`.
    pub speed: f32,
}

/// What the sensors report at one moment: the ego, and every other vehicle that is seen, in any order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation<'a> {
    /// The vehicle that is driven.
    pub ego: Vehicle,
    /// The others. One that is not among them any more counts as not seen: it is expected to be somewhere until
    /// it has certainly left.
    pub tracks: &'a [Track],
}
