//! Points, vectors, poses and footprints in the plane: [`nalgebra`]'s types, in metres.
//!
//! [`nalgebra`] is used without features, so on a microcontroller it has no square root: lengths are
//! those of [`length`] and [`distance`], which have the same bits everywhere.

use crate::real::sqrt;
use nalgebra::{Point2, Scalar, Unit, UnitVector2, Vector2};

/// A point in metres, in any fixed frame of the plane: first axis east, second north.
pub type Point<R = f32> = Point2<R>;

/// The difference of two points, in metres.
pub type Vector<R = f32> = Vector2<R>;

/// A direction: a vector of length 1.
pub type UnitVector = UnitVector2<f32>;

/// The direction (`x`, `y`), which the caller knows to have length 1: its bits stay as they are.
#[must_use]
#[inline]
pub const fn unit(x: f32, y: f32) -> UnitVector {
    Unit::new_unchecked(Vector::new(x, y))
}

/// Length of `vector` in metres; correctly rounded square root, so the same bits everywhere.
#[must_use]
#[inline]
pub fn length(vector: &Vector) -> f32 {
    sqrt(vector.dot(vector))
}

/// Distance between two points in metres, with the same bits everywhere.
#[must_use]
#[inline]
pub fn distance(a: &Point, b: &Point) -> f32 {
    length(&(b - a))
}

/// Where a vehicle is and where it points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<R: Scalar = f32> {
    /// Centre of the footprint in metres.
    pub position: Point<R>,
    /// Unit vector of the heading; kept instead of an angle so that no trigonometry is needed.
    pub direction: UnitVector,
}

/// The rectangle that a vehicle covers, centred on its reference point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Metres from bumper to bumper.
    pub length: f32,
    /// Metres from side to side.
    pub width: f32,
}

impl Footprint {
    /// The paper's vehicle: 5.0 m × 2.0 m.
    pub const PAPER: Self = Self {
        length: 5.0,
        width: 2.0,
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Decisions depend on the order of nalgebra's operations: no other order has these bits.
        #[test]
        fn products_and_lengths_have_the_bits_of_their_formulas(bits in any::<[u32; 4]>()) {
            let [x, y, u, v] = bits.map(f32::from_bits);
            let (a, b) = (Vector::new(x, y), Vector::new(u, v));
            let same = |found: f32, formula: f32| {
                found.to_bits() == formula.to_bits() || (found.is_nan() && formula.is_nan())
            };
            prop_assert!(same(a.dot(&b), x * u + y * v));
            prop_assert!(same(a.perp(&b), x * v - y * u));
            prop_assert!(same(length(&a), libm::sqrtf(x * x + y * y)));
            let unit = unit(x, y);
            prop_assert!(same(unit.x, x) && same(unit.y, y));
        }
    }
}
