//! Whether zones cover every overlap: rectangles at sampled places, directions and offsets, in `f64`.

use crate::geometry::{Footprint, Point};
use crate::junction::route::Route;
use crate::junction::{Class, Junction, PathId, Polyline, Span};
use proptest::prelude::*;
use std::vec::Vec;

/// A convex polygon, with corners in order.
type Shape = [[f64; 2]; 4];

/// A vehicle somewhere on its route: arc length, place and a direction (rad) that it has there.
#[derive(Clone, Copy, Debug)]
struct Place {
    s: f64,
    at: [f64; 2],
    heading: f64,
}

fn wide(p: &Point) -> [f64; 2] {
    [f64::from(p.x), f64::from(p.y)]
}

fn heading(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[1] - from[1]).atan2(to[0] - from[0])
}

/// The change of direction from one heading to another, within ± π.
fn turn(from: f64, to: f64) -> f64 {
    use std::f64::consts::PI;
    (to - from + 3.0 * PI).rem_euclid(2.0 * PI) - PI
}

/// Places along the route, with several directions at each of its points, and for a vehicle of `length` (m) that
/// begins to turn before a point and has turned behind it.
fn places(route: Polyline<'_>, step: f64, length: f64) -> Vec<Place> {
    let points: Vec<_> = route.points().iter().map(wide).collect();
    let arc: Vec<_> = route.arc().iter().map(|&s| f64::from(s)).collect();
    let mut found = Vec::new();
    for i in 0..points.len() - 1 {
        let (a, b) = (points[i], points[i + 1]);
        let (from, to) = (arc[i], arc[i + 1]);
        let along = heading(a, b);
        let count = ((to - from) / step).ceil();
        for k in 0..=count as usize {
            let share = k as f64 / count;
            found.push(Place {
                s: from + (to - from) * share,
                at: [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share],
                heading: along,
            });
        }
        if let Some(&next) = points.get(i + 2) {
            let turn = turn(along, heading(b, next));
            found.extend((1..16).map(|k| Place {
                s: to,
                at: b,
                heading: along + turn * f64::from(k) / 16.0,
            }));
        }
    }
    found.extend(turning(&points, &arc, length));
    found
}

/// Places beside the route's points at which a vehicle of `length` (m) has the direction half-way to the next piece's,
/// or some of it.
fn turning(points: &[[f64; 2]], arc: &[f64], length: f64) -> Vec<Place> {
    let mut found = Vec::new();
    for i in 1..points.len() - 1 {
        let [before, at, after] = [points[i - 1], points[i], points[i + 1]];
        let change = turn(heading(before, at), heading(at, after));
        for (towards, piece, sign) in [
            (before, arc[i] - arc[i - 1], -1.0),
            (after, arc[i + 1] - arc[i], 1.0),
        ] {
            let window = (0.59 * length).min(piece);
            let own = if sign < 0.0 {
                heading(before, at)
            } else {
                heading(at, after)
            };
            for k in 0..8 {
                let away = window * f64::from(k) / 7.0;
                let share = away / piece;
                found.extend([0.2, 0.5, 0.99].map(|part| Place {
                    s: arc[i] + sign * away,
                    at: [0, 1].map(|c| at[c] + (towards[c] - at[c]) * share),
                    heading: own - sign * 0.5 * part * change,
                }));
            }
        }
    }
    found
}

/// The corners of a footprint, the whole of it moved by `offset`.
fn shape(place: &Place, footprint: Footprint, offset: [f64; 2]) -> Shape {
    let (sin, cos) = place.heading.sin_cos();
    let (l, w) = (
        0.5 * f64::from(footprint.length),
        0.5 * f64::from(footprint.width),
    );
    [(l, w), (-l, w), (-l, -w), (l, -w)].map(|(x, y)| {
        [
            place.at[0] + offset[0] + x * cos - y * sin,
            place.at[1] + offset[1] + x * sin + y * cos,
        ]
    })
}

