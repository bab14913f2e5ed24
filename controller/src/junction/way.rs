//! What one approach needs of a junction, without its capacities in the type.

use crate::geometry::Point;
use crate::junction::conflict::RouteConflict;
use crate::junction::path::{Path, PathId, SpeedLimit};
use crate::junction::polyline::Polyline;
use crate::junction::profile::Profile;

/// A junction as the vehicles of one path see it: all paths, and how this one meets each of them.
#[derive(Clone, Copy, Debug)]
pub struct Way<'j> {
    pub(super) ego: PathId,
    pub(super) paths: &'j [Path],
    pub(super) points: &'j [Point],
    pub(super) arc: &'j [f32],
    /// One for each path.
    pub(super) conflicts: &'j [RouteConflict],
    pub(super) limits: &'j [SpeedLimit],
    pub(super) tolerance: f32,
    pub(super) lateral: f32,
}

impl<'j> Way<'j> {
    /// The path of the ego.
    #[must_use]
    pub const fn ego(self) -> PathId {
        self.ego
    }

    /// The number of paths of the junction.
    #[must_use]
    pub const fn paths(self) -> usize {
        self.paths.len()
    }

    /// A path; `None` if there is no such path.
    #[must_use]
    pub fn path(self, id: PathId) -> Option<&'j Path> {
        self.paths.get(id.index())
    }

    /// How the ego's path meets path `other`, which may be the same; `None` if there is no such path.
    #[must_use]
    pub fn conflict(self, other: PathId) -> Option<&'j RouteConflict> {
        self.conflicts.get(other.index())
    }

    /// How the ego's path meets each path, in their order.
    pub fn conflicts(self) -> impl Iterator<Item = (PathId, &'j RouteConflict)> {
        (0..=u8::MAX).map(PathId::new).zip(self.conflicts)
    }

    /// The points of a path; `None` if there is no such path.
    #[must_use]
    pub fn polyline(self, id: PathId) -> Option<Polyline<'j>> {
        let range = &self.path(id)?.range;
        Some(Polyline::new(
            self.points.get(range.clone())?,
            self.arc.get(range.clone())?,
        ))
    }

    /// What bounds the ego's speed along its path, whoever is there.
    #[must_use]
    pub fn profile(self) -> Profile<'j> {
        let polyline = self.polyline(self.ego).unwrap_or(Polyline::new(&[], &[]));
        Profile::new(polyline, self.limits, self.lateral)
    }

    /// How far (m) any point of a vehicle's footprint may be from where it is on its route.
    #[must_use]
    pub const fn tolerance(self) -> f32 {
        self.tolerance
    }
}
