//! What a builder refuses, and what a junction keeps.

use super::*;
use crate::geometry::{Footprint, Point, unit};
use std::string::ToString;

const CAR: Footprint = Footprint::PAPER;
const LORRY: Footprint = Footprint {
    length: 12.0,
    width: 2.5,
};

fn route(points: &[(f32, f32)]) -> Route<16> {
    Route::new(points.iter().map(|&(x, y)| Point::new(x, y))).unwrap()
}

fn east() -> Route<16> {
    route(&[(-50.0, 0.0), (50.0, 0.0)])
}

fn north() -> Route<16> {
    route(&[(0.0, -40.0), (0.0, 40.0)])
}

/// Joins the road to the east.
fn ramp() -> Route<16> {
    route(&[(-30.0, -40.0), (0.0, -10.0), (14.0, 0.0), (50.0, 0.0)])
}

/// The road to the east, that to the north, the ramp, and lorries on the first.
fn builder<const E: usize>() -> JunctionBuilder<4, 16, E> {
    let mut builder = Junction::<4, 16, E>::builder();
    let first = builder.path(&east(), Class::Car, CAR).unwrap();
    builder.path(&north(), Class::Car, CAR).unwrap();
    builder.path(&ramp(), Class::Car, CAR).unwrap();
    builder.variant(first, Class::Lorry, LORRY).unwrap();
    builder
}

#[test]
fn a_junction_that_is_built_in_place_is_the_same_also_when_it_is_built_again() {
    let junction = builder::<4>().build().unwrap();
    let mut place = builder::<4>();
    for _ in 0..2 {
        assert_eq!(place.build_in_place().unwrap(), &junction);
    }
}

fn ids() -> [PathId; 4] {
    [0, 1, 2, 3].map(PathId::new)
}

#[test]
fn two_vehicles_see_the_same_zones_mirrored() {
    let junction = builder::<4>().build().unwrap();
    for ego in ids() {
        for other in ids() {
            let conflict = junction.conflict(ego, other).unwrap();
            assert_eq!(
                conflict.swapped(),
                *junction.conflict(other, ego).unwrap(),
                "{ego}, {other}"
            );
            assert_eq!(junction.way(ego).unwrap().conflict(other), Some(conflict));
        }
    }
    let kind = |a: usize, b: usize| junction.conflict(ids()[a], ids()[b]).unwrap().kind;
    assert_eq!(kind(0, 1), ConflictKind::Crossing);
    assert_eq!(kind(0, 2), ConflictKind::Merging);
    assert_eq!(kind(0, 3), ConflictKind::Following);
    assert_eq!(kind(1, 1), ConflictKind::Following);
}

#[test]
fn vehicles_on_one_path_keep_apart_by_their_length() {
    let junction = builder::<4>().build().unwrap();
    let lead = |id: PathId| {
        let conflict = junction.conflict(id, id).unwrap();
        let zones: std::vec::Vec<_> = conflict.zones().collect();
        assert_eq!(zones.len(), 1);
        assert!(zones[0].ego.contains(-9.0) && zones[0].ego.contains(600.0));
        assert_eq!(zones[0].lead.from, -zones[0].lead.to);
        zones[0].lead.to
    };
    assert!((lead(PathId::new(0)) - 5.26).abs() < 1e-4);
    assert!((lead(PathId::new(3)) - 12.26).abs() < 1e-4);
    assert!((5.26..7.0).contains(&lead(PathId::new(2))));
}

#[test]
fn rights_of_way_are_opposite() {
    let mut builder = builder::<2>();
    let [east, north, ramp, lorry] = ids();
    builder.right_of_way(east, north).unwrap();
    builder.right_of_way(ramp, east).unwrap();
    builder.control(north, Control::Stop).unwrap();
    builder.right_of_way(lorry, ramp).unwrap();
    let junction = builder.build().unwrap();
    let right = |ego, other| junction.conflict(ego, other).unwrap().right_of_way;
    assert_eq!(right(east, north), RightOfWay::Ego);
    assert_eq!(right(north, east), RightOfWay::Other);
    assert_eq!(right(east, ramp), RightOfWay::Other);
    assert_eq!(right(north, ramp), RightOfWay::Unsettled);
    assert_eq!(junction.conflict(ramp, lorry), None);
    let control = |id: PathId| junction.path(id).unwrap().control();
    assert_eq!(
        (control(north), control(east)),
        (Control::Stop, Control::Unknown)
    );
}

