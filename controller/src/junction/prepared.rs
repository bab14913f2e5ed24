//! A junction: its routes and how each two of them meet, prepared once for all vehicles.

use crate::geometry::Point;
use crate::junction::conflict::RouteConflict;
use crate::junction::path::{Class, MAX_LIMITS, Path, PathId, SpeedLimit};
use crate::junction::polyline::Polyline;
use crate::junction::way::Way;
use heapless::Vec;

/// Largest tolerance of a junction in metres.
pub const MAX_TOLERANCE: f32 = 1.0;

/// Largest lateral acceleration of a junction in m/s².
pub const MAX_LATERAL: f32 = 20.0;

/// Up to `R` paths with `P` points in all, of which the first `E` can be entered.
///
/// It keeps how each of the `E` meets each of the `R`: about 100 bytes for each such pair, and 12 bytes
/// for a point. Paths that nobody enters with this controller come last. Vehicles that share a junction
/// see the same zones, mirrored.
///
/// ```
/// use cede_controller::{Class, ConflictKind, Footprint, Junction, Point, Route};
///
/// let east = Route::<4>::new([Point::new(-30.0, 0.0), Point::new(30.0, 0.0)])?;
/// let north = Route::<4>::new([Point::new(0.0, -40.0), Point::new(0.0, 40.0)])?;
/// let mut builder = Junction::<2, 8>::builder();
/// let east = builder.path(&east, Class::Car, Footprint::PAPER)?;
/// let north = builder.path(&north, Class::Car, Footprint::PAPER)?;
/// builder.right_of_way(north, east)?;
/// let junction = builder.build()?;
/// let conflict = junction.conflict(east, north).unwrap();
/// assert_eq!(conflict.kind, ConflictKind::Crossing);
/// assert_eq!((conflict.ego_conflict, conflict.other_conflict), (25.0, 35.0));
/// // 2.5 m of the ego's bumper and 1 m of the other's side before the crossing; 2 cm and the tolerance for each.
/// assert!((conflict.zones().next().unwrap().ego.from - (30.0 - 3.74)).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Junction<const R: usize, const P: usize, const E: usize = R> {
    pub(super) paths: Vec<Path, R>,
    /// The points of all paths, one path after the other.
    pub(super) points: Vec<Point, P>,
    /// Their arc lengths (m), each path's from its own start.
    pub(super) arc: Vec<f32, P>,
    /// How each path that can be entered meets each path.
    pub(super) conflicts: Vec<[RouteConflict; R], E>,
    /// The speed limits along each path that can be entered, in the order of their places.
    pub(super) limits: Vec<Vec<SpeedLimit, MAX_LIMITS>, E>,
    pub(super) tolerance: f32,
    /// Lateral acceleration (m/s²) in bends, at most.
    pub(super) lateral: f32,
}

impl<const R: usize, const P: usize, const E: usize> Junction<R, P, E> {
    /// The paths; a [`PathId`] is an index into them.
    #[must_use]
    pub fn paths(&self) -> &[Path] {
        &self.paths
    }

    /// A path; `None` if there is no such path.
    #[must_use]
    pub fn path(&self, id: PathId) -> Option<&Path> {
        self.paths.get(id.index())
    }

    /// The points of a path; `None` if there is no such path.
    #[must_use]
    pub fn polyline(&self, id: PathId) -> Option<Polyline<'_>> {
        let range = &self.path(id)?.range;
        Some(Polyline::new(
            self.points.get(range.clone())?,
            self.arc.get(range.clone())?,
        ))
    }

    /// How path `ego` meets path `other`, which may be the same.
    ///
    /// `None` if `ego` is not among the first `E` or one of the two does not exist.
    #[must_use]
    pub fn conflict(&self, ego: PathId, other: PathId) -> Option<&RouteConflict> {
        self.way(ego)?.conflict(other)
    }

    /// The junction as the vehicles of path `ego` see it; `None` if `ego` is not among the first `E`, does not exist, or
    /// is for pedestrians.
    #[must_use]
    pub fn way(&self, ego: PathId) -> Option<Way<'_>> {
        self.path(ego)
            .filter(|path| path.class() != Class::Pedestrian)?;
        let row = self.conflicts.get(ego.index())?;
        Some(Way {
            ego,
            paths: &self.paths,
            points: &self.points,
            arc: &self.arc,
            conflicts: row.get(..self.paths.len())?,
            limits: self.limits.get(ego.index())?,
            tolerance: self.tolerance,
            lateral: self.lateral,
        })
    }

    /// How far (m) any point of a vehicle's footprint may be from where it is on its route.
    #[must_use]
    pub const fn tolerance(&self) -> f32 {
        self.tolerance
    }
}

#[cfg(test)]
impl<const R: usize, const P: usize, const E: usize> Junction<R, P, E> {
    /// How the first path meets each.
    pub(crate) fn conflicts_mut(&mut self) -> &mut [RouteConflict] {
        self.conflicts.first_mut().map_or(&mut [], |row| row)
    }
}
