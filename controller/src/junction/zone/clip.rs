//! What two motions have occupied: their rectangle in the (s, t) plane, cut by half-planes.

use super::body::Motion;
use super::cell::{opposite, parallel};
use super::patch::Patch;
use super::{FAR, INFLATION, Span, TOUCHING};
use crate::geometry::{Point, Vector};
use heapless::Vec;

/// A polygon in the (s, t) plane, both counted from the motions' starts.
type Polygon = Vec<Point, 12>;

/// What of the two motions is occupied.
// Not inlined, like `cut`: a microcontroller has no stack for all of their polygons at once.
#[inline(never)]
pub(super) fn meet(a: &Motion, b: &Motion) -> Option<Patch> {
    let between = a.start - b.start;
    let reach = a.length + b.length + a.half.0 + a.half.1 + b.half.0 + b.half.1;
    if between.dot(&between) > reach * reach {
        return None;
    }
    let mut limits = [Limit::default(); 4];
    for (limit, (axis, radius)) in limits.iter_mut().zip(axes(a, b)) {
        *limit = Limit {
            radius,
            offset: axis.dot(&between),
            along: axis.dot(&a.velocity),
            other_along: -axis.dot(&b.velocity),
        };
        let range = limit.range(a.length, b.length);
        if range.from > radius || range.to < -radius {
            return None;
        }
    }
    let mut polygon = rectangle(a.length, b.length);
    for limit in &limits {
        let range = limit.range(a.length, b.length);
        if range.to > limit.radius {
            cut(&mut polygon, limit, 1.0);
        }
        if range.from < -limit.radius {
            cut(&mut polygon, limit, -1.0);
        }
    }
    bounds(a, b, &polygon)
}

/// The rectangles overlap along one axis while |offset + along s + other_along t| ≤ radius.
#[derive(Clone, Copy, Default)]
struct Limit {
    radius: f32,
    offset: f32,
    along: f32,
    other_along: f32,
}

impl Limit {
    fn at(&self, p: Point) -> f32 {
        self.offset + self.along * p.x + self.other_along * p.y
    }

    /// Its values over the rectangle from (0, 0) to (`width`, `height`).
    fn range(&self, width: f32, height: f32) -> Span {
        let (x, y) = (self.along * width, self.other_along * height);
        let below = |v: f32| if v < 0.0 { v } else { 0.0 };
        Span {
            from: self.offset + below(x) + below(y),
            to: self.offset - below(-x) - below(-y),
        }
    }
}

/// The four directions in which two rectangles can be apart, each with the distance of their
/// centres from which they are. Across comes first: most segments near each other are lanes side by side.
fn axes(a: &Motion, b: &Motion) -> [(Vector, f32); 4] {
    let normal = |v: Vector| Vector::new(-v.y, v.x);
    let cos = a.direction.dot(&b.direction).abs();
    let sin = a.direction.perp(&b.direction).abs();
    let ((l, w), (other_l, other_w)) = (a.half, b.half);
    [
        (normal(a.direction), w + other_l * sin + other_w * cos),
        (normal(b.direction), other_w + l * sin + w * cos),
        (a.direction, l + other_l * cos + other_w * sin),
        (b.direction, other_l + l * cos + w * sin),
    ]
}

fn rectangle(width: f32, height: f32) -> Polygon {
    let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
    let mut polygon = Polygon::new();
    for (x, y) in corners {
        let _ = polygon.push(Point::new(x, y));
    }
    polygon
}

/// Leaves the part of a convex polygon in which the value of `limit`, times `side` (1 or -1), is no more than its radius
/// (Sutherland and Hodgman, 1974).
#[inline(never)]
fn cut(polygon: &mut Polygon, limit: &Limit, side: f32) {
    let inside = |p| limit.radius - side * limit.at(p);
    let mut kept = Polygon::new();
    // A cut by a line adds at most one corner, and 4 + 8 fit in the capacity. If rounding made it more,
    // the polygon would stay as it is: larger, not smaller.
    let mut fits = true;
    let mut keep = |p| fits &= kept.push(p).is_ok();
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
    if fits {
        *polygon = kept;
    }
}

fn bounds(a: &Motion, b: &Motion, polygon: &Polygon) -> Option<Patch> {
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
    let parallel = parallel(a, b);
    let offset = a.arc - b.arc;
    Some(Patch {
        ego: placed(ego, a),
        other: placed(other, b),
        lead: Span {
            from: lead.from + offset - INFLATION,
            to: lead.to + offset + INFLATION,
        },
        parallel: parallel.then_some([along(ego, a), along(other, b)]),
        starts: parallel && starts,
        ends: parallel && ends,
        mixed: opposite(a, b),
    })
}

/// An interval of a motion as arc lengths.
fn along(interval: Span, motion: &Motion) -> Span {
    Span {
        from: motion.arc + interval.from,
        to: motion.arc + interval.to,
    }
}

/// An interval of a motion as arc lengths; one that reaches an end of the route goes on past it.
fn placed(interval: Span, motion: &Motion) -> Span {
    Span {
        from: if motion.first && interval.from <= TOUCHING {
            -FAR
        } else {
            motion.arc + interval.from
        },
        to: if motion.last && interval.to >= motion.length - TOUCHING {
            FAR
        } else {
            motion.arc + interval.to
        },
    }
}