/// Whether two convex polygons overlap: no side of either has all of the other beyond it.
fn overlap(a: &Shape, b: &Shape) -> bool {
    let apart = |a: &Shape, b: &Shape| {
        (0..4).any(|i| {
            let (p, q) = (a[i], a[(i + 1) % 4]);
            let beyond =
                |r: &[f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
            b.iter().all(|r| beyond(r) < 0.0)
        })
    };
    !apart(a, b) && !apart(b, a)
}

/// Overlaps that are in none of the zones of paths `a` and `b`; and the number of overlaps.
fn missed(
    junction: &Junction<2, 32>,
    [a, b]: [usize; 2],
    offsets: [[f64; 2]; 2],
) -> (Vec<(Place, Place)>, usize) {
    let id = |i: usize| PathId::new(u8::try_from(i).unwrap());
    let zones: Vec<_> = junction.conflict(id(a), id(b)).unwrap().zones().collect();
    let holds = |span: Span, x: f64| f64::from(span.from) <= x && x <= f64::from(span.to);
    let [egos, others] = [(a, offsets[0]), (b, offsets[1])].map(|(i, offset)| {
        let route = junction.polyline(id(i)).unwrap();
        let footprint = junction.paths()[i].footprint();
        let shaped = |place| (place, shape(&place, footprint, offset));
        let placed: Vec<_> = places(route, 0.7, footprint.length.into())
            .into_iter()
            .map(shaped)
            .collect();
        placed
    });
    let (mut found, mut count) = (Vec::new(), 0);
    for (ego, own) in &egos {
        for (other, its) in &others {
            let (x, y) = (ego.at[0] - other.at[0], ego.at[1] - other.at[1]);
            if x * x + y * y > 16.0 * 16.0 || !overlap(own, its) {
                continue;
            }
            count += 1;
            let covered = zones.iter().any(|zone| {
                holds(zone.ego, ego.s)
                    && holds(zone.other, other.s)
                    && holds(zone.lead, ego.s - other.s)
            });
            if !covered {
                found.push((*ego, *other));
            }
        }
    }
    (found, count)
}

fn any_footprint() -> impl Strategy<Value = Footprint> {
    (1.0_f32..12.0, 0.5_f32..2.6).prop_map(|(length, width)| Footprint { length, width })
}

/// A route with turns of up to 90°, through the neighbourhood of the origin.
fn any_route() -> impl Strategy<Value = Route<16>> {
    let leg = (
        1.0_f32..14.0,
        prop_oneof![
            Just(0.0_f32),
            -90.0_f32..90.0,
            -8.0_f32..8.0,
            -1.5_f32..1.5,
            Just(89.99),
            Just(-89.99),
        ],
    );
    let start = (-12.0_f32..12.0, -12.0_f32..12.0, 0.0_f32..6.3);
    (start, prop::collection::vec(leg, 2..10)).prop_map(|((x, y, heading), legs)| {
        let mut at = Point::new(x, y);
        let mut heading = heading;
        let mut points = std::vec![at];
        for (length, turn) in legs {
            at += length * crate::geometry::Vector::new(heading.cos(), heading.sin());
            points.push(at);
            heading += turn.to_radians();
        }
        Route::new(points).unwrap()
    })
}

fn any_offset() -> impl Strategy<Value = (f64, f64)> {
    (prop_oneof![Just(1.0_f64), 0.0..1.0], 0.0_f64..6.3)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 192, ..ProptestConfig::default() })]

    /// Also at kinks, in all directions between those of two segments, and off the route by the tolerance.
    #[test]
    fn no_overlap_is_outside_the_zones(
        routes in [any_route(), any_route()],
        footprints in [any_footprint(), any_footprint()],
        tolerance in prop_oneof![Just(0.0_f32), 0.0_f32..1.0],
        offsets in [any_offset(), any_offset()],
    ) {
        let mut builder = Junction::<2, 32>::builder();
        builder.tolerance(tolerance);
        for (route, footprint) in routes.iter().zip(footprints) {
            builder.path(route, Class::Car, footprint).unwrap();
        }
        // A route that comes back to itself is refused.
        let Ok(junction) = builder.build() else { return Ok(()) };
        let offsets = offsets.map(|(share, direction)| {
            let away = share * f64::from(tolerance);
            [away * direction.cos(), away * direction.sin()]
        });
        for pair in [[0, 1], [1, 0], [0, 0], [1, 1]] {
            let (missed, count) = missed(&junction, pair, offsets);
            prop_assert!(
                missed.is_empty(),
                "{} of {count} overlaps of {pair:?} are outside: {:?} of {:?}",
                missed.len(), missed[0], junction.conflict(PathId::new(pair[0] as u8), PathId::new(pair[1] as u8)),
            );
        }
    }
}

