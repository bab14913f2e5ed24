//! Conflict zones against an independent sweep of polygons: never too small, and hardly too large.
//!
//! The other's footprint is swept along each straight piece of its route by a
//! convex hull; whether the ego's footprint at some arc length meets the sweep
//! is then exact in the other's arc length, and asked every few centimetres of
//! the ego's.

use cede_controller::junction::zone::FAR;
use cede_controller::{Footprint, Point, Route, RouteConflict, Span, Vector, Zone};
use cede_data::{Dataset, SimRoute};
use cede_sim::meeting::{conflict, crossroads};
use geo::{ConvexHull, Coord, Intersects, MultiPoint, Polygon};
use proptest::prelude::*;
use rayon::prelude::*;

const PAPER: Footprint = Footprint::PAPER;

fn corners(centre: Point, direction: Vector) -> [Coord<f64>; 4] {
    let (c, d) = (
        (centre.x.into(), centre.y.into()),
        (direction.x, direction.y),
    );
    let (cx, cy): (f64, f64) = c;
    let (dx, dy) = (f64::from(d.0), f64::from(d.1));
    [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)].map(|(along, across)| {
        let (l, w) = (2.5 * along, 1.0 * across);
        Coord {
            x: cx + l * dx - w * dy,
            y: cy + l * dy + w * dx,
        }
    })
}

fn hull(points: impl IntoIterator<Item = Coord<f64>>) -> Polygon<f64> {
    let points: Vec<geo::Point<f64>> = points.into_iter().map(geo::Point::from).collect();
    MultiPoint::from(points).convex_hull()
}

/// What a vehicle covers on each straight piece of its route.
fn sweep<const P: usize>(route: &Route<P>) -> Vec<Polygon<f64>> {
    let ends = route.points().windows(2).zip(route.arc().windows(2));
    ends.map(|(ends, arcs)| {
        let direction = (ends[1] - ends[0]) * (1.0 / (arcs[1] - arcs[0]));
        hull(
            corners(ends[0], direction)
                .into_iter()
                .chain(corners(ends[1], direction)),
        )
    })
    .collect()
}

/// Arc lengths of `route`, `step` apart, at which its vehicle meets the sweep.
fn occupied<const P: usize>(route: &Route<P>, sweep: &[Polygon<f64>], step: f32) -> Vec<f32> {
    let count = (route.length() / step) as usize;
    let meets = |s: &f32| {
        let pose = route.pose(*s);
        let vehicle = hull(corners(pose.position, pose.direction.into_inner()));
        sweep.iter().any(|piece| piece.intersects(&vehicle))
    };
    (0..=count).map(|i| i as f32 * step).filter(meets).collect()
}

/// How much of the zones' intervals on a route is more than `step` from anything occupied, in metres.
fn excess(intervals: &[Span], occupied: &[f32], length: f32, step: f32) -> f32 {
    let count = (length / step) as usize;
    let needless = |s: f32| {
        let after = occupied.partition_point(|&o| o < s);
        let near = |i: usize| occupied.get(i).is_none_or(|o| (o - s).abs() > step);
        intervals.iter().any(|z| z.contains(s)) && near(after) && near(after.wrapping_sub(1))
    };
    let mut worst = 0.0_f32;
    let mut run = 0.0_f32;
    for s in (0..=count).map(|i| i as f32 * step) {
        run = if needless(s) { run + step } else { 0.0 };
        worst = worst.max(run);
    }
    worst
}

/// The zones of the first route with the second; none if they make no junction.
fn zones<const P: usize>(routes: [(&Route<P>, Footprint); 2]) -> Option<Vec<Zone>> {
    // A route that comes back to itself is no path.
    let Ok(junction) = crossroads(routes) else {
        return None;
    };
    let conflict = conflict(&junction, 0).into_iter();
    Some(conflict.flat_map(RouteConflict::zones).copied().collect())
}

