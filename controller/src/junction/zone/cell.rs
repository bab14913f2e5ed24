//! Where two motions can be at most: their rectangle in the (s, t) plane.

use super::body::Motion;
use super::{INFLATION, Span};

/// Two directions whose cosine is above this point the same way: within 30°.
const PARALLEL: f32 = 0.866;

/// Two directions whose cosine is below this come towards each other: more than 120° apart.
const OPPOSITE: f32 = -0.5;

/// Where two motions can be at most.
pub(super) struct Cell {
    pub(super) ego: Span,
    pub(super) other: Span,
    pub(super) lead: Span,
    /// The two may point the same way.
    pub(super) parallel: bool,
    /// They meet head-on.
    pub(super) opposite: bool,
    /// An end of a route is in it.
    pub(super) end: bool,
}

impl Cell {
    pub(super) fn of(a: &Motion, b: &Motion) -> Self {
        let span = |motion: &Motion| Span {
            from: motion.arc,
            to: motion.arc + motion.length,
        };
        let (ego, other) = (span(a), span(b));
        Self {
            ego,
            other,
            lead: Span {
                from: ego.from - other.to - INFLATION,
                to: ego.to - other.from + INFLATION,
            },
            parallel: parallel(a, b),
            opposite: opposite(a, b),
            end: a.first || a.last || b.first || b.last,
        }
    }
}

/// Whether the vehicles point the same way. Turns do not count: they are in no lane.
pub(super) fn parallel(a: &Motion, b: &Motion) -> bool {
    !a.turning && !b.turning && a.direction.dot(&b.direction) > PARALLEL
}

/// Whether the vehicles come towards each other.
pub(super) fn opposite(a: &Motion, b: &Motion) -> bool {
    a.direction.dot(&b.direction) < OPPOSITE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Vector};

    /// From arc length `arc` (m) on, in direction `degrees`.
    fn motion(arc: f32, length: f32, degrees: f32) -> Motion {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let direction = Vector::new(cos, sin);
        Motion {
            start: Point::origin(),
            velocity: direction,
            direction,
            arc,
            length,
            turning: false,
            first: false,
            last: false,
            half: (2.5, 1.0),
        }
    }

    #[test]
    fn a_cell_is_all_that_two_motions_can_reach() {
        let cell = Cell::of(&motion(10.0, 4.0, 0.0), &motion(30.0, 7.0, 90.0));
        let is = |span: Span, from: f32, to: f32| {
            assert!(
                (span.from - from).abs() < 1e-5 && (span.to - to).abs() < 1e-5,
                "{span:?}"
            );
        };
        is(cell.ego, 10.0, 14.0);
        is(cell.other, 30.0, 37.0);
        is(cell.lead, 10.0 - 37.0 - INFLATION, 14.0 - 30.0 + INFLATION);
        assert!(!cell.end && !cell.parallel && !cell.opposite);
        let ends: [fn(&mut Motion); 2] =
            [|motion| motion.first = true, |motion| motion.last = true];
        for end in ends {
            let (mut a, b) = (motion(0.0, 1.0, 0.0), motion(0.0, 1.0, 0.0));
            end(&mut a);
            assert!(Cell::of(&a, &b).end && Cell::of(&b, &a).end);
        }
    }

    #[test]
    fn two_point_the_same_way_within_30_degrees_and_head_on_beyond_120() {
        let with = |degrees: f32| (motion(0.0, 1.0, 10.0), motion(0.0, 1.0, 10.0 + degrees));
        for degrees in [29.9, -29.9, 0.0] {
            let (a, b) = with(degrees);
            assert!(parallel(&a, &b) && !opposite(&a, &b));
            let turning = Motion { turning: true, ..a };
            assert!(!parallel(&turning, &b) && !parallel(&b, &turning));
        }
        for degrees in [30.2, 90.0, 119.9, -119.9] {
            let (a, b) = with(degrees);
            assert!(!parallel(&a, &b) && !opposite(&a, &b));
        }
        for degrees in [120.1, -120.1, 180.0] {
            let (a, b) = with(degrees);
            assert!(!parallel(&a, &b) && opposite(&a, &b));
        }
    }
}
