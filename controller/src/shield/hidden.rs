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
    /// Since the last observation began, somebody in sight has become one who would be new.
    lost: bool,
    /// The same before that.
    doubtful: bool,
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
            lost: false,
            doubtful: false,
        }
    }

    /// Somebody who is in sight may be taken for one who comes into sight at the next call: its state was refused, it could not be
    /// remembered, or its number is forgotten.
    pub(super) const fn lose(&mut self) {
        self.lost = true;
    }

    /// An observation begins.
    pub(super) const fn begin(&mut self) {
        self.doubtful = core::mem::replace(&mut self.lost, false);
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

    /// From where somebody comes who appears on `path`, if that is certainly out of sight.
    pub(super) fn source<R: Rules>(
        &self,
        contract: &Contract,
        path: PathId,
        vehicle: &Vehicle,
    ) -> Option<Bounds> {
        let edge = self.edges.iter().find(|edge| edge.path == path)?;
        if self.doubtful {
            return None;
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Footprint, Point};
    use crate::junction::{Class, Junction, Route};
    use crate::shield::rules::Sound;

    const PATH: PathId = PathId::new(1);
    const WORST: Contract = Contract::WORST_CASE;

    /// The ego's road, one that crosses it, and one apart.
    fn site() -> Junction<3, 6, 1> {
        let mut builder = Junction::builder();
        for ends in [
            [(-50.0, 0.0), (50.0, 0.0)],
            [(0.0, -50.0), (0.0, 50.0)],
            [(-50.0, 30.0), (-30.0, 30.0)],
        ] {
            let route = Route::<2>::new(ends.map(|(x, y)| Point::new(x, y))).unwrap();
            builder.path(&route, Class::Car, Footprint::PAPER).unwrap();
        }
        builder.build().unwrap()
    }

    fn sight(path: PathId, from: f32, speed: f32) -> Sight {
        Sight { path, from, speed }
    }

    fn at(millis: u64) -> Instant {
        Instant::from_millis(millis)
    }

    /// Where the one out of sight may be, and how fast, at most.
    fn most(hidden: &Hidden) -> [f32; 2] {
        let bounds = hidden.edges[0].bounds::<Sound>(&WORST, hidden.now);
        [bounds.s.to, bounds.speed.to]
    }

    #[track_caller]
    fn near(a: [f32; 2], b: [f32; 2]) {
        assert!(
            (a[0] - b[0]).abs() < 1e-3 && (a[1] - b[1]).abs() < 1e-3,
            "{a:?}, {b:?}"
        );
    }

    #[test]
    fn one_out_of_sight_comes_on_until_more_is_seen() {
        let site = site();
        let way = site.way(PathId::new(0)).unwrap();
        let mut hidden = Hidden::new();
        let mut look = |now, told: Option<(f32, f32)>| {
            if let Some((from, speed)) = told {
                hidden
                    .tell(way, at(now), &[sight(PATH, from, speed)])
                    .unwrap();
            }
            hidden.advance(at(now));
            hidden.look::<Sound>(&WORST);
            (most(&hidden), hidden.edges[0].fresh)
        };
        assert_eq!(look(100, Some((30.0, 10.0))), ([30.0, 10.0], true));
        // Nothing is said: it comes on. Then less is in sight, and more.
        let (now, fresh) = look(600, None);
        near(now, [35.375, 11.5]);
        assert!(!fresh);
        near(look(700, Some((90.0, 14.0))).0, [36.54, 11.8]);
        near(look(800, Some((33.0, 14.0))).0, [33.0, 12.1]);
        near(look(900, Some((33.0, 9.0))).0, [33.0, 9.0]);
        // It is no faster than the contract lets it be.
        near(look(60_000, Some((33.0, 40.0))).0, [33.0, 15.0]);
        hidden.advance(at(60_100));
        let before = most(&hidden);
        hidden.rebase::<Sound>(&WORST);
        assert_eq!(hidden.edges[0].at, at(60_100));
        near(most(&hidden), before);
    }

    #[test]
    fn what_is_told_is_on_a_path_with_a_speed() {
        let site = site();
        let way = site.way(PathId::new(0)).unwrap();
        let tell = |path, from, speed| Hidden::new().tell(way, at(0), &[sight(path, from, speed)]);
        for (from, speed) in [
            (0.0, 10.0),
            (100.0, 10.0),
            (5.0, Vehicle::MAX_SPEED),
            (5.0, 0.1),
        ] {
            assert_eq!(tell(PATH, from, speed), Ok(()));
        }
        for value in [-0.1, 100.1] {
            let (path, length) = (PATH, 100.0);
            let refused = SightError::From {
                path,
                value,
                length,
            };
            assert_eq!(tell(PATH, value, 10.0), Err(refused));
        }
        for value in [0.0, -1.0, Vehicle::MAX_SPEED + 1.0] {
            assert_eq!(
                tell(PATH, 5.0, value),
                Err(SightError::Speed { path: PATH, value })
            );
        }
        let path = PathId::new(3);
        assert_eq!(tell(path, 5.0, 5.0), Err(SightError::Path { path }));
        // A path that does not meet the ego's takes no room.
        let many = [sight(PathId::new(2), 5.0, 5.0); 9];
        assert_eq!(Hidden::new().tell(way, at(0), &many), Ok(()));
        let many = [sight(PATH, 5.0, 5.0); 9];
        assert_eq!(
            Hidden::new().tell(way, at(0), &many),
            Err(SightError::TooMany)
        );
        assert_eq!(Hidden::new().tell(way, at(0), &many[1..]), Ok(()));
    }

    #[test]
    fn as_many_paths_are_out_of_sight_as_there_is_room_for_however_often_they_are_told() {
        let mut builder = Junction::<10, 20, 1>::builder();
        let crosses = (0..9_u8).map(|i| 10.0 * f32::from(i) - 40.0);
        let roads = crosses.map(|x| [(x, -50.0), (x, 50.0)]);
        for ends in core::iter::once([(-60.0, 0.0), (60.0, 0.0)]).chain(roads) {
            let route = Route::<2>::new(ends.map(|(x, y)| Point::new(x, y))).unwrap();
            builder.path(&route, Class::Car, Footprint::PAPER).unwrap();
        }
        let site = builder.build().unwrap();
        let way = site.way(PathId::new(0)).unwrap();
        let tell = |hidden: &mut Hidden, paths: &[u8]| {
            let sights = paths
                .iter()
                .map(|&path| sight(PathId::new(path), 20.0, 5.0));
            hidden.tell(way, at(0), &sights.collect::<std::vec::Vec<_>>())
        };
        let mut hidden = Hidden::new();
        assert_eq!(tell(&mut hidden, &[1, 2, 3, 4, 5, 6, 7, 1]), Ok(()));
        hidden.advance(at(0));
        hidden.look::<Sound>(&WORST);
        assert_eq!(hidden.edges.len(), 7);
        for (paths, told) in [
            (&[1, 2, 3, 4, 5, 6, 7, 8][..], Ok(())),
            (&[1, 8], Ok(())),
            (&[8, 8], Ok(())),
            (&[8, 9], Err(SightError::TooMany)),
        ] {
            assert_eq!(tell(&mut hidden, paths), told, "{paths:?}");
        }
    }
}
