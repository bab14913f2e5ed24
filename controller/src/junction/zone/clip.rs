//! What two motions have occupied: their rectangle in the (s, t) plane, cut by half-planes.

use super::body::Motion;
use super::cell::{opposite, parallel};
use super::patch::Patch;
use super::{FAR, INFLATION, Span, TOUCHING};
use crate::geometry::{Point, Vector};
use crate::real::Real;
use heapless::Vec;

/// What grows by less than this along an axis (m for each m) is taken to say nothing of where it ends.
const LEAST_SLOPE: f32 = 0.1;

/// A polygon in the (s, t) plane, both counted from the motions' starts.
type Polygon = Vec<Point, 12>;

/// What of the two motions is occupied.
// Not inlined, like `cut`: a microcontroller has no stack for all of their polygons at once.
#[inline(never)]
pub(super) fn meet(a: &Motion, b: &Motion) -> Option<Patch> {
    let limits = limits(a, b)?;
    let mut polygon = rectangle(a.length, b.length);
    for limit in &limits {
        let range = limit.range(a.length, b.length);
        for (side, most) in [(1.0, range.to), (-1.0, -range.from)] {
            if most > limit.radius {
                cut(&mut polygon, limit, side);
            }
        }
    }
    bounds(a, b, &polygon)
}

/// Along which axes the rectangles have to overlap; none, if along one of them they never do.
pub(super) fn limits(a: &Motion, b: &Motion) -> Option<[Limit; 4]> {
    let between = a.start - b.start;
    if far_apart(a, b, between) {
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
        if limit.excludes(range) {
            return None;
        }
    }
    Some(limits)
}

/// A lower bound of the first one's arc length minus the second one's where the two touch; none, if they never do.
///
/// With what [`meet`] allows for rounding: no polygon's least lead is lower by more than rounding.
pub(super) fn least_lead(a: &Motion, b: &Motion) -> Option<f32> {
    let [.., one, other] = limits(a, b)?;
    let least = Real::max(one.least_lead(a.length), other.least_lead(a.length));
    Some(a.arc - b.arc + Real::max(least, -b.length) - INFLATION)
}

/// Whether nothing of the two can touch, `between` their starts.
fn far_apart(a: &Motion, b: &Motion, between: Vector) -> bool {
    let reach = a.length + b.length + a.half.0 + a.half.1 + b.half.0 + b.half.1;
    between.dot(&between) > reach * reach
}

/// The rectangles overlap along one axis while |offset + along s + other_along t| ≤ radius.
#[derive(Clone, Copy, Default)]
pub(super) struct Limit {
    radius: f32,
    offset: f32,
    along: f32,
    other_along: f32,
}

impl Limit {
    fn at(&self, p: Point) -> f32 {
        self.offset + self.along * p.x + self.other_along * p.y
    }

    /// Whether the rectangles are apart wherever its value is in `range`.
    fn excludes(&self, range: Span) -> bool {
        range.from > self.radius || range.to < -self.radius
    }

    /// A lower bound of s − t where its value is at least −radius and s is in [0, `width`].
    fn least_lead(&self, width: f32) -> f32 {
        // t ≤ (offset + radius + along s) / back
        let back = -self.other_along;
        if back < LEAST_SLOPE {
            return -FAR;
        }
        let slope = 1.0 - self.along / back;
        Real::min(0.0, slope * width) - (self.offset + self.radius) / back
    }

