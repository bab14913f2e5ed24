//! Who touches whom, and who is ahead.

use super::car::Car;
use super::obstacle::Obstacle;
use cede_controller::{OrientedBox, Pose};
use cede_data::Participant;

/// As far (m) as anybody looks ahead.
const SIGHT: f32 = 60.0;
/// Room (m) to either side that a vehicle wants in its way.
const ROOM: f32 = 0.2;
/// Whoever goes the same way to within this (its cosine) is a leader.
const SAME_WAY: f32 = 0.7;

/// Seconds and metres that whoever enters keeps from others.
const HEADWAY: f32 = 1.0;
const STANDSTILL: f32 = 4.0;

/// What is ahead of a vehicle on its route.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Ahead {
    /// The nearest that goes the same way.
    pub(super) leader: Option<Obstacle>,
    /// The nearest that is not where its record has it, wherever it goes.
    pub(super) obstacle: Option<Obstacle>,
}

/// What is ahead of `ego` at `step`.
pub(super) fn ahead(cars: &[Car<'_>], there: &[usize], ego: usize, step: u32) -> Ahead {
    let mut ahead = Ahead::default();
    let own = &cars[ego];
    for other in there
        .iter()
        .filter(|&&index| index != ego)
        .map(|&index| &cars[index])
    {
        let pose = other.vehicle.route.pose(other.state().s);
        let Some((obstacle, along)) = in_way(own, other.vehicle, pose, other.state().v) else {
            continue;
        };
        let nearer = |known: Option<Obstacle>| known.is_none_or(|known| obstacle.gap < known.gap);
        if along > SAME_WAY && nearer(ahead.leader) {
            ahead.leader = Some(obstacle);
        }
        if (other.driven || other.is_late(step)) && nearer(ahead.obstacle) {
            ahead.obstacle = Some(obstacle);
        }
    }
    ahead
}

/// The vehicle at `pose` as an obstacle on the route of `own`, and the cosine between their directions.
fn in_way(own: &Car<'_>, other: &Participant, pose: Pose, speed: f32) -> Option<(Obstacle, f32)> {
    let (route, state) = (&own.vehicle.route, own.state());
    let centre = pose.position;
    let here = route.pose(state.s).position;
    if (centre - here).norm_squared() > SIGHT * SIGHT {
        return None;
    }
    let s = route.project(centre);
    let on = route.pose(s);
    let along = on.direction.dot(&pose.direction);
    let across = on.direction.perp(&pose.direction).abs();
    let body = other.footprint;
    let half_length = 0.5 * (body.length * along.abs() + body.width * across);
    let half_width = 0.5 * (body.length * across + body.width * along.abs());
    let aside = on.direction.perp(&(centre - on.position)).abs();
    if s <= state.s || aside > half_width + 0.5 * own.vehicle.footprint.width + ROOM {
        return None;
    }
    let gap = s - half_length - state.s - 0.5 * own.vehicle.footprint.length;
    let obstacle = Obstacle {
        gap,
        speed: speed * along.max(0.0),
    };
    Some((obstacle, along))
}

/// Whether nobody is where `index` enters who is not where his record has him, nor right ahead.
pub(super) fn has_room(cars: &[Car<'_>], index: usize, step: u32) -> bool {
    let entering = &cars[index];
    let Some(first) = entering.vehicle.record.first() else {
        return true;
    };
    let mut footprint = entering.vehicle.footprint;
    footprint.length += 2.0 * HEADWAY * first.v + STANDSTILL;
    let body = OrientedBox::new(entering.vehicle.route.pose(first.s), footprint);
    let displaced = |car: &&Car<'_>| car.is_there() && (car.driven || car.is_late(step));
    !cars
        .iter()
        .filter(displaced)
        .any(|car| car.body().overlaps(&body))
}

/// The pairs of `there` that touch, in order.
pub(super) fn touching(cars: &[Car<'_>], there: &[usize]) -> Vec<[usize; 2]> {
    let bodies: Vec<_> = there.iter().map(|&index| cars[index].body()).collect();
    let mut pairs = Vec::new();
    for j in 1..there.len() {
        for i in 0..j {
            if bodies[i].overlaps(&bodies[j]) {
                pairs.push([there[i], there[j]]);
            }
        }
    }
    pairs
}
