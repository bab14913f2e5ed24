//! Storage that is zero, of another kind, moved, overwritten or stale has a status.

mod common;

use cede::*;
use common::{OK, World, seen, track, worst_case};
use std::ptr::null_mut;

/// The bits of a storage, one after the other: the status with each of them flipped. What is behind the object is free.
fn flipped<const N: usize>(storage: *mut [u64; N], mut ask: impl FnMut() -> cede_status) {
    let mut used = 0;
    for word in 0..N {
        let mut found = 0;
        for bit in 0..64 {
            let flip = |storage: *mut [u64; N]| {
                // SAFETY: a word of the storage, which nobody else uses now.
                unsafe { (*storage)[word] ^= 1 << bit };
            };
            flip(storage);
            let status = ask();
            flip(storage);
            match status {
                cede_status::Corrupt | cede_status::NotInitialised => found += 1,
                status => assert_eq!(status, OK),
            }
        }
        // The last word of an object may be half a word.
        assert!(
            found == 0 || found == 64 || found == 32,
            "word {word}: {found}"
        );
        assert!(found == 0 || used == word, "word {word}");
        used += usize::from(found > 0);
    }
    assert!(used > N / 2, "{used} of {N}");
}

#[test]
fn every_flipped_bit_of_an_object_is_found() {
    let mut world = World::new(&worst_case());
    let world = &raw mut *world;
    // SAFETY: as the header says.
    unsafe {
        let approach = &raw mut (*world).approach;
        let mut plan = std::mem::zeroed();
        flipped(&raw mut (*approach).storage, || {
            cede_approach_plan(approach, &mut plan)
        });
        let junction = &raw mut (*world).junction;
        flipped(&raw mut (*junction).storage, || {
            cede_junction_check(junction)
        });
        let policy = &raw mut (*world).policy;
        let mut info = std::mem::zeroed();
        flipped(&raw mut (*policy).storage, || {
            cede_policy_describe(policy, &mut info)
        });
    }
}

#[test]
fn a_corrupt_approach_brakes_and_stays_corrupt_until_it_is_made_anew() {
    let mut world = World::new(&worst_case());
    let tracks = [track()];
    assert_eq!(world.decide(1_000_000, &seen(&tracks)).0, OK);
    world.approach.storage[9] ^= 1 << 40;
    for now in [1_100_000, 1_200_000] {
        let (status, decision) = world.decide(now, &seen(&tracks));
        assert_eq!(status, cede_status::Corrupt);
        assert_eq!(decision.cause, cede_cause::None);
        assert_eq!(decision.acceleration, -CEDE_LAST_RESORT_BRAKING);
    }
    assert_eq!(world.enter(0), OK);
    assert_eq!(world.decide(1_300_000, &seen(&tracks)).0, OK);
}

#[test]
fn what_was_never_made_is_no_object() {
    let mut world = World::empty();
    let none = cede_status::NotInitialised;
    assert_eq!(world.decide(0, &seen(&[])).0, none);
    assert_eq!(world.enter(0), none);
    // SAFETY: as the header says; any bytes are storage.
    unsafe {
        assert_eq!(cede_policy_check(&world.policy), none);
        assert_eq!(cede_junction_check(&world.junction), none);
        assert_eq!(cede_junction_build(&mut world.junction, null_mut()), none);
        let contract = worst_case();
        assert_eq!(
            cede_drive_init(&mut world.drive, &world.policy, &contract, 0, null_mut()),
            none
        );
        world.approach.storage = [u64::MAX; CEDE_APPROACH_WORDS];
        assert_eq!(cede_approach_forget(&mut world.approach, 1), none);
        // An object of another kind.
        world.junction();
        let other = (&raw const world.junction).cast::<cede_policy>();
        assert_eq!(cede_policy_check(other), none);
    }
}

#[test]
fn an_object_that_is_moved_is_none() {
    let mut world = World::new(&worst_case());
    let mut elsewhere = World::empty();
    elsewhere.approach.storage = world.approach.storage;
    assert_eq!(
        elsewhere.decide(0, &seen(&[])).0,
        cede_status::NotInitialised
    );
    assert_eq!(world.decide(0, &seen(&[])).0, OK);
}

