//! Which pieces of two polylines are near each other: boxes around several pieces, then around each.

use super::body::{Body, Stage};
use crate::geometry::Point;
use crate::junction::polyline::Piece;
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

    fn around(p: Point, q: Point) -> Self {
        Self {
            low: p.inf(&q),
            high: p.sup(&q),
        }
    }

    fn near(&self, other: &Self, reach: f32) -> bool {
        (self.low.x <= other.high.x + reach)
            & (other.low.x <= self.high.x + reach)
            & (self.low.y <= other.high.y + reach)
            & (other.low.y <= self.high.y + reach)
    }
}

/// Whether the discs around two pieces come as near as `reach` (m); rounding is allowed for.
fn discs_near(a: &Piece, b: &Piece, reach: f32) -> bool {
    let between = (b.start - a.start) + (b.end - a.end);
    let twice = 1.01 * ((a.to - a.from) + (b.to - b.from)) + 2.0 * reach;
    between.dot(&between) <= twice * twice
}

/// Calls `meet` for all pairs of pieces, of `a` and of `b`, at which the footprints may touch, and for
/// some at which they cannot.
pub(super) fn near_pieces(a: &Body<'_>, b: &Body<'_>, mut meet: impl FnMut(&Stage, &Stage)) {
    let reach = a.reach() + b.reach();
    let (points, others) = (a.polyline.points(), b.polyline.points());
    for of_a in chunks(a.polyline.pieces()) {
        let around_a = Bounds::of(points, of_a.clone());
        for of_b in chunks(b.polyline.pieces()) {
            let around_b = Bounds::of(others, of_b.clone());
            if !around_a.near(&around_b, reach) {
                continue;
            }
            // What of the chunk was needed before.
            let mut known: [Option<Stage>; CHUNK] = [None; CHUNK];
            for i in of_a.clone() {
                let Some(this) = a.polyline.piece(i) else {
                    continue;
                };
                let piece = Bounds::around(this.start, this.end);
                if !piece.near(&around_b, reach) {
                    continue;
                }
                let mut stage = None;
                for (j, known) in of_b.clone().zip(&mut known) {
                    let close = b.polyline.piece(j).is_some_and(|other| {
                        discs_near(&this, &other, reach)
                            && piece.near(&Bounds::around(other.start, other.end), reach)
                    });
                    if !close {
                        continue;
                    }
                    if known.is_none() {
                        *known = b.stage(j);
                    }
                    if stage.is_none() {
                        stage = a.stage(i);
                    }
                    if let (Some(stage), Some(other)) = (&stage, known) {
                        meet(stage, other);
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
