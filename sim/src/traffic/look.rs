//! Who touches whom, and who is ahead.

use super::car::Car;
use super::obstacle::Obstacle;
use cede_controller::OrientedBox;
use cede_controller::kinematics::State;

/// As far (m) as anybody looks ahead.
const SIGHT: f32 = 60.0;
/// Room (m) to either side that a vehicle wants in its way.
const ROOM: f32 = 0.2;
/// Whoever goes the same way to within this (its cosine) is a leader.
const SAME_WAY: f32 = 0.7;
/// As far (m), at least, as a look ahead goes on at once.
const PIECE: f32 = 0.25;

/// Whoever enters leaves everybody the way on which he stops: after so many seconds, braking like that (m/s²), and with so many
/// metres left.
const REACTION: f32 = 1.0;
const BRAKING: f32 = 3.0;
const STANDSTILL: f32 = 2.0;

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
        let Some((obstacle, along)) = in_way(own, other) else {
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

/// `other` as an obstacle on the way of `own`, and the cosine between their directions where they would touch.
fn in_way(own: &Car<'_>, other: &Car<'_>) -> Option<(Obstacle, f32)> {
    let (route, from) = (&own.vehicle.route, own.state().s);
    let body = other.body();
    if (body.centre - own.body().centre).norm_squared() > SIGHT * SIGHT
        || route.project(body.centre) <= from
    {
        return None;
    }
    let mut wide = own.vehicle.footprint;
    wide.width += 2.0 * ROOM;
    if OrientedBox::new(route.pose(from), wide).overlaps(&body) {
        // Side by side: it is in the way only if it is touched.
        wide = own.vehicle.footprint;
    }
    let mut s = from;
    while s < from + SIGHT {
        let there = OrientedBox::new(route.pose(s), wide);
        let apart = there.separation(&body);
        if apart <= 0.0 {
            let along = there.direction.dot(&body.direction);
            let obstacle = Obstacle {
                gap: s - from,
                speed: other.state().v * along.max(0.0),
            };
            return Some((obstacle, along));
        }
        s += PIECE.max(0.5 * apart);
    }
    None
}

/// Whether the way on which `index`, which enters, would stop is apart from those of all who are not where their record has
/// them.
pub(super) fn has_room(cars: &[Car<'_>], index: usize, step: u32) -> bool {
    let entering = &cars[index];
    let Some(first) = entering.first() else {
        return true;
    };
    let displaced = |car: &&Car<'_>| car.is_there() && (car.driven || car.is_late(step));
    let mut others = cars.iter().filter(displaced);
    others.all(|other| {
        stopping(other, other.state())
            .all(|there| stopping(entering, first).all(|here| !here.overlaps(&there)))
    })
}

/// The body of `car` every metre from `state` to where it stops.
fn stopping(car: &Car<'_>, state: State) -> impl Iterator<Item = OrientedBox> {
    let reach = state.v * (REACTION + 0.5 * state.v / BRAKING) + STANDSTILL;
    (0..=reach as u32).map(move |metre| {
        let pose = car.vehicle.route.pose(state.s + metre as f32);
        OrientedBox::new(pose, car.vehicle.footprint)
    })
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
