//! Vehicles out of sight: where a part of a path is hidden, one is assumed to come.

use super::bounds::Bounds;
use super::contract::Contract;
use super::lane;
use super::other::{News, Other};
use super::own::Own;
use super::rules::Rules;
use crate::headroom::Room;
use crate::instant::Instant;
use crate::junction::zone::{FAR, Span};
use crate::junction::{PathId, Way};
use crate::observation::{Sight, Vehicle};
use crate::real::Real;
use core::fmt;
use heapless::Vec;

/// Most paths of which a part is out of sight, in one approach. Those without a zone with the ego's do not count.
pub const MAX_SIGHTS: usize = 8;

/// Why it cannot be said what is in sight.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SightError {
    /// The junction has no such path.
    Path {
        /// Its number.
        path: PathId,
    },
    /// The arc length is not on the path.
    From {
        /// The path.
        path: PathId,
        /// The arc length that was given, in m.
        value: f32,
        /// The path's length in m.
        length: f32,
    },
    /// The speed is not in (0, [`Vehicle::MAX_SPEED`]].
    Speed {
        /// The path.
        path: PathId,
        /// The speed that was given, in m/s.
        value: f32,
    },
    /// More than [`MAX_SIGHTS`] paths with a zone with the ego's in this approach.
    TooMany,
}

impl fmt::Display for SightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Path { path } => {
                write!(f, "the sight of {path}, which the junction does not have")
            }
            Self::From {
                path,
                value,
                length,
            } => write!(
                f,
                "the sight of {path} from {value} m on: it must be on the path, in [0, {length}] m"
            ),
            Self::Speed { path, value } => write!(
                f,
                "{value} m/s out of sight on {path}: it must be in (0, {}] m/s",
                Vehicle::MAX_SPEED
            ),
            Self::TooMany => write!(
                f,
                "the sight of more than {MAX_SIGHTS} paths that meet the ego's: leave out those that are always in sight"
            ),
        }
    }
}

impl core::error::Error for SightError {}

/// The edges of sight, and what was said of them last.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hidden {
    edges: Vec<Edge, MAX_SIGHTS>,
    told: Vec<Sight, MAX_SIGHTS>,
    /// When it was told.
    at: Instant,
    /// The present.
    now: Instant,
    /// The plan in force is safe from everybody who was out of sight before.
    pub(super) holds: bool,
}

/// Whoever is out of sight on a path is within these bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Edge {
    path: PathId,
    /// Arc length (m) and speed (m/s), at most, at `at`.
    most: [f32; 2],
    at: Instant,
    /// It was not known before this observation.
    fresh: bool,
}

impl Edge {
    /// Where they are at `now`, as far as it is known before it is told anew.
    fn bounds<R: Rules>(&self, contract: &Contract, now: Instant) -> Bounds {
        let span = |from, to| Span { from, to };
        let [s, speed] = self.most;
        let base = Bounds {
            s: span(-FAR, s),
            speed: span(0.0, speed),
        };
        R::coast(contract, base, now.seconds_since(self.at))
    }
}

impl Hidden {
    pub(super) const fn new() -> Self {
        Self {
            edges: Vec::new(),
            told: Vec::new(),
            at: Instant::from_micros(0),
            now: Instant::from_micros(0),
            holds: false,
        }
    }

    /// Takes down what is in sight at `now`. What is refused changes nothing.
    pub(super) fn tell(
        &mut self,
        way: Way<'_>,
        now: Instant,
        sights: &[Sight],
    ) -> Result<(), SightError> {
        let mut told = Vec::new();
        let mut known = self.edges.len();
        for sight in sights {
            let path = sight.path;
            let line = way.polyline(path).ok_or(SightError::Path { path })?;
            let (value, length) = (sight.from, line.length());
            if !(value >= 0.0 && value <= length) {
                return Err(SightError::From {
                    path,
                    value,
                    length,
                });
            }
            let value = sight.speed;
            if !(value > 0.0 && value <= Vehicle::MAX_SPEED) {
                return Err(SightError::Speed { path, value });
            }
            if way.conflict(path).is_none_or(|it| it.zones().count() == 0) {
                continue;
            }
            let before: &[Sight] = &told;
            if !self.edges.iter().any(|edge| edge.path == path)
                && !before.iter().any(|other| other.path == path)
            {
                known += 1;
            }
            if known > MAX_SIGHTS || told.push(*sight).is_err() {
                return Err(SightError::TooMany);
            }
        }
        (self.told, self.at) = (told, now);
        Ok(())
    }

    /// It is `now`, and nothing is told yet.
    pub(super) fn advance(&mut self, now: Instant) {
        self.now = now;
        self.edges.iter_mut().for_each(|edge| edge.fresh = false);
    }

    /// Until the present everybody kept to `contract`, from now on to another one.
    pub(super) fn rebase<R: Rules>(&mut self, contract: &Contract) {
        for edge in &mut self.edges {
            let Bounds { s, speed } = edge.bounds::<R>(contract, self.now);
            (edge.most, edge.at) = ([s.to, speed.to], self.now);
        }
    }

    /// From where somebody comes who appears on `path`, if that is out of sight.
    pub(super) fn source<R: Rules>(
        &self,
        contract: &Contract,
        path: PathId,
        vehicle: &Vehicle,
    ) -> Option<Bounds> {
        let edge = self.edges.iter().find(|edge| edge.path == path)?;
        let bounds = edge.bounds::<R>(contract, self.now);
        Room::hold(bounds.rooms(contract, vehicle.s, vehicle.speed)).then_some(bounds)
    }

    /// Uses what was told for the present. Nobody who is out of sight has come nearer than anybody can.
    pub(super) fn look<R: Rules>(&mut self, contract: &Contract) {
        let now = self.now;
        if self.at != now {
            return;
        }
        for &Sight { path, from, speed } in &self.told {
            let told = [from, Real::min(speed, contract.other.max_speed)];
            if let Some(edge) = self.edges.iter_mut().find(|edge| edge.path == path) {
                let Bounds { s, speed } = edge.bounds::<R>(contract, now);
                edge.most = [Real::min(s.to, told[0]), Real::min(speed.to, told[1])];
                edge.at = now;
                continue;
            }
            // `tell` sees to it that there is room.
            let _ = self.edges.push(Edge {
                path,
                most: told,
                at: now,
                fresh: true,
            });
        }
    }

    /// Somebody at every edge of sight, who claims no precedence. Whom the ego leads in a lane keeps its distance, as one who
    /// appears there does.
    pub(super) fn others<R: Rules>(
        &self,
        contract: &Contract,
        way: Way<'_>,
        ego: &Own,
    ) -> impl Iterator<Item = Other> {
        self.edges.iter().map(move |edge| {
            let bounds = edge.bounds::<R>(contract, self.now);
            let mut other = Other::at(0, edge.path, 0.0, bounds, self.now);
            if let Some(conflict) = way.conflict(edge.path) {
                lane::settle::<R>(contract, conflict.zones(), ego, &mut other);
            }
            other.news = if edge.fresh {
                News::Appeared
            } else {
                News::None
            };
            other
        })
    }
}
