//! What is let in, and what is refused by name.

use super::*;
use crate::fault::{Field, InputFault, Subject};

/// Sets one number of a vehicle.
type Change = fn(&mut Vehicle, f32);

/// What is wrong with a vehicle on the ego's path, or on the first other's.
fn refused(change: impl Fn(&mut Vehicle)) -> [Option<InputFault>; 2] {
    let site = crossing();
    let way = site.way(EGO).unwrap();
    let input = |result: Result<Admitted, Fault>| match result {
        Err(Fault::Input(input)) => Some(input),
        _ => None,
    };
    let mut own = ego(&site, [20.0, 5.0]);
    change(&mut own);
    let mut other = on(&site, PathId::new(1), [20.0, 5.0]);
    change(&mut other);
    let track = Track::on(9, PathId::new(1), other);
    let candidate = track.candidates().next().unwrap();
    [
        input(super::super::door::ego(way, &WORST, &own)),
        input(super::super::door::track(way, &WORST, &track, candidate)),
    ]
}

#[test]
fn every_number_is_checked() {
    assert_eq!(refused(|_| {}), [None, None]);
    let wrong: [(Field, Change); 6] = [
        (Field::ArcLength, |v, x| v.s = x),
        (Field::Speed, |v, x| v.speed = x),
        (Field::Position, |v, x| v.pose.position.x = x),
        (Field::Position, |v, x| v.pose.position.y = x),
        (Field::Direction, |v, x| {
            v.pose.direction = unit(x, v.pose.direction.y);
        }),
        (Field::Direction, |v, x| {
            v.pose.direction = unit(v.pose.direction.x, x);
        }),
    ];
    for (field, set) in wrong {
        for bad in [f32::NAN, f32::INFINITY, -1e9] {
            let [own, other] = refused(|vehicle| set(vehicle, bad)).map(Option::unwrap);
            assert_eq!(
                (own.subject, other.subject),
                (Subject::Ego, Subject::Track(9))
            );
            assert_eq!([own.field, other.field], [field; 2], "{bad}");
        }
    }
}

#[test]
fn a_vehicle_beyond_its_path_beside_it_or_against_it_is_refused() {
    let fields = |change: fn(&mut Vehicle)| refused(change).map(|fault| fault.map(|f| f.field));
    assert_eq!(fields(|v| v.s = 120.5), [Some(Field::ArcLength); 2]);
    assert_eq!(fields(|v| v.s = 26.0), [Some(Field::Offset); 2]);
    let turned =
        |v: &mut Vehicle| v.pose.direction = unit(-v.pose.direction.x, -v.pose.direction.y);
    assert_eq!(fields(turned), [Some(Field::Heading); 2]);
}

#[test]
fn a_fault_names_field_value_and_range() {
    let [_, other] = refused(|vehicle| vehicle.s = 130.0);
    let text = other.unwrap().to_string();
    assert!(
        text.starts_with("track 9: arc length (m) 130 is outside [-0.02, 120.0"),
        "{text}"
    );
}

#[test]
fn rolling_back_counts_as_rest() {
    let site = crossing();
    let way = site.way(EGO).unwrap();
    let own = super::super::door::ego(way, &WORST, &ego(&site, [20.0, -0.1]));
    assert_eq!(own.unwrap().vehicle.speed, 0.0);
}

#[test]
fn a_path_of_another_class_or_of_no_junction_is_refused() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    let mut field = |track: Track| {
        let decision = run.observe(ego(&site, [20.0, 0.0]), &[track], 0.0);
        match decision.fault {
            Some(Fault::Input(input)) => Some((input.field, decision.unwatched)),
            _ => None,
        }
    };
    let vehicle = on(&site, PathId::new(1), [20.0, 5.0]);
    let unknown = Track::on(3, PathId::new(7), vehicle);
    assert_eq!(field(unknown), Some((Field::Path, Some(3))));
    let lorry = Track::on(4, PathId::new(1), vehicle).class(Class::Lorry);
    assert_eq!(field(lorry), Some((Field::Path, Some(4))));
}

#[test]
fn an_error_that_blurs_who_is_ahead_is_refused() {
    let lane = site(&[east(), east()]);
    let contract = |error| WORST.to_builder().position_error(error).build().unwrap();
    assert!(Shield::<8>::enter(contract(2.4), &lane, EGO).is_ok());
    let refused = Shield::<8>::enter(contract(2.6), &lane, EGO).unwrap_err();
    assert!(matches!(refused, EnterError::PositionError { value, .. } if value == 2.6));
    let no_path = Shield::<8>::enter(WORST, &lane, PathId::new(1)).unwrap_err();
    assert!(
        matches!(no_path, EnterError::Path { .. }),
        "only the first can be entered"
    );
}

