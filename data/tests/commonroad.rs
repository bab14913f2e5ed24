//! CommonRoad scenarios: what becomes of them, and what users read when one is not as it should be.

use cede_controller::{ConflictKind, Control};
use cede_data::lanelet::{LineKind, RegulationKind, Sign};
use cede_data::{Dataset, Role, Rule, Split, commonroad};
use insta::assert_snapshot;
use std::path::Path;

/// A car from the west, and one from the south that has a stop sign and brakes.
const CROSSING: &str = include_str!("../../fuzz/seeds/commonroad/crossing.xml");

/// The scenario with `wrong` in place of the first `right`, as a file that `use_it` is given.
fn with_file<T>(right: &str, wrong: &str, use_it: impl FnOnce(&Path) -> T) -> T {
    assert!(CROSSING.contains(right), "{right}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scenario.xml");
    std::fs::write(&path, CROSSING.replacen(right, wrong, 1)).unwrap();
    use_it(&path)
}

fn message(right: &str, wrong: &str) -> String {
    with_file(right, wrong, |path| {
        let error = commonroad::read(path).unwrap_err();
        let folder = path.parent().unwrap().display();
        error.to_string().replace(&format!("{folder}/"), "")
    })
}

#[test]
fn roads_signs_and_vehicles_are_read() {
    let scenario = with_file("", "", commonroad::read).unwrap();
    assert_eq!(scenario.name, "ZAM_Crossing-1_1_T-1");
    let tracks: Vec<_> = scenario
        .tracks
        .iter()
        .map(|t| (t.id, t.states.len()))
        .collect();
    // The pedestrian is passed over.
    assert_eq!(tracks, [(31, 91), (32, 101)]);
    assert_eq!(
        (scenario.tracks[1].length, scenario.tracks[1].width),
        (4.0, 2.0)
    );
    let state = scenario.tracks[1].states[10];
    assert!(
        (state.y + 36.5).abs() < 1e-3 && (state.vy - 8.0).abs() < 1e-3 && state.vx.abs() < 1e-4
    );
    let lanelets = &scenario.map.lanelets;
    assert_eq!(lanelets.len(), 6);
    assert_eq!((lanelets[0].limit, lanelets[1].limit), (Some(13.9), None));
    let successors: Vec<_> = lanelets.iter().map(|l| l.successors.clone()).collect();
    assert_eq!(
        successors,
        [vec![1], vec![2], vec![], vec![4], vec![5], vec![]]
    );
    let regulations = &scenario.map.regulations;
    assert_eq!(regulations.len(), 1);
    assert_eq!(
        (regulations[0].sign, &*regulations[0].yielding),
        (Some(Sign::Stop), &[3][..])
    );
    let stop = scenario
        .map
        .lines
        .iter()
        .find(|line| line.kind == LineKind::Stop);
    assert_eq!(stop.unwrap().points, [[0.0, -8.5], [3.5, -8.5]]);
}

#[test]
fn vehicles_whose_ways_cross_are_an_encounter_for_testing() {
    let dataset = with_file("", "", |path| Dataset::load(path, "EP0")).unwrap();
    assert_eq!(dataset.site.name, "ZAM_Crossing-1_1_T-1");
    assert_eq!(dataset.split(Split::Test).count(), 1);
    let encounter = &dataset.encounters[0];
    assert_eq!((encounter.id.left, encounter.id.other), (31, 32));
    assert_eq!(
        (encounter.kind, encounter.first),
        (ConflictKind::Crossing, Role::Left)
    );
    assert_eq!(
        (encounter.rights.first, encounter.rights.rule),
        (Some(Role::Left), Rule::MinorRoad)
    );
    let entries = Role::BOTH.map(|role| encounter.judged(role).entry);
    assert_eq!(
        entries.map(|entry| entry.control),
        [Control::Free, Control::Stop]
    );
    assert_eq!(entries[0].limit, Some(13.9));
    // From y = −45.5 m to the line.
    assert!((entries[1].line.unwrap() - 37.0).abs() < 0.6, "{entries:?}");
}

#[test]
fn where_everybody_has_a_stop_sign_it_is_an_all_way_stop() {
    let signed = "<additionalValue>13.9</additionalValue></trafficSignElement><trafficSignElement><trafficSignID>206</trafficSignID>";
    let map = with_file(
        "<additionalValue>13.9</additionalValue>",
        signed,
        commonroad::read,
    );
    let regulations = map.unwrap().map.regulations;
    assert_eq!(regulations.len(), 1);
    assert_eq!(
        (regulations[0].kind, &*regulations[0].yielding),
        (RegulationKind::AllWayStop, &[0, 3][..])
    );
}

