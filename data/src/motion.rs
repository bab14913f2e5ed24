//! From recorded states to a route and a motion along it.

use super::tracks::RawState;
use crate::encounter::{Sample, SimRoute};
use cede_controller::kinematics::{MAX_ACCELERATION, STEP, State, advance};
use cede_controller::{Point, RouteError};

/// Positions closer (m) to the one before are dropped: a vehicle at rest jitters.
const SPACING: f64 = 0.2;
/// The same where a standing vehicle's jitter must not make kinks.
const SMOOTH: f64 = 1.0;
/// A route may cut its track's corners by this much (m).
const TOLERANCE: f64 = 0.01;
/// Length (m) of the route of a vehicle that never moves.
const PARKED: f64 = 1.0;
/// Rate (1/s) at which the replayed position is drawn to the recorded one.
const PULL: f32 = 2.0;

/// The route of a vehicle with these recorded states, and its motion along it: one sample a state.
///
/// # Errors
/// When a coordinate is out of a route's range; the readers let none through.
pub(crate) fn motion(states: &[RawState]) -> Result<(SimRoute, Vec<Sample>), RouteError> {
    along_path(&spaced(states, SPACING), states)
}

/// The same on a route without the jitter of a vehicle that stands: its points are a metre apart, each ahead of the one
/// before.
///
/// # Errors
/// See [`motion`].
pub(crate) fn smooth_motion(states: &[RawState]) -> Result<(SimRoute, Vec<Sample>), RouteError> {
    let mut path: Vec<Vertex> = Vec::new();
    for vertex in spaced(states, SMOOTH) {
        let ahead = path.last().is_none_or(|last| {
            let [x, y] = [0, 1].map(|i| vertex.position[i] - last.position[i]);
            let heading = states.get(vertex.index).map_or(0.0, |state| state.heading);
            x * heading.cos() + y * heading.sin() > 0.5 * SMOOTH
        });
        if ahead {
            path.push(vertex);
        }
    }
    along_path(&path, states)
}

fn along_path(path: &[Vertex], states: &[RawState]) -> Result<(SimRoute, Vec<Sample>), RouteError> {
    let mut tolerance = TOLERANCE;
    loop {
        let kept = simplified(path, tolerance);
        match SimRoute::new(kept.iter().map(|vertex| single(vertex.position))) {
            Err(RouteError::TooManyPoints) => tolerance *= 2.0,
            Err(error) => return Err(error),
            Ok(route) => {
                let mut samples = along(&route, &kept, states);
                accelerations(&mut samples);
                return Ok((route, samples));
            }
        }
    }
}

fn single(point: [f64; 2]) -> Point {
    Point::new(point[0] as f32, point[1] as f32)
}

/// A point of a path, and which of the recorded states was there.
#[derive(Clone, Copy)]
struct Vertex {
    index: usize,
    position: [f64; 2],
}

/// The positions, at least `spacing` (m) apart; a parked vehicle's lead straight ahead.
fn spaced(states: &[RawState], spacing: f64) -> Vec<Vertex> {
    let mut path: Vec<Vertex> = Vec::new();
    for (index, state) in states.iter().enumerate() {
        let position = state.position();
        if path
            .last()
            .is_none_or(|last| distance(last.position, position) >= spacing)
        {
            path.push(Vertex { index, position });
        }
    }
    if let ([only], Some(state)) = (path.as_slice(), states.first()) {
        let [x, y] = only.position;
        let (sin, cos) = state.heading.sin_cos();
        path.push(Vertex {
            index: states.len(),
            position: [x + PARKED * cos, y + PARKED * sin],
        });
    }
    path
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Ramer–Douglas–Peucker: fewest points by which no dropped one is farther than `tolerance` away.
fn simplified(path: &[Vertex], tolerance: f64) -> Vec<Vertex> {
    let mut keep = vec![false; path.len()];
    let mut open = vec![(0, path.len().saturating_sub(1))];
    while let Some((from, to)) = open.pop() {
        let at = |i: usize| path[i].position;
        let off = |i: usize| distance_to_segment(at(i), at(from), at(to));
        let farthest = (from + 1..to).max_by(|&a, &b| off(a).total_cmp(&off(b)));
        if let Some(i) = farthest.filter(|&i| off(i) > tolerance) {
            open.extend([(from, i), (i, to)]);
        }
        for end in [from, to] {
            if let Some(keep) = keep.get_mut(end) {
                *keep = true;
            }
        }
    }
    let kept = path.iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(&vertex, _)| vertex).collect()
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
///
/// A state is projected on the segment whose ends the vehicle passed just
/// before and after it, not on the nearest: a route may come back close to
/// itself. Past the last vertex the route goes on straight.
fn along(route: &SimRoute, kept: &[Vertex], states: &[RawState]) -> Vec<Sample> {
    let mut samples: Vec<Sample> = Vec::with_capacity(states.len());
    let mut segment = 0;
    for (i, state) in states.iter().enumerate() {
        while segment + 2 < kept.len() && kept[segment + 1].index <= i {
            segment += 1;
        }
        let direction = route
            .pose(0.5 * (route.arc()[segment] + route.arc()[segment + 1]))
            .direction;
        let (ux, uy) = (f64::from(direction.x), f64::from(direction.y));
        let [ax, ay] = kept[segment].position;
        let ahead = ((state.x - ax) * ux + (state.y - ay) * uy) as f32;
        let ahead = if segment + 2 < kept.len() {
            ahead.min(route.arc()[segment + 1] - route.arc()[segment])
        } else {
            ahead
        };
        let last = samples.last().map_or(0.0, |sample| sample.s);
        samples.push(Sample {
            s: last.max(route.arc()[segment] + ahead),
            v: (state.vx * ux + state.vy * uy).max(0.0) as f32,
            a: 0.0,
        });
    }
    samples
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