/// The straight route of `length` (m) whose middle is at `at`, in direction `heading` (rad).
fn straight(at: [f64; 2], heading: f64, length: f64) -> Route<16> {
    let end = |share: f64| {
        let away = share * length;
        Point::new(
            (at[0] + away * heading.cos()) as f32,
            (at[1] + away * heading.sin()) as f32,
        )
    };
    Route::new([end(-0.5), end(0.5)]).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    /// Within 10 cm, with footprints that are larger by what is for rounding. Where nothing turns, zones are not larger than
    /// what they cover.
    #[test]
    fn each_end_of_a_zone_of_straight_routes_is_touched(
        at in (-4.0_f64..4.0, -4.0_f64..4.0), headings in [0.0_f64..6.3, 0.0_f64..6.3], lengths in [30.0_f64..60.0, 30.0_f64..60.0],
        footprints in [any_footprint(), any_footprint()], tolerance in 0.0_f32..0.3,
    ) {
        const STEP: f64 = 0.02;
        const NEAR: f64 = 0.1;
        let routes = [straight([0.0; 2], headings[0], lengths[0]), straight([at.0, at.1], headings[1], lengths[1])];
        let mut builder = Junction::<2, 32>::builder();
        builder.tolerance(tolerance);
        for (route, footprint) in routes.iter().zip(footprints) {
            builder.path(route, Class::Car, footprint).unwrap();
        }
        let junction = builder.build().unwrap();
        let inflation = crate::junction::zone::INFLATION;
        let shape_at = |i: usize, s: f64| {
            let Footprint { length, width } = footprints[i];
            let more = 2.0 * (inflation + tolerance);
            let larger = Footprint { length: length + more, width: width + more };
            let pose = routes[i].polyline().pose(s as f32);
            let heading = f64::from(pose.direction.y).atan2(pose.direction.x.into());
            shape(&Place { s, at: wide(&pose.position), heading }, larger, [0.0; 2])
        };
        let near = |a: f64, b: f64| overlap(&shape_at(0, a), &shape_at(1, b));
        let steps = |length: f64| (0..=(length / STEP) as usize).map(|i| i as f64 * STEP);
        let [one, two] = [routes[0].length(), routes[1].length()].map(f64::from);
        for zone in junction.conflict(PathId::new(0), PathId::new(1)).unwrap().zones() {
            for (end, inwards) in [(zone.ego.from, NEAR), (zone.ego.to, -NEAR)] {
                let s = f64::from(end) + inwards;
                prop_assert!(end.abs() > 1e5 || steps(two).any(|t| near(s, t)), "ego {end} of {zone:?}");
            }
            for (end, inwards) in [(zone.other.from, NEAR), (zone.other.to, -NEAR)] {
                let t = f64::from(end) + inwards;
                prop_assert!(end.abs() > 1e5 || steps(one).any(|s| near(s, t)), "other {end} of {zone:?}");
            }
            for (end, inwards) in [(zone.lead.from, NEAR), (zone.lead.to, -NEAR)] {
                let lead = f64::from(end) + inwards + f64::from(inflation) * inwards.signum();
                let touched = |s: f64| (0.0..=two).contains(&(s - lead)) && near(s, s - lead);
                prop_assert!(zone.is_lane() || steps(one).any(touched), "lead {end} of {zone:?}");
            }
        }
    }
}
