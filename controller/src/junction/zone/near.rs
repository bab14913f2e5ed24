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

    fn around(piece: &Piece) -> Self {
        Self {
            low: piece.start.inf(&piece.end),
            high: piece.start.sup(&piece.end),
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
// Not generic: once in flash.
pub(super) fn near_pieces(a: &Body<'_>, b: &Body<'_>, meet: &mut dyn FnMut(&Stage, &Stage)) {
    let reach = a.reach() + b.reach();
    let (points, others) = (a.polyline.points(), b.polyline.points());
    for of_a in chunks(a.polyline.pieces()) {
        let around_a = Bounds::of(points, of_a.clone());
        let mut stages_a = Stages::of(a, of_a.start);
        for of_b in chunks(b.polyline.pieces()) {
            let around_b = Bounds::of(others, of_b.clone());
            if !around_a.near(&around_b, reach) {
                continue;
            }
            let mut stages_b = Stages::of(b, of_b.start);
            for i in of_a.clone() {
                let Some(piece) = a.polyline.piece(i) else {
                    continue;
                };
                let around = Bounds::around(&piece);
                if !around.near(&around_b, reach) {
                    continue;
                }
                for j in of_b.clone() {
                    let close = b.polyline.piece(j).is_some_and(|other| {
                        discs_near(&piece, &other, reach)
                            && around.near(&Bounds::around(&other), reach)
                    });
                    if close && let (Some(a), Some(b)) = (stages_a.at(i), stages_b.at(j)) {
                        meet(a, b);
                    }
                }
            }
        }
    }
}

/// What moves on the pieces of one chunk, worked out when it is first needed.
struct Stages<'a> {
    body: &'a Body<'a>,
    from: usize,
    known: [Option<Stage>; CHUNK],
}

impl<'a> Stages<'a> {
    const fn of(body: &'a Body<'a>, from: usize) -> Self {
        Self {
            body,
            from,
            known: [None; CHUNK],
        }
    }

    fn at(&mut self, i: usize) -> Option<&Stage> {
        let known = self.known.get_mut(i.checked_sub(self.from)?)?;
        if known.is_none() {
            *known = self.body.stage(i);
        }
        known.as_ref()
    }
}

fn chunks(pieces: usize) -> impl Iterator<Item = Range<usize>> {
    (0..pieces)
        .step_by(CHUNK)
        .map(move |from| from..(from + CHUNK).min(pieces))
}
