//! Points, poses and footprints in the plane.

/// A point, or a vector between two points, in metres, in any fixed frame of the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Metres along the first axis (east).
    pub x: f32,
    /// Metres along the second axis (north).
    pub y: f32,
}

impl Point {
    /// The point at (`x`, `y`), in metres.
    ///
    /// Cost: constant. Never panics.
    #[must_use]
    pub const fn new(x: f32, y: f32) -> Self {
        Self { x, y }
    }

    /// Distance to `other` in metres.
    ///
    /// Cost: constant. Never panics.
    #[must_use]
    pub fn distance(self, other: Self) -> f32 {
        (other - self).norm()
    }

    /// Length of the vector in metres; correctly rounded square root, so the same bits everywhere.
    ///
    /// Cost: constant. Never panics.
    #[must_use]
    pub fn norm(self) -> f32 {
        libm::sqrtf(self.dot(self))
    }

    /// Scalar product in m².
    ///
    /// Cost: constant. Never panics.
    #[must_use]
    pub fn dot(self, other: Self) -> f32 {
        self.x * other.x + self.y * other.y
    }

    /// Third component of the cross product in m²: positive if `other` points to the left of `self`.
    ///
    /// Cost: constant. Never panics.
    #[must_use]
    pub fn cross(self, other: Self) -> f32 {
        self.x * other.y - self.y * other.x
    }
}

impl core::ops::Add for Point {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl core::ops::Sub for Point {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl core::ops::Mul<f32> for Point {
    type Output = Self;
    fn mul(self, factor: f32) -> Self {
        Self::new(self.x * factor, self.y * factor)
    }
}

/// Where a vehicle is and where it points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Centre of the footprint in metres.
    pub position: Point,
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
