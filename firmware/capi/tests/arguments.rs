//! Whatever the arguments: a status, never a panic; and an acceleration that is finite and admissible.

mod common;

use cede::*;
use common::{OK, World, no_decision, off, off_mut, seen, track, worst_case};
use proptest::prelude::*;
use std::ptr::{null, null_mut};

/// Bytes as a structure of the header, all bits of which are allowed.
fn of<T: Copy>(bytes: &[u8]) -> T {
    assert!(bytes.len() >= size_of::<T>());
    // SAFETY: there are enough bytes, and the types are those of arguments: numbers and pointers.
    unsafe { bytes.as_ptr().cast::<T>().read_unaligned() }
}

/// As many bytes as the structure has, that are numbers of a usual size now and then.
fn bytes<T>() -> impl Strategy<Value = Vec<u8>> {
    let word = prop_oneof![
        any::<u32>(),
        (-100.0_f32..100.0).prop_map(f32::to_bits),
        Just(0),
        Just(1)
    ];
    let words = size_of::<T>().div_ceil(4);
    prop::collection::vec(word, words)
        .prop_map(|words| words.iter().flat_map(|w| w.to_le_bytes()).collect())
}

fn admissible(contract: &cede_contract, acceleration: f32) -> bool {
    (-contract.ego_braking.max(contract.ego_emergency)..=contract.ego_acceleration)
        .contains(&acceleration)
}

