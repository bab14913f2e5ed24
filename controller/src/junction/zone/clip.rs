//! What two segments have occupied: their rectangle in the (s, t) plane, cut by half-planes.

use super::join::Patch;
use super::{FAR, INFLATION, Span, TOUCHING};
use crate::geometry::{Footprint, Point, Vector};
use crate::junction::route::Route;
use heapless::Vec;

/// Two directions whose cosine is above this point the same way: within 30°.
const PARALLEL: f32 = 0.866;

/// A vehicle on one segment of its route.
pub(super) struct Segment {
    start: Point,
    direction: Vector,
    /// Arc length at the start.
    arc: f32,
    length: f32,
    first: bool,
    last: bool,
    /// Half the footprint's length and width, inflated.
    half: (f32, f32),
}

pub(super) fn segments<const P: usize>(
    route: &Route<P>,
    footprint: Footprint,
) -> impl Iterator<Item = Segment> {
    let ends = route.points().iter().zip(route.points().iter().skip(1));
    let arcs = route.arc().iter().zip(route.arc().iter().skip(1));
    let count = route.points().len();
    ends.zip(arcs)
        .enumerate()
        .map(move |(i, ((&a, &b), (&from, &to)))| Segment {
            start: a,
            direction: (b - a) * (1.0 / (to - from)),
            arc: from,
            length: to - from,
            first: i == 0,
            last: i + 2 == count,
            half: (
                0.5 * footprint.length + INFLATION,
                0.5 * footprint.width + INFLATION,
            ),
        })
}

/// A polygon in the (s, t) plane, both counted from the segments' starts.
type Polygon = Vec<Point, 12>;

/// What of the two segments is occupied.
// Not inlined, like `cut`: a microcontroller has no stack for all of their polygons at once.
#[inline(never)]
pub(super) fn meet(a: &Segment, b: &Segment) -> Option<Patch> {
    let between = a.start - b.start;
    let reach = a.length + b.length + a.half.0 + a.half.1 + b.half.0 + b.half.1;
    if between.dot(&between) > reach * reach {
        return None;
    }
    let mut polygon = rectangle(a.length, b.length);
    for (axis, radius) in axes(a, b) {
        let (along, other_along) = (axis.dot(&a.direction), -axis.dot(&b.direction));
        let offset = axis.dot(&between);
        for side in [-1.0, 1.0] {
            cut(&mut polygon, |p| {
                radius + side * (offset + along * p.x + other_along * p.y)
            });
        }
    }
    bounds(a, b, &polygon)
}

/// The four directions in which two rectangles can be apart, each with the distance of their
/// centres from which they are.
fn axes(a: &Segment, b: &Segment) -> [(Vector, f32); 4] {
    let normal = |v: Vector| Vector::new(-v.y, v.x);
    let radius = |half: (f32, f32), direction: Vector, axis: Vector| {
        half.0 * axis.dot(&direction).abs() + half.1 * axis.perp(&direction).abs()
    };
    [
        a.direction,
        normal(a.direction),
        b.direction,
        normal(b.direction),
    ]
    .map(|axis| {
        let radius = radius(a.half, a.direction, axis) + radius(b.half, b.direction, axis);
        (axis, radius)
    })
}

fn rectangle(width: f32, height: f32) -> Polygon {
    let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
    let mut polygon = Polygon::new();
    for (x, y) in corners {
        let _ = polygon.push(Point::new(x, y));
    }
    polygon
}

/// Leaves the part of a convex polygon in which `inside` is not negative (Sutherland and Hodgman, 1974).
#[inline(never)]
fn cut(polygon: &mut Polygon, inside: impl Fn(Point) -> f32) {
    let mut kept = Polygon::new();
    // A cut by a line adds at most one corner, and 4 + 8 fit in the capacity: `push` never fails.
    let mut keep = |p| {
        let _ = kept.push(p);
    };
    let ahead = polygon.iter().cycle().skip(1);
    for (&p, &q) in polygon.iter().zip(ahead) {
        let (at_p, at_q) = (inside(p), inside(q));
        if at_p >= 0.0 {
            keep(p);
        }
        if (at_p >= 0.0) != (at_q >= 0.0) {
            keep(p + (q - p) * (at_p / (at_p - at_q)));
        }
    }
    *polygon = kept;
}

fn bounds(a: &Segment, b: &Segment, polygon: &Polygon) -> Option<Patch> {
    let first = *polygon.first()?;
    let point = |value| Span {
        from: value,
        to: value,
    };
    let (mut ego, mut other) = (point(first.x), point(first.y));
    let mut lead = point(first.x - first.y);
    for p in polygon {
        ego = ego.including(p.x);
        other = other.including(p.y);
        lead = lead.including(p.x - p.y);
    }
    let starts = (a.first && ego.from <= TOUCHING) || (b.first && other.from <= TOUCHING);
    let ends =
        (a.last && ego.to >= a.length - TOUCHING) || (b.last && other.to >= b.length - TOUCHING);
    let parallel = a.direction.dot(&b.direction) > PARALLEL;
    let offset = a.arc - b.arc;
    Some(Patch {
        ego: placed(ego, a),
        other: placed(other, b),
        lead: Span {
            from: lead.from + offset - INFLATION,
            to: lead.to + offset + INFLATION,
        },
        parallel: parallel.then_some(Span {
            from: a.arc + ego.from,
            to: a.arc + ego.to,
        }),
        starts: parallel && starts,
        ends: parallel && ends,
    })
}

/// An interval on a segment as arc lengths; one that reaches an end of the route goes on past it.
fn placed(interval: Span, segment: &Segment) -> Span {
    Span {
        from: if segment.first && interval.from <= TOUCHING {
            -FAR
        } else {
            segment.arc + interval.from
        },
        to: if segment.last && interval.to >= segment.length - TOUCHING {
            FAR
        } else {
            segment.arc + interval.to
        },
    }
}
