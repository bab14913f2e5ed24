//! The conflict point of two routes, which the policy counts distances to.

use crate::geometry::Point;
use crate::junction::polyline::{Piece, Polyline, within};
use crate::junction::zone::{Span, Zone, Zones};
use crate::real::sqrt;

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
        if let Some(along) =
            alongs.reduce(|nearest, along| if along < nearest { along } else { nearest })
        {
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
