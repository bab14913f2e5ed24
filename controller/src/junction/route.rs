//! A vehicle's path through the intersection: a polyline of fixed capacity, addressed by arc length.

use crate::geometry::{Point, Pose, distance};
use crate::junction::polyline::Polyline;
use heapless::Vec;

/// A polyline of at most `P` points, addressed by arc length `s` in metres from its first point.
///
/// Before its start and past its end a route goes on straight, so every finite
/// `s` has a pose. Consecutive points are at least [`Route::MIN_SPACING`] apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Route<const P: usize> {
    points: Vec<Point, P>,
    /// Arc length at each point; strictly increasing, first is 0.
    arc: Vec<f32, P>,
}

/// Why a polyline is not a route.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RouteError {
    /// Fewer than two points that are apart from each other.
    TooFewPoints,
    /// More points than the route's capacity.
    TooManyPoints,
    /// A coordinate is NaN, infinite, or more than [`Route::MAX_COORDINATE`] from the origin.
    OutOfRange,
}

impl core::fmt::Display for RouteError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::TooFewPoints => "a route needs two points that are apart",
            Self::TooManyPoints => "more points than the route's capacity",
            Self::OutOfRange => "a coordinate is not a number or too far from the origin",
        })
    }
}

impl core::error::Error for RouteError {}

impl<const P: usize> Route<P> {
    /// Points closer than this (m) to the one before them are dropped: they carry no direction.
    pub const MIN_SPACING: f32 = 0.01;
    /// Largest coordinate (m). Beyond it `f32` no longer resolves millimetres.
    pub const MAX_COORDINATE: f32 = 8192.0;

    /// A route through `points`, in order.
    ///
    /// Cost: O(points).
    ///
    /// # Errors
    /// See [`RouteError`].
    pub fn new(points: impl IntoIterator<Item = Point>) -> Result<Self, RouteError> {
        let mut route = Self {
            points: Vec::new(),
            arc: Vec::new(),
        };
        for point in points {
            route.push(point)?;
        }
        if route.points.len() < 2 {
            return Err(RouteError::TooFewPoints);
        }
        Ok(route)
    }

    fn push(&mut self, point: Point) -> Result<(), RouteError> {
        let in_range = |c: f32| c.abs() <= Self::MAX_COORDINATE;
        if !(in_range(point.x) && in_range(point.y)) {
            return Err(RouteError::OutOfRange);
        }
        let s = match (self.points.last(), self.arc.last()) {
            (Some(&last), Some(&s)) => {
                let step = distance(&last, &point);
                if step < Self::MIN_SPACING {
                    return Ok(());
                }
                s + step
            }
            _ => 0.0,
        };
        self.points
            .push(point)
            .map_err(|_| RouteError::TooManyPoints)?;
        self.arc.push(s).map_err(|_| RouteError::TooManyPoints)
    }

    /// The points and arc lengths, without the capacity in the type.
    #[must_use]
    pub fn polyline(&self) -> Polyline<'_> {
        Polyline::new(&self.points, &self.arc)
    }

    /// The same route, straight on by `before` metres at its start and by `after` metres at its end.
    ///
    /// It has as many points: the first and the last one are moved. Arc lengths grow by `before`.
    /// Cost: O(points).
    ///
    /// # Errors
    /// [`RouteError::OutOfRange`] if `before` or `after` is negative or not a number, or if an end
    /// would be more than [`Route::MAX_COORDINATE`] from the origin.
    pub fn extended(&self, before: f32, after: f32) -> Result<Self, RouteError> {
        if !(before >= 0.0 && after >= 0.0) {
            return Err(RouteError::OutOfRange);
        }
        let last = self.points.len().saturating_sub(1);
        let ends = [-before, self.length() + after].map(|s| self.pose(s).position);
        Self::new(self.points.iter().enumerate().map(|(i, &point)| match i {
            0 => ends[0],
            _ if i == last => ends[1],
            _ => point,
        }))
    }

    /// Length in metres; always positive.
    #[must_use]
    pub fn length(&self) -> f32 {
        self.polyline().length()
    }

    /// The points of the polyline, at least two.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// The arc length (m) at each of [`Route::points`].
    #[must_use]
    pub fn arc(&self) -> &[f32] {
        &self.arc
    }

    /// The pose at arc length `s` (m): [`Polyline::pose`].
    #[must_use]
    pub fn pose(&self, s: f32) -> Pose {
        self.polyline().pose(s)
    }

    /// Arc length (m) of the point of the polyline nearest to `point`: [`Polyline::project`].
    #[must_use]
    pub fn project(&self, point: Point) -> f32 {
        self.polyline().project(point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::unit;

    fn corner() -> Route<4> {
        Route::new([
            Point::new(0.0, 0.0),
            Point::new(10.0, 0.0),
            Point::new(10.0, 5.0),
        ])
        .unwrap()
    }

    #[test]
    fn poses_follow_the_polyline_and_go_straight_beyond_it() {
        let route = corner();
        assert_eq!(route.length(), 15.0);
        assert_eq!(route.pose(4.0).position, Point::new(4.0, 0.0));
        assert_eq!(route.pose(12.0).position, Point::new(10.0, 2.0));
        assert_eq!(route.pose(-1.0).position, Point::new(-1.0, 0.0));
        assert_eq!(route.pose(16.0).position, Point::new(10.0, 6.0));
        assert_eq!(route.pose(12.0).direction, unit(0.0, 1.0));
    }

    #[test]
    fn projection_inverts_pose() {
        let route = corner();
        for s in [0.0, 3.0, 10.0, 14.5, 15.0] {
            assert!((route.project(route.pose(s).position) - s).abs() < 1e-5);
        }
    }

    #[test]
    fn an_extended_route_goes_straight_on_at_both_ends() {
        let route = corner().extended(2.0, 3.0).unwrap();
        assert_eq!(route.points().len(), 3);
        assert_eq!(route.length(), 20.0);
        assert_eq!(route.pose(0.0).position, Point::new(-2.0, 0.0));
        assert_eq!(route.pose(20.0).position, Point::new(10.0, 8.0));
        assert_eq!(corner().extended(0.0, 0.0).unwrap(), corner());
        for (before, after) in [(-1.0, 0.0), (0.0, f32::NAN), (9000.0, 0.0)] {
            let refused = corner().extended(before, after);
            assert_eq!(refused.unwrap_err(), RouteError::OutOfRange);
        }
    }

    #[test]
    fn bad_polylines_are_refused() {
        let at = |x: f32| Point::new(x, 0.0);
        let error = |points: &[Point]| Route::<3>::new(points.iter().copied()).unwrap_err();
        assert_eq!(error(&[at(0.0), at(0.001)]), RouteError::TooFewPoints);
        let least = [at(0.0), at(Route::<3>::MIN_SPACING)];
        assert_eq!(Route::<3>::new(least).unwrap().points(), least);
        assert_eq!(error(&[at(0.0), at(f32::NAN)]), RouteError::OutOfRange);
        let many = [at(0.0), at(1.0), at(2.0), at(3.0)];
        assert_eq!(error(&many), RouteError::TooManyPoints);
    }
}
