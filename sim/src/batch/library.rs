//! Encounters prepared for stepping: all routes as one list of segments, all recorded SVOs as one list of angles.

use cede_controller::geometry::{Footprint, Point, Vector, length};
use cede_controller::kinematics::State;
use cede_controller::policy::svo::{self, svo};
use cede_data::encounter::{Encounter, Participant, Role};
use thiserror::Error;

/// Why encounters cannot be stepped in a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum LibraryError {
    /// There is none.
    #[error("no encounters to simulate")]
    Empty,
    /// An encounter has fewer than two participants.
    #[error("encounter {0} has fewer than two vehicles")]
    TooFewVehicles(usize),
    /// A participant has no recorded state to start from.
    #[error("encounter {0} has a vehicle without a recorded state")]
    NoRecord(usize),
    /// Routes or records exceed 2³² entries.
    #[error("too many encounters for one batch")]
    TooLarge,
}

/// A straight stretch of a route.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) from: Point,
    pub(super) direction: Vector,
    /// Arc lengths at its ends (m); the last of a route ends at infinity.
    pub(super) start: f32,
    pub(super) end: f32,
}

/// A vehicle of an encounter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Track {
    pub(super) start: State,
    /// Its route's first segment.
    pub(super) first_segment: u32,
    /// Its conflict point (m); infinite for traffic.
    pub(super) conflict_s: f32,
    /// Step at which it appears, and the step at which its record has ended.
    pub(super) appears: u32,
    pub(super) leaves: u32,
    /// Its recorded accelerations start here in the library.
    pub(super) accelerations: u32,
}

/// An encounter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scenario {
    /// Recorded length l_GT in steps.
    pub(super) recorded: u32,
    /// Its tracks start here in the library, and there are so many.
    pub(super) tracks: u32,
    pub(super) vehicles: u32,
    /// The recorded SVOs of steps 0 to l_GT start here in the library.
    pub(super) svo: u32,
}

/// Encounters prepared for stepping, shared by all blocks of a batch.
#[derive(Clone, Debug)]
pub struct Library {
    pub(super) footprint: Footprint,
    /// Squared distance (m²) of two centres beyond which footprints cannot touch.
    pub(super) reach_squared: f32,
    scenarios: Vec<Scenario>,
    tracks: Vec<Track>,
    segments: Vec<Segment>,
    svo: Vec<f32>,
    accelerations: Vec<f32>,
}

impl Library {
    /// Prepares `encounters`; every vehicle has the same `footprint`, as in the paper's protocol.
    ///
    /// # Errors
    /// See [`LibraryError`].
    pub fn new(encounters: &[Encounter], footprint: Footprint) -> Result<Self, LibraryError> {
        // The diagonal, and a millimetre for rounding.
        let reach = length(&Vector::new(footprint.length, footprint.width)) + 1e-3;
        let mut library = Self {
            footprint,
            reach_squared: reach * reach,
            scenarios: Vec::with_capacity(encounters.len()),
            tracks: Vec::new(),
            segments: Vec::new(),
            svo: Vec::new(),
            accelerations: Vec::new(),
        };
        for (index, encounter) in encounters.iter().enumerate() {
            library.push(index, encounter)?;
        }
        if library.scenarios.is_empty() {
            return Err(LibraryError::Empty);
        }
        Ok(library)
    }

    /// Number of encounters; at least one.
    #[must_use]
    #[allow(clippy::len_without_is_empty, reason = "a library is never empty")]
    pub fn len(&self) -> usize {
        self.scenarios.len()
    }

    fn push(&mut self, index: usize, encounter: &Encounter) -> Result<(), LibraryError> {
        let [left, other, ..] = encounter.participants.as_slice() else {
            return Err(LibraryError::TooFewVehicles(index));
        };
        self.scenarios.push(Scenario {
            recorded: encounter.steps.max(1),
            tracks: offset(self.tracks.len())?,
            vehicles: offset(encounter.participants.len())?,
            svo: offset(self.svo.len())?,
        });
        self.push_svo(encounter.steps.max(1), left, other);
        for participant in &encounter.participants {
            self.push_track(index, participant)?;
        }
        Ok(())
    }

