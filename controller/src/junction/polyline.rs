//! Points with their arc lengths, wherever they are kept.

use crate::geometry::{Point, Pose, Vector, distance, unit};
use crate::real::Real;

/// A view of a polyline, addressed by arc length `s` in metres from its first point.
///
/// Before its start and past its end it goes on straight, so every finite `s` has a pose.
/// It is that of a [`Route`](crate::Route) or of a path of a [`Junction`](crate::Junction).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polyline<'a> {
    points: &'a [Point],
    arc: &'a [f32],
}

/// A straight piece of a polyline.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// Where it starts.
    pub(crate) start: Point,
    /// Where it ends.
    pub(crate) end: Point,
    /// Arc length (m) at its start.
    pub(crate) from: f32,
    /// Arc length (m) at its end.
    pub(crate) to: f32,
}

impl Piece {
    /// Metres of the plane for each metre of arc length; its length is 1, to rounding.
    pub(crate) fn velocity(&self) -> Vector {
        (self.end - self.start) * (1.0 / (self.to - self.from))
    }
}

impl<'a> Polyline<'a> {
    /// Of points that are apart from one another, and of their arc lengths; two at least.
    pub(crate) const fn new(points: &'a [Point], arc: &'a [f32]) -> Self {
        Self { points, arc }
    }

    /// Length in metres; always positive.
    #[must_use]
    pub fn length(self) -> f32 {
        self.arc.last().copied().unwrap_or(0.0)
    }

    /// The points, at least two.
    #[must_use]
    pub const fn points(self) -> &'a [Point] {
        self.points
    }

    /// The arc length (m) at each of [`Polyline::points`]; strictly increasing, the first is 0.
    #[must_use]
    pub const fn arc(self) -> &'a [f32] {
        self.arc
    }

    /// The number of straight pieces: one fewer than points.
    pub(crate) const fn pieces(self) -> usize {
        self.points.len().saturating_sub(1)
    }

    /// The piece from point `i` to the next.
    pub(crate) fn piece(self, i: usize) -> Option<Piece> {
        Some(Piece {
            start: *self.points.get(i)?,
            end: *self.points.get(i + 1)?,
            from: *self.arc.get(i)?,
            to: *self.arc.get(i + 1)?,
        })
    }

    /// The pose at arc length `s` (m), straight on beyond both ends.
    ///
    /// Cost: O(log points).
    #[must_use]
    pub fn pose(self, s: f32) -> Pose {
        let after = self.arc.partition_point(|&a| a <= s);
        let i = after.clamp(1, self.points.len().max(2) - 1);
        let Some(piece) = self.piece(i - 1) else {
            // Unreachable: there are two points at least.
            return Pose {
                position: Point::origin(),
                direction: unit(1.0, 0.0),
            };
        };
        let direction = piece.velocity();
        Pose {
            position: piece.start + direction * (s - piece.from),
            direction: unit(direction.x, direction.y),
        }
    }

    /// Arc length (m) of the point of the polyline nearest to `point`, in [0, length].
    ///
    /// Cost: O(points).
    #[must_use]
    pub fn project(self, point: Point) -> f32 {
        let mut best = (f32::INFINITY, 0.0);
        for piece in (0..self.pieces()).filter_map(|i| self.piece(i)) {
            let direction = piece.velocity();
            let along = (point - piece.start).dot(&direction);
            // Not `clamp`, which panics where it cannot see that the piece has a length.
            let along = within(along, piece.to - piece.from);
            let away = distance(&(piece.start + direction * along), &point);
            if away < best.0 {
                best = (away, piece.from + along);
            }
        }
        best.1
    }
}

/// `value` in [0, `length`].
pub(super) fn within(value: f32, length: f32) -> f32 {
    Real::min(Real::max(value, 0.0), length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_places_as_near_the_first_is_projected_to() {
        let points = [(0.0, 0.0), (10.0, 0.0), (10.0, 4.0), (0.0, 4.0)];
        let points = points.map(|(x, y)| Point::new(x, y));
        let line = Polyline::new(&points, &[0.0, 10.0, 14.0, 24.0]);
        let at = |x, y| line.project(Point::new(x, y));
        assert_eq!([at(5.0, 2.0), at(5.0, 1.9), at(5.0, 2.1)], [5.0, 5.0, 19.0]);
    }

    #[test]
    fn what_is_beyond_an_end_is_at_the_end() {
        assert_eq!(
            [-0.1, 0.0, 1.0, 3.0, 3.1].map(|s| within(s, 3.0)),
            [0.0, 0.0, 1.0, 3.0, 3.0]
        );
    }
}
