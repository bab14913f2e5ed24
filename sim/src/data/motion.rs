//! From recorded states to a route and a motion along it.

use super::tracks::RawState;
use crate::driver::State;
use crate::encounter::{STEP, Sample, SimRoute};
use crate::kinematics::{MAX_ACCELERATION, advance};
use cede_controller::{Point, RouteError};

/// Positions closer (m) to the one before are dropped: a vehicle at rest jitters.
const SPACING: f64 = 0.2;
/// A route may cut its track's corners by this much (m).
const TOLERANCE: f64 = 0.01;
/// No vehicle covers more (m) in a step; the search for its place on its route ends there.
const REACH: f64 = 5.0;
/// Length (m) of the route of a vehicle that never moves.
const PARKED: f64 = 1.0;
/// Rate (1/s) at which the replayed position is drawn to the recorded one.
const PULL: f32 = 2.0;

/// The route of a vehicle with these recorded states, and its motion along it: one sample a state.
///
/// # Errors
/// When a coordinate is out of a route's range; the readers let none through.
pub(crate) fn motion(states: &[RawState]) -> Result<(SimRoute, Vec<Sample>), RouteError> {
    let route = route(states)?;
    let mut samples = along(&route, states);
    accelerations(&mut samples);
    Ok((route, samples))
}

fn route(states: &[RawState]) -> Result<SimRoute, RouteError> {
    let path = spaced(states);
    let mut tolerance = TOLERANCE;
    loop {
        let points = simplified(&path, tolerance);
        match SimRoute::new(points.into_iter().map(single)) {
            Err(RouteError::TooManyPoints) => tolerance *= 2.0,
            other => return other,
        }
    }
}

fn single(point: [f64; 2]) -> Point {
    Point::new(point[0] as f32, point[1] as f32)
}

/// The positions, at least [`SPACING`] apart; a parked vehicle's lead straight ahead.
fn spaced(states: &[RawState]) -> Vec<[f64; 2]> {
    let mut path: Vec<[f64; 2]> = Vec::new();
    for state in states {
        let position = state.position();
        if path
            .last()
            .is_none_or(|&last| distance(last, position) >= SPACING)
        {
            path.push(position);
        }
    }
    if let (&[[x, y]], Some(state)) = (path.as_slice(), states.first()) {
        let (sin, cos) = state.heading.sin_cos();
        path.push([x + PARKED * cos, y + PARKED * sin]);
    }
    path
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Ramer–Douglas–Peucker: fewest points by which no dropped one is farther than `tolerance` away.
fn simplified(path: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let mut keep = vec![false; path.len()];
    let mut open = vec![(0, path.len() - 1)];
    while let Some((from, to)) = open.pop() {
        (keep[from], keep[to]) = (true, true);
        let off = |i: usize| distance_to_segment(path[i], path[from], path[to]);
        let farthest = (from + 1..to).max_by(|&a, &b| off(a).total_cmp(&off(b)));
        if let Some(i) = farthest.filter(|&i| off(i) > tolerance) {
            open.push((from, i));
            open.push((i, to));
        }
    }
    let kept = path.iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(&point, _)| point).collect()
}

fn distance_to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let square = dx * dx + dy * dy;
    let share = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square;
    let share = if square > 0.0 {
        share.clamp(0.0, 1.0)
    } else {
        0.0
    };
    distance(p, [a[0] + dx * share, a[1] + dy * share])
}

/// Arc length and speed along the route; never backwards. Accelerations are still 0.
fn along(route: &SimRoute, states: &[RawState]) -> Vec<Sample> {
    let mut s = 0.0;
    let sample = |state: &RawState| {
        s = project(route, state.position(), s);
        let direction = route.pose(s as f32).direction;
        let v = state.vx * f64::from(direction.x) + state.vy * f64::from(direction.y);
        Sample {
            s: s as f32,
            v: v.max(0.0) as f32,
            a: 0.0,
        }
    };
    states.iter().map(sample).collect()
}

/// Arc length of the place on the route nearest to `p`, from `s` to [`REACH`] beyond it.
///
/// A route may come back close to itself; the bounded search keeps to the branch that is driven.
fn project(route: &SimRoute, p: [f64; 2], s: f64) -> f64 {
    let arc: Vec<f64> = route.arc().iter().map(|&a| f64::from(a)).collect();
    let first = arc.partition_point(|&a| a <= s).clamp(1, arc.len() - 1) - 1;
    let mut best = (f64::INFINITY, s);
    for i in first..arc.len() - 1 {
        if arc[i] > s + REACH {
            break;
        }
        let [a, b] = [route.points()[i], route.points()[i + 1]];
        let (ax, ay) = (f64::from(a.x), f64::from(a.y));
        let length = arc[i + 1] - arc[i];
        let (dx, dy) = (
            (f64::from(b.x) - ax) / length,
            (f64::from(b.y) - ay) / length,
        );
        let ahead = (p[0] - ax) * dx + (p[1] - ay) * dy;
        let ahead = ahead.clamp((s - arc[i]).clamp(0.0, length), length);
        let off = distance(p, [ax + dx * ahead, ay + dy * ahead]);
        if off < best.0 {
            best = (off, arc[i] + ahead);
        }
    }
    best.1
}

/// Sets the accelerations that, replayed by [`advance`], follow the samples.
///
/// Each step aims at the recorded speed of its end, and a little beyond it if
/// the replayed vehicle has fallen behind: recorded speeds and positions come
/// from a filter and do not quite integrate to one another. Within
/// ±[`MAX_ACCELERATION`], as the episodes are.
fn accelerations(samples: &mut [Sample]) {
    let Some(first) = samples.first() else { return };
    let mut state = State {
        s: first.s,
        v: first.v,
    };
    for i in 1..samples.len() {
        let next = samples[i];
        let behind = next.s - (state.s + 0.5 * (state.v + next.v) * STEP);
        let aim = (next.v + PULL * behind).max(0.0);
        let a = ((aim - state.v) / STEP).clamp(-MAX_ACCELERATION, MAX_ACCELERATION);
        samples[i - 1].a = a;
        state = advance(state, a);
    }
}
