//! The conflict geometry of the ego's route with those of the others, prepared once.

use crate::geometry::{Footprint, Point, UnitVector};
use crate::junction::conflict::ConflictKind;
use crate::junction::conflict::RightOfWay;
use crate::junction::route::Route;
use crate::junction::zone::{Zone, Zones, zones};
use heapless::Vec;

/// A vehicle has reached the conflict point when it is nearer to it than this (m): the paper's rule.
pub const CONFLICT_RADIUS: f32 = 5.0;

/// Most others of a scene, whatever its capacity.
pub const MAX_OTHERS: usize = 8;

/// A route and the rectangle that its vehicle covers.
#[derive(Clone, Copy, Debug)]
pub struct Path<'a, const P: usize> {
    /// Where the vehicle goes.
    pub route: &'a Route<P>,
    /// What it covers; both sides in (0, [`Scene::MAX_FOOTPRINT`]].
    pub footprint: Footprint,
}

/// Why a scene cannot be prepared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SceneError {
    /// No other route, or more than the scene's capacity or [`MAX_OTHERS`].
    Others,
    /// A footprint's side is not a number, not positive or larger than [`Scene::MAX_FOOTPRINT`].
    Footprint,
}

impl core::fmt::Display for SceneError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Others => "a scene needs one other route, and no more than its capacity or 8",
            Self::Footprint => "a footprint's sides must be positive and at most 40 m",
        })
    }
}

impl core::error::Error for SceneError {}

/// How the ego's route meets one other's. Arc lengths are the respective vehicle's own, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RouteConflict {
    /// How the routes conflict first.
    pub kind: ConflictKind,
    /// Where the ego has reached the conflict point: the first point of its route within
    /// [`CONFLICT_RADIUS`] of the routes' first crossing. Routes that run together without crossing
    /// have it at the entry of their zone; routes that do not meet, at their end.
    pub ego_conflict: f32,
    /// The same for the other.
    pub other_conflict: f32,
    /// Unit vector in which the other's route ends.
    pub other_exit: UnitVector,
    /// The other's footprint.
    pub other_footprint: Footprint,
    /// Who goes first if both arrive at once; unsettled unless [`Scene::set_right_of_way`] says so.
    pub right_of_way: RightOfWay,
    pub(crate) zones: Zones,
}

impl RouteConflict {
    /// Where the footprints can touch; at most [`crate::junction::zone::MAX_ZONES`], in no particular order.
    pub fn zones(&self) -> impl Iterator<Item = &Zone> {
        self.zones.iter().flatten()
    }
}

/// The conflict geometry of the ego's route with those of up to `N` others.
///
/// It keeps no polylines: 8 others take less than 1.5 KiB.
///
/// ```
/// use cede_controller::{ConflictKind, Footprint, Path, Point, Route, Scene};
///
/// let east = Route::<4>::new([Point::new(-30.0, 0.0), Point::new(30.0, 0.0)])?;
/// let north = Route::<4>::new([Point::new(0.0, -40.0), Point::new(0.0, 40.0)])?;
/// let path = |route| Path { route, footprint: Footprint::PAPER };
/// let scene = Scene::<8>::new(path(&east), &[path(&north)])?;
/// let conflict = &scene.conflicts()[0];
/// assert_eq!(conflict.kind, ConflictKind::Crossing);
/// assert_eq!((conflict.ego_conflict, conflict.other_conflict), (25.0, 35.0));
/// // 2.5 m of the ego's bumper and 1 m of the other's side before the crossing, and 2 cm for each.
/// assert!((conflict.zones().next().unwrap().ego.from - (30.0 - 3.54)).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scene<const N: usize> {
    /// The ego's footprint.
    footprint: Footprint,
    /// Unit vector in which the ego's route ends.
    exit: UnitVector,
    conflicts: Vec<RouteConflict, N>,
}

impl<const N: usize> Scene<N> {
    /// Largest side of a footprint in metres.
    pub const MAX_FOOTPRINT: f32 = 40.0;

