//! What a junction publishes: paths, footprints, tolerance and zones.

use cede_controller::{Junction, PathId, Span};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The public data of a junction. Numbers are taken as they are written: nothing is rounded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Site {
    /// How far (m) any point of a vehicle may be from where it is on its path, at least 0.
    pub tolerance: f64,
    /// The paths.
    pub paths: Vec<Path>,
    /// Which path meets which, and where.
    #[serde(default)]
    pub pairs: Vec<Pair>,
}

/// A path, and the footprint of the vehicles on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Path {
    /// Points (m).
    pub points: Vec<[f64; 2]>,
    /// The arc length (m) at each point, increasing.
    pub arc: Vec<f64>,
    /// From bumper to bumper (m), more than 0.
    pub length: f64,
    /// From side to side (m), more than 0.
    pub width: f64,
}

/// The zones of two paths, which may be one path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// The ego's path, counted from 0.
    pub ego: usize,
    /// The other's path.
    pub other: usize,
    /// In no particular order.
    pub zones: Vec<Zone>,
}

/// A zone: a box of places and a band of the lead, each from … to (m).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Zone {
    /// The ego's arc lengths.
    pub ego: [f64; 2],
    /// The other's.
    pub other: [f64; 2],
    /// The ego's less the other's.
    pub lead: [f64; 2],
    /// Both run along one lane in it.
    pub lane: bool,
}

/// Why a site cannot be checked.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SiteError {
    /// A number is out of its range, or there are too few.
    #[error("{place}: {problem}")]
    Value {
        /// The field.
        place: String,
        /// What is wrong with it, and what would be right.
        problem: &'static str,
    },
    /// A number of a path is too large.
    #[error("pairs[{pair}]: there is no path {path}, only {paths} paths")]
    NoPath {
        /// Which pair.
        pair: usize,
        /// The number that it has.
        path: usize,
        /// How many there are.
        paths: usize,
    },
    /// Two paths have zones for the one, and not the same for the other.
    #[error("the zones of paths {ego} and {other} are not mirrored")]
    NotMirrored {
        /// One path.
        ego: usize,
        /// The other.
        other: usize,
    },
    /// A path can be entered, and nothing is said of how it meets another one, not even that it does not.
    #[error(
        "pairs: nothing is said of ego {ego} and other {other}; if they do not meet, their zones are []"
    )]
    NotSaid {
        /// The ego's path.
        ego: usize,
        /// The other's.
        other: usize,
    },
}

impl Site {
    /// What `junction` publishes. Pairs are those of paths that can be entered with all paths.
    #[must_use]
    pub fn of<const R: usize, const P: usize, const E: usize>(
        junction: &Junction<R, P, E>,
    ) -> Self {
        let ids = || (0..=u8::MAX).map(PathId::new).zip(junction.paths());
        let paths = ids().filter_map(|(id, path)| {
            let line = junction.polyline(id)?;
            let footprint = path.footprint();
            let point = |p: &cede_controller::Point| [p.x.into(), p.y.into()];
            Some(Path {
                points: line.points().iter().map(point).collect(),
                arc: line.arc().iter().map(|&s| s.into()).collect(),
                length: footprint.length.into(),
                width: footprint.width.into(),
            })
        });
        let pairs = ids().flat_map(|(ego, _)| {
            ids().filter_map(move |(other, _)| {
                let conflict = junction.conflict(ego, other)?;
                Some(Pair {
                    ego: ego.index(),
                    other: other.index(),
                    zones: conflict.zones().map(Zone::of).collect(),
                })
            })
        });
        Self {
            tolerance: junction.tolerance().into(),
            paths: paths.collect(),
            pairs: pairs.collect(),
        }
    }

    /// Whether the numbers make sense, and the zones that two vehicles see of each other are mirrored.
    ///
    /// # Errors
    /// See [`SiteError`].
    pub fn sound(&self) -> Result<(), SiteError> {
        if !(self.tolerance >= 0.0 && self.tolerance.is_finite()) {
            return Err(SiteError::value("tolerance", "is not a length (m)"));
        }
        for (i, path) in self.paths.iter().enumerate() {
            path.sound().map_err(|(field, problem)| {
                SiteError::value(format!("paths[{i}].{field}"), problem)
            })?;
        }
        for (i, pair) in self.pairs.iter().enumerate() {
            self.known(i, pair)?;
            if self.mirrored(pair) == Some(false) {
                let (ego, other) = (pair.ego, pair.other);
                return Err(SiteError::NotMirrored { ego, other });
            }
        }
        Ok(())
    }

