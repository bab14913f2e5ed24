//! What an approach does beyond policy and shield.

use super::ask::Urgency;
use super::nearby::{nearby, traffic};
use super::*;
use crate::decision::Cause;
use crate::fault::Fault;
use crate::geometry::{Footprint, Point};
use crate::junction::{Class, Junction, PathId, Route};
use crate::observation::Track;
use crate::policy::features::FeatureSet;
use crate::policy::weights::Perspective;
use crate::policy::weights::testing::file;
use std::vec::Vec;

type Site = Junction<4, 16, 1>;

fn route(points: &[(f32, f32)]) -> Route<4> {
    Route::new(points.iter().map(|&(x, y)| Point::new(x, y))).unwrap()
}

/// The ego goes east; the others cross from the south, follow it, and come from the south further on.
fn site() -> Site {
    let routes = [
        route(&[(-60.0, 0.0), (120.0, 0.0)]),
        route(&[(0.0, -60.0), (0.0, 60.0)]),
        route(&[(-60.0, 0.0), (120.0, 0.0)]),
        route(&[(30.0, -60.0), (30.0, 60.0)]),
    ];
    let mut builder = Site::builder();
    builder.tolerance(0.0);
    for route in &routes {
        builder.path(route, Class::Car, Footprint::PAPER).unwrap();
    }
    builder.build().unwrap()
}

fn on(site: &Site, path: u8, s: f32, speed: f32) -> Vehicle {
    let pose = site.polyline(PathId::new(path)).unwrap().pose(s);
    Vehicle { s, speed, pose }
}

fn tracks(site: &Site, others: &[(u8, f32, f32)]) -> Vec<Track> {
    let track = |&(path, s, speed): &(u8, f32, f32)| {
        Track::on(
            100 + u16::from(path),
            PathId::new(path),
            on(site, path, s, speed),
        )
    };
    others.iter().map(track).collect()
}

fn drive(file: &[u32]) -> Drive<'_> {
    let policy = Policy::new(file).unwrap();
    Drive::new(policy, Contract::WORST_CASE, Part::Left)
}

#[test]
fn the_policy_is_asked_about_the_one_that_arrives_first() {
    let file = file(FeatureSet::Route, Perspective::Ego, 16);
    let site = site();
    let decide = |others: &[(u8, f32, f32)]| {
        let mut approach = drive(&file).enter(&site, PathId::new(0)).unwrap();
        let tracks = tracks(&site, others);
        let seen = Observation {
            ego: on(&site, 0, 0.0, 5.0),
            tracks: &tracks,
        };
        approach.ask(None, &seen, FREE).unwrap().0.unwrap()
    };
    let (a, c) = ((1, 5.0, 4.0), (3, 20.0, 9.0));
    // 55 m at 4 m/s, and 40 m at 9 m/s.
    let (first, third) = (decide(&[a]), decide(&[c]));
    assert_eq!(first.1.other, 101);
    assert_eq!(third.1.other, 103);
    assert_eq!(decide(&[a, c]), third);
    assert_eq!(decide(&[c, a]), third);
}

#[test]
fn who_waits_for_the_ego_is_asked_about_last() {
    let [waits, comes, later] = [(true, 1.0), (false, 8.0), (false, 9.0)]
        .map(|(waits, arrives)| Urgency { waits, arrives });
    assert!(comes.precedes(waits) && !waits.precedes(comes));
    assert!(comes.precedes(later) && !later.precedes(comes));
    assert!(!comes.precedes(comes));
}

#[test]
fn an_ego_with_a_driver_of_its_own_is_left_to_it_until_stopping_takes_more_than_gentle_braking() {
    let file = file(FeatureSet::Route, Perspective::Ego, 16);
    let site = site();
    let mut approach = drive(&file).enter(&site, PathId::new(0)).unwrap();
    let tracks = tracks(&site, &[(1, 20.0, 1.0)]);
    let line = site.path(PathId::new(0)).unwrap().line();
    let (speed, most) = (6.0, 0.25);
    let stop = speed * speed / (2.0 * GENTLE);
    let mut decide = |short: f32, at: u64| {
        let seen = Observation {
            ego: on(&site, 0, line - short, speed),
            tracks: &tracks,
        };
        let wanted = approach.ask(None, &seen, most).unwrap().0.unwrap().0;
        let decision = approach.decide_up_to(Instant::from_millis(at), &seen, most);
        (wanted, decision.acceleration)
    };
    let (asked, decided) = decide(stop + 1.0, 0);
    assert!(asked < most && decided == most, "{asked} {decided}");
    let (asked, decided) = decide(stop - 0.5, 100);
    assert!(
        asked < most && decided <= most.min(asked),
        "{asked} {decided}"
    );
}

#[test]
fn one_ahead_in_the_lane_is_a_leader_and_nobody_to_meet() {
    let site = site();
    let (way, ego) = (site.way(PathId::new(0)).unwrap(), on(&site, 0, 0.0, 5.0));
    let tracks = tracks(&site, &[(2, 20.0, 4.0)]);
    let nearby = nearby::<8>(way, &Contract::WORST_CASE, &ego, &tracks);
    let leader = traffic(&ego, &nearby, 0).leader.unwrap();
    assert_eq!(leader.speed, 4.0);
    assert!((leader.gap - 15.0).abs() < 0.1, "{leader:?}");
    assert!(!nearby[0].meets(&ego));
}

