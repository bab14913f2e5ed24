//! The conflict geometry of the ego's route with those of the others, prepared once.

use crate::geometry::{Footprint, UnitVector};
use crate::junction::conflict::{RightOfWay, RouteConflict};
use crate::junction::path::MAX_FOOTPRINT;
use crate::junction::route::Route;
use crate::junction::zone::Body;
use heapless::Vec;

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

/// The conflict geometry of the ego's route with those of up to `N` others.
///
/// It keeps no polylines: 8 others take less than 1.5 KiB.
///
/// ```
/// use cede_controller::{ConflictKind, Footprint, Point, Route, Scene, ScenePath as Path};
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
    /// In which direction each other's route ends, and its footprint.
    others: Vec<(UnitVector, Footprint), N>,
}

impl<const N: usize> Scene<N> {
    /// Largest side of a footprint in metres.
    pub const MAX_FOOTPRINT: f32 = MAX_FOOTPRINT;

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
            others: Vec::new(),
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
        let footprint = checked(other.footprint)?;
        let exit = exit(other.route);
        let [ego, other] =
            [ego, other].map(|path| Body::new(path.route.polyline(), path.footprint, 0.0));
        let conflict = RouteConflict::between(&ego, &other);
        let pushed = self.conflicts.push(conflict);
        pushed.map_err(|_| SceneError::Others)?;
        let pushed = self.others.push((exit, footprint));
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

    /// In which direction each other's route ends, and its footprint.
    pub(crate) fn others(&self) -> &[(UnitVector, Footprint)] {
        &self.others
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

fn checked(footprint: Footprint) -> Result<Footprint, SceneError> {
    let good = |side: f32| side > 0.0 && side <= MAX_FOOTPRINT;
    if good(footprint.length) && good(footprint.width) {
        Ok(footprint)
    } else {
        Err(SceneError::Footprint)
    }
}

fn exit<const P: usize>(route: &Route<P>) -> UnitVector {
    route.pose(route.length()).direction
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, unit};
    use crate::junction::conflict::ConflictKind;

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
        assert_eq!(scene.others()[0].0, unit(-1.0, 0.0));
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
