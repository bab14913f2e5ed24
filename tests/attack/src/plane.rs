//! Polylines and rectangles in the plane, in f64.

/// A point or a vector, in metres.
pub type V2 = [f64; 2];

/// `a + k b`.
#[must_use]
pub fn along(a: V2, b: V2, k: f64) -> V2 {
    [a[0] + k * b[0], a[1] + k * b[1]]
}

/// `a − b`.
#[must_use]
pub fn minus(a: V2, b: V2) -> V2 {
    [a[0] - b[0], a[1] - b[1]]
}

/// Scalar product.
#[must_use]
pub fn dot(a: V2, b: V2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Length of a vector.
#[must_use]
pub fn norm(a: V2) -> f64 {
    dot(a, a).sqrt()
}

/// The unit vector along `a`, which is not 0.
#[must_use]
pub fn direction(a: V2) -> V2 {
    let length = norm(a);
    [a[0] / length, a[1] / length]
}

/// The unit vector at `angle` (rad).
#[must_use]
pub fn heading(angle: f64) -> V2 {
    [angle.cos(), angle.sin()]
}

/// `a` turned to the left by a right angle.
#[must_use]
pub fn left(a: V2) -> V2 {
    [-a[1], a[0]]
}

/// `a` turned by `angle` (rad), counter-clockwise.
#[must_use]
pub fn turned(a: V2, angle: f64) -> V2 {
    let (sin, cos) = angle.sin_cos();
    [cos * a[0] - sin * a[1], sin * a[0] + cos * a[1]]
}

/// Where a vehicle's centre is, and the unit vector in which it points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Centre of the rectangle.
    pub at: V2,
    /// Unit vector of the heading.
    pub to: V2,
}

/// Length and width of a rectangle in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Metres from bumper to bumper.
    pub length: f64,
    /// Metres from side to side.
    pub width: f64,
}

impl Size {
    /// Half of the diagonal: no corner is farther from the centre.
    #[must_use]
    pub fn radius(self) -> f64 {
        0.5 * self.length.hypot(self.width)
    }
}

/// The distance between two rectangles along the axis that separates them best: no more than their true
/// distance, and negative exactly if they overlap.
#[must_use]
pub fn separation(a: Place, size_a: Size, b: Place, size_b: Size) -> f64 {
    let apart = minus(b.at, a.at);
    let (cos, sin) = (dot(a.to, b.to).abs(), dot(left(a.to), b.to).abs());
    let [la, wa] = [0.5 * size_a.length, 0.5 * size_a.width];
    let [lb, wb] = [0.5 * size_b.length, 0.5 * size_b.width];
    let gaps = [
        dot(apart, a.to).abs() - la - lb * cos - wb * sin,
        dot(apart, left(a.to)).abs() - wa - lb * sin - wb * cos,
        dot(apart, b.to).abs() - lb - la * cos - wa * sin,
        dot(apart, left(b.to)).abs() - wb - la * sin - wa * cos,
    ];
    gaps.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    fn corners(place: Place, size: Size) -> [V2; 4] {
        [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)].map(|(x, y)| {
            let front = along(place.at, place.to, 0.5 * size.length * x);
            along(front, left(place.to), 0.5 * size.width * y)
        })
    }

    /// Whether some point of a fine grid of `a` is in `b`.
    fn share_a_point(a: Place, sa: Size, b: Place, sb: Size) -> bool {
        let [c, ..] = corners(a, sa);
        let inside = |p: V2| {
            let d = minus(p, b.at);
            dot(d, b.to).abs() <= 0.5 * sb.length && dot(d, left(b.to)).abs() <= 0.5 * sb.width
        };
        (0..=40).any(|i| {
            (0..=40).any(|j| {
                let p = along(c, a.to, -sa.length * f64::from(i) / 40.0);
                inside(along(p, left(a.to), -sa.width * f64::from(j) / 40.0))
            })
        })
    }

    #[test]
    fn separation_agrees_with_points_of_both() {
        let mut rng = Rng::new(3);
        let mut both = [0; 2];
        for _ in 0..3000 {
            let mut place = || Place {
                at: [rng.within(-4.0, 4.0), rng.within(-4.0, 4.0)],
                to: heading(rng.within(0.0, 7.0)),
            };
            let (a, b) = (place(), place());
            let size = Size {
                length: rng.within(0.5, 6.0),
                width: rng.within(0.5, 3.0),
            };
            let gap = separation(a, size, b, size);
            if gap.abs() > 0.2 {
                assert_eq!(gap < 0.0, share_a_point(a, size, b, size), "{a:?} {b:?}");
                both[usize::from(gap < 0.0)] += 1;
            }
        }
        assert!(both[0] > 500 && both[1] > 500);
    }
}
