//! The conflict point of two routes, which the policy counts distances to.

use crate::geometry::Point;
use crate::junction::polyline::{Piece, Polyline, within};
use crate::junction::zone::{Span, Zone, Zones};
use crate::real::{Real, sqrt};

/// A vehicle has reached the conflict point when it is nearer to it than this (m): the paper's rule.
pub const CONFLICT_RADIUS: f32 = 5.0;

/// Where on its own route (arc length, m) each of the two has reached the conflict point.
///
/// `first` is the one of their `zones` that the ego reaches first.
pub(super) fn conflict_points(
    ego: Polyline<'_>,
    other: Polyline<'_>,
    zones: &Zones,
    first: Option<&Zone>,
) -> (f32, f32) {
    match (crossing(ego, other, zones), first) {
        (Some(point), _) => (reach(ego, point), reach(other, point)),
        (None, Some(zone)) => (
            within(zone.ego.from, ego.length()),
            within(zone.other.from, other.length()),
        ),
        (None, None) => (ego.length(), other.length()),
    }
}

/// The first proper crossing of two polylines along the first of them. It is in one of their zones.
fn crossing(a: Polyline<'_>, b: Polyline<'_>, zones: &Zones) -> Option<Point> {
    let within = |piece: &Piece, side: fn(&Zone) -> Span| {
        let mut spans = zones.iter().flatten().map(side);
        spans.any(|span| piece.from <= span.to && span.from <= piece.to)
    };
    for p in pieces(a).filter(|p| within(p, |zone| zone.ego)) {
        let others = pieces(b).filter(|q| within(q, |zone| zone.other));
        let alongs = others.filter_map(|q| cross(p.start, p.end, q.start, q.end));
        if let Some(along) = alongs.reduce(Real::min) {
            return Some(p.start + (p.end - p.start) * along);
        }
    }
    None
}

fn pieces(route: Polyline<'_>) -> impl Iterator<Item = Piece> {
    (0..route.pieces()).filter_map(move |i| route.piece(i))
}

/// Where the open segment from `p` to `q` crosses that from `r` to `s`, as a fraction of `p` to `q`.
fn cross(p: Point, q: Point, r: Point, s: Point) -> Option<f32> {
    let (along, across) = (q - p, s - r);
    let (side_p, side_q) = (across.perp(&(p - r)), across.perp(&(q - r)));
    let (side_r, side_s) = (along.perp(&(r - p)), along.perp(&(s - p)));
    // A crossing in a corner of a polyline belongs to the segment that begins there.
    let crosses = |from: f32, to: f32| (from >= 0.0) != (to >= 0.0);
    (crosses(side_p, side_q) && crosses(side_r, side_s)).then(|| side_p / (side_p - side_q))
}