    /// The left-turner's SVO along the record, as [`super::Block`] keeps it along an episode.
    fn push_svo(&mut self, steps: u32, left: &Participant, other: &Participant) {
        let mut last = svo::FIRST;
        for step in 0..=steps as usize {
            let at = |p: &Participant| {
                let sample = p.record.get(step).or(p.record.last());
                sample.map_or((0.0, 0.0), |now| (now.v, p.conflict_s - now.s))
            };
            let ((v, d), (other_v, other_d)) = (at(left), at(other));
            last = svo(v, d, other_v, other_d, last);
            self.svo.push(last);
        }
    }

    fn push_track(&mut self, index: usize, vehicle: &Participant) -> Result<(), LibraryError> {
        let start = vehicle
            .record
            .first()
            .ok_or(LibraryError::NoRecord(index))?;
        self.tracks.push(Track {
            start: State {
                s: start.s,
                v: start.v,
            },
            first_segment: offset(self.segments.len())?,
            conflict_s: vehicle.conflict_s,
            appears: vehicle.appears,
            leaves: vehicle
                .appears
                .saturating_add(offset(vehicle.record.len())?),
            accelerations: offset(self.accelerations.len())?,
        });
        self.accelerations
            .extend(vehicle.record.iter().map(|sample| sample.a));
        let (points, arc) = (vehicle.route.points(), vehicle.route.arc());
        for (ends, arcs) in points.windows(2).zip(arc.windows(2)) {
            if let ([from, to], [start, end]) = (ends, arcs) {
                // The very expression of `Route::pose`, so that poses have the same bits.
                let direction = (*to - *from) * (1.0 / (end - start));
                self.segments.push(Segment {
                    from: *from,
                    direction,
                    start: *start,
                    end: *end,
                });
            }
        }
        if let Some(last) = self.segments.last_mut() {
            last.end = f32::INFINITY;
        }
        Ok(())
    }

    #[inline]
    pub(super) fn segment(&self, index: u32) -> &Segment {
        &self.segments[index as usize]
    }

    /// [`Library::len`], which fits: there are fewer scenarios than tracks.
    pub(super) fn count(&self) -> u32 {
        self.scenarios.len() as u32
    }

    #[inline]
    pub(super) fn scenario(&self, index: u32) -> &Scenario {
        &self.scenarios[index as usize]
    }

    /// Vehicle number `vehicle` of a scenario, if it has so many.
    #[inline]
    pub(super) fn track(&self, scenario: &Scenario, vehicle: usize) -> Option<&Track> {
        let vehicle = u32::try_from(vehicle).ok()?;
        (vehicle < scenario.vehicles).then(|| &self.tracks[(scenario.tracks + vehicle) as usize])
    }

    /// Conflict points (m along each route) of the two judged vehicles.
    pub(super) fn conflict_s(&self, scenario: &Scenario) -> [f32; 2] {
        [Role::Left, Role::Other].map(|role| {
            let track = self.track(scenario, role as usize);
            track.map_or(f32::INFINITY, |track| track.conflict_s)
        })
    }

    /// Recorded SVO (rad) number `index` of the library.
    #[inline]
    pub(super) fn svo(&self, index: u32) -> f32 {
        self.svo[index as usize]
    }

    /// Recorded acceleration (m/s²) of `track` at `step` of the encounter; 0 where there is none.
    #[inline]
    pub(super) fn acceleration(&self, track: &Track, step: u32) -> f32 {
        if (track.appears..track.leaves).contains(&step) {
            self.accelerations[(track.accelerations + (step - track.appears)) as usize]
        } else {
            0.0
        }
    }
}

fn offset(length: usize) -> Result<u32, LibraryError> {
    u32::try_from(length).map_err(|_| LibraryError::TooLarge)
}