/// What is left of place and heading of an ego that is let in on a road with a right angle at 20 m.
fn admitted(change: impl Fn(&mut Vehicle)) -> Option<[crate::headroom::Room; 2]> {
    let site = site(&[route(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0)])]);
    let mut own = ego(&site, [10.0, 5.0]);
    change(&mut own);
    let admitted = super::super::door::ego(site.way(EGO).unwrap(), &WORST, &own);
    admitted.ok().map(|admitted| admitted.pose)
}

#[test]
fn ends_of_ranges_are_let_in_and_what_is_beyond_them_is_not() {
    let along = |s: f32| {
        admitted(|v| {
            v.s = s;
            // Where that is on the road.
            v.pose.position = if s < 20.0 {
                Point::new(s, 0.0)
            } else {
                Point::new(20.0, s - 20.0)
            };
            v.pose.direction = if s < 20.0 {
                unit(1.0, 0.0)
            } else {
                unit(0.0, 1.0)
            };
        })
    };
    assert!(along(-0.019).is_some() && along(-0.021).is_none());
    assert!(along(40.019).is_some() && along(40.021).is_none());
    let speed = |speed: f32| admitted(|v| v.speed = speed).is_some();
    assert!(speed(Vehicle::MAX_SPEED) && !speed(Vehicle::MAX_SPEED + 0.1));
    assert!(speed(-Vehicle::REVERSING) && !speed(-Vehicle::REVERSING - 0.01));
    let long = |norm: f32| admitted(|v| v.pose.direction = unit(norm, 0.0)).is_some();
    assert!(long(0.901) && long(1.099) && !long(0.899) && !long(1.101));
}

#[test]
fn what_is_left_of_place_and_heading_is_told() {
    let near = |room: crate::headroom::Room, left: f32, most: f32| {
        let near = (room.left - left).abs() < 1e-4 && (room.share - left / most).abs() < 1e-2;
        assert!(near, "{room:?}, {left} of {most}");
    };
    let [offset, heading] = admitted(|v| v.pose.position.y = 0.015).unwrap();
    near(offset, 0.005, 0.02);
    near(heading, 0.5, 0.5);
    assert!(admitted(|v| v.pose.position.y = -0.021).is_none());
    let turned = |cosine: f32, norm: f32| {
        let sine = (1.0 - cosine * cosine).sqrt();
        admitted(|v| v.pose.direction = unit(norm * cosine, norm * sine))
    };
    near(turned(0.6, 1.0).unwrap()[1], 0.1, 0.5);
    near(turned(0.51, 0.95).unwrap()[1], 0.01, 0.5);
    assert!(turned(0.49, 1.0).is_none() && turned(0.48, 1.05).is_none());
}

/// Within what its place may be off by, it may have the direction on either side.
#[test]
fn near_a_corner_a_vehicle_has_the_direction_before_or_after_it() {
    let at = |s: f32, (x, y): (f32, f32)| {
        admitted(|v| {
            v.s = s;
            v.pose.position = if s < 20.0 {
                Point::new(s, 0.0)
            } else {
                Point::new(20.0, s - 20.0)
            };
            v.pose.direction = unit(x, y);
        })
        .is_some()
    };
    let (before, after) = ((1.0, 0.0), (0.0, 1.0));
    assert!(at(19.99, after) && !at(19.97, after));
    assert!(at(20.01, before) && !at(20.03, before));
}

#[test]
fn a_coordinate_out_of_range_is_the_one_that_is_named() {
    let named = |x: f32, y: f32| {
        let [own, _] = refused(|vehicle| vehicle.pose.position = Point::new(x, y));
        let own = own.unwrap();
        (own.field, own.value)
    };
    assert_eq!(named(9000.0, 3.0), (Field::Position, 9000.0));
    assert_eq!(named(3.0, -9000.0), (Field::Position, -9000.0));
    assert_eq!(named(-9000.0, 8000.0), (Field::Position, -9000.0));
    assert!(named(3.0, f32::NAN).1.is_nan() && named(f32::NAN, 3.0).1.is_nan());
    let [own, _] = refused(|vehicle| vehicle.pose.position = Point::new(8192.0, 0.0));
    assert_eq!(own.unwrap().field, Field::Offset);
}

#[test]
fn a_place_may_be_off_by_what_sensors_and_the_junction_may_err() {
    let mut builder = Site::builder();
    builder.tolerance(0.25);
    builder.path(&east(), Class::Car, Footprint::PAPER).unwrap();
    let site = builder.build().unwrap();
    let contract = WORST.to_builder().position_error(0.5).build().unwrap();
    let offset = |y: f32| {
        let mut own = ego(&site, [10.0, 5.0]);
        own.pose.position.y += y;
        let admitted = super::super::door::ego(site.way(EGO).unwrap(), &contract, &own);
        admitted.ok().map(|admitted| admitted.pose[0].left)
    };
    assert!((offset(0.0).unwrap() - 0.77).abs() < 1e-4);
    assert!(offset(0.769).is_some() && offset(0.771).is_none());
}