/// Arc length of the first point of `route` within [`CONFLICT_RADIUS`] of `point`; its end if there is none.
fn reach(route: Polyline<'_>, point: Point) -> f32 {
    for piece in pieces(route) {
        let direction = piece.velocity();
        // |start + direction·x − point| = radius, solved for the smaller x.
        let offset = piece.start - point;
        let half = offset.dot(&direction);
        let rest = offset.dot(&offset) - CONFLICT_RADIUS * CONFLICT_RADIUS;
        if rest <= 0.0 {
            return piece.from;
        }
        let discriminant = half * half - rest * direction.dot(&direction);
        if discriminant >= 0.0 {
            let x = (-half - sqrt(discriminant)) / direction.dot(&direction);
            if x >= 0.0 && x <= piece.to - piece.from {
                return piece.from + x;
            }
        }
    }
    route.length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::junction::{ConflictKind, Route};

    fn at(x: f32, y: f32) -> Point {
        Point::new(x, y)
    }

    fn route(points: &[(f32, f32)]) -> Route<8> {
        Route::new(points.iter().map(|&(x, y)| at(x, y))).unwrap()
    }

    /// A zone of these arc lengths, the ego's and the other's.
    fn zone(ego: [f32; 2], other: [f32; 2]) -> Zone {
        let span = |[from, to]: [f32; 2]| Span { from, to };
        let (ego, other, lead) = (span(ego), span(other), span([-1.0, 1.0]));
        let kind = ConflictKind::Crossing;
        Zone {
            ego,
            other,
            lead,
            kind,
        }
    }

    #[test]
    fn two_pieces_cross_where_one_goes_through_the_other() {
        let (p, q) = (at(-1.0, 2.0), at(7.0, 2.0));
        assert_eq!(cross(p, q, at(1.0, 0.0), at(1.0, 8.0)), Some(0.25));
        assert_eq!(cross(p, q, at(1.0, 8.0), at(1.0, 0.0)), Some(0.25));
        assert_eq!(cross(p, q, at(0.0, -1.0), at(6.0, 5.0)), Some(0.5));
        // Beside it, before it, beyond it, and along it.
        for (r, s) in [
            (at(1.0, 3.0), at(1.0, 8.0)),
            (at(1.0, 1.0), at(1.0, 0.0)),
            (at(-2.0, 0.0), at(-2.0, 8.0)),
            (at(8.0, 0.0), at(8.0, 8.0)),
            (at(-1.0, 3.0), at(7.0, 3.0)),
        ] {
            assert_eq!(cross(p, q, r, s), None, "{r}, {s}");
        }
    }

    #[test]
    fn a_crossing_in_a_corner_belongs_to_one_piece() {
        let (p, q) = (at(-4.0, 0.0), at(4.0, 0.0));
        let [below, corner, above] = [at(0.0, -3.0), at(0.0, 0.0), at(1.0, 3.0)];
        let crossings = [cross(p, q, below, corner), cross(p, q, corner, above)];
        assert_eq!(crossings.iter().flatten().count(), 1);
        let crossings = [
            cross(below, above, p, corner),
            cross(below, above, corner, q),
        ];
        assert_eq!(crossings.iter().flatten().count(), 1);
    }

    #[test]
    fn a_point_is_reached_where_a_route_first_comes_within_the_radius() {
        let reached = |points: &[(f32, f32)], x, y| reach(route(points).polyline(), at(x, y));
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-5, "{a}, {b}");
        near(reached(&[(-20.0, 0.0), (20.0, 0.0)], 0.0, 0.0), 15.0);
        near(reached(&[(-20.0, 3.0), (20.0, 3.0)], 0.0, 0.0), 16.0);
        // On a later piece, which is oblique: 5 m before the point, which is 10 m along it.
        let bent = [(-20.0, 0.0), (-6.0, 0.0), (6.0, 16.0)];
        near(reached(&bent, 0.0, 8.0), 14.0 + 5.0);
        // It begins within the radius; it ends before it; it never comes there.
        near(reached(&[(-4.0, 0.0), (20.0, 0.0)], 0.0, 0.0), 0.0);
        near(reached(&[(-20.0, 0.0), (-6.0, 0.0)], 0.0, 0.0), 14.0);
        near(reached(&[(6.0, 0.0), (20.0, 0.0)], 0.0, 0.0), 14.0);
        // It would come there beyond a piece in its middle.
        let aside = [(-30.0, 0.0), (-20.0, 0.0), (-10.0, 0.0), (-10.0, 9.0)];
        near(reached(&aside, 0.0, 0.0), 29.0);
        near(reached(&[(-20.0, 6.0), (20.0, 6.0)], 0.0, 0.0), 40.0);
        // A corner at the radius, to within rounding, is the end of one piece or the start of the other.
        near(
            reached(&[(-20.0, 0.0), (-5.0, 0.0), (-5.0, 9.0)], 0.0, 0.0),
            15.0,
        );
    }

    #[test]
    fn routes_meet_at_the_first_crossing_within_their_zones() {
        let ego = route(&[(0.0, 0.0), (30.0, 0.0), (60.0, 0.0)]);
        // Crosses at x = 50, then at 40, then at 10.
        let other = route(&[
            (50.0, -8.0),
            (50.0, 8.0),
            (40.0, 8.0),
            (40.0, -8.0),
            (10.0, -8.0),
            (10.0, 8.0),
        ]);
        let points = |of: &[Zone]| {
            let mut zones: Zones = Default::default();
            for (slot, zone) in zones.iter_mut().zip(of) {
                *slot = Some(*zone);
            }
            conflict_points(ego.polyline(), other.polyline(), &zones, of.first())
        };
        let meets = |of: &[Zone], at: (f32, f32)| {
            let (ego, other) = points(of);
            let near = (ego - at.0).abs() < 1e-4 && (other - at.1).abs() < 1e-4;
            assert!(near, "{ego}, {other}, not {at:?}");
        };
        let (all, first, last) = ([0.0, 60.0], [5.0, 15.0], [35.0, 55.0]);
        // Of two crossings on one piece, the one that the ego comes to first.
        meets(&[zone(last, all)], (35.0, 29.0));
        meets(&[zone(first, [72.0, 100.0])], (5.0, 75.0));
        // What is not in a zone does not count; a crossing that no zone has, neither.
        meets(&[zone(last, [0.0, 10.0])], (45.0, 3.0));
        meets(&[zone(first, [10.0, 20.0])], (5.0, 10.0));
        meets(&[zone([-9.0, 20.0], [20.0, 25.0])], (0.0, 20.0));
        meets(&[], (60.0, 88.0));
    }
}
