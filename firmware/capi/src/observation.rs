//! What the sensors report.

use crate::memory::{Plain, read, slice};
use crate::status::cede_status;
use cede_controller::geometry::unit;
use cede_controller::{Class, MAX_CANDIDATES, Observation, PathId, Point, Pose, Track, Vehicle};
use heapless::Vec;

/// Most tracks of an observation.
pub const CEDE_MAX_TRACKS: usize = 24;
/// Most paths between which a track may be undecided.
pub const CEDE_MAX_CANDIDATES: usize = 4;

const _: () = assert!(CEDE_MAX_CANDIDATES == MAX_CANDIDATES);

/// A car or anything of its size.
pub const CEDE_CLASS_CAR: u8 = 0;
/// A lorry or a bus.
pub const CEDE_CLASS_LORRY: u8 = 1;
/// A bicycle or a motorcycle.
pub const CEDE_CLASS_BICYCLE: u8 = 2;
/// Somebody on foot on a crossing, who may turn back at any time.
pub const CEDE_CLASS_PEDESTRIAN: u8 = 3;

/// A point in m, in any fixed frame of the plane: x east, y north.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct cede_point {
    /// East.
    pub x: f32,
    /// North.
    pub y: f32,
}

/// Where a vehicle is and where it points.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct cede_pose {
    /// Centre of the footprint in m.
    pub position: cede_point,
    /// Direction of the heading: a vector of length 1, to within 10 %.
    pub direction: cede_point,
}

/// A vehicle as it is sensed on a path.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct cede_vehicle {
    /// Arc length in m of the footprint's centre along the path.
    pub s: f32,
    /// Speed in m/s along the path, in [-1, 100].
    pub speed: f32,
    /// Where it is and where it points.
    pub pose: cede_pose,
}

/// A path that a track may be on.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct cede_candidate {
    /// Arc length in m along that path.
    pub s: f32,
    /// Number of the path.
    pub path: u8,
    /// Ignored.
    pub reserved: [u8; 3],
}

/// Another vehicle, as tracking reports it. It is known by its number from one observation to the next. All its candidates
/// count until the caller leaves one out.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct cede_track {
    /// The number that tracking gave it.
    pub number: u16,
    /// CEDE_CLASS_CAR, CEDE_CLASS_LORRY or CEDE_CLASS_BICYCLE; its candidates are paths of this class.
    pub vehicle_class: u8,
    /// How many candidates there are, 1 to CEDE_MAX_CANDIDATES.
    pub candidate_count: u8,
    /// Speed in m/s, in [-1, 100].
    pub speed: f32,
    /// Where it is and where it points.
    pub pose: cede_pose,
    /// The paths that it may be on.
    pub candidates: [cede_candidate; CEDE_MAX_CANDIDATES],
}

/// What the sensors report at one moment. A vehicle that is no longer among the tracks counts as not seen: it is expected
/// to be somewhere until it has certainly left.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct cede_observation {
    /// The vehicle that is driven.
    pub ego: cede_vehicle,
    /// The others, in any order; may be null if there are none.
    pub tracks: *const cede_track,
    /// How many they are, up to CEDE_MAX_TRACKS.
    pub track_count: u32,
}

// SAFETY: numbers.
unsafe impl Plain for cede_point {}
// SAFETY: numbers.
unsafe impl Plain for cede_vehicle {}
// SAFETY: numbers.
unsafe impl Plain for cede_track {}
// SAFETY: numbers and a pointer, which is checked before it is used.
unsafe impl Plain for cede_observation {}

/// An observation of one's own: a copy of the caller's. It is large, so there is one, and it is filled where it is.
pub(crate) struct Seen {
    ego: Vehicle,
    tracks: Vec<Track, CEDE_MAX_TRACKS>,
}

impl Seen {
    /// What cannot be trusted: the controller carries on with its plan.
    pub(crate) fn nothing() -> Self {
        let nowhere = cede_vehicle {
            s: f32::NAN,
            ..cede_vehicle::default()
        };
        Self {
            ego: vehicle(&nowhere),
            tracks: Vec::new(),
        }
    }

    /// Becomes a copy of what is observed; remains nothing if that cannot be read.
    ///
    /// # Safety
    /// As [`read`] and [`slice`], of the tracks as well.
    pub(crate) unsafe fn copy(
        &mut self,
        observation: *const cede_observation,
    ) -> Result<(), cede_status> {
        // SAFETY: by the caller's contract.
        let seen = unsafe { read(observation) }?;
        if seen.track_count as usize > CEDE_MAX_TRACKS {
            return Err(cede_status::TooManyTracks);
        }
        // SAFETY: by the caller's contract.
        let copied = self.copy_tracks(unsafe { slice(seen.tracks, seen.track_count) }?);
        match copied {
            Ok(()) => self.ego = vehicle(&seen.ego),
            Err(_) => self.tracks.clear(),
        }
        copied
    }

    fn copy_tracks(&mut self, tracks: &[cede_track]) -> Result<(), cede_status> {
        for given in tracks {
            let known = self.tracks.push(track(given)?);
            known.map_err(|_| cede_status::TooManyTracks)?;
        }
        Ok(())
    }

    pub(crate) fn observation(&self) -> Observation<'_> {
        Observation {
            ego: self.ego,
            tracks: &self.tracks,
        }
    }
}

fn track(given: &cede_track) -> Result<Track, cede_status> {
    let count = usize::from(given.candidate_count);
    let candidates = given.candidates.get(..count);
    let Some([first, rest @ ..]) = candidates else {
        return Err(cede_status::CandidateCount);
    };
    let vehicle = vehicle(&cede_vehicle {
        s: first.s,
        speed: given.speed,
        pose: given.pose,
    });
    let first = Track::on(given.number, PathId::new(first.path), vehicle);
    let mut track = first.class(class(given.vehicle_class)?);
    for candidate in rest {
        let more = track.or(PathId::new(candidate.path), candidate.s);
        track = more.ok_or(cede_status::CandidateCount)?;
    }
    Ok(track)
}

fn vehicle(given: &cede_vehicle) -> Vehicle {
    let cede_pose {
        position,
        direction,
    } = given.pose;
    Vehicle {
        s: given.s,
        speed: given.speed,
        pose: Pose {
            position: point(&position),
            direction: unit(direction.x, direction.y),
        },
    }
}

pub(crate) fn point(given: &cede_point) -> Point {
    Point::new(given.x, given.y)
}

pub(crate) fn class(number: u8) -> Result<Class, cede_status> {
    match number {
        CEDE_CLASS_CAR => Ok(Class::Car),
        CEDE_CLASS_LORRY => Ok(Class::Lorry),
        CEDE_CLASS_BICYCLE => Ok(Class::Bicycle),
        CEDE_CLASS_PEDESTRIAN => Ok(Class::Pedestrian),
        _ => Err(cede_status::UnknownChoice),
    }
}

pub(crate) fn class_number(class: Class) -> u8 {
    match class {
        Class::Car => CEDE_CLASS_CAR,
        Class::Lorry => CEDE_CLASS_LORRY,
        Class::Bicycle => CEDE_CLASS_BICYCLE,
        Class::Pedestrian => CEDE_CLASS_PEDESTRIAN,
        _ => u8::MAX,
    }
}

pub(crate) fn pose(of: &Pose) -> cede_pose {
    cede_pose {
        position: cede_point {
            x: of.position.x,
            y: of.position.y,
        },
        direction: cede_point {
            x: of.direction.x,
            y: of.direction.y,
        },
    }
}
