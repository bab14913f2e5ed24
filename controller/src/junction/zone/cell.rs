//! Where two motions can be at most: their rectangle in the (s, t) plane.

use super::body::{Motion, Stage};
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

    /// Where all motions of two stages can be of which one turns; none, if some of them meet head-on and some do not.
    pub(super) fn of_turns(a: &Stage, b: &Stage) -> Option<Self> {
        let along = a.straight().direction.dot(&b.straight().direction);
        // Rounding is allowed for.
        let uncertain = a.askew + b.askew + 1.0e-3;
        ((along - OPPOSITE).abs() > uncertain).then(|| Self {
            parallel: false,
            ..Self::of(a.straight(), b.straight())
        })
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
    use crate::geometry::{Footprint, Point, Vector};
    use crate::junction::route::Route;
    use crate::junction::zone::body::Body;

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
    fn where_turns_can_be_is_known_if_all_or_none_of_them_meet_head_on() {
        let stage = |degrees: f32, bend: f32| {
            let at = |degrees: f32| {
                let (sin, cos) = degrees.to_radians().sin_cos();
                Vector::new(20.0 * cos, 20.0 * sin)
            };
            let middle = Point::origin() + at(degrees);
            let points = [Point::origin(), middle, middle + at(degrees + bend)];
            let route = Route::<3>::new(points).unwrap();
            let footprint = Footprint::PAPER;
            Body::new(route.polyline(), footprint, 0.0)
                .stage(0)
                .unwrap()
        };
        // The cosine of 120° may be off by 0.17: half of a bend of 20°.
        let other = stage(0.0, 0.0);
        for (degrees, bend, known) in [
            (0.0, 20.0, true),
            (105.0, 20.0, true),
            (115.0, 20.0, false),
            (125.0, -20.0, false),
            (135.0, 20.0, true),
            (119.0, 0.0, true),
        ] {
            let turns = Cell::of_turns(&stage(degrees, bend), &other);
            assert_eq!(turns.is_some(), known, "{degrees}, {bend}");
            let Some(cell) = turns else { continue };
            assert!(!cell.parallel);
            assert_eq!(cell.opposite, degrees > 120.0);
            assert!(cell.ego.contains(19.9) && cell.other.contains(19.9));
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