    /// Whether something is said of every other path for each path that can be entered.
    ///
    /// # Errors
    /// [`SiteError::NotSaid`].
    pub fn complete(&self) -> Result<(), SiteError> {
        for ego in self.pairs.iter().map(|pair| pair.ego) {
            let missing = (0..self.paths.len()).find(|&other| self.pair(ego, other).is_none());
            if let Some(other) = missing {
                return Err(SiteError::NotSaid { ego, other });
            }
        }
        Ok(())
    }

    fn known(&self, i: usize, pair: &Pair) -> Result<(), SiteError> {
        let paths = self.paths.len();
        if let Some(path) = [pair.ego, pair.other].into_iter().find(|&p| p >= paths) {
            let pair = i;
            return Err(SiteError::NoPath { pair, path, paths });
        }
        if !pair.zones.iter().all(Zone::is_sound) {
            let place = format!("pairs[{i}].zones");
            return Err(SiteError::value(
                place,
                "has an interval that is none: from ≤ to",
            ));
        }
        Ok(())
    }

    /// Whether what the other sees is `pair` mirrored; none if nothing is said of it.
    fn mirrored(&self, pair: &Pair) -> Option<bool> {
        let back = self.pair(pair.other, pair.ego)?;
        let same = pair.zones.len() == back.zones.len()
            && pair
                .zones
                .iter()
                .all(|zone| back.zones.contains(&zone.swapped()));
        Some(same || pair.ego == pair.other)
    }

    fn pair(&self, ego: usize, other: usize) -> Option<&Pair> {
        let is = |pair: &&Pair| (pair.ego, pair.other) == (ego, other);
        self.pairs.iter().find(is)
    }

    /// Each two paths of which one can be entered, once.
    pub fn each(&self) -> impl Iterator<Item = &Pair> {
        let twice =
            |pair: &&Pair| pair.ego > pair.other && self.pair(pair.other, pair.ego).is_some();
        self.pairs.iter().filter(move |pair| !twice(pair))
    }
}

impl SiteError {
    fn value(place: impl Into<String>, problem: &'static str) -> Self {
        let place = place.into();
        Self::Value { place, problem }
    }
}

impl Path {
    fn sound(&self) -> Result<(), (&'static str, &'static str)> {
        if self.points.len() < 2 || self.points.len() != self.arc.len() {
            return Err((
                "points",
                "has fewer than two points, or not as many as `arc`",
            ));
        }
        if !self.points.iter().flatten().all(|x| x.is_finite()) {
            return Err(("points", "has a coordinate that is no number"));
        }
        if !(self.arc.iter().all(|s| s.is_finite()) && self.arc.is_sorted_by(|a, b| a < b)) {
            return Err(("arc", "does not increase"));
        }
        let apart = |ends: &[[f64; 2]]| ends.first() != ends.last();
        if !self.points.windows(2).all(apart) {
            return Err(("points", "has one point twice"));
        }
        if !self.arc_is_length() {
            return Err((
                "arc",
                "is not the length of the points, to 0.1 mm and as much for each metre",
            ));
        }
        if !(self.length > 0.0 && self.width > 0.0 && (self.length + self.width).is_finite()) {
            return Err(("length, width", "is not more than 0 (m)"));
        }
        Ok(())
    }

    /// Whether arc lengths grow as the points are apart.
    fn arc_is_length(&self) -> bool {
        let apart = self.points.windows(2).zip(self.arc.windows(2));
        apart.into_iter().all(|(points, arc)| {
            let long = arc[1] - arc[0];
            let far = (points[1][0] - points[0][0]).hypot(points[1][1] - points[0][1]);
            (far - long).abs() <= 1e-4 + 1e-4 * long
        })
    }
}

impl Zone {
    fn of(zone: &cede_controller::Zone) -> Self {
        let span = |span: Span| [span.from.into(), span.to.into()];
        Self {
            ego: span(zone.ego),
            other: span(zone.other),
            lead: span(zone.lead),
            lane: zone.is_lane(),
        }
    }

    fn is_sound(&self) -> bool {
        let sound = |[from, to]: [f64; 2]| from <= to;
        sound(self.ego) && sound(self.other) && sound(self.lead)
    }

    fn swapped(&self) -> Self {
        let [from, to] = self.lead;
        Self {
            ego: self.other,
            other: self.ego,
            lead: [-to, -from],
            lane: self.lane,
        }
    }
}
