//! The measures of criticality, by hand, by themselves, and held against those of CommonRoad-CriMe.

use cede_data::encounter::Role;
use cede_data::lanelet::{ConflictArea, OnLanelet, Trace, rectangle};
use cede_data::{Dataset, commonroad};
use cede_sim::criticality::{AreaOf, Criticality};
use cede_tests::conformance;
use geo::{Contains, Point};
use std::path::PathBuf;

fn close(value: Option<f64>, expected: f64, tolerance: f64) {
    let near = value.is_some_and(|value| (value - expected).abs() <= tolerance);
    assert!(near, "{value:?} is not {expected} ± {tolerance}");
}

/// A car from the west at 10 m/s; one from the south brakes from 10 to 5 m/s and passes behind it. Both are 4 m × 2 m,
/// the lanes 3.5 m wide.
#[test]
fn an_encounter_whose_measures_are_known_by_hand() {
    let path =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../fuzz/seeds/commonroad/crossing.xml");
    let dataset = Dataset::load(&path, "EP0").unwrap();
    let measured = Criticality::of(&dataset, &dataset.encounters[0]);
    assert_eq!(measured.area, Some(AreaOf::Lanes));
    // The first enters with its front at x = 0 and leaves with its rear at x = 3.5 m.
    close(measured.encroachment[0], 0.75, 0.01);
    // The second is at −5.5 m at 6.75 s and at 2 m at 8.25 s.
    close(measured.encroachment[1], 1.5, 0.01);
    close(measured.post_encroachment, 6.75 - 4.55, 0.01);
    // Unbraked they touch after 4.08 s; in steps of 0.1 s.
    close(measured.ttc, 4.1, 1e-6);
    // 40 m before the area at 10 m/s, which the first leaves after 4.55 s.
    close(
        measured.deceleration,
        2.0 * (45.5 - 40.0) / 4.55_f64.powi(2),
        0.01,
    );
    // Without the lanes, where the bodies can touch: the first's front at 0.75 m, its rear at 2.75 m.
    let mut paths = dataset.clone();
    paths.map = None;
    paths.recordings[0].scene = None;
    let measured = Criticality::of(&paths, &paths.encounters[0]);
    assert_eq!(measured.area, Some(AreaOf::Paths));
    close(measured.encroachment[0], 0.6, 0.02);
    // From the rear at 2.75 m, at 4.475 s, to the second's front at −2.7 m, at 6.91 s.
    close(measured.post_encroachment, 6.91 - 4.475, 0.02);
}

#[test]
fn measures_of_many_encounters_agree_with_each_other() {
    let dataset = Dataset::synthetic(150, 3);
    let mut passed = 0;
    for encounter in &dataset.encounters {
        let measured = Criticality::of(&dataset, encounter);
        assert!(
            measured.gap >= 0.0
                && measured
                    .deceleration
                    .is_none_or(|a| a.is_finite() && a >= 0.0)
        );
        assert!(
            measured
                .encroachment
                .iter()
                .flatten()
                .all(|&time| time > 0.0)
        );
        assert_eq!(
            measured.deceleration.is_some(),
            measured.post_encroachment.is_some()
        );
        assert!(
            measured.deceleration.is_none_or(|braking| braking < 30.0),
            "{measured:?}"
        );
        if let Some(time) = measured.post_encroachment {
            passed += 1;
            // Who left before the other came has not touched it there.
            assert!(
                time >= 0.0 && measured.gap > 0.0,
                "{:?}: {measured:?}",
                encounter.id
            );
        }
    }
    assert!(passed > 50, "{passed} of {}", dataset.encounters.len());
}

