//! The golden file: junctions, what is observed in them, and what the host decides, as 32-bit words.
//!
//! Junction after junction: the number of others and of steps, a route for each vehicle with the ego's first
//! ([`ROUTE`] words each), then for each step the observation ([`QUESTION`] words) and the decision
//! ([`ANSWER`] words). Host and image read it by this code. Numbers are bit patterns, so that what is
//! no number is asked about as well.
#![no_std]
#![forbid(unsafe_code)]

mod answer;

pub use answer::{ANSWER, answer};

use cede_controller::geometry::unit;
use cede_controller::{
    Class, Contract, Drive, Footprint, Instant, Junction, Observation, Part, PathId, Point, Policy,
    Pose, Route, RouteError, Track, Vehicle,
};

/// Others in a junction, at most.
pub const OTHERS: usize = 8;
/// Points of a route, at most.
pub const POINTS: usize = 8;
/// Words of a route: length and width of its vehicle, who goes first (0 unsettled, 1 the ego, 2 the
/// other), the number of points, and the points.
pub const ROUTE: usize = 4 + 2 * POINTS;
/// Words of a vehicle: 1 and its track number, or 0 if it is not there; s, speed, x, y, and the direction's x and y.
pub const VEHICLE: usize = 7;
/// Words of an observation: when it is made, in ms; the ego and the others.
pub const QUESTION: usize = 1 + VEHICLE * (1 + OTHERS);

/// A path for each vehicle; the ego's, which comes first, can be entered.
pub type Site = Junction<{ OTHERS + 1 }, { POINTS * (OTHERS + 1) }, 1>;

/// The ego's path.
pub const EGO: PathId = PathId::new(0);

/// A junction of the golden file.
#[derive(Clone, Copy, Debug)]
pub struct Golden<'a> {
    routes: &'a [[u32; ROUTE]],
    /// Observation and decision of each step.
    pub steps: &'a [[u32; QUESTION + ANSWER]],
}

impl<'a> Golden<'a> {
    /// Takes a junction from the front of `words`; `None` at their end.
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

    /// The junction; `None` if the routes make none.
    #[must_use]
    pub fn site(&self) -> Option<Site> {
        let mut builder = Site::builder();
        for words in self.routes {
            let path = builder.path(&route(words).ok()?, Class::Car, footprint(words));
            let path = path.ok()?;
            match words[2] {
                1 => builder.right_of_way(EGO, path).ok()?,
                2 => builder.right_of_way(path, EGO).ok()?,
                _ => {}
            }
        }
        builder.build().ok()
    }
}

/// What is asked: within the worst-case contract, as the left-turner.
#[must_use]
pub const fn drive<'w>(policy: &Policy<'w>) -> Drive<'w> {
    Drive::new(*policy, Contract::WORST_CASE, Part::Left)
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

/// What the words of a step observe.
#[derive(Clone, Debug)]
pub struct Seen {
    /// When.
    pub now: Instant,
    ego: Vehicle,
    tracks: [Track; OTHERS],
    /// As many are there.
    count: usize,
}

impl Seen {
    /// Reads the words of a step. Not inlined: it would take its room twice.
    #[must_use]
    #[inline(never)]
    pub fn read([now, vehicles @ ..]: &[u32; QUESTION]) -> Self {
        let nobody = [0; VEHICLE];
        let vehicles = vehicles.as_chunks().0;
        let (ego, others) = vehicles.split_first().unwrap_or((&nobody, &[]));
        let mut seen = Self {
            now: Instant::from_millis((*now).into()),
            ego: vehicle(ego),
            tracks: [Track::on(0, EGO, vehicle(&nobody)); OTHERS],
            count: 0,
        };
        for (path, words) in (1..).map(PathId::new).zip(others) {
            let number = words[0].checked_sub(1);
            if let (Some(number), Some(place)) = (number, seen.tracks.get_mut(seen.count)) {
                *place = Track::on(number as u16, path, vehicle(words));
                seen.count += 1;
            }
        }
        seen
    }

    /// The observation.
    #[must_use]
    pub fn observation(&self) -> Observation<'_> {
        Observation {
            ego: self.ego,
            tracks: self.tracks.get(..self.count).unwrap_or(&[]),
        }
    }
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
