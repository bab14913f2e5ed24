//! Which pieces of two polylines are near each other: boxes around several pieces, then around each.

use super::body::Body;
use crate::geometry::Point;
use core::ops::Range;

/// Pieces that share one box.
const CHUNK: usize = 8;

/// An axis-parallel box around points.
#[derive(Clone, Copy)]
struct Bounds {
    low: Point,
    high: Point,
}

impl Bounds {
    /// Around the points of pieces `pieces`; around nothing, and near nothing, if there are none.
    fn of(points: &[Point], pieces: Range<usize>) -> Self {
        let empty = Self {
            low: Point::new(f32::INFINITY, f32::INFINITY),
            high: Point::new(f32::NEG_INFINITY, f32::NEG_INFINITY),
        };
        let end = (pieces.end + 1).min(points.len());
        let around = points.get(pieces.start..end).unwrap_or_default();
        around.iter().fold(empty, |bounds, p| Self {
            low: bounds.low.inf(p),
            high: bounds.high.sup(p),
        })
    }

    fn near(&self, other: &Self, reach: f32) -> bool {
        (self.low.x <= other.high.x + reach)
            & (other.low.x <= self.high.x + reach)
            & (self.low.y <= other.high.y + reach)
            & (other.low.y <= self.high.y + reach)
    }
}

/// Calls `meet` for all pairs of pieces, of `a` and of `b`, at which the footprints may touch, and for
/// some at which they cannot.
pub(super) fn near_pieces(a: &Body<'_>, b: &Body<'_>, mut meet: impl FnMut(usize, usize)) {
    let reach = a.reach() + b.reach();
    let (points, others) = (a.polyline.points(), b.polyline.points());
    for of_a in chunks(a.polyline.pieces()) {
        let around_a = Bounds::of(points, of_a.clone());
        for of_b in chunks(b.polyline.pieces()) {
            let around_b = Bounds::of(others, of_b.clone());
            if !around_a.near(&around_b, reach) {
                continue;
            }
            for i in of_a.clone() {
                let piece = Bounds::of(points, i..i + 1);
                if !piece.near(&around_b, reach) {
                    continue;
                }
                for j in of_b.clone() {
                    if piece.near(&Bounds::of(others, j..j + 1), reach) {
                        meet(i, j);
                    }
                }
            }
        }
    }
}

fn chunks(pieces: usize) -> impl Iterator<Item = Range<usize>> {
    (0..pieces)
        .step_by(CHUNK)
        .map(move |from| from..(from + CHUNK).min(pieces))
}
