//! Whether two rectangles overlap: this crate's own test, in double precision.

use super::line::Place;
use cede_controller::Footprint;

/// What a vehicle covers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rectangle {
    place: Place,
    /// Half of length and width, in metres.
    half: [f64; 2],
}

impl Rectangle {
    pub(crate) fn new(place: Place, footprint: Footprint) -> Self {
        let half = [footprint.length, footprint.width].map(|side| 0.5 * f64::from(side));
        Self { place, half }
    }

    fn corners(&self) -> [[f64; 2]; 4] {
        let ([x, y], [cos, sin]) = (self.place.at, self.place.towards);
        let [l, w] = self.half;
        [(l, w), (l, -w), (-l, -w), (-l, w)]
            .map(|(l, w)| [x + l * cos - w * sin, y + l * sin + w * cos])
    }

    /// By how much (m) they overlap: the least distance by which one would have to be moved. 0 if they are apart.
    pub(crate) fn overlap(&self, other: &Self) -> f64 {
        let axes = [self, other].map(|body| {
            let [x, y] = body.place.towards;
            [[x, y], [-y, x]]
        });
        let (own, others) = (self.corners(), other.corners());
        axes.as_flattened()
            .iter()
            .fold(f64::INFINITY, |least, axis| {
                let [a, b] = [&own, &others].map(|corners| extent(corners, *axis));
                least.min((a[1] - b[0]).min(b[1] - a[0]))
            })
            .max(0.0)
    }
}

/// The least and the largest coordinate along `axis`.
fn extent(corners: &[[f64; 2]; 4], axis: [f64; 2]) -> [f64; 2] {
    let along = corners.map(|[x, y]| x * axis[0] + y * axis[1]);
    along
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(*x), high.max(*x)]
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, degrees: f64) -> Rectangle {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Rectangle::new(
            Place {
                at: [x, y],
                towards: [cos, sin],
            },
            Footprint::PAPER,
        )
    }

    #[test]
    fn rectangles_overlap_by_what_parts_them() {
        let overlap = |a: Rectangle, b: Rectangle| a.overlap(&b);
        assert_eq!(overlap(at(0.0, 0.0, 0.0), at(7.0, 0.0, 0.0)), 0.0);
        assert!((overlap(at(0.0, 0.0, 0.0), at(4.0, 0.0, 0.0)) - 1.0).abs() < 1e-9);
        assert!((overlap(at(0.0, 0.0, 0.0), at(3.0, 0.0, 90.0)) - 0.5).abs() < 1e-9);
        // Bounding boxes overlap, the vehicles do not.
        assert_eq!(overlap(at(0.0, 0.0, 0.0), at(3.2, 2.8, 135.0)), 0.0);
    }
}