#[test]
fn with_nobody_to_meet_the_ego_drives_on_and_with_bad_senses_it_brakes() {
    let file = file(FeatureSet::Route, Perspective::Ego, 16);
    let site = site();
    let mut approach = drive(&file).enter(&site, PathId::new(0)).unwrap();
    let mut seen = Observation {
        ego: on(&site, 0, 0.0, 5.0),
        tracks: &[],
    };
    let decision = approach.decide(Instant::from_millis(0), &seen);
    assert_eq!(
        (decision.acceleration, decision.cause),
        (FREE, Cause::Policy)
    );
    assert_eq!(decision.prediction, None);
    seen.ego.s = f32::NAN;
    let decision = approach.decide(Instant::from_millis(100), &seen);
    assert!(matches!(decision.cause, Cause::Fallback(Fault::Input(_))));
    assert_eq!(decision.acceleration, -3.0);
}

#[test]
fn another_policy_drives_on_with_the_same_plan() {
    let (one, two) = [16, 32]
        .map(|width| file(FeatureSet::Route, Perspective::Ego, width))
        .into();
    let site = site();
    let mut approach = drive(&one).enter(&site, PathId::new(0)).unwrap();
    let tracks = tracks(&site, &[(1, 5.0, 4.0)]);
    let seen = Observation {
        ego: on(&site, 0, 0.0, 5.0),
        tracks: &tracks,
    };
    approach.decide(Instant::from_millis(0), &seen);
    let plan = approach.plan();
    assert!(plan.is_some());
    approach.set_policy(Policy::new(&two).unwrap());
    assert_eq!(approach.plan(), plan);
}

#[cfg(feature = "estimates")]
#[test]
fn estimates_come_when_they_are_wanted_and_change_no_command() {
    let file = file(FeatureSet::Route, Perspective::Ego, 16);
    let site = site();
    let decisions = |wanted: bool| -> Vec<_> {
        let mut drive = drive(&file);
        drive.set_estimates(wanted);
        let mut approach = drive.enter(&site, PathId::new(0)).unwrap();
        let decide = |step: u16| {
            let t = 0.1 * f32::from(step);
            let tracks = tracks(&site, &[(1, 5.0 + 4.0 * t, 4.0), (3, 2.0 + 9.0 * t, 9.0)]);
            let seen = Observation {
                ego: on(&site, 0, 5.0 * t, 5.0),
                tracks: &tracks,
            };
            approach.decide(Instant::from_millis(100 * u64::from(step)), &seen)
        };
        (0..12).map(decide).collect()
    };
    for (plain, estimated) in decisions(false).iter().zip(&decisions(true)) {
        assert_eq!(plain.acceleration, estimated.acceleration);
        let (plain, estimated) = (plain.prediction.unwrap(), estimated.prediction.unwrap());
        assert_eq!((plain.shown, plain.svo), (None, estimated.svo));
        assert!((0.0..=1.0).contains(&estimated.shown.unwrap().confidence));
    }
}

#[test]
fn a_dial_in_its_middle_changes_nothing_and_an_altruist_proposes_less() {
    let file = file(FeatureSet::Route, Perspective::Ego, 16);
    let site = site();
    let tracks = tracks(&site, &[(1, 20.0, 6.0)]);
    let seen = Observation {
        ego: on(&site, 0, 20.0, 5.0),
        tracks: &tracks,
    };
    let proposal = |degrees: Option<f32>| {
        let mut drive = drive(&file);
        if let Some(degrees) = degrees {
            let orientation = Orientation::from_degrees(degrees).unwrap();
            drive.set_orientation(orientation).unwrap();
        }
        let mut approach = drive.enter(&site, PathId::new(0)).unwrap();
        approach.proposal(&seen)
    };
    let plain = proposal(None);
    assert_eq!(proposal(Some(45.0)), plain);
    assert!(proposal(Some(75.0)) <= plain && plain <= proposal(Some(15.0)));
}

#[test]
fn no_proposal_exceeds_the_profile() {
    let file = file(FeatureSet::Route, Perspective::Ego, 16);
    let mut builder = Site::builder();
    let east = route(&[(-60.0, 0.0), (120.0, 0.0)]);
    let path = builder.path(&east, Class::Car, Footprint::PAPER).unwrap();
    builder.speed_limit(path, 50.0, 6.0).unwrap();
    let site = builder.build().unwrap();
    let at = |s, most: Option<f32>| {
        let mut approach = drive(&file).enter(&site, path).unwrap();
        let seen = Observation {
            ego: on(&site, 0, s, 10.0),
            tracks: &[],
        };
        let now = Instant::from_millis(0);
        let decision = match most {
            Some(most) => approach.decide_up_to(now, &seen, most),
            None => approach.decide(now, &seen),
        };
        assert_eq!(decision.cause, Cause::Policy);
        decision.acceleration
    };
    // 64 m²/s² at 1.5 m/s² are 21.3 m.
    assert_eq!((at(0.0, None), at(0.0, Some(0.5))), (FREE, 0.5));
    for most in [None, Some(2.0)] {
        assert!((at(29.0, most) + 1.5).abs() < 0.2, "{}", at(29.0, most));
    }
    assert_eq!(at(29.0, Some(-2.5)), -2.5);
}

#[test]
fn an_approach_fits_its_share_of_the_memory() {
    let share = 3136 + if cfg!(feature = "estimates") { 192 } else { 0 };
    let size = size_of::<Approach<'_, '_>>();
    assert!(size <= share, "{size}");
}
