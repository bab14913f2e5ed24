//! The recorded encounters of INTERACTION's EP0 and MA; skipped where the recordings are absent.

use cede_controller::kinematics::{State, advance, clamp_acceleration};
use cede_controller::{ConflictKind, Control};
use cede_data::lanelet::{Lanelet, LineKind};
use cede_data::{Dataset, Encounter, REST, Role, Rule, Split};
use cede_tests::interaction;

fn load(site: &str) -> Option<Dataset> {
    Some(Dataset::load(&interaction()?, site).unwrap_or_else(|error| panic!("{error}")))
}

fn encounters_per_file(dataset: &Dataset) -> Vec<usize> {
    dataset
        .folds(dataset.files().len())
        .iter()
        .map(|fold| fold.held_out.len())
        .collect()
}

#[test]
fn the_paper_s_site_has_its_known_number_of_pairs_in_each_file() {
    let Some(dataset) = load("EP0") else { return };
    assert_eq!(encounters_per_file(&dataset), [7, 44, 16, 38, 66, 80, 30]);
    assert_eq!(dataset.split(Split::Train).count(), 215);
    assert_eq!(dataset.split(Split::Validation).count(), 66);
}

#[test]
fn the_train_set_s_known_facts() {
    let Some(dataset) = load("EP0") else { return };
    let train = || dataset.split(Split::Train);
    let different = |id: fn(&Encounter) -> u32| {
        let ids = train().map(|e| (e.id.file, id(e)));
        ids.collect::<std::collections::HashSet<_>>().len()
    };
    assert_eq!(different(|e| e.id.left), 48);
    assert_eq!(different(|e| e.id.other), 103);
    let starts_at_rest = |e: &&Encounter| e.judged(Role::Left).record[0].v < REST;
    assert_eq!(train().filter(starts_at_rest).count(), 41);
    let steps = || train().map(|e| e.steps);
    assert_eq!((steps().min(), steps().max()), (Some(1), Some(275)));
    assert_eq!(steps().filter(|&steps| steps < 10).count(), 7);
}

/// Cases like the paper's three: a straight-going vehicle that gives way to the left-turner, one
/// that does not, and a right-turner that gives way. Read off the files by hand.
#[test]
fn who_arrives_first_in_three_named_cases() {
    let Some(dataset) = load("EP0") else { return };
    let cases = [
        ((4, 68, 71), ConflictKind::Crossing, Role::Left, 89, 3.8),
        ((2, 46, 47), ConflictKind::Crossing, Role::Other, 94, 2.3),
        ((1, 79, 84), ConflictKind::Merging, Role::Left, 90, 2.9),
    ];
    for ((file, left, other), kind, first, steps, pet) in cases {
        let named = |e: &&Encounter| (e.id.file, e.id.left, e.id.other) == (file, left, other);
        let case = dataset.encounters.iter().find(named).unwrap();
        assert_eq!((case.kind, case.first, case.steps), (kind, first, steps));
        assert!((case.pet - pet).abs() < 1e-3, "{:?}", case.id);
    }
}

/// The floor of the simulator's own error: what is left when recorded accelerations are replayed.
#[test]
fn replayed_accelerations_repeat_the_record() {
    for site in ["EP0", "MA"] {
        let Some(dataset) = load(site) else { return };
        let replays: Vec<_> = dataset.encounters.iter().map(|e| (e, replay(e))).collect();
        let n = replays.len() as f32;
        let right = replays.iter().filter(|(e, r)| r.0 == Some(e.first)).count() as f32;
        let error = |(e, r): &(&Encounter, _)| relative(e, r);
        let error = replays.iter().map(error).sum::<f32>() / n;
        println!(
            "{site}: n = {n}, priority {}, length error {error}",
            right / n
        );
        assert!(right / n >= 0.99, "{site}: {right} of {n}");
        assert!(error <= 0.03, "{site}: {error}");
    }
}

fn relative(encounter: &Encounter, replay: &(Option<Role>, u32)) -> f32 {
    encounter.steps.abs_diff(replay.1) as f32 / encounter.steps as f32
}