/// When, in steps, the vehicle `id` is in the conflict area of two lanelets, by its recorded poses.
fn stay(scenario: &commonroad::Scenario, id: u32, area: &ConflictArea) -> (usize, usize) {
    let track = scenario.tracks.iter().find(|track| track.id == id).unwrap();
    let inside = |state: &cede_data::RawState| {
        let body = cede_controller::separation::OrientedBox::new(
            cede_controller::Pose {
                position: cede_controller::Point::new(state.x as f32, state.y as f32),
                direction: cede_controller::UnitVector::new_normalize(
                    cede_controller::Vector::new(
                        state.heading.cos() as f32,
                        state.heading.sin() as f32,
                    ),
                ),
            },
            cede_controller::Footprint {
                length: track.length as f32,
                width: track.width as f32,
            },
        );
        area.meets(&body)
    };
    let entry = track.states.iter().position(inside).unwrap();
    let exit = track.states.iter().rposition(inside).unwrap() + 1;
    (entry, exit)
}

/// CriMe's own tests expect an encroachment time of 1.1 s of vehicle 1, and a post-encroachment time of 3.2 s of
/// vehicles 1 and 5. Its conflict area for the latter is that of vehicle 1's lanelet with 50207, the right turn from
/// vehicle 5's lane; vehicle 5 turns left, along 50217. With CriMe's pair of lanelets the number is CriMe's; with
/// those that are driven it is that of [`Criticality`].
#[test]
fn a_scenario_of_commonroad_has_the_times_of_crime() {
    let Some(folder) = conformance("commonroad") else {
        return;
    };
    let path = folder.join("ZAM_Tjunction-1_97_T-1.xml");
    let dataset = Dataset::load(&path, "EP0").unwrap();
    let named = |id: &cede_data::EncounterId| (id.left, id.other) == (1, 5);
    let encounter = dataset.encounters.iter().find(|e| named(&e.id)).unwrap();
    let measured = Criticality::of(&dataset, encounter);
    assert_eq!(
        (measured.area, encounter.first),
        (Some(AreaOf::Lanes), Role::Left)
    );
    // CriMe counts steps of 0.1 s.
    close(measured.encroachment[0], 1.1, 0.1);

    let scenario = commonroad::read(&path).unwrap();
    // On this map the places of lanelets in the file tell them: 50195, 50197, …, 50217.
    let way = |id: usize| {
        Trace(vec![OnLanelet {
            lanelet: (id - 50195) / 2,
            from: 0,
            changed: false,
        }])
    };
    let area = |a, b| scenario.map.conflict_area([&way(a), &way(b)]).unwrap();
    let of_crime = area(50213, 50207);
    let (left, entered) = (
        stay(&scenario, 1, &of_crime).1,
        stay(&scenario, 5, &of_crime).0,
    );
    // CriMe takes the last step before the entry.
    assert_eq!(entered - 1 - left, 32);
    let driven = area(50213, 50217);
    let (left, entered) = (stay(&scenario, 1, &driven).1, stay(&scenario, 5, &driven).0);
    close(
        measured.post_encroachment,
        0.1 * (entered - left) as f64,
        0.1,
    );
}

#[test]
fn vehicles_of_commonroad_s_second_scenario_merge_by_right_before_left() {
    let Some(folder) = conformance("commonroad") else {
        return;
    };
    let path = folder.join("DEU_TestIntersectionInteract-3_1_T-1.xml");
    let dataset = Dataset::load(&path, "EP0").unwrap();
    let [encounter] = dataset.encounters.as_slice() else {
        panic!("{} encounters", dataset.encounters.len());
    };
    let measured = Criticality::of(&dataset, encounter);
    // One follows the other into the lane that both leave by: both are in the area of their lanes at once.
    assert_eq!(
        (measured.area, measured.post_encroachment),
        (Some(AreaOf::Lanes), None)
    );
    assert_eq!(measured.deceleration, None);
    assert_eq!(encounter.rights.rule, cede_data::Rule::Right);
}

#[test]
fn a_rectangle_covers_its_vehicle() {
    let body = cede_controller::separation::OrientedBox {
        centre: cede_controller::Point::new(1.0, 2.0),
        direction: cede_controller::Vector::new(0.0, 1.0),
        half_length: 2.0,
        half_width: 1.0,
    };
    let covered = rectangle(&body);
    assert!(covered.contains(&Point::new(1.9, 3.9)) && !covered.contains(&Point::new(2.1, 2.0)));
}