/// The longest needless stretch of the zones of two routes, in metres; fails where a zone is too small.
fn check<const P: usize>(ego: &Route<P>, other: &Route<P>, step: f32) -> f32 {
    let Some(zones) = zones([(ego, PAPER), (other, PAPER)]) else {
        return 0.0;
    };
    let mut worst = 0.0_f32;
    for (route, against, mine) in [(ego, other, true), (other, ego, false)] {
        let side = |z: &Zone| if mine { z.ego } else { z.other };
        let intervals: Vec<Span> = zones.iter().map(side).collect();
        let occupied = occupied(route, &sweep(against), step);
        for s in &occupied {
            assert!(
                intervals.iter().any(|z| z.contains(*s)),
                "{s} is in none of {zones:?}"
            );
        }
        // A zone that goes on past the end of either route does so on purpose.
        let ends = |z: &Span| Span {
            from: if z.from == -FAR {
                occupied.first().copied().unwrap_or(z.from)
            } else {
                z.from
            },
            to: if z.to == FAR {
                occupied.last().copied().unwrap_or(z.to)
            } else {
                z.to
            },
        };
        let bounded: Vec<Span> = intervals.iter().map(ends).collect();
        worst = worst.max(excess(&bounded, &occupied, route.length(), step));
    }
    worst
}

/// A smooth route through the neighbourhood of the origin, of constant curvature in its middle.
fn curve(x: f32, y: f32, heading: f32, curvature: f32, wobble: f32) -> Route<64> {
    let mut points = vec![];
    for sign in [-1.0_f32, 1.0] {
        let mut at = Point::new(x, y);
        let mut half = vec![];
        for i in 0..20_u8 {
            let s = f32::from(i) * 1.5;
            let angle = heading + sign * s * (curvature + wobble * (0.3 * s).sin());
            at += Vector::new(angle.cos(), angle.sin()) * (sign * 1.5);
            half.push(at);
        }
        if sign < 0.0 {
            half.reverse();
        }
        points.extend(half);
    }
    Route::new(points).unwrap()
}

prop_compose! {
    fn any_route()(
        x in -8.0_f32..8.0, y in -8.0_f32..8.0, heading in 0.0_f32..6.3,
        curvature in -0.08_f32..0.08, wobble in -0.05_f32..0.05,
    ) -> Route<64> {
        curve(x, y, heading, curvature, wobble)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn zones_are_never_too_small(ego in any_route(), other in any_route()) {
        check(&ego, &other, 0.1);
    }

    /// Near-parallel routes, the hard case.
    #[test]
    fn nor_are_those_of_routes_side_by_side(
        heading in -0.05_f32..0.05, offset in 0.0_f32..4.0, bend in -0.01_f32..0.01,
    ) {
        check(&curve(0.0, 0.0, 0.0, 0.0, 0.0), &curve(0.0, offset, heading, bend, 0.0), 0.1);
    }

    /// Where they overlap, the lead is in the zone's.
    #[test]
    fn the_lead_holds_every_overlap(
        ego in any_route(), other in any_route(), s in 0.0_f32..1.0, t in 0.0_f32..1.0,
    ) {
        let zones = zones([(&ego, PAPER), (&other, PAPER)]);
        prop_assume!(zones.is_some());
        let zones = zones.unwrap();
        let (s, t) = (s * ego.length(), t * other.length());
        let cover = |pose: cede_controller::Pose| hull(corners(pose.position, pose.direction.into_inner()));
        if cover(ego.pose(s)).intersects(&cover(other.pose(t))) {
            let inside = |z: &Zone| z.ego.contains(s) && z.other.contains(t) && z.lead.contains(s - t);
            prop_assert!(zones.iter().any(inside));
        }
    }
}

#[test]
fn a_zone_that_is_too_small_is_noticed() {
    let (ego, other) = (
        curve(0.0, 0.0, 0.0, 0.0, 0.0),
        curve(0.0, 0.0, 1.5, 0.0, 0.0),
    );
    let small = Footprint {
        length: 4.9,
        width: 1.9,
    };
    let zone = zones([(&ego, small), (&other, PAPER)]).unwrap()[0].ego;
    let occupied = occupied(&ego, &sweep(&other), 0.01);
    assert!(occupied.iter().any(|&s| !zone.contains(s)));
}

/// Needs the INTERACTION recordings, whose licence keeps them out of the repository.
#[test]
fn zones_of_recorded_routes_are_at_most_six_tenths_of_a_metre_too_large() {
    let Some(dir) = cede_tests::interaction() else {
        return;
    };
    let data = Dataset::load(&dir, "EP0").unwrap();
    data.encounters.par_iter().for_each(|encounter| {
        let route = |i: usize| -> &SimRoute { &encounter.participants[i].route };
        let excess = check(route(0), route(1), 0.05);
        assert!(excess <= 0.601, "{:?}: {excess} m", encounter.id);
    });
}
