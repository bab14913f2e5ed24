//! What the controller lets in: every number in its range, and the pose where the path is.

use super::contract::Contract;
use crate::fault::{Fault, Field, InputFault, Subject};
use crate::geometry::{Point, Pose, distance};
use crate::headroom::Room;
use crate::junction::zone::INFLATION;
use crate::junction::{Class, PathId, Polyline, Route, Way};
use crate::observation::{Candidate, Track, Vehicle};
use crate::real::Real;

/// A direction whose cosine to its path is below this points elsewhere: 60°.
const ALIGNED: f32 = 0.5;

/// The shortest and the longest direction that counts as one.
const UNIT: [f32; 2] = [0.9, 1.1];

/// A vehicle whose numbers are in their ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Admitted {
    /// Its speed is not negative.
    pub(crate) vehicle: Vehicle,
    /// What is left of the offset from its path, and of its heading.
    pub(crate) pose: [Room; 2],
}

/// The ego.
///
/// # Errors
/// The first number that is out of its range.
pub(crate) fn ego(way: Way<'_>, contract: &Contract, vehicle: &Vehicle) -> Result<Admitted, Fault> {
    vehicle_on(way, contract, Subject::Ego, way.ego(), *vehicle)
}

/// The vehicle of `track` on one of its candidates.
///
/// # Errors
/// The first number that is out of its range.
pub(crate) fn track(
    way: Way<'_>,
    contract: &Contract,
    track: &Track,
    candidate: Candidate,
) -> Result<Admitted, Fault> {
    let subject = Subject::Track(track.number);
    let known = way
        .path(candidate.path)
        .filter(|path| path.class() == track.class);
    if known.is_none() {
        let last = way.paths().saturating_sub(1) as f32;
        let number = candidate.path.index() as f32;
        return Err(refused(subject, Field::Path, number, [0.0, last]));
    }
    vehicle_on(
        way,
        contract,
        subject,
        candidate.path,
        track.vehicle(candidate),
    )
}

/// The same number twice in one observation.
pub(crate) fn twice(number: u16) -> Fault {
    refused(
        Subject::Track(number),
        Field::Number,
        number.into(),
        [0.0, u16::MAX.into()],
    )
}

fn vehicle_on(
    way: Way<'_>,
    contract: &Contract,
    subject: Subject,
    path: PathId,
    mut vehicle: Vehicle,
) -> Result<Admitted, Fault> {
    let keep = |room: Room, field, value, range| {
        if room.holds() {
            Ok(room)
        } else {
            Err(refused(subject, field, value, range))
        }
    };
    let check = |field, value, range| keep(Room::between(value, range), field, value, range);
    let walks = (way.path(path)).is_some_and(|path| path.class() == Class::Pedestrian);
    let Some(line) = way.polyline(path) else {
        return Err(refused(
            subject,
            Field::Path,
            path.index() as f32,
            [0.0, 0.0],
        ));
    };
    let spare = contract.position_error + way.tolerance() + INFLATION;
    check(Field::ArcLength, vehicle.s, [-spare, line.length() + spare])?;
    check(
        Field::Speed,
        vehicle.speed,
        [-Vehicle::REVERSING, Vehicle::MAX_SPEED],
    )?;
    let most = Route::<2>::MAX_COORDINATE;
    check(
        Field::Position,
        largest(vehicle.pose.position),
        [-most, most],
    )?;
    let direction = vehicle.pose.direction;
    let norm = crate::geometry::length(&direction);
    check(Field::Direction, norm, UNIT)?;
    let there = line.pose(vehicle.s);
    let away = distance(&vehicle.pose.position, &there.position);
    let offset = Room::up_to(spare, away);
    let offset = keep(offset, Field::Offset, away, [0.0, spare])?;
    let cosine = aligned(line, (vehicle, there), spare) / norm;
    let heading = Room::cosine(ALIGNED, cosine);
    let heading = if walks {
        // It may turn back.
        Room::cosine(ALIGNED, 1.0)
    } else {
        keep(heading, Field::Heading, cosine, [ALIGNED, 2.0])?
    };
    vehicle.speed = Real::max(vehicle.speed, 0.0);
    Ok(Admitted {
        vehicle,
        pose: [offset, heading],
    })
}

/// How well the vehicle points along its path, which is like `there` where it is, and may have a kink within `spare` (m).
fn aligned(line: Polyline<'_>, (vehicle, there): (Vehicle, Pose), spare: f32) -> f32 {
    let cosine = |pose: Pose| vehicle.pose.direction.dot(&pose.direction);
    let mut best = cosine(there);
    if best < ALIGNED {
        for s in [vehicle.s - spare, vehicle.s + spare] {
            best = Real::max(best, cosine(line.pose(s)));
        }
    }
    best
}

/// The coordinate that is farther from 0; one that is not a number comes first.
fn largest(point: Point) -> f32 {
    if point.x.abs() <= point.y.abs() || point.y.is_nan() {
        point.y
    } else {
        point.x
    }
}

const fn refused(subject: Subject, field: Field, value: f32, [low, high]: [f32; 2]) -> Fault {
    Fault::Input(InputFault {
        subject,
        field,
        value,
        low,
        high,
    })
}
