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
