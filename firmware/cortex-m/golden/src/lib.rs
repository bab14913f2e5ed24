//! The golden file: scenes, what is observed in them, and what the host decides, as 32-bit words.
//!
//! Scene after scene: the number of others and of steps, a route for each vehicle with the ego's first
//! ([`ROUTE`] words each), then for each step the observation ([`QUESTION`] words) and the decision
//! ([`ANSWER`] words). Host and image read it by this code. Numbers are bit patterns, so that what is
//! no number is asked about as well.
#![no_std]
#![forbid(unsafe_code)]

mod answer;

pub use answer::{ANSWER, answer};

use cede_controller::geometry::unit;
use cede_controller::{
    Contract, Controller, Footprint, Observation, Part, Path, Point, Policy, Pose, RightOfWay,
    Route, RouteError, Scene, SceneError, Vehicle,
};

/// Others in a scene, at most.
pub const OTHERS: usize = 8;
/// Points of a route, at most.
pub const POINTS: usize = 8;
/// Words of a route: length and width of its vehicle, who goes first (0 unsettled, 1 the ego, 2 the
/// other), the number of points, and the points.
pub const ROUTE: usize = 4 + 2 * POINTS;
/// Words of a vehicle: whether it is there, s, speed, x, y, and the direction's x and y.
pub const VEHICLE: usize = 7;
/// Words of an observation: the ego and the others.
pub const QUESTION: usize = VEHICLE * (1 + OTHERS);

/// A scene of the golden file.
#[derive(Clone, Copy, Debug)]
pub struct Golden<'a> {
    routes: &'a [[u32; ROUTE]],
    /// Observation and decision of each step.
    pub steps: &'a [[u32; QUESTION + ANSWER]],
}

impl<'a> Golden<'a> {
    /// Takes a scene from the front of `words`; `None` at their end.
    pub fn next(words: &mut &'a [u32]) -> Option<Self> {
        let (&[others, steps], rest) = words.split_first_chunk()?;
        let (routes, rest) = rest.split_at_checked((usize::try_from(others).ok()? + 1) * ROUTE)?;
        let steps = usize::try_from(steps).ok()? * (QUESTION + ANSWER);
        let (steps, rest) = rest.split_at_checked(steps)?;
        *words = rest;
        Some(Self {
            routes: routes.as_chunks().0,
            steps: steps.as_chunks().0,
        })
    }

    /// The scene, with nobody's right of way: see [`Golden::settle`]. It is the result of one call, so that
    /// it is made where it is to be and needs its room once.
    ///
    /// # Errors
    /// If the routes make none.
    pub fn scene(&self) -> Result<Scene<OTHERS>, SceneError> {
        let Some((mine, theirs)) = self.routes.split_first() else {
            return Err(SceneError::Others);
        };
        let Ok(route) = &route(mine) else {
            return Err(SceneError::Others);
        };
        let footprint = footprint(mine);
        let ego = Path { route, footprint };
        let others = theirs.iter().map_while(other);
        Scene::gather(ego, others)
    }

    /// Says in `scene` who goes first.
    pub fn settle(&self, scene: &mut Scene<OTHERS>) {
        for (i, [_, _, right_of_way, ..]) in self.routes.iter().skip(1).enumerate() {
            let right_of_way = match right_of_way {
                1 => RightOfWay::Ego,
                2 => RightOfWay::Other,
                _ => RightOfWay::Unsettled,
            };
            scene.set_right_of_way(i, right_of_way);
        }
    }
}

/// The controller that is asked: within the worst-case contract, as the left-turner.
#[must_use]
#[inline(never)]
pub fn controller<'w>(policy: &Policy<'w>) -> Controller<'w, OTHERS> {
    Controller::new(*policy, Contract::WORST_CASE, Part::Left)
}

fn other(words: &[u32; ROUTE]) -> Option<(Route<POINTS>, Footprint)> {
    let route = route(words).ok()?;
    Some((route, footprint(words)))
}

#[inline(never)]
fn route(words: &[u32; ROUTE]) -> Result<Route<POINTS>, RouteError> {
    let [_, _, _, count, points @ ..] = words;
    let count = usize::try_from(*count).unwrap_or(POINTS);
    let points = points.as_chunks().0.iter().take(count);
    Route::new(points.map(|[x, y]| point(*x, *y)))
}

fn footprint([length, width, ..]: &[u32; ROUTE]) -> Footprint {
    Footprint {
        length: f32::from_bits(*length),
        width: f32::from_bits(*width),
    }
}

/// What the words of a step observe. Not inlined: it would take its room twice.
#[must_use]
#[inline(never)]
pub fn observation(words: &[u32; QUESTION]) -> Observation<OTHERS> {
    let nobody = [0; VEHICLE];
    let (ego, others) = words.as_chunks().0.split_first().unwrap_or((&nobody, &[]));
    let mut observation = Observation {
        ego: vehicle(ego),
        others: [None; OTHERS],
    };
    for (place, words) in observation.others.iter_mut().zip(others) {
        *place = (words[0] != 0).then(|| vehicle(words));
    }
    observation
}

fn vehicle(words: &[u32; VEHICLE]) -> Vehicle {
    let [_, s, speed, x, y, dx, dy] = *words;
    Vehicle {
        s: f32::from_bits(s),
        speed: f32::from_bits(speed),
        pose: Pose {
            position: point(x, y),
            direction: unit(f32::from_bits(dx), f32::from_bits(dy)),
        },
    }
}

fn point(x: u32, y: u32) -> Point {
    Point::new(f32::from_bits(x), f32::from_bits(y))
}