#[test]
fn an_approach_of_a_junction_that_is_made_anew_is_stale() {
    let mut world = World::new(&worst_case());
    let tracks = [track()];
    assert_eq!(world.decide(1_000_000, &seen(&tracks)).0, OK);
    // SAFETY: as the header says.
    assert_eq!(unsafe { cede_junction_init(&mut world.junction) }, OK);
    let (status, decision) = world.decide(1_100_000, &seen(&tracks));
    assert_eq!(status, cede_status::Stale);
    assert_eq!(decision.acceleration, -CEDE_LAST_RESORT_BRAKING);
    // Another junction; the same one, byte for byte, would be the one that it entered.
    world.path(&common::points(&common::THEIRS));
    // SAFETY: as the header says.
    let built = unsafe { cede_junction_build(&mut world.junction, null_mut()) };
    assert_eq!(built, OK);
    let (status, _) = world.decide(1_200_000, &seen(&tracks));
    assert_eq!(status, cede_status::Stale);
}

#[test]
fn policy_and_contract_are_replaced_with_the_plan_kept() {
    let mut world = World::new(&worst_case());
    let tracks = [track()];
    assert_eq!(world.decide(1_000_000, &seen(&tracks)).0, OK);
    // SAFETY: as the header says.
    unsafe {
        let mut before: cede_plan = std::mem::zeroed();
        assert_eq!(cede_approach_plan(&world.approach, &mut before), OK);
        assert_eq!(before.exists, 1);
        assert_eq!(
            cede_approach_set_policy(&mut world.approach, &world.policy),
            OK
        );
        let mut contract = worst_case();
        contract.other_acceleration = 3.5;
        assert_eq!(
            cede_approach_set_contract(&mut world.approach, &contract, null_mut()),
            OK
        );
        contract.period = 0.0;
        let refused = cede_approach_set_contract(&mut world.approach, &contract, null_mut());
        assert_eq!(refused, cede_status::ContractOutOfRange);
        let mut after: cede_plan = std::mem::zeroed();
        assert_eq!(cede_approach_plan(&world.approach, &mut after), OK);
        assert_eq!(before, after);
        assert_eq!(cede_policy_check(&world.policy), OK);
        let mut info: cede_policy_info = std::mem::zeroed();
        assert_eq!(cede_policy_describe(&world.policy, &mut info), OK);
        assert_eq!((info.width, info.features, info.perspective), (48, 4, 1));
    }
}

#[test]
fn a_junction_tells_what_it_is() {
    let mut world = World::empty();
    let (left, oncoming) = world.junction();
    // SAFETY: as the header says.
    unsafe {
        let mut paths = 0;
        assert_eq!(cede_junction_count(&world.junction, &mut paths), OK);
        assert_eq!(paths, 2);
        let mut conflict: cede_conflict = std::mem::zeroed();
        assert_eq!(
            cede_junction_conflict(&world.junction, left, oncoming, &mut conflict),
            OK
        );
        assert_eq!(conflict.kind, cede_conflict_kind::Crossing);
        assert_eq!(conflict.right, cede_right::Other);
        assert!(conflict.zone_count >= 1);
        assert!(conflict.zones[0].ego_from < conflict.zones[0].ego_to);
        let mut info: cede_path_info = std::mem::zeroed();
        assert_eq!(cede_junction_path(&world.junction, oncoming, &mut info), OK);
        assert_eq!((info.length, info.vehicle_class), (80.0, CEDE_CLASS_CAR));
        assert!(info.line > 20.0 && info.line < 40.0);
        let mut pose = cede_pose::default();
        assert_eq!(
            cede_junction_pose(&world.junction, oncoming, 25.0, &mut pose),
            OK
        );
        let mut s = 0.0;
        assert_eq!(
            cede_junction_project(&world.junction, oncoming, &pose.position, &mut s),
            OK
        );
        assert_eq!(s, 25.0);
        assert_eq!(
            cede_junction_pose(&world.junction, 7, 25.0, &mut pose),
            cede_status::JunctionUnknownPath
        );
    }
}