proptest! {
    #[test]
    fn any_observation(
        ego in bytes::<cede_vehicle>(),
        tracks in prop::collection::vec(bytes::<cede_track>(), 0..30),
        sound in 0..3_usize,
        times in any::<[u64; 3]>(),
        is_there in any::<bool>(),
        most in any::<u32>(),
    ) {
        let contract = worst_case();
        let mut world = World::new(&contract);
        let mut tracks: Vec<cede_track> = tracks.iter().map(|bytes| of(bytes)).collect();
        for (i, given) in tracks.iter_mut().take(sound).enumerate() {
            *given = track();
            given.number += i as u16;
        }
        let mut observation = seen(&tracks);
        observation.ego = of(&ego);
        if !is_there {
            observation.tracks = null();
        }
        for now in times {
            let (_, mut decision) = world.decide(now, &observation);
            prop_assert!(admissible(&contract, decision.acceleration), "{decision:?}");
            prop_assert!(!decision.margin.is_nan());
            // SAFETY: as the header says.
            unsafe {
                let (later, most) = (now.wrapping_add(100_000), f32::from_bits(most));
                cede_approach_decide_up_to(&mut world.approach, later, most, &observation, &mut decision);
            }
            prop_assert!(admissible(&contract, decision.acceleration), "{decision:?}");
            // SAFETY: as the header says.
            let proposal = unsafe {
                cede_approach_ready(&world.approach, now, &observation, null_mut());
                let mut proposal = 0.0;
                cede_approach_proposal(&mut world.approach, &observation, &mut proposal);
                proposal
            };
            prop_assert!(proposal.abs() <= 3.0);
            let (mut margin, mut first) = (0.0, 0);
            // SAFETY: as the header says.
            unsafe {
                let given = f32::from_bits(most);
                cede_approach_margin(&world.approach, &observation, given, given, &mut margin, null_mut());
                cede_approach_goes_before(&world.approach, most as u16, &mut first);
                let mut profile = std::mem::zeroed();
                prop_assert_eq!(cede_approach_profile(&world.approach, given, given, &mut profile), OK);
            }
            prop_assert!(!margin.is_nan());
            prop_assert!(first <= 1);
        }
    }

    #[test]
    fn any_contract(bytes in bytes::<cede_contract>(), part in any::<u8>(), usual in any::<u32>()) {
        let mut contract: cede_contract = of(&bytes);
        let known = worst_case();
        // Where a bit is set, the number is a usual one: now and then the contract is sound.
        let pairs = [
            (&mut contract.period, known.period), (&mut contract.latency, known.latency),
            (&mut contract.jitter, known.jitter), (&mut contract.position_error, known.position_error),
            (&mut contract.speed_error, known.speed_error), (&mut contract.slack, known.slack),
            (&mut contract.ego_max_speed, known.ego_max_speed), (&mut contract.ego_acceleration, known.ego_acceleration),
            (&mut contract.ego_go, known.ego_go), (&mut contract.ego_braking, known.ego_braking),
            (&mut contract.other_max_speed, known.other_max_speed), (&mut contract.other_acceleration, known.other_acceleration),
            (&mut contract.other_braking, known.other_braking), (&mut contract.follower_reaction, known.follower_reaction),
            (&mut contract.follower_braking, known.follower_braking),
            (&mut contract.ego_emergency, known.ego_emergency), (&mut contract.ego_lag, known.ego_lag),
            (&mut contract.ego_gain, known.ego_gain), (&mut contract.ego_disturbance, known.ego_disturbance),
        ];
        for (i, (number, known)) in pairs.into_iter().enumerate() {
            if usual % 21 != i as u32 {
                *number = known;
            }
        }
        let mut detail = cede_detail { status: OK, ..of(&[0; 64]) };
        // SAFETY: as the header says.
        let checked = unsafe { cede_contract_check(&contract, &mut detail) };
        prop_assert_eq!(checked, detail.status);
        if checked != OK {
            prop_assert!(detail.contract_field as u8 != 0 && detail.contract_field as u8 != 255);
        }
        let mut world = World::empty();
        world.junction();
        prop_assert_eq!(world.drive(&contract), checked);
        // SAFETY: as the header says.
        let other = unsafe { cede_drive_init(&mut world.drive, &world.policy, &contract, part, null_mut()) };
        prop_assert!(other == checked || part > 1);
        if checked == OK && world.drive(&contract) == OK && world.enter(0) == OK {
            let (status, decision) = world.decide(1_000_000, &seen(&[track()]));
            prop_assert_eq!(status, OK);
            prop_assert!(admissible(&contract, decision.acceleration), "{decision:?}");
        }
    }

    #[test]
    fn any_other_contract_while_it_drives(bytes in bytes::<cede_contract>()) {
        let mut world = World::new(&worst_case());
        // SAFETY: as the header says.
        unsafe { cede_approach_set_contract(&mut world.approach, &of(&bytes), null_mut()) };
        let (status, decision) = world.decide(1_000_000, &seen(&[track()]));
        prop_assert_eq!(status, OK);
        prop_assert!(decision.acceleration.is_finite());
    }

    #[test]
    fn any_traffic(
        bytes in bytes::<cede_traffic>(),
        number in any::<u16>(),
        sights in prop::collection::vec(bytes::<cede_sight>(), 0..15),
    ) {
        let sights: Vec<cede_sight> = sights.iter().map(|bytes| of(bytes)).collect();
        let contract = worst_case();
        let mut world = World::new(&contract);
        // SAFETY: as the header says.
        unsafe {
            prop_assert_eq!(cede_approach_set_traffic(&mut world.approach, &of(&bytes)), OK);
            prop_assert_eq!(cede_approach_forget(&mut world.approach, number), OK);
            let (first, count) = (sights.as_ptr(), sights.len() as u32);
            cede_approach_set_sight(&mut world.approach, 1_000_000, first, count, null_mut());
        }
        let (status, decision) = world.decide(1_000_000, &seen(&[track()]));
        prop_assert_eq!(status, OK);
        prop_assert!(admissible(&contract, decision.acceleration), "{decision:?}");
    }

    #[test]
    fn any_junction(
        points in prop::collection::vec(bytes::<cede_point>(), 0..70),
        footprint in bytes::<cede_footprint>(),
        [class, of_path, first, second, priority, control] in any::<[u8; 6]>(),
        [tolerance, line, s] in any::<[u32; 3]>(),
    ) {
        let mut world = World::empty();
        let points: Vec<cede_point> = points.iter().map(|bytes| of(bytes)).collect();
        let footprint: cede_footprint = of(&footprint);
        let [tolerance, line, s] = [tolerance, line, s].map(f32::from_bits);
        let (junction, none) = (&raw mut world.junction, null_mut());
        let mut path = 0;
        // SAFETY: as the header says.
        unsafe {
            cede_junction_init(junction);
            let count = points.len() as u32;
            let added = [
                cede_junction_add_path(junction, points.as_ptr(), count, class, &footprint, &mut path, none),
                cede_junction_add_path(junction, points.as_ptr(), count, class % 3, &common::CAR, &mut path, none),
                cede_junction_add_variant(junction, of_path % 3, class % 4, &footprint, &mut path, none),
            ];
            let paths = added.iter().filter(|&&status| status == OK).count();
            cede_junction_set_line(junction, of_path, line, none);
            cede_junction_set_right_of_way(junction, first, second, none);
            let known = cede_junction_set_priority(junction, first % 3, second % 3, priority, none);
            prop_assert_eq!(known == cede_status::UnknownChoice, priority > cede_priority::Signed as u8);
            let known = cede_junction_set_control(junction, of_path % 3, control, none);
            prop_assert_eq!(known == cede_status::UnknownChoice, control > cede_control::AllWayStop as u8);
            cede_junction_add_speed_limit(junction, of_path % 3, line, s, none);
            cede_junction_set_pace(junction, of_path % 3, s, none);
            let known = cede_junction_set_order(junction, of_path, u16::from(control), none);
            prop_assert_eq!(known == cede_status::Ok, usize::from(of_path) < paths);
            cede_junction_set_lateral(junction, s);
            cede_junction_set_tolerance(junction, tolerance);
            cede_junction_build(junction, none);
            let mut pose = cede_pose::default();
            let mut along = 0.0;
            cede_junction_pose(junction, of_path, s, &mut pose);
            cede_junction_project(junction, of_path, &pose.position, &mut along);
            prop_assert!(!along.is_nan());
        }
    }

    #[test]
    fn any_weights(words in prop::collection::vec(any::<u32>(), 0..200), good in 0..50_usize) {
        let mut world = World::empty();
        let mut words = words;
        let known = cede_controller::policy::embedded::words();
        for (word, known) in words.iter_mut().zip(known).take(good) {
            *word = *known;
        }
        // SAFETY: as the header says.
        let status = unsafe { cede_policy_init(&mut world.policy, words.as_ptr(), 4 * words.len() as u32) };
        prop_assert!(status != OK);
    }

    #[test]
    fn any_number_has_a_text(number in any::<i32>(), byte in any::<u8>()) {
        let mut texts = vec![cede_status_text(number)];
        for text in [
            cede_cause_text, cede_action_text, cede_reason_text, cede_fault_text, cede_subject_text, cede_field_text,
            cede_breach_text, cede_condition_text, cede_contract_field_text, cede_conflict_text, cede_right_text, cede_priority_text,
            cede_control_text, cede_class_text,
        ] {
            texts.push(text(byte));
        }
        prop_assert!(texts.iter().all(|text| !text.is_null()));
    }
}

