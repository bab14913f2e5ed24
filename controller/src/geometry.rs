//! Points, poses and footprints in the plane.

use crate::real::Real;

/// A point, or a vector between two points, in metres, in any fixed frame of the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point<R = f32> {
    /// Metres along the first axis (east).
    pub x: R,
    /// Metres along the second axis (north).
    pub y: R,
}

impl<R> Point<R> {
    /// The point at (`x`, `y`), in metres.
    #[must_use]
    pub const fn new(x: R, y: R) -> Self {
        Self { x, y }
    }
}

impl<R: Real> Point<R> {
    /// Distance to `other` in metres.
    #[must_use]
    pub fn distance(self, other: Self) -> R {
        (other - self).norm()
    }

    /// Length of the vector in metres; correctly rounded square root, so the same bits everywhere.
    #[must_use]
    pub fn norm(self) -> R {
        self.dot(self).sqrt()
    }

    /// Scalar product in m².
    #[must_use]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y
    }

    /// Third component of the cross product in m²: positive if `other` points to the left of `self`.
    #[must_use]
    pub fn cross(self, other: Self) -> R {
        self.x * other.y - self.y * other.x
    }
}

impl<R: Real> core::ops::Add for Point<R> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl<R: Real> core::ops::Sub for Point<R> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl<R: Real> core::ops::Mul<R> for Point<R> {
    type Output = Self;
    fn mul(self, factor: R) -> Self {
        Self::new(self.x * factor, self.y * factor)
    }
}

/// Where a vehicle is and where it points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<R = f32> {
    /// Centre of the footprint in metres.
    pub position: Point<R>,
    /// Unit vector of the heading; kept instead of an angle so that no trigonometry is needed.
    pub direction: Point,
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
