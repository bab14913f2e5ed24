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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Footprint;
    use crate::junction::route::Route;

    fn piece(start: (f32, f32), end: (f32, f32), length: f32) -> Piece {
        Piece {
            start: Point::new(start.0, start.1),
            end: Point::new(end.0, end.1),
            from: 10.0,
            to: 10.0 + length,
        }
    }

    #[test]
    fn boxes_are_near_if_they_come_within_reach_either_way() {
        let around = |x: f32, y: f32| Bounds::around(&piece((x, y + 2.0), (x + 4.0, y), 5.0));
        let one = around(0.0, 0.0);
        assert_eq!(
            (one.low, one.high),
            (Point::new(0.0, 0.0), Point::new(4.0, 2.0))
        );
        for (x, y, near) in [
            (6.9, 0.0, true),
            (7.1, 0.0, false),
            (-6.9, 0.0, true),
            (-7.1, 0.0, false),
            (0.0, 4.9, true),
            (0.0, 5.1, false),
            (0.0, -4.9, true),
            (0.0, -5.1, false),
        ] {
            assert_eq!(one.near(&around(x, y), 3.0), near, "{x}, {y}");
        }
    }

    #[test]
    fn a_box_is_around_the_points_of_its_pieces() {
        let points =
            [(0.0, 0.0), (1.0, 5.0), (2.0, -3.0), (9.0, 1.0)].map(|(x, y)| Point::new(x, y));
        let of = |pieces| Bounds::of(&points, pieces);
        let is = |bounds: Bounds, low: (f32, f32), high: (f32, f32)| {
            let corners = (Point::new(low.0, low.1), Point::new(high.0, high.1));
            assert_eq!((bounds.low, bounds.high), corners);
        };
        is(of(0..1), (0.0, 0.0), (1.0, 5.0));
        is(of(1..3), (1.0, -3.0), (9.0, 5.0));
        is(of(2..8), (2.0, -3.0), (9.0, 1.0));
        assert!(!of(1..1).near(&of(9..12), 1e3));
    }

    #[test]
    fn discs_are_near_by_half_of_each_length_and_the_reach() {
        // Middles at 0, and at x; lengths of 4 m and 6 m; a reach of 3 m; a hundredth more.
        let one = piece((-2.0, 0.0), (2.0, 0.0), 4.0);
        let at = |x: f32| piece((x, -3.0), (x, 3.0), 6.0);
        for (x, near) in [(8.04, true), (8.06, false), (-8.04, true), (-8.06, false)] {
            assert_eq!(discs_near(&one, &at(x), 3.0), near, "{x}");
            assert_eq!(discs_near(&at(x), &one, 3.0), near, "{x}");
        }
    }

    #[test]
    fn pieces_come_in_chunks_of_eight() {
        let all = |pieces| chunks(pieces).collect::<std::vec::Vec<_>>();
        assert_eq!(all(20), [0..8, 8..16, 16..20]);
        assert_eq!(all(16), [0..8, 8..16]);
        assert!(all(0).is_empty());
    }

    #[test]
    fn pieces_far_apart_are_not_met_and_all_that_are_near_are() {
        let points = (0..20_u8).map(|i| Point::new(5.0 * f32::from(i), 0.0));
        let long = Route::<32>::new(points).unwrap();
        let points = [-40.0, -20.0, 0.0, 20.0, 40.0].map(|y| Point::new(52.0, y));
        let short = Route::<8>::new(points).unwrap();
        let footprint = Footprint::PAPER;
        let [long, short] =
            [long.polyline(), short.polyline()].map(|line| Body::new(line, footprint, 0.0));
        let mut met = std::vec::Vec::new();
        near_pieces(&long, &short, &mut |a, b| {
            met.push((a.straight().arc, b.straight().arc));
        });
        // 5.5 m from the crossing at 52 m, or a little more.
        let mut expected = std::vec::Vec::new();
        for a in [45.0, 50.0, 55.0] {
            expected.extend([(a, 20.0), (a, 40.0)]);
        }
        assert!(expected.iter().all(|pair| met.contains(pair)), "{met:?}");
        assert!(
            met.iter()
                .all(|&(a, b)| (40.0..=60.0).contains(&a) && (20.0..=40.0).contains(&b)),
            "{met:?}"
        );
    }

    #[test]
    fn small_footprints_are_met_as_far_as_both_reach() {
        let walks = Footprint {
            length: 0.6,
            width: 0.6,
        };
        let met = |beside: f32| {
            let lines = [0.0, beside]
                .map(|y| Route::<2>::new([0.0, 5.0].map(|x| Point::new(x, y))).unwrap());
            let [a, b] = [0, 1].map(|i| Body::new(lines[i].polyline(), walks, 0.0));
            let mut count = 0;
            near_pieces(&a, &b, &mut |_, _| count += 1);
            count
        };
        // Each as far as 0.4997 m.
        assert_eq!([0.99, 1.01].map(met), [1, 0]);
    }
}