/// Who arrives first when the recorded accelerations drive, and after how many steps.
fn replay(encounter: &Encounter) -> (Option<Role>, u32) {
    let judged = &encounter.participants[..2];
    let mut states = [0, 1].map(|i| State {
        s: judged[i].record[0].s,
        v: judged[i].record[0].v,
    });
    for step in 1..=2 * encounter.steps {
        for (state, participant) in states.iter_mut().zip(judged) {
            let sample = participant.record.get(step as usize - 1);
            *state = advance(*state, clamp_acceleration(sample.map_or(0.0, |s| s.a)));
        }
        for (role, i) in [(Role::Left, 0), (Role::Other, 1)] {
            if states[i].s >= judged[i].conflict_s {
                return (Some(role), step);
            }
        }
    }
    (None, 2 * encounter.steps)
}

#[test]
fn the_map_lies_under_the_tracks() {
    for (site, stop_lines) in [("EP0", 5), ("MA", 6)] {
        let Some(dataset) = load(site) else { return };
        let map = dataset.map.unwrap();
        let of_kind = |kind| map.lines.iter().filter(move |line| line.kind == kind);
        assert_eq!(of_kind(LineKind::Stop).count(), stop_lines, "{site}");
        // Vehicles drive in lanes: a shift or a wrong scale of the map would show here.
        let states = dataset
            .recordings
            .iter()
            .flat_map(|r| &r.tracks)
            .flat_map(|t| &t.states);
        let states: Vec<_> = states.step_by(997).collect();
        let lanes: Vec<_> = map.lanelets.iter().map(Lanelet::outline).collect();
        let on_lane = |p: [f64; 2]| lanes.iter().any(|lane| inside(lane, p));
        let in_lane = states.iter().filter(|s| on_lane([s.x, s.y])).count();
        let share = in_lane as f64 / states.len() as f64;
        println!(
            "{site}: {:.1} % of {} positions lie in a lane",
            100.0 * share,
            states.len()
        );
        assert!(share > 0.95, "{site}: {share}");
    }
}

/// What a look at each site's map and its signs says.
#[test]
fn the_maps_say_who_gives_way() {
    for site in ["EP0", "MA", "GL", "FT", "SR"] {
        let Some(dataset) = load(site) else { return };
        let count = |holds: &dyn Fn(&Encounter) -> bool| {
            let all = &dataset.encounters;
            let n = all.iter().filter(|e| holds(e)).count();
            n as f64 / all.len() as f64
        };
        let rule = |rule: Rule| count(&|e| e.rights.rule == rule);
        let control = |role, control: Control| count(&|e| e.judged(role).entry.control == control);
        assert!(rule(Rule::Unknown) < 0.01, "{site}");
        match site {
            "EP0" => assert_eq!(rule(Rule::AllWayStop), 1.0),
            // Some come from a car park.
            "MA" => assert!(rule(Rule::AllWayStop) > 0.98),
            // Left-turners of the major road give way to oncoming traffic; on the minor roads both stop.
            "GL" => {
                let both_major = |e: &Encounter| {
                    Role::BOTH
                        .iter()
                        .all(|&role| e.judged(role).entry.control == Control::Free)
                };
                assert!(count(&|e| both_major(e) && e.rights.settled() == Some(Role::Other)) > 0.7);
                assert!(control(Role::Left, Control::Stop) > 0.2);
            }
            // Everybody who enters a roundabout has a sign.
            _ => assert!(control(Role::Left, Control::Free) < 0.1, "{site}"),
        }
        let limit = |e: &Encounter| e.judged(Role::Left).entry.limit;
        let mph = [
            ("EP0", 15.0),
            ("MA", 40.0),
            ("GL", 40.0),
            ("FT", 25.0),
            ("SR", 25.0),
        ];
        let expected = mph.iter().find(|(name, _)| *name == site).unwrap().1 * 0.447_04;
        let told = count(&|e| limit(e).is_some_and(|v| (v - expected as f32).abs() < 1e-3));
        assert!(told > 0.99, "{site}: {told}");
    }
}

/// Whether a ray from `p` to the east meets the outline an odd number of times.
fn inside(outline: &[[f64; 2]], p: [f64; 2]) -> bool {
    let ends = outline.iter().zip(outline.iter().cycle().skip(1));
    let met = ends.filter(|(a, b)| {
        let spans = (a[1] > p[1]) != (b[1] > p[1]);
        spans && p[0] < a[0] + (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1])
    });
    met.count() % 2 == 1
}