    /// The scene of `ego` among `others`; an observation counts them in this order.
    ///
    /// Cost: for each other, a distance for each pair of segments, more where the routes are
    /// near each other: about 1 ms on a desktop for 8 others of 128 points.
    ///
    /// # Errors
    /// See [`SceneError`].
    pub fn new<const P: usize>(
        ego: Path<'_, P>,
        others: &[Path<'_, P>],
    ) -> Result<Self, SceneError> {
        let mut scene = Self::alone(ego)?;
        for other in others {
            scene.add(ego, *other)?;
        }
        if scene.conflicts.is_empty() {
            return Err(SceneError::Others);
        }
        Ok(scene)
    }

    /// [`Scene::new`] from routes that come one after the other, for targets without the memory
    /// to hold all of them at once: each is dropped before the next one is asked for.
    ///
    /// # Errors
    /// See [`SceneError`].
    // Not inlined, so that it fills the caller's scene and no copy of it.
    #[inline(never)]
    pub fn gather<const P: usize>(
        ego: Path<'_, P>,
        others: impl IntoIterator<Item = (Route<P>, Footprint)>,
    ) -> Result<Self, SceneError> {
        let mut scene = Self::alone(ego)?;
        for (route, footprint) in others {
            let route = &route;
            scene.add(ego, Path { route, footprint })?;
        }
        if scene.conflicts.is_empty() {
            return Err(SceneError::Others);
        }
        Ok(scene)
    }

    /// Nobody but the ego, yet.
    fn alone<const P: usize>(ego: Path<'_, P>) -> Result<Self, SceneError> {
        Ok(Self {
            footprint: checked(ego.footprint)?,
            exit: exit(ego.route),
            conflicts: Vec::new(),
        })
    }

    fn add<const P: usize>(
        &mut self,
        ego: Path<'_, P>,
        other: Path<'_, P>,
    ) -> Result<(), SceneError> {
        if self.conflicts.len() >= MAX_OTHERS {
            return Err(SceneError::Others);
        }
        let conflict = RouteConflict::new(ego, other)?;
        let pushed = self.conflicts.push(conflict);
        pushed.map_err(|_| SceneError::Others)
    }

    /// How the ego's route meets each other's.
    #[must_use]
    pub fn conflicts(&self) -> &[RouteConflict] {
        &self.conflicts
    }

    #[cfg(test)]
    pub(crate) fn conflicts_mut(&mut self) -> &mut [RouteConflict] {
        &mut self.conflicts
    }

    /// The ego's footprint.
    #[must_use]
    pub const fn footprint(&self) -> Footprint {
        self.footprint
    }

    /// Unit vector in which the ego's route ends.
    #[must_use]
    pub const fn exit(&self) -> UnitVector {
        self.exit
    }

    /// Says who goes first if the ego and other number `other` arrive at once; no effect if there is none.
    pub fn set_right_of_way(&mut self, other: usize, right_of_way: RightOfWay) {
        if let Some(conflict) = self.conflicts.get_mut(other) {
            conflict.right_of_way = right_of_way;
        }
    }
}

impl RouteConflict {
    // Not inlined, so that its stack is free again when the scene is moved.
    #[inline(never)]
    fn new<const P: usize>(ego: Path<'_, P>, other: Path<'_, P>) -> Result<Self, SceneError> {
        let other_footprint = checked(other.footprint)?;
        let zones = zones((ego.route, ego.footprint), (other.route, other_footprint));
        let first = zones
            .iter()
            .flatten()
            .fold(None, |first: Option<&Zone>, zone| match first {
                Some(first) if first.ego.from <= zone.ego.from => Some(first),
                _ => Some(zone),
            });
        let (ego_conflict, other_conflict) = match (crossing(ego.route, other.route), first) {
            (Some(point), _) => (reach(ego.route, point), reach(other.route, point)),
            (None, Some(zone)) => (
                within(zone.ego.from, ego.route.length()),
                within(zone.other.from, other.route.length()),
            ),
            (None, None) => (ego.route.length(), other.route.length()),
        };
        Ok(Self {
            kind: first.map_or(ConflictKind::None, |zone| zone.kind),
            ego_conflict,
            other_conflict,
            other_exit: exit(other.route),
            other_footprint,
            right_of_way: RightOfWay::Unsettled,
            zones,
        })
    }
}

fn checked(footprint: Footprint) -> Result<Footprint, SceneError> {
    let good = |side: f32| side > 0.0 && side <= Scene::<0>::MAX_FOOTPRINT;
    if good(footprint.length) && good(footprint.width) {
        Ok(footprint)
    } else {
        Err(SceneError::Footprint)
    }
}

/// `value` in [0, `length`].
fn within(value: f32, length: f32) -> f32 {
    if value < 0.0 {
        0.0
    } else if value > length {
        length
    } else {
        value
    }
}

fn exit<const P: usize>(route: &Route<P>) -> UnitVector {
    route.pose(route.length()).direction
}

/// The first proper crossing of two polylines along the first of them.
fn crossing<const P: usize>(a: &Route<P>, b: &Route<P>) -> Option<Point> {
    let sides = |route: &'_ Route<P>| {
        let points = route.points();
        points.len().saturating_sub(1)
    };
    for i in 0..sides(a) {
        let mut nearest: Option<f32> = None;
        let (&p, &q) = (a.points().get(i)?, a.points().get(i + 1)?);
        for j in 0..sides(b) {
            let (&r, &s) = (b.points().get(j)?, b.points().get(j + 1)?);
            if let Some(along) = cross(p, q, r, s)
                && nearest.is_none_or(|nearest| along < nearest)
            {
                nearest = Some(along);
            }
        }
        if let Some(along) = nearest {
            return Some(p + (q - p) * along);
        }
    }
    None
}