#[test]
fn who_is_not_on_the_priority_road_gives_way() {
    let stop = "<trafficSignID>206</trafficSignID>";
    let text = CROSSING.replace(stop, "<trafficSignID>101</trafficSignID>");
    let text = text.replace("<additionalValue>13.9</additionalValue>", "<additionalValue>13.9</additionalValue></trafficSignElement><trafficSignElement><trafficSignID>306</trafficSignID>");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.xml"), &text).unwrap();
    std::fs::write(folder.path().join("b.xml"), text.replace(">306<", ">102<")).unwrap();
    let dataset = Dataset::load(folder.path(), "EP0").unwrap();
    let rights: Vec<_> = dataset
        .encounters
        .iter()
        .map(|e| (e.id.file, e.rights.first, e.rights.rule))
        .collect();
    // Without the priority road, who comes from the right.
    assert_eq!(
        rights,
        [
            (0, Some(Role::Left), Rule::Regulation),
            (1, Some(Role::Other), Rule::Right)
        ]
    );
}

#[test]
fn the_area_of_two_lanes_is_where_they_overlap() {
    let dataset = with_file("", "", |path| Dataset::load(path, "EP0")).unwrap();
    let area = dataset.conflict_area(&dataset.encounters[0]).unwrap();
    assert!((area.size() - 3.5 * 3.5).abs() < 1e-9, "{}", area.size());
}

#[test]
fn a_folder_of_scenarios_is_one_data_set() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["b.xml", "a.xml"] {
        let text = CROSSING.replace("Crossing-1", name.trim_end_matches(".xml"));
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let dataset = Dataset::load(folder.path(), "EP0").unwrap();
    let named: Vec<_> = dataset
        .encounters
        .iter()
        .map(|e| (e.id.file, e.id.site.as_str()))
        .collect();
    assert_eq!(named, [(0, "ZAM_a_1_T-1"), (1, "ZAM_b_1_T-1")]);
    assert!(dataset.map.is_none() && dataset.map_of(1).is_some());
    assert_eq!(dataset.every_pair().encounters.len(), 2);
    assert_eq!(Dataset::sites(folder.path()).unwrap(), [dataset.site.name]);
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    assert_snapshot!(message("2020a", "2018b"), @"scenario.xml:2: not a CommonRoad scenario of version 2020a: its version is `2018b`");
    assert_snapshot!(message("<x>-8</x>", "<x>west</x>"), @"scenario.xml:5: not a CommonRoad scenario of version 2020a: <x> is `west`, not a number");
    assert_snapshot!(message("<x>-8</x>", "<x>-500000</x>"), @"scenario.xml:5: not a CommonRoad scenario of version 2020a: (-500000, 0) m is farther than 8192 m from the origin");
    assert_snapshot!(message("<successor ref=\"2\"/>", "<successor ref=\"77\"/>"), @"scenario.xml:5: not a CommonRoad scenario of version 2020a: there is no lanelet 77");
    assert_snapshot!(message("<trafficSignRef ref=\"20\"/>", "<trafficSignRef ref=\"99\"/>"), @"scenario.xml:5: not a CommonRoad scenario of version 2020a: there is no traffic sign 99");
    assert_snapshot!(message("timeStepSize=\"0.1\"", "timeStepSize=\"0\""), @"scenario.xml:2: not a CommonRoad scenario of version 2020a: timeStepSize `0` is outside (0, 1] s");
    assert_snapshot!(message("<length>4</length>", "<length>-4</length>"), @"scenario.xml:19: not a CommonRoad scenario of version 2020a: obstacle 31 is -4 m long and 2 m wide");
    assert_snapshot!(message("<exact>1</exact>", "<intervalStart>1</intervalStart>"), @"scenario.xml:22: not a CommonRoad scenario of version 2020a: <state> without <time/exact>");
    assert_snapshot!(message("<exact>2</exact></time>", "<exact>1</exact></time>"), @"scenario.xml:23: duplicate row: track 31 already has a row at 100 ms");
    assert_snapshot!(message("<trajectory>", "<occupancySet/><trajectory>"), @"scenario.xml:21: not a CommonRoad scenario of version 2020a: obstacle 31 has occupied areas in place of a trajectory");
    assert_snapshot!(message("</commonRoad>", ""), @"scenario.xml:1: not a CommonRoad scenario of version 2020a: the root node was opened but never closed");
}