#[test]
fn null_and_misaligned_pointers_have_a_status() {
    let contract = worst_case();
    let mut world = World::new(&contract);
    let (null_pointer, misaligned) = (cede_status::NullPointer, cede_status::Misaligned);
    let observation = seen(&[]);
    let mut decision = no_decision();
    // SAFETY: as the header says.
    unsafe {
        let approach = &raw mut world.approach;
        let decide = |approach, observation, decision| {
            cede_approach_decide(approach, 1_000_000, observation, decision)
        };
        assert_eq!(
            decide(null_mut(), &observation, &mut decision),
            null_pointer
        );
        assert_eq!(decision.acceleration, -CEDE_LAST_RESORT_BRAKING);
        assert_eq!(
            decide(off_mut(&mut world.approach), &observation, &mut decision),
            misaligned
        );
        assert_eq!(decision.cause, cede_cause::None);
        assert_eq!(decide(approach, &observation, null_mut()), null_pointer);
        assert_eq!(
            decide(approach, &observation, off_mut(&mut decision)),
            misaligned
        );
        assert_eq!(decide(approach, null(), &mut decision), null_pointer);
        assert_eq!(decision.cause, cede_cause::Fallback);
        assert!(admissible(&contract, decision.acceleration));
        assert_eq!(
            decide(approach, off(&observation), &mut decision),
            misaligned
        );
        let tracks = [track(), track()];
        let mut crooked = seen(&tracks[..1]);
        crooked.tracks = off(&tracks[0]);
        assert_eq!(decide(approach, &crooked, &mut decision), misaligned);

        assert_eq!(
            cede_approach_ready(null(), 0, &observation, null_mut()),
            null_pointer
        );
        assert_eq!(
            cede_approach_ready(approach, 0, null(), null_mut()),
            null_pointer
        );
        assert_eq!(
            cede_approach_proposal(approach, &observation, null_mut()),
            null_pointer
        );
        let up_to = |approach, observation, decision| {
            cede_approach_decide_up_to(approach, 2_000_000, 1.0, observation, decision)
        };
        assert_eq!(up_to(null_mut(), &observation, &mut decision), null_pointer);
        assert_eq!(decision.acceleration, -CEDE_LAST_RESORT_BRAKING);
        assert_eq!(up_to(approach, &observation, null_mut()), null_pointer);
        assert_eq!(up_to(approach, null(), &mut decision), null_pointer);
        assert_eq!(decision.cause, cede_cause::Fallback);
        assert_eq!(cede_approach_plan(approach, null_mut()), null_pointer);
        assert_eq!(cede_approach_contract(approach, null_mut()), null_pointer);
        assert_eq!(
            cede_approach_goes_before(approach, 1, null_mut()),
            null_pointer
        );
        assert_eq!(
            cede_approach_margin(approach, &observation, 0.0, 0.0, null_mut(), null_mut()),
            null_pointer
        );
        assert_eq!(
            cede_approach_profile(approach, 0.0, 0.0, null_mut()),
            null_pointer
        );
        assert_eq!(cede_approach_set_policy(approach, null()), null_pointer);
        assert_eq!(
            cede_approach_set_contract(approach, null(), null_mut()),
            null_pointer
        );
        assert_eq!(cede_approach_set_traffic(approach, null()), null_pointer);
        assert_eq!(cede_approach_forget(null_mut(), 1), null_pointer);
        assert_eq!(
            cede_approach_enter(null_mut(), &world.drive, &world.junction, 0, null_mut()),
            null_pointer
        );
        assert_eq!(
            cede_approach_enter(approach, null(), &world.junction, 0, null_mut()),
            null_pointer
        );
        assert_eq!(
            cede_approach_enter(approach, &world.drive, null(), 0, null_mut()),
            null_pointer
        );

        assert_eq!(cede_contract_worst_case(null_mut()), null_pointer);
        assert_eq!(cede_contract_all_way_stop(null_mut()), null_pointer);
        assert_eq!(cede_contract_check(null(), null_mut()), null_pointer);
        assert_eq!(
            cede_drive_init(null_mut(), &world.policy, &contract, 0, null_mut()),
            null_pointer
        );
        assert_eq!(
            cede_drive_init(&mut world.drive, null(), &contract, 0, null_mut()),
            null_pointer
        );
        assert_eq!(
            cede_drive_init(&mut world.drive, &world.policy, null(), 0, null_mut()),
            null_pointer
        );
        assert_eq!(cede_policy_init_embedded(null_mut()), null_pointer);
        assert_eq!(cede_policy_init(&mut world.policy, null(), 8), null_pointer);
        assert_eq!(cede_policy_check(null()), null_pointer);
        assert_eq!(
            cede_policy_describe(&world.policy, null_mut()),
            null_pointer
        );

        let junction = &raw mut world.junction;
        let mut path = 0;
        assert_eq!(cede_junction_init(null_mut()), null_pointer);
        assert_eq!(cede_junction_init(junction), OK);
        assert_eq!(
            cede_junction_add_path(junction, null(), 2, 0, &common::CAR, &mut path, null_mut()),
            null_pointer
        );
        assert_eq!(
            cede_junction_add_path(junction, null(), 0, 0, &common::CAR, null_mut(), null_mut()),
            null_pointer
        );
        let points = common::points(&common::MINE);
        let (start, count) = (points.as_ptr(), points.len() as u32);
        assert_eq!(
            cede_junction_add_path(junction, start, count, 0, null(), &mut path, null_mut()),
            null_pointer
        );
        assert_eq!(
            cede_junction_add_path(
                null_mut(),
                start,
                count,
                0,
                &common::CAR,
                &mut path,
                null_mut()
            ),
            null_pointer
        );
        assert_eq!(
            cede_junction_set_priority(null_mut(), 0, 1, 0, null_mut()),
            null_pointer
        );
        assert_eq!(
            cede_junction_set_control(null_mut(), 0, 0, null_mut()),
            null_pointer
        );
        assert_eq!(cede_junction_build(null_mut(), null_mut()), null_pointer);
        assert_eq!(cede_junction_check(null()), null_pointer);
        assert_eq!(cede_junction_count(null(), null_mut()), null_pointer);
        let mut answer = 0;
        assert_eq!(
            cede_known_answer(null(), junction, approach, &mut answer),
            null_pointer
        );
        assert_eq!(
            cede_known_answer(&world.policy, null_mut(), approach, &mut answer),
            null_pointer
        );
        assert_eq!(
            cede_known_answer(&world.policy, junction, null_mut(), &mut answer),
            null_pointer
        );
        assert_eq!(
            cede_known_answer(&world.policy, junction, approach, null_mut()),
            null_pointer
        );
    }
}