#[test]
fn only_the_first_paths_can_be_entered_and_all_of_them_are_kept() {
    let mut builder = builder::<1>();
    builder.tolerance(0.25);
    let junction = builder.build().unwrap();
    let [east, north, ramp, lorry] = ids();
    assert!(junction.way(north).is_none());
    assert!(junction.way(PathId::new(4)).is_none());
    let way = junction.way(east).unwrap();
    assert_eq!((way.ego(), way.paths(), way.tolerance()), (east, 4, 0.25));
    assert_eq!(junction.tolerance(), 0.25);
    assert!(way.conflict(ramp).is_some() && way.conflict(PathId::new(4)).is_none());
    assert_eq!(way.path(lorry).unwrap().class(), Class::Lorry);
    assert_eq!(way.path(lorry).unwrap().footprint(), LORRY);
    assert_eq!(way.path(north).unwrap().exit(), unit(0.0, 1.0));
    assert_eq!(way.polyline(lorry), junction.polyline(east));
    assert_eq!(way.polyline(ramp).unwrap().points(), self::ramp().points());
    assert_eq!(way.polyline(ramp).unwrap().length(), self::ramp().length());
}

#[test]
fn a_line_is_before_the_first_zone_that_is_shared_with_another_road() {
    let whole = builder::<4>().build().unwrap();
    let one = builder::<1>().build().unwrap();
    for (ego, path) in ids().into_iter().zip(whole.paths()) {
        let others = ids().into_iter().filter(|&other| other != ego);
        let entries = others.flat_map(|other| {
            let zones = whole.conflict(ego, other).unwrap().zones();
            let stop = |z: &&Zone| z.kind != ConflictKind::Following;
            zones.filter(stop).map(|z| z.ego.from)
        });
        let least = entries.fold(f32::INFINITY, f32::min);
        assert_eq!(path.line(), least, "{ego}");
        assert_eq!(one.path(ego).unwrap().line(), least, "{ego}");
    }
    // 2.5 m to the bumper, 1 m to the other's side, 2 cm and the tolerance for each of them.
    assert!((whole.paths()[0].line() - (50.0 - 3.74)).abs() < 1e-4);
}

#[test]
fn a_line_can_be_set_and_is_the_end_of_a_path_that_meets_nobody() {
    let mut builder = Junction::<2, 4>::builder();
    let first = builder.path(&east(), Class::Car, CAR).unwrap();
    let apart = route(&[(-50.0, 20.0), (50.0, 20.0)]);
    let second = builder.path(&apart, Class::Bicycle, CAR).unwrap();
    builder.line(second, 12.5).unwrap();
    let junction = builder.build().unwrap();
    assert_eq!(junction.path(first).unwrap().line(), 100.0);
    assert_eq!(junction.path(second).unwrap().line(), 12.5);
}

#[test]
fn a_path_that_begins_in_a_zone_has_its_line_at_its_start() {
    let mut builder = Junction::<2, 4>::builder();
    let late = route(&[(-1.0, 0.0), (50.0, 0.0)]);
    let first = builder.path(&late, Class::Car, CAR).unwrap();
    builder.path(&north(), Class::Car, CAR).unwrap();
    let junction = builder.build().unwrap();
    assert_eq!(junction.path(first).unwrap().line(), 0.0);
}