    /// Its values over the rectangle from (0, 0) to (`width`, `height`).
    fn range(&self, width: f32, height: f32) -> Span {
        let (x, y) = (self.along * width, self.other_along * height);
        let below = |v: f32| Real::min(0.0, v);
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
    let inside = |p: &Point| limit.radius - side * limit.at(*p);
    if polygon.iter().all(|p| inside(p) >= 0.0) {
        return;
    }
    let mut kept = Polygon::new();
    // A cut by a line adds at most one corner, and 4 + 8 fit in the capacity. If rounding made it more,
    // the polygon would stay as it is: larger, not smaller.
    let mut fits = true;
    let mut keep = |p| fits &= kept.push(p).is_ok();
    let Some(&first) = polygon.first() else {
        return;
    };
    let (mut p, mut at_p) = (first, inside(&first));
    for &q in polygon.iter().skip(1).chain([&first]) {
        let at_q = inside(&q);
        if at_p >= 0.0 {
            keep(p);
        }
        if (at_p >= 0.0) != (at_q >= 0.0) {
            keep(p + (q - p) * (at_p / (at_p - at_q)));
        }
        (p, at_p) = (q, at_q);
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A vehicle of 5 m × 2 m from `start` on, in direction `degrees`.
    fn motion(start: (f32, f32), degrees: f32, length: f32) -> Motion {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let direction = Vector::new(cos, sin);
        Motion {
            start: Point::new(start.0, start.1),
            velocity: direction,
            direction,
            arc: 100.0,
            length,
            turning: false,
            first: false,
            last: false,
            half: (2.5, 1.0),
        }
    }

    #[track_caller]
    fn is(span: Span, from: f32, to: f32) {
        let near = (span.from - from).abs() < 1e-3 && (span.to - to).abs() < 1e-3;
        assert!(near, "{span:?}, not {from} to {to}");
    }

    #[test]
    fn motions_are_far_apart_beyond_all_their_lengths() {
        let a = Motion {
            half: (3.0, 1.5),
            ..motion((0.0, 0.0), 0.0, 6.0)
        };
        let b = motion((0.0, 0.0), 0.0, 9.0);
        let apart = |x: f32, y: f32| far_apart(&a, &b, Vector::new(x, y));
        // 6 + 9 + 3 + 1.5 + 2.5 + 1 m.
        assert!(!apart(22.9, 0.0) && !apart(0.0, -22.9) && !apart(-23.0, 0.0));
        assert!(apart(-23.1, 0.0) && apart(0.0, 23.1) && apart(17.0, 17.0));
    }

    #[test]
    fn a_limit_excludes_what_is_beyond_its_radius_on_either_side() {
        let limit = Limit {
            radius: 3.0,
            ..Limit::default()
        };
        let excludes = |from, to| limit.excludes(Span { from, to });
        assert!(excludes(3.1, 9.0) && excludes(-9.0, -3.1));
        assert!(!excludes(3.0, 9.0) && !excludes(-9.0, -3.0) && !excludes(-9.0, 9.0));
    }

    #[test]
    fn a_limit_is_linear_in_both_arc_lengths() {
        let limit = |along, other_along| Limit {
            radius: 3.0,
            offset: 10.0,
            along,
            other_along,
        };
        assert_eq!(limit(2.0, -0.5).at(Point::new(3.0, 8.0)), 12.0);
        is(limit(2.0, -0.5).range(3.0, 8.0), 6.0, 16.0);
        is(limit(-2.0, 0.5).range(3.0, 8.0), 4.0, 14.0);
        is(limit(2.0, 0.5).range(3.0, 8.0), 10.0, 20.0);
        is(limit(-2.0, -0.5).range(3.0, 8.0), 0.0, 10.0);
    }

    #[test]
    fn rectangles_are_apart_along_a_side_by_what_both_reach() {
        let (a, b) = (
            motion((0.0, 0.0), 0.0, 9.0),
            Motion {
                half: (4.0, 1.5),
                ..motion((0.0, 0.0), 30.0, 9.0)
            },
        );
        let (sin, cos) = 30.0_f32.to_radians().sin_cos();
        let expected = [
            ((0.0, 1.0), 1.0 + 4.0 * sin + 1.5 * cos),
            ((-sin, cos), 1.5 + 2.5 * sin + cos),
            ((1.0, 0.0), 2.5 + 4.0 * cos + 1.5 * sin),
            ((cos, sin), 4.0 + 2.5 * cos + sin),
        ];
        for ((axis, radius), ((x, y), expected)) in axes(&a, &b).into_iter().zip(expected) {
            let away = crate::geometry::length(&(axis - Vector::new(x, y)));
            assert!(away < 1e-5 && (radius - expected).abs() < 1e-5);
        }
    }

    #[test]
    fn a_cut_leaves_what_is_on_one_side() {
        let cut = |along, other_along, offset, side| {
            let mut polygon = rectangle(4.0, 2.0);
            let limit = Limit {
                radius: 1.0,
                offset,
                along,
                other_along,
            };
            cut(&mut polygon, &limit, side);
            polygon
                .iter()
                .map(|p| (p.x, p.y))
                .collect::<std::vec::Vec<_>>()
        };
        // x ≤ 3, x ≥ 1, y ≤ 1, and x + y ≤ 1: in order, from the corner that is kept first.
        assert_eq!(
            cut(1.0, 0.0, -2.0, 1.0),
            [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0)]
        );
        assert_eq!(
            cut(1.0, 0.0, -2.0, -1.0),
            [(1.0, 0.0), (4.0, 0.0), (4.0, 2.0), (1.0, 2.0)]
        );
        assert_eq!(
            cut(0.0, 2.0, -1.0, 1.0),
            [(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (0.0, 1.0)]
        );
        assert_eq!(
            cut(1.0, 1.0, 0.0, 1.0),
            [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]
        );
        assert_eq!(
            cut(1.0, 0.0, -9.0, 1.0),
            [(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (0.0, 2.0)]
        );
        assert!(cut(1.0, 0.0, 9.0, 1.0).is_empty());
    }

    /// 3.5 m to either side of a right angle, at 12 m and 9 m.
    #[test]
    fn a_crossing_is_occupied_over_half_of_both() {
        let (a, b) = (
            motion((-12.0, 0.0), 0.0, 30.0),
            motion((0.0, -9.0), 90.0, 20.0),
        );
        let patch = meet(&a, &b).unwrap();
        is(patch.ego, 108.5, 115.5);
        is(patch.other, 105.5, 112.5);
        is(patch.lead, -4.02, 10.02);
        assert!(patch.parallel.is_none() && !patch.mixed && !patch.starts && !patch.ends);
        // Too far aside, and too far ahead; just not.
        let beside = |x: f32, y: f32| meet(&a, &motion((x, y), 90.0, 20.0)).is_some();
        assert!(beside(21.4, -9.0) && !beside(21.6, -9.0));
        assert!(beside(-15.4, -9.0) && !beside(-15.6, -9.0));
        assert!(beside(0.0, 3.4) && !beside(0.0, 3.6));
        assert!(beside(0.0, -23.4) && !beside(0.0, -23.6));
    }

    #[test]
    fn in_a_lane_vehicles_are_apart_by_their_lengths() {
        let (a, b) = (
            motion((0.0, 0.0), 0.0, 30.0),
            motion((10.0, 1.0), 0.0, 40.0),
        );
        let patch = meet(&a, &b).unwrap();
        // The other is 10 m ahead at the same arc length.
        is(patch.lead, 5.0 - 0.02, 15.0 + 0.02);
        is(patch.ego, 105.0, 130.0);
        is(patch.other, 100.0, 125.0);
        let [ego, other] = patch.parallel.unwrap();
        is(ego, 105.0, 130.0);
        is(other, 100.0, 125.0);
        assert!(meet(&a, &motion((10.0, 2.1), 0.0, 40.0)).is_none());
        let head_on = meet(&a, &motion((40.0, 1.0), 180.0, 40.0)).unwrap();
        assert!(head_on.mixed && head_on.parallel.is_none());
    }

    #[test]
    fn what_reaches_an_end_of_a_route_goes_on_beyond_it() {
        let (a, b) = (
            motion((-2.0, 0.0), 0.0, 30.0),
            motion((0.0, -9.0), 90.0, 11.0),
        );
        let ends = |first, last| meet(&Motion { first, ..a }, &Motion { last, ..b }).unwrap();
        let plain = ends(false, false);
        is(plain.ego, 100.0, 105.5);
        is(plain.other, 105.5, 111.0);
        let far = ends(true, true);
        is(far.ego, -FAR, 105.5);
        is(far.other, 105.5, FAR);
        assert!(!far.starts && !far.ends, "they only cross");
        // What ends a millimetre before the end is at it; what ends farther, not.
        let whole = |interval: Span| {
            placed(
                interval,
                &Motion {
                    first: true,
                    last: true,
                    ..a
                },
            )
        };
        let span = |from, to| Span { from, to };
        is(whole(span(0.0009, 29.9991)), -FAR, FAR);
        is(whole(span(0.0011, 29.9988)), 100.0011, 129.9988);
    }

    #[test]
    fn a_lane_starts_or_ends_with_either_route() {
        let meets = |change: fn(&mut Motion, &mut Motion)| {
            let (mut a, mut b) = (motion((0.0, 0.0), 0.0, 30.0), motion((0.0, 1.0), 0.0, 30.0));
            change(&mut a, &mut b);
            let patch = meet(&a, &b).unwrap();
            (patch.starts, patch.ends)
        };
        assert_eq!(meets(|_, _| {}), (false, false));
        assert_eq!(meets(|a, _| a.first = true), (true, false));
        assert_eq!(meets(|_, b| b.first = true), (true, false));
        assert_eq!(meets(|a, _| a.last = true), (false, true));
        assert_eq!(meets(|_, b| b.last = true), (false, true));
        // The other is far ahead: only the ego's end and the other's start are in it.
        let apart = |change: fn(&mut Motion, &mut Motion)| {
            let (mut a, mut b) = (
                motion((0.0, 0.0), 0.0, 30.0),
                motion((20.0, 1.0), 0.0, 30.0),
            );
            change(&mut a, &mut b);
            let patch = meet(&a, &b).unwrap();
            (patch.starts, patch.ends)
        };
        assert_eq!(apart(|a, _| a.first = true), (false, false));
        assert_eq!(apart(|_, b| b.last = true), (false, false));
        assert_eq!(apart(|a, b| (a.last, b.first) = (true, true)), (true, true));
    }

    proptest! {
        #[test]
        fn nobody_is_farther_behind_than_the_bound(
            x in -12.0_f32..12.0,
            y in -4.0_f32..4.0,
            degrees in -180.0_f32..180.0,
            slanted in -10.0_f32..10.0,
            lengths in (0.5_f32..9.0, 0.5_f32..9.0),
        ) {
            let a = Motion { arc: 40.0, ..motion((0.0, 0.0), slanted, lengths.0) };
            let a = Motion { velocity: Vector::new(1.0, 0.0), ..a };
            let b = motion((x, y), degrees, lengths.1);
            if let Some(patch) = meet(&a, &b) {
                let least = least_lead(&a, &b).unwrap();
                prop_assert!(least <= patch.lead.from + 1e-4, "{least}, {:?}", patch.lead);
            }
        }
    }

    #[test]
    fn the_bound_is_met_within_millimetres_where_one_follows_the_other() {
        let a = motion((0.0, 0.0), 0.0, 6.0);
        for (x, degrees) in [(3.0, 0.0), (4.0, 0.0), (3.0, -4.0)] {
            let b = Motion {
                arc: 103.0,
                ..motion((x, 0.0), degrees, 6.0)
            };
            let (least, patch) = (least_lead(&a, &b).unwrap(), meet(&a, &b).unwrap());
            assert!(
                (least - patch.lead.from).abs() < 2e-3,
                "{least}, {:?}",
                patch.lead
            );
        }
        assert_eq!(least_lead(&a, &motion((0.0, 2.1), 0.0, 6.0)), None);
    }
}