#[test]
fn what_is_refused_is_named() {
    let mut world = World::empty();
    let mut contract = worst_case();
    contract.ego_braking = 9.0;
    let mut detail: cede_detail = of(&[0; 64]);
    // SAFETY: as the header says.
    unsafe {
        let status = cede_contract_check(&contract, &mut detail);
        assert_eq!(status, cede_status::ContractOutOfRange);
        assert_eq!(detail.contract_field, cede_contract_field::EgoBraking);
        assert_eq!((detail.value, detail.low, detail.high), (9.0, 0.0, 8.0));
        assert_eq!((detail.excludes_low, detail.excludes_high), (1, 0));

        let (left, _) = world.junction();
        let line = cede_junction_set_line(&mut world.junction, left, 1.0, null_mut());
        assert_eq!(line, cede_status::JunctionBuilt);
        let control = cede_junction_set_control(&mut world.junction, left, 1, null_mut());
        assert_eq!(control, cede_status::JunctionBuilt);
        let odd = cede_junction_set_control(&mut world.junction, left, 5, &mut detail);
        assert_eq!(
            (odd, detail.status),
            (cede_status::UnknownChoice, cede_status::UnknownChoice)
        );
        assert_eq!(world.drive(&worst_case()), OK);
        assert_eq!(world.enter(9), cede_status::EnterPath);

        let three = [track(), track(), track()];
        assert_eq!(world.enter(left), OK);
        let mut observation = seen(&three);
        observation.track_count = u32::MAX;
        let (status, _) = world.decide(0, &observation);
        assert_eq!(status, cede_status::TooManyTracks);
        let mut odd = [track()];
        odd[0].candidate_count = 5;
        assert_eq!(world.decide(1, &seen(&odd)).0, cede_status::CandidateCount);
        odd[0].candidate_count = 1;
        odd[0].vehicle_class = 7;
        assert_eq!(world.decide(2, &seen(&odd)).0, cede_status::UnknownChoice);

        assert_eq!(cede_junction_init(&mut world.junction), OK);
        assert_eq!(
            cede_junction_build(&mut world.junction, &mut detail),
            cede_status::JunctionNoPaths
        );
        let loose = cede_junction_set_line(&mut world.junction, 3, 0.0, &mut detail);
        assert_eq!((loose, detail.path), (cede_status::JunctionUnknownPath, 3));
        world.path(&common::points(&common::MINE));
        let long = cede_junction_set_line(&mut world.junction, 0, 1000.0, &mut detail);
        assert_eq!((long, detail.value), (cede_status::JunctionLine, 1000.0));
        assert!(detail.high > 80.0 && detail.high < 100.0);
        let itself = cede_junction_set_priority(&mut world.junction, 0, 0, 2, &mut detail);
        assert_eq!((itself, detail.path), (cede_status::JunctionRightOfWay, 0));
        let odd = cede_junction_set_priority(&mut world.junction, 0, 0, 3, &mut detail);
        assert_eq!(odd, cede_status::UnknownChoice);
        assert_eq!(world.enter(0), cede_status::JunctionNotBuilt);
    }
}