/// Where the open segment from `p` to `q` crosses that from `r` to `s`, as a fraction of `p` to `q`.
fn cross(p: Point, q: Point, r: Point, s: Point) -> Option<f32> {
    let (along, across) = (q - p, s - r);
    let (side_p, side_q) = (across.perp(&(p - r)), across.perp(&(q - r)));
    let (side_r, side_s) = (along.perp(&(r - p)), along.perp(&(s - p)));
    // A crossing in a corner of a polyline belongs to the segment that begins there.
    let crosses = |from: f32, to: f32| (from >= 0.0) != (to >= 0.0);
    (crosses(side_p, side_q) && crosses(side_r, side_s)).then(|| side_p / (side_p - side_q))
}

/// Arc length of the first point of `route` within [`CONFLICT_RADIUS`] of `point`; its end if there is none.
fn reach<const P: usize>(route: &Route<P>, point: Point) -> f32 {
    let ends = route.points().iter().zip(route.points().iter().skip(1));
    for ((&a, &b), (&from, &to)) in ends.zip(route.arc().iter().zip(route.arc().iter().skip(1))) {
        let direction = (b - a) * (1.0 / (to - from));
        // |a + direction·x − point| = radius, solved for the smaller x.
        let offset = a - point;
        let half = offset.dot(&direction);
        let rest = offset.dot(&offset) - CONFLICT_RADIUS * CONFLICT_RADIUS;
        if rest <= 0.0 {
            return from;
        }
        let discriminant = half * half - rest * direction.dot(&direction);
        if discriminant >= 0.0 {
            let x = (-half - libm::sqrtf(discriminant)) / direction.dot(&direction);
            if x >= 0.0 && x <= to - from {
                return from + x;
            }
        }
    }
    route.length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::unit;

    fn path(route: &Route<8>) -> Path<'_, 8> {
        Path {
            route,
            footprint: Footprint::PAPER,
        }
    }

    fn route(points: &[(f32, f32)]) -> Route<8> {
        Route::new(points.iter().map(|&(x, y)| Point::new(x, y))).unwrap()
    }

    #[test]
    fn the_conflict_point_is_reached_at_five_metres() {
        let ego = route(&[(-30.0, 0.0), (0.0, 0.0), (0.0, 30.0)]);
        let other = route(&[(40.0, 12.0), (-40.0, 12.0)]);
        let scene = Scene::<2>::new(path(&ego), &[path(&other)]).unwrap();
        let conflict = scene.conflicts()[0];
        assert!((conflict.ego_conflict - 37.0).abs() < 1e-4);
        assert!((conflict.other_conflict - 35.0).abs() < 1e-4);
        assert_eq!(conflict.other_exit, unit(-1.0, 0.0));
        assert_eq!(scene.exit(), unit(0.0, 1.0));
    }

    #[test]
    fn a_lane_that_is_only_joined_has_its_conflict_point_at_the_entry() {
        let ego = route(&[(0.0, -30.0), (0.0, 0.0), (40.0, 0.1)]);
        let other = route(&[(-40.0, 0.2), (40.0, 0.2)]);
        let scene = Scene::<2>::new(path(&ego), &[path(&other)]).unwrap();
        let conflict = scene.conflicts()[0];
        let zone = conflict.zones().next().unwrap();
        assert_eq!(conflict.kind, ConflictKind::Merging);
        assert_eq!(conflict.ego_conflict, zone.ego.from);
    }

    #[test]
    fn bad_scenes_are_refused() {
        let ego = route(&[(0.0, 0.0), (9.0, 0.0)]);
        let none = Scene::<2>::new(path(&ego), &[]);
        assert_eq!(none.unwrap_err(), SceneError::Others);
        let many = Scene::<2>::new(path(&ego), &[path(&ego); 3]);
        assert_eq!(many.unwrap_err(), SceneError::Others);
        let too_many = Scene::<9>::new(path(&ego), &[path(&ego); 9]);
        assert_eq!(too_many.unwrap_err(), SceneError::Others);
        for (length, width) in [(0.0, 2.0), (f32::NAN, 2.0), (5.0, 41.0)] {
            let bad = Path {
                route: &ego,
                footprint: Footprint { length, width },
            };
            let refused = Scene::<2>::new(path(&ego), &[bad]);
            assert_eq!(refused.unwrap_err(), SceneError::Footprint);
        }
    }

    #[test]
    fn routes_one_after_the_other_make_the_same_scene() {
        let ego = route(&[(-30.0, 0.0), (30.0, 0.0)]);
        let others = [
            route(&[(0.0, -40.0), (0.0, 40.0)]),
            route(&[(-30.0, 8.0), (-5.0, 0.0), (30.0, 0.0)]),
        ];
        let together = Scene::<4>::new(path(&ego), &others.each_ref().map(path));
        let owned = others.into_iter().map(|route| (route, Footprint::PAPER));
        assert_eq!(Scene::gather(path(&ego), owned), together);
        assert_eq!(Scene::<4>::gather(path(&ego), []), Err(SceneError::Others));
    }

    #[test]
    fn eight_others_fit_in_their_share_of_the_memory() {
        assert!(size_of::<Scene<8>>() <= 1536, "{}", size_of::<Scene<8>>());
    }
}
