//! The fast collision test: oriented rectangle against oriented rectangle, by separating axes.
//!
//! Two convex shapes are apart exactly if some line separates them; for two
//! rectangles it suffices to try the four directions of their sides (Gottschalk,
//! Lin and Manocha, "OBBTree", SIGGRAPH 1996). Only +, −, × and comparisons are used, so the result
//! has the same bits on every machine.

use crate::geometry::{Footprint, Point, Pose, Vector};
use crate::real::Elementary;
use nalgebra::Scalar;

/// A rectangle anywhere in the plane: what a vehicle covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox<R: Scalar = f32> {
    /// Centre in metres.
    pub centre: Point<R>,
    /// Unit vector along the length.
    pub direction: Vector<R>,
    /// Half of the length in metres.
    pub half_length: R,
    /// Half of the width in metres.
    pub half_width: R,
}

impl OrientedBox {
    /// What a vehicle with `footprint` covers at `pose`.
    #[must_use]
    #[inline]
    pub fn new(pose: Pose, footprint: Footprint) -> Self {
        Self {
            centre: pose.position,
            direction: pose.direction.into_inner(),
            half_length: 0.5 * footprint.length,
            half_width: 0.5 * footprint.width,
        }
    }

    /// Whether the two rectangles share a point (touching counts).
    ///
    /// False if a coordinate is NaN. Cost: about 30 multiplications and additions.
    #[must_use]
    #[inline]
    pub fn overlaps(&self, other: &Self) -> bool {
        let [a, b, c, d] = self.separations(other);
        // Without short circuits: four comparisons cost less than one mispredicted branch.
        (a <= 0.0) & (b <= 0.0) & (c <= 0.0) & (d <= 0.0)
    }
}

impl<R: Elementary> OrientedBox<R> {
    /// The widest gap (m) seen along the four directions of the sides.
    ///
    /// Positive: the rectangles are at least so far apart (exactly so, if an edge
    /// of one faces the other). Negative: they overlap, and this is how far one must
    /// be moved to part them. Symmetric to rounding.
    #[must_use]
    #[inline]
    pub fn separation(&self, other: &Self) -> R {
        let [a, b, c, d] = self.separations(other);
        a.max(b).max(c.max(d))
    }

    /// The squared distance (m²) of the two centres.
    #[must_use]
    #[inline]
    pub fn centres_apart_squared(&self, other: &Self) -> R {
        let (x, y) = (
            other.centre.x - self.centre.x,
            other.centre.y - self.centre.y,
        );
        x * x + y * y
    }

    /// Gap along each of the four directions: own length and width, the other's length and width.
    #[inline]
    fn separations(&self, other: &Self) -> [R; 4] {
        // By components: not every number has the assigning operators of nalgebra's vectors.
        let dot = |a: &Vector<R>, b: &Vector<R>| a.x * b.x + a.y * b.y;
        let cross = |a: &Vector<R>, b: &Vector<R>| a.x * b.y - a.y * b.x;
        let (from, to) = (&self.centre, &other.centre);
        let between = Vector::new(to.x - from.x, to.y - from.y);
        let (along, other_along) = (&self.direction, &other.direction);
        let cos = dot(along, other_along).abs();
        let sin = cross(along, other_along).abs();
        let (l, w) = (self.half_length, self.half_width);
        let (other_l, other_w) = (other.half_length, other.half_width);
        [
            dot(&between, along).abs() - (other_l * cos + other_w * sin + l),
            cross(&between, along).abs() - (other_l * sin + other_w * cos + w),
            dot(&between, other_along).abs() - (l * cos + w * sin + other_l),
            cross(&between, other_along).abs() - (l * sin + w * cos + other_w),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{distance, unit};
    use core::f32::consts::{FRAC_1_SQRT_2, SQRT_2};
    use proptest::prelude::*;

    fn vehicle(x: f32, y: f32, heading: f32) -> OrientedBox {
        let pose = Pose {
            position: Point::new(x, y),
            direction: unit(heading.cos(), heading.sin()),
        };
        OrientedBox::new(pose, Footprint::PAPER)
    }

    #[test]
    fn gaps_between_parallel_vehicles() {
        let a = vehicle(0.0, 0.0, 0.0);
        assert_eq!(a.separation(&vehicle(7.0, 0.0, 0.0)), 2.0);
        assert_eq!(a.separation(&vehicle(0.0, 2.5, 0.0)), 0.5);
        assert_eq!(a.separation(&vehicle(4.0, 0.0, 0.0)), -1.0);
        assert!(a.overlaps(&vehicle(5.0, 2.0, 0.0)), "touching corners");
        assert!(!a.overlaps(&vehicle(5.001, 2.0, 0.0)));
    }

    #[test]
    fn a_corner_that_points_at_a_side() {
        // A 2 × 2 square turned by 45° has its corner √2 from its centre.
        let mut square = vehicle(0.0, 0.0, 0.0);
        square.direction = Vector::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2);
        square.half_length = 1.0;
        let gap = |x| vehicle(x, 0.0, 0.0).separation(&square);
        assert!((gap(2.5 + SQRT_2 + 0.01) - 0.01).abs() < 1e-5);
        assert!((gap(2.5 + SQRT_2 - 0.01) + 0.01).abs() < 1e-5);
    }

    #[test]
    fn boxes_apart_whose_bounding_boxes_overlap() {
        // The other stands askew beside a corner: only the other's own side separates them.
        let a = vehicle(0.0, 0.0, 0.0);
        let b = vehicle(3.2, 2.8, core::f32::consts::FRAC_PI_4 * 3.0);
        assert!(!a.overlaps(&b) && !b.overlaps(&a));
    }

    proptest! {
        /// The corners and the centre of a vehicle are in it; nothing farther than the two
        /// half diagonals is.
        #[test]
        fn overlap_is_symmetric_and_bounded_by_the_circles(
            x in -8.0_f32..8.0, y in -8.0_f32..8.0,
            heading in -3.2_f32..3.2, other_heading in -3.2_f32..3.2,
        ) {
            let (a, b) = (vehicle(0.0, 0.0, heading), vehicle(x, y, other_heading));
            let between = distance(&a.centre, &b.centre);
            prop_assert!((a.separation(&b) - b.separation(&a)).abs() < 1e-5);
            prop_assert_eq!(a.overlaps(&b), a.separation(&b) <= 0.0);
            if between < 2.0 { prop_assert!(a.overlaps(&b)); }
            if between > 29.0_f32.sqrt() + 1e-4 { prop_assert!(!a.overlaps(&b)); }
        }
    }
}