#[test]
fn what_does_not_fit_is_refused() {
    let full = builder::<1>();
    let mut refused = full.clone();
    let error = refused.path(&east(), Class::Car, CAR).unwrap_err();
    assert_eq!(error, JunctionError::TooManyPaths { capacity: 4 });
    let error = full.clone().variant(ids()[0], Class::Car, CAR).unwrap_err();
    assert_eq!(error, JunctionError::TooManyPaths { capacity: 4 });
    assert_eq!(refused.build(), full.build(), "nothing is changed");
    let mut small = Junction::<4, 5>::builder();
    small.path(&east(), Class::Car, CAR).unwrap();
    let before = small.clone().build();
    assert_eq!(
        small.path(&ramp(), Class::Car, CAR).unwrap_err(),
        JunctionError::TooManyPoints {
            path: PathId::new(1),
            points: 6,
            capacity: 5
        }
    );
    assert_eq!(small.build(), before);
    let empty = Junction::<4, 5>::builder().build();
    assert_eq!(empty.unwrap_err(), JunctionError::NoPaths);
}

#[test]
fn paths_that_are_not_there_are_refused() {
    let mut builder = builder::<4>();
    let unknown = JunctionError::UnknownPath {
        path: PathId::new(4),
        paths: 4,
    };
    let (known, missing) = (PathId::new(0), PathId::new(4));
    assert_eq!(builder.line(missing, 1.0), Err(unknown));
    assert_eq!(builder.right_of_way(known, missing), Err(unknown));
    assert_eq!(builder.right_of_way(missing, known), Err(unknown));
    assert_eq!(builder.variant(missing, Class::Car, CAR), Err(unknown));
    let itself = JunctionError::RightOfWay { path: known };
    assert_eq!(builder.right_of_way(known, known), Err(itself));
}

#[test]
fn numbers_out_of_range_are_refused() {
    for (length, width) in [(0.0, 2.0), (5.0, f32::NAN), (40.5, 2.0), (5.0, -1.0)] {
        let refused =
            Junction::<1, 4>::builder().path(&east(), Class::Car, Footprint { length, width });
        assert!(matches!(refused, Err(JunctionError::Footprint { .. })));
    }
    for tolerance in [-0.1, 1.1, f32::NAN, f32::INFINITY] {
        let mut builder = builder::<1>();
        let refused = builder.tolerance(tolerance).clone().build();
        assert!(matches!(refused, Err(JunctionError::Tolerance { .. })));
    }
    for s in [-0.1, 100.1, f32::NAN] {
        let refused = builder::<1>().line(PathId::new(0), s);
        assert!(matches!(refused, Err(JunctionError::Line { .. })));
    }
    let long = route(&[(0.0, 0.0), (512.1, 0.0)]);
    let refused = Junction::<1, 4>::builder().path(&long, Class::Car, CAR);
    assert!(matches!(refused, Err(JunctionError::TooLong { .. })));
}

#[test]
fn a_path_may_turn_by_a_right_angle_at_once_and_by_no_more() {
    let corner = |x: f32, y: f32| route(&[(0.0, 0.0), (30.0, 10.0), (30.0 + x, 10.0 + y)]);
    let built = |route| Junction::<1, 4>::builder().path(&route, Class::Car, CAR);
    assert!(built(corner(-10.0, 30.0)).is_ok());
    let Err(JunctionError::Kink { at, degrees, .. }) = built(corner(-11.0, 30.0)) else {
        panic!("accepted");
    };
    assert_eq!(at, 1);
    assert!((90.5..95.0).contains(&degrees), "{degrees}");
}

#[test]
fn errors_name_the_path_the_value_and_the_range() {
    let kink = JunctionError::Kink {
        path: PathId::new(2),
        at: 5,
        degrees: 101.25,
    };
    let text = kink.to_string();
    for part in ["path 2", "101.3°", "point 5", "90°"] {
        assert!(
            text.contains(part) || part == "101.3°" && text.contains("101.2°"),
            "{text}"
        );
    }
    let text = JunctionError::Tolerance { value: 3.0 }.to_string();
    assert_eq!(text, "a tolerance of 3 m: it must be in [0, 1] m");
}