#[test]
fn what_was_set_is_what_the_junction_says() {
    use cede_control::{AllWayStop, Free, Stop, Unknown, Yield};
    use cede_priority::{FirstCome, Signed, Unsigned};
    let mut world = World::empty();
    let junction = &raw mut world.junction;
    for control in [Unknown, Free, Yield, Stop, AllWayStop] {
        for priority in [FirstCome, Unsigned, Signed] {
            // SAFETY: as the header says.
            unsafe {
                assert_eq!(cede_junction_init(junction), OK);
                let mine = world.path(&common::points(&common::MINE));
                let theirs = world.path(&common::points(&common::THEIRS));
                for set in [
                    cede_junction_set_control(junction, mine, control as u8, null_mut()),
                    cede_junction_set_priority(junction, theirs, mine, priority as u8, null_mut()),
                    cede_junction_set_line(junction, mine, 30.0, null_mut()),
                    cede_junction_build(junction, null_mut()),
                ] {
                    assert_eq!(set, OK);
                }
                let mut paths: [cede_path_info; 2] = std::mem::zeroed();
                assert_eq!(cede_junction_path(junction, mine, &mut paths[0]), OK);
                assert_eq!(cede_junction_path(junction, theirs, &mut paths[1]), OK);
                assert_eq!(paths.map(|path| path.control), [control, Unknown]);
                assert_eq!(paths.map(|path| path.waits_at_line), [1, 0]);
                assert_eq!(paths[0].line, 30.0);
                let mut conflict: cede_conflict = std::mem::zeroed();
                assert_eq!(
                    cede_junction_conflict(junction, mine, theirs, &mut conflict),
                    OK
                );
                assert_eq!(
                    (conflict.right, conflict.priority),
                    (cede_right::Other, priority)
                );
            }
        }
    }
}