/// Two who wait at an all-way stop: it is known who goes first.
#[test]
fn an_approach_tells_what_it_knows() {
    let mut world = World::new(&plain(&cede_controller::Contract::ALL_WAY_STOP));
    let tracks = [track()];
    assert_eq!(world.decide(1_000_000, &seen(&tracks)).0, OK);
    // SAFETY: as the header says.
    unsafe {
        let mut contract: cede_contract = std::mem::zeroed();
        assert_eq!(cede_approach_contract(&world.approach, &mut contract), OK);
        assert_eq!(contract, plain(&cede_controller::Contract::ALL_WAY_STOP));

        let mut first = 7;
        assert_eq!(
            cede_approach_goes_before(&world.approach, 17, &mut first),
            OK
        );
        assert_eq!(first, 0);
        assert_eq!(
            cede_approach_goes_before(&world.approach, 99, &mut first),
            OK
        );
        assert_eq!(first, 0, "nobody has this number");

        let margin = |seen: &cede_observation, acceleration| {
            let (mut margin, mut fault): (f32, cede_fault) = (f32::NAN, std::mem::zeroed());
            let status = cede_approach_margin(
                &world.approach,
                seen,
                0.0,
                acceleration,
                &mut margin,
                &mut fault,
            );
            (status, margin, fault.kind)
        };
        let (status, braking, _) = margin(&seen(&tracks), -3.0);
        assert_eq!(status, OK);
        assert!(braking >= 0.0, "{braking}");
        let (status, _, kind) = margin(&seen(&tracks), f32::NAN);
        assert_eq!(
            (status, kind),
            (cede_status::InputFault, cede_fault_kind::Proposal)
        );
        let mut blind = seen(&tracks);
        blind.ego.speed = f32::NAN;
        let (status, _, kind) = margin(&blind, 0.0);
        assert_eq!(
            (status, kind),
            (cede_status::InputFault, cede_fault_kind::Input)
        );
    }
}

/// The ego does as it is told; the other one stands far from the junction.
#[test]
fn the_ego_goes_before_one_that_has_not_arrived() {
    let mut world = World::new(&plain(&cede_controller::Contract::ALL_WAY_STOP));
    let mut far = track();
    (far.speed, far.candidates[0].s, far.pose.position.x) = (0.0, 1.0, 39.0);
    let mut seen = seen(std::slice::from_ref(&far));
    let mut told = Vec::new();
    for step in 0..60 {
        // SAFETY: as the header says.
        unsafe {
            let ego = &mut seen.ego;
            assert_eq!(
                cede_junction_pose(&world.junction, 0, ego.s, &mut ego.pose),
                OK
            );
            let (status, decision) = world.decide(1_000_000 + 100_000 * step, &seen);
            assert_eq!(status, OK);
            let mut first = 7;
            let status = cede_approach_goes_before(&world.approach, 17, &mut first);
            assert_eq!(status, OK);
            told.push(first);
            let speed = (seen.ego.speed + 0.1 * decision.acceleration).max(0.0);
            seen.ego.s += 0.05 * (seen.ego.speed + speed);
            seen.ego.speed = speed;
        }
    }
    assert_eq!(told[0], 0);
    assert!(told.contains(&1), "{told:?}");
}

#[test]
fn a_profile_is_that_of_the_limits() {
    let mut world = World::empty();
    // SAFETY: as the header says.
    unsafe {
        assert_eq!(cede_junction_init(&mut world.junction), OK);
        let left = world.path(&common::points(&common::MINE));
        let limit = cede_junction_add_speed_limit(&mut world.junction, left, 10.0, 5.0, null_mut());
        assert_eq!(limit, OK);
        assert_eq!(cede_junction_build(&mut world.junction, null_mut()), OK);
        assert_eq!(world.drive(&worst_case()), OK);
        assert_eq!(world.enter(left), OK);
        let profile = |s, speed| {
            let mut profile: cede_profile = std::mem::zeroed();
            let status = cede_approach_profile(&world.approach, s, speed, &mut profile);
            assert_eq!(status, OK);
            profile
        };
        assert_eq!(profile(2.0, 1.0).speed, f32::INFINITY);
        assert_eq!(profile(15.0, 5.0).speed, 5.0);
        assert!(profile(15.0, 6.0).acceleration < 0.0);
        assert!(profile(15.0, 2.0).acceleration > 0.0);
    }
}