#[test]
fn a_small_junction_fits_in_a_microcontroller() {
    assert!(size_of::<RouteConflict>() <= 96);
    let (junction, builder) = (
        size_of::<Junction<9, 72, 1>>(),
        size_of::<JunctionBuilder<9, 72, 1>>(),
    );
    assert!(junction <= 2560 && builder <= 2688, "{junction}, {builder}");
}

#[test]
fn points_on_a_straight_line_are_left_out_and_bends_are_kept() {
    let mut points = std::vec::Vec::new();
    points.extend((0..30_u8).map(|i| Point::new(f32::from(i) * 2.0, 0.0)));
    points.extend((1..10_u8).map(|i| Point::new(58.0, f32::from(i) * 2.0)));
    let route = Route::<64>::new(points).unwrap();
    let mut builder = Junction::<1, 8>::builder();
    let path = builder.path(&route, Class::Car, Footprint::PAPER).unwrap();
    let junction = builder.build().unwrap();
    let kept = junction.polyline(path).unwrap();
    assert!(kept.points().len() < 8, "{kept:?}");
    for s in [0.0, 13.0, 57.9, 58.1, 76.0] {
        assert_eq!(kept.pose(s), route.pose(s), "{s}");
    }
}

#[test]
fn numbers_at_the_ends_of_their_ranges_are_taken() {
    let side = |length: f32, width: f32| {
        let footprint = Footprint { length, width };
        Junction::<1, 4>::builder()
            .path(&east(), Class::Car, footprint)
            .is_ok()
    };
    assert!(side(40.0, 40.0) && !side(40.0, 40.1) && !side(40.1, 40.0) && !side(5.0, 0.0));
    let long = |length: f32| {
        let route = route(&[(0.0, 0.0), (length, 0.0)]);
        Junction::<1, 4>::builder()
            .path(&route, Class::Car, CAR)
            .is_ok()
    };
    assert!(long(512.0) && !long(512.01));
    let [first, ..] = ids();
    let line = |s: f32| builder::<1>().line(first, s).is_ok();
    assert!([0.0, 50.0, 100.0].into_iter().all(line));
    let pace = |pace: f32| builder::<1>().pace(first, pace).is_ok();
    assert!(pace(0.1) && pace(10.0));
    assert!(!pace(0.0) && !pace(-1.0) && !pace(10.1) && !pace(f32::NAN));
    let limit = |from: f32, speed: f32| builder::<1>().speed_limit(first, from, speed).is_ok();
    assert!(limit(0.0, 0.1) && limit(100.0, 100.0));
    for (from, speed) in [
        (-0.1, 5.0),
        (100.1, 5.0),
        (f32::NAN, 5.0),
        (50.0, 0.0),
        (50.0, 100.1),
        (50.0, f32::NAN),
    ] {
        assert!(!limit(from, speed), "{speed} m/s from {from} m");
    }
    let lateral = |most: f32| builder::<1>().lateral(most).clone().build().is_ok();
    assert!(lateral(0.1) && lateral(20.0) && lateral(f32::INFINITY));
    assert!(!lateral(0.0) && !lateral(-1.0) && !lateral(20.1) && !lateral(f32::NAN));
    let tolerance = |most: f32| builder::<1>().tolerance(most).clone().build().is_ok();
    assert!(tolerance(0.0) && tolerance(1.0));
}

#[test]
fn what_is_said_of_a_path_is_kept_for_that_path() {
    let mut builder = builder::<2>();
    let [east, north, ramp, lorry] = ids();
    builder.pace(north, 1.5).unwrap();
    builder.order(ramp, 77).unwrap();
    builder.control(east, Control::Yield).unwrap();
    builder.line(lorry, 12.0).unwrap();
    let junction = builder.build().unwrap();
    let of = |get: fn(&Path) -> u16| ids().map(|id| get(junction.path(id).unwrap()));
    assert_eq!(of(|path| (10.0 * path.pace()) as u16), [30, 15, 30, 30]);
    assert_eq!(of(Path::order), [0, 1, 77, 3]);
    assert_eq!(
        of(|path| u16::from(path.control() == Control::Yield)),
        [1, 0, 0, 0]
    );
    assert_eq!(of(|path| u16::from(path.waits_at_line())), [0, 0, 0, 1]);
    assert_eq!(junction.path(lorry).unwrap().line(), 12.0);
}