#[test]
fn no_more_is_proposed_than_the_driver_wants() {
    let mut world = World::new(&worst_case());
    for (now, most, acceleration) in [
        (1_000_000, 0.25, 0.25),
        (1_100_000, -1.5, -1.5),
        (1_200_000, f32::NAN, -3.0),
    ] {
        let mut decision = no_decision();
        // SAFETY: as the header says.
        let status = unsafe {
            cede_approach_decide_up_to(&mut world.approach, now, most, &seen(&[]), &mut decision)
        };
        assert_eq!((status, decision.acceleration), (OK, acceleration));
    }
}

#[test]
fn each_contract_field_has_the_name_that_the_controller_gives_it() {
    let known = worst_case();
    type Spoil = fn(&mut cede_contract);
    let spoil: [(&str, Spoil); 18] = [
        ("period", |c| c.period = f32::NAN),
        ("latency", |c| c.latency = f32::NAN),
        ("jitter", |c| c.jitter = f32::NAN),
        ("position_error", |c| c.position_error = f32::NAN),
        ("speed_error", |c| c.speed_error = f32::NAN),
        ("slack", |c| c.slack = f32::NAN),
        ("ego.max_speed", |c| c.ego_max_speed = f32::NAN),
        ("ego.acceleration", |c| c.ego_acceleration = f32::NAN),
        ("ego.go", |c| c.ego_go = f32::NAN),
        ("ego.braking", |c| c.ego_braking = f32::NAN),
        ("other.max_speed", |c| c.other_max_speed = f32::NAN),
        ("other.acceleration", |c| c.other_acceleration = f32::NAN),
        ("other.braking", |c| c.other_braking = f32::NAN),
        ("follower.reaction", |c| c.follower_reaction = f32::NAN),
        ("follower.braking", |c| c.follower_braking = f32::NAN),
        ("precedence.distance", |c| c.precedence_distance = f32::NAN),
        ("precedence.braking", |c| c.precedence_braking = f32::NAN),
        ("precedence.patience", |c| c.precedence_patience = 3),
    ];
    for (name, spoil) in spoil {
        let mut contract = known;
        contract.has_precedence = 1;
        spoil(&mut contract);
        let mut detail: cede_detail = of(&[0; 64]);
        // SAFETY: as the header says; the text is one.
        let text = unsafe {
            cede_contract_check(&contract, &mut detail);
            std::ffi::CStr::from_ptr(cede_contract_field_text(detail.contract_field as u8))
        };
        assert_eq!(text.to_str().unwrap(), name);
    }
}
