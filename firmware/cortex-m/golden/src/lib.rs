//! The golden file: junctions, what is observed on the way through them, and what the host decides, as 32-bit words.
//!
//! Junction after junction: the number of others, of steps and of the contract, a route for each vehicle with the ego's
//! first ([`ROUTE`] words each), then for each step the question ([`QUESTION`] words) and the decision
//! ([`ANSWER`] words). Host and image read it by this code. Numbers are bit patterns, so that what is
//! no number is asked about as well.
#![no_std]
#![forbid(unsafe_code)]

mod answer;

pub use answer::{ANSWER, answer};

use cede_controller::geometry::unit;
use cede_controller::{
    Approach, Class, Contract, Drive, EnterError, Footprint, Instant, JunctionError, Observation,
    Part, PathId, Point, Policy, Pose, Priority, Route, RouteError, Track, Vehicle,
};

/// The paths of the ego and of each other; nobody but the ego is driven.
pub type Junction = cede_controller::Junction<{ 1 + OTHERS }, { (1 + OTHERS) * POINTS }, 1>;

/// Others at a junction, at most.
pub const OTHERS: usize = 8;
/// Points of a route, at most.
pub const POINTS: usize = 8;
/// Words before those of the routes.
pub const HEADER: usize = 3;
/// Words of a route: length and width of its vehicle, who has the right of way (0 unsettled, 1 the ego, 2 the
/// other), when it counts (0 if both arrive at once, 1 without signs, 2 by signs), the line (none, if it is no number), the
/// number of points, and the points.
pub const ROUTE: usize = 6 + 2 * POINTS;
/// Words of a vehicle: whether it is there, s, speed, x, y, and the direction's x and y.
pub const VEHICLE: usize = 7;
/// Words of a question: milliseconds of the clock, the ego and the others.
pub const QUESTION: usize = 1 + VEHICLE * (1 + OTHERS);

/// Why there is no junction.
#[derive(Clone, Copy, Debug)]
pub enum Wrong {
    /// A polyline is no route.
    Route(RouteError),
    /// The routes make no junction.
    Junction(JunctionError),
}

impl core::fmt::Display for Wrong {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Route(error) => error.fmt(f),
            Self::Junction(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for Wrong {}

/// A junction of the golden file.
#[derive(Clone, Copy, Debug)]
pub struct Golden<'a> {
    contract: u32,
    routes: &'a [[u32; ROUTE]],
    /// Observation and decision of each step.
    pub steps: &'a [[u32; QUESTION + ANSWER]],
}

impl<'a> Golden<'a> {
    /// Takes a junction from the front of `words`; `None` at their end.
    pub fn next(words: &mut &'a [u32]) -> Option<Self> {
        let (&[others, steps, contract], rest) = words.split_first_chunk::<HEADER>()?;
        let (routes, rest) = rest.split_at_checked((usize::try_from(others).ok()? + 1) * ROUTE)?;
        let steps = usize::try_from(steps).ok()? * (QUESTION + ANSWER);
        let (steps, rest) = rest.split_at_checked(steps)?;
        *words = rest;
        Some(Self {
            contract,
            routes: routes.as_chunks().0,
            steps: steps.as_chunks().0,
        })
    }

    /// Number 1 has a rule of precedence, number 2 as well that nothing is exact.
    const fn contract(&self) -> &'static Contract {
        match self.contract {
            1 => &Contract::ALL_WAY_STOP,
            2 => &INEXACT,
            _ => &Contract::WORST_CASE,
        }
    }

    /// The approach that is asked, as the left-turner.
    ///
    /// # Errors
    /// If the ego cannot enter.
    #[inline(never)]
    pub fn approach<'j, 'w>(
        &self,
        policy: &Policy<'w>,
        junction: &'j Junction,
    ) -> Result<Approach<'j, 'w>, EnterError> {
        Drive::new(*policy, *self.contract(), Part::Left).enter(junction, EGO)
    }

    /// The junction.
    ///
    /// # Errors
    /// If the routes make none.
    // Not inlined, so that it fills the caller's junction and no copy of it.
    #[inline(never)]
    pub fn junction(&self) -> Result<Junction, Wrong> {
        let mut builder = Junction::builder();
        for words in self.routes {
            let route = route(words).map_err(Wrong::Route)?;
            let path = builder.path(&route, Class::Car, footprint(words));
            let path = path.map_err(Wrong::Junction)?;
            let [_, _, right, priority, line, ..] = *words;
            let priority = match priority {
                1 => Priority::Unsigned,
                2 => Priority::Signed,
                _ => Priority::FirstCome,
            };
            let settled = match right {
                1 => builder.priority(EGO, path, priority),
                2 => builder.priority(path, EGO, priority),
                _ => Ok(()),
            };
            // The ego has no right of way over itself, and not every path has a line.
            let _ = settled.and(builder.line(path, f32::from_bits(line)));
        }
        builder.build().map_err(Wrong::Junction)
    }
}

/// Sensors err, and the drivetrain is late and not exact: `contracts/passenger-car.toml`, but for a shorter latency.
pub const INEXACT: Contract = match Contract::ALL_WAY_STOP
    .to_builder()
    .jitter(0.003)
    .position_error(0.3)
    .speed_error(0.3)
    .ego_acceleration(2.4)
    .ego_go(1.5)
    .ego_braking(5.0)
    .ego_emergency(7.0)
    .ego_lag(0.2)
    .ego_gain(0.1)
    .ego_disturbance(0.3)
    .other_max_speed(16.0)
    .other_braking(9.0)
    .follower_reaction(1.0)
    .build()
{
    Ok(contract) => contract,
    Err(_) => panic!("the numbers are in their ranges"),
};

/// The ego's path.
pub const EGO: PathId = PathId::new(0);

#[inline(never)]
fn route(words: &[u32; ROUTE]) -> Result<Route<POINTS>, RouteError> {
    let [_, _, _, _, _, count, points @ ..] = words;
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

/// What is asked in one step.
#[derive(Clone, Copy, Debug)]
pub struct Question {
    /// When.
    pub now: Instant,
    ego: Vehicle,
    tracks: [Track; OTHERS],
    /// How many of them there are.
    count: usize,
}

impl Question {
    /// What the words of a step ask. Not inlined: it would take its room twice.
    #[must_use]
    #[inline(never)]
    pub fn new([millis, vehicles @ ..]: &[u32; QUESTION]) -> Self {
        let nobody = [0; VEHICLE];
        let (ego, others) = vehicles
            .as_chunks()
            .0
            .split_first()
            .unwrap_or((&nobody, &[]));
        let ego = vehicle(ego);
        let mut question = Self {
            now: Instant::from_millis(u64::from(*millis)),
            ego,
            tracks: [Track::on(0, EGO, ego); OTHERS],
            count: 0,
        };
        let mut places = question.tracks.iter_mut();
        for (number, words) in (1_u8..).zip(others) {
            if words[0] == 0 {
                continue;
            }
            if let Some(place) = places.next() {
                // The numbers of tracks are not those of paths.
                let track = 1000 - 7 * u16::from(number);
                *place = Track::on(track, PathId::new(number), vehicle(words));
                question.count += 1;
            }
        }
        question
    }

    /// What is observed.
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