#[test]
fn a_variant_has_what_was_said_of_its_path_and_its_own_place() {
    let mut builder = Junction::<3, 8>::builder();
    let first = builder.path(&east(), Class::Car, CAR).unwrap();
    builder.speed_limit(first, 0.0, 7.0).unwrap();
    builder.control(first, Control::Stop).unwrap();
    let variant = builder.variant(first, Class::Lorry, LORRY).unwrap();
    builder.speed_limit(first, 0.0, 5.0).unwrap();
    let junction = builder.build().unwrap();
    let path = junction.path(variant).unwrap();
    assert_eq!((path.order(), path.control()), (1, Control::Stop));
    assert_eq!((path.class(), path.footprint()), (Class::Lorry, LORRY));
    assert_eq!(junction.way(variant).unwrap().profile().speed(1.0), 7.0);
}

#[test]
fn the_last_word_on_a_right_of_way_counts() {
    let mut builder = builder::<4>();
    let [east, north, ..] = ids();
    builder.priority(east, north, Priority::Signed).unwrap();
    builder.priority(north, east, Priority::Unsigned).unwrap();
    let junction = builder.build().unwrap();
    let said = |ego, other| {
        let conflict = junction.conflict(ego, other).unwrap();
        (conflict.right_of_way, conflict.priority)
    };
    assert_eq!(said(north, east), (RightOfWay::Ego, Priority::Unsigned));
    assert_eq!(said(east, north), (RightOfWay::Other, Priority::Unsigned));
}

#[test]
fn a_point_is_left_out_if_it_is_within_a_millimetre_of_the_line_past_it() {
    let kept = |points: &[(f32, f32)]| {
        let mut builder = Junction::<1, 32>::builder();
        let path = builder.path(&route(points), Class::Car, CAR).unwrap();
        let junction = builder.build().unwrap();
        let points = junction.polyline(path).unwrap().points();
        points
            .iter()
            .map(|point| point.x)
            .collect::<std::vec::Vec<_>>()
    };
    assert_eq!(
        kept(&[(0.0, 0.0), (10.0, 0.0009), (20.0, 0.0)]),
        [0.0, 20.0]
    );
    assert_eq!(
        kept(&[(0.0, 0.0), (10.0, 0.0011), (20.0, 0.0)]),
        [0.0, 10.0, 20.0]
    );
    assert_eq!(
        kept(&[(0.0, 0.0), (10.0, -0.0011), (20.0, 0.0)]),
        [0.0, 10.0, 20.0]
    );
    // Off the origin, along an oblique line, and a curve that leaves the line bit by bit.
    assert_eq!(
        kept(&[(50.0, 50.0), (53.0, 54.0), (56.0, 58.0), (62.0, 66.0)]),
        [50.0, 62.0]
    );
    assert_eq!(
        kept(&[(0.0, 0.0), (10.0, 0.0), (20.0, 0.0009), (30.0, 0.0045)]),
        [0.0, 20.0, 30.0]
    );
    // So many in a row and no more.
    let straight: std::vec::Vec<_> = (0..16).map(|i| (i as f32, 0.0)).collect();
    assert_eq!(kept(&straight), [0.0, 15.0]);
}

#[test]
fn no_more_than_sixteen_points_in_a_row_are_left_out() {
    let points = (0..40_u8).map(|i| Point::new(f32::from(i), 0.0));
    let route = Route::<64>::new(points).unwrap();
    let mut builder = Junction::<1, 8>::builder();
    let path = builder.path(&route, Class::Car, CAR).unwrap();
    let junction = builder.build().unwrap();
    let kept = junction.polyline(path).unwrap().points().iter();
    assert_eq!(
        kept.map(|point| point.x).collect::<std::vec::Vec<_>>(),
        [0.0, 17.0, 34.0, 39.0]
    );
}
