//! What survives from one call to the next: plans, tracks that are missing or new, times that are wrong.

use super::without_room::numbered;
use super::*;
use crate::kinematics::{self, advance};

/// An ego that is committed to clear the crossing: it can no longer stop before it.
fn committed<R: Rules>(run: &mut Run<'_, R>) -> Plan {
    let decision = run.decide([50.0, 10.0], &[(1, [10.0, 5.0])], 3.0);
    assert_eq!(decision.cause, Cause::Policy);
    decision.plan.unwrap()
}

/// Where the committed ego is a period later, and the other.
const NEXT: State = [51.015, 10.3];
const OTHER: State = [10.5, 5.0];

#[test]
fn a_broken_contract_is_reported_and_the_plan_is_void() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    committed(&mut run);
    // The other jumps to its zone; the ego can neither stop nor clear.
    let decision = run.decide(NEXT, &[(1, [56.0, 5.0])], 3.0);
    assert_eq!(decision.breach, Some(Breach::Other(1)));
    assert_eq!(decision.cause, Cause::Fallback(Fault::NoPlan));
    assert_eq!((decision.acceleration, run.shield.plan()), (-3.0, None));
    // Recovery: as soon as a plan is safe again, everything is as it was.
    let decision = run.decide([52.0, 10.0], &[(1, [64.0, 5.0])], 1.0);
    assert_eq!(decision.cause, Cause::Policy);
    assert!(run.shield.plan().is_some());
}

#[test]
fn a_small_breach_is_reported_and_leaves_a_plan_that_still_holds() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    committed(&mut run);
    let decision = run.decide(NEXT, &[(1, [12.0, 5.0])], f32::NAN);
    assert_eq!(decision.breach, Some(Breach::Other(1)));
    assert!(decision.plan.is_some(), "{decision:?}");
}

#[test]
fn without_a_plan_nothing_else_is_the_cause() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    let decision = run.decide([50.0, 10.0], &[(1, [50.0, 5.0])], f32::NAN);
    assert_eq!(decision.cause, Cause::Fallback(Fault::NoPlan));
}

#[test]
fn a_bystander_that_comes_and_goes_changes_nothing() {
    let beside = route(&[(-60.0, 30.0), (60.0, 30.0)]);
    let site = site(&[east(), north(), beside]);
    let mut run = Run::new(&site, WORST);
    committed(&mut run);
    let mut alone = run.shield.copy();
    let now = Instant::from_millis(run.millis + 100);
    let tracks = [track(&site, 1, OTHER), track(&site, 2, [60.0, 5.0])];
    let seen = |tracks| Observation {
        ego: ego(&site, NEXT),
        tracks,
    };
    let with = run.shield.filter(now, &seen(&tracks), 0.0);
    let without = alone.filter(now, &seen(&tracks[..1]), 0.0);
    assert_eq!(with, without);
    assert_eq!(run.shield.tracks.iter().count(), 1);
}

#[test]
fn a_newcomer_voids_a_plan_only_if_its_own_zone_is_not_free() {
    let second = route(&[(12.0, -60.0), (12.0, 60.0)]);
    let site = site(&[east(), north(), second]);
    for (newcomer, kept) in [([0.0, 5.0], true), ([52.0, 8.0], false)] {
        let mut run = Run::new(&site, WORST);
        committed(&mut run);
        let decision = run.decide(NEXT, &[(1, OTHER), (2, newcomer)], 3.0);
        assert_eq!(decision.plan.is_some(), kept, "{decision:?}");
    }
}

/// Forgets whoever is not seen.
struct Amnesia;
impl Rules for Amnesia {
    fn coast(contract: &Contract, _: Bounds, _: f32) -> Bounds {
        Bounds::sensed(contract, 1e5, 0.0)
    }
}

#[test]
fn one_that_is_missing_is_still_somewhere() {
    fn margin<R: Rules>() -> f32 {
        let site = crossing();
        let mut run = Run::<R, 8>::with_rules(&site, WORST);
        run.decide([40.0, 5.0], &[(1, [40.0, 5.0])], -3.0);
        run.decide([40.5, 5.0], &[], 3.0).margin
    }
    assert!(margin::<Sound>() < 20.0);
    assert!(
        margin::<Amnesia>() > 1e5,
        "the rule is what makes the difference"
    );
}

/// Whether nobody was in the ego's way at the last decision.
fn free(run: &Run<'_>) -> bool {
    run.shield.last.margin > 1e5
}

#[test]
fn one_that_is_missing_ceases_to_matter_when_it_has_certainly_left() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    // Braking as hard as it can, it comes 14 m farther than its zone.
    run.decide([1.0, 0.0], &[(1, [62.0, 15.0])], 0.0);
    for _ in 0..3 {
        run.decide([1.0, 0.0], &[], 0.0);
    }
    assert!(free(&run), "it has left");
    run.decide([1.0, 0.0], &[(1, [20.0, 5.0])], 0.0);
    for _ in 0..1000 {
        run.decide([1.0, 0.0], &[], 0.0);
    }
    assert!(!free(&run), "it may have stopped");
    run.shield.forget(1);
    run.decide([1.0, 0.0], &[], 0.0);
    assert!(free(&run));
}

#[test]
fn the_order_of_tracks_does_not_matter() {
    let second = route(&[(12.0, -60.0), (12.0, 60.0)]);
    let site = site(&[east(), north(), second]);
    let mut runs = [false, true].map(|_| Run::new(&site, Contract::ALL_WAY_STOP));
    for step in 0..40_u8 {
        let t = 0.1 * f32::from(step);
        let own = [20.0 + 5.0 * t, 5.0];
        let mut others = [(1, [20.0 + 6.0 * t, 6.0]), (2, [10.0 + 7.0 * t, 7.0])];
        let one = runs[0].decide(own, &others, 1.0);
        others.reverse();
        let two = runs[1].decide(own, &others, 1.0);
        assert_eq!(one.acceleration, two.acceleration, "step {step}");
    }
}

#[test]
fn without_room_the_nearest_unwatched_zone_is_closed() {
    let third = route(&[(20.0, -60.0), (20.0, 60.0)]);
    let site = site(&[
        east(),
        north(),
        route(&[(10.0, -60.0), (10.0, 60.0)]),
        third,
    ]);
    let mut shield = Shield::<2>::enter(WORST, &site, EGO).unwrap();
    let tracks = [3, 1, 2].map(|number| track(&site, number, [1.0, 0.0]));
    let seen = Observation {
        ego: ego(&site, [40.0, 8.0]),
        tracks: &tracks,
    };
    let decision = shield.filter(Instant::from_millis(5), &seen, 3.0);
    assert_eq!(decision.unwatched, Some(3), "{decision:?}");
    let rest = zone(&site, 3).ego.from - 40.0;
    assert!(
        decision.margin < rest,
        "it has to stop before the third zone"
    );
    assert!(decision.to_string().ends_with("no room to watch other 3"));
}

/// Three paths that the ego crosses, the first two at nearly one place.
fn crowded() -> Site {
    let north = |x: f32| route(&[(x, -60.0), (x, 60.0)]);
    site(&[east(), north(0.0), north(-1.0), north(24.0)])
}

#[test]
fn one_without_room_leaves_a_plan_that_passes_it_in_time() {
    let site = crowded();
    // Its zone comes before where the plan rests, so that to close it bars the plan.
    for (newcomer, kept) in [([0.0, 5.0], true), ([52.0, 8.0], false)] {
        let mut run = Run::<Sound, 1>::with_rules(&site, WORST);
        let first = run.decide([50.0, 10.0], &[(1, [10.0, 5.0])], 3.0);
        assert_eq!(first.cause, Cause::Policy);
        let decision = run.decide(NEXT, &[(1, OTHER), (2, newcomer)], f32::NAN);
        assert_eq!(decision.unwatched, Some(2));
        assert_eq!(decision.plan.is_some(), kept, "{decision:?}");
        if kept {
            // It gets the room of the first one, which is known not to be there.
            run.shield.forget(1);
            let newcomer = [newcomer[0] + 0.5, 5.0];
            let decision = run.decide([52.05, 10.3], &[(2, newcomer)], f32::NAN);
            assert_eq!(decision.unwatched, None);
            assert!(decision.plan.is_some(), "{decision:?}");
        }
    }
}

/// One is watched, 16 are remembered with their bounds, and of one the number.
#[test]
fn zones_of_one_beyond_the_room_to_remember_stay_closed_while_it_is_missing() {
    let site = crowded();
    let mut run = Run::<Sound, 1>::with_rules(&site, WORST);
    let own = ego(&site, [20.0, 0.0]);
    let mut tracks: std::vec::Vec<_> = (10..27_u8)
        .map(|i| numbered(&site, i.into(), 3, [2.0 * f32::from(i - 10), 0.0]))
        .collect();
    let mut nearest = |seen: &[Track], forgotten: bool| {
        if forgotten {
            run.shield.forget(99);
        }
        run.observe(own, seen, 0.0).unwatched
    };
    let known = nearest(&tracks, false);
    tracks.push(numbered(&site, 99, 1, [1.0, 0.0]));
    assert_eq!(nearest(&tracks, false), Some(99));
    for _ in 0..3 {
        assert_eq!(nearest(&tracks[..17], false), Some(99));
    }
    assert_eq!(nearest(&tracks, false), Some(99));
    assert_eq!(nearest(&tracks[..17], true), known);
}

#[test]
fn zones_of_one_without_room_stay_closed_while_it_is_missing() {
    let site = crowded();
    let mut run = Run::<Sound, 1>::with_rules(&site, WORST);
    let first = (1, [1.0, 0.0]);
    let closed = |decision: Decision| decision.unwatched;
    assert_eq!(
        closed(run.decide([20.0, 0.0], &[first, (3, [1.0, 0.0])], 0.0)),
        Some(3)
    );
    assert_eq!(closed(run.decide([20.0, 0.0], &[first], 0.0)), Some(3));
    // Seen again, and past its zone.
    assert_eq!(
        closed(run.decide([20.0, 0.0], &[first, (3, [90.0, 0.0])], 0.0)),
        None
    );
    assert_eq!(
        closed(run.decide([20.0, 0.0], &[first, (2, [1.0, 0.0])], 0.0)),
        Some(2)
    );
    run.shield.forget(2);
    assert_eq!(closed(run.decide([20.0, 0.0], &[first], 0.0)), None);
}

#[test]
fn two_of_one_number_are_both_feared() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    let tracks = [[1.0, 0.0], [50.0, 5.0]].map(|state| track(&site, 1, state));
    let decision = run.observe(ego(&site, [40.0, 8.0]), &tracks, 3.0);
    assert!(
        matches!(decision.fault, Some(Fault::Input(_))),
        "{decision:?}"
    );
    assert_eq!(decision.unwatched, Some(1));
}

#[test]
fn all_candidates_count_until_one_is_left_out() {
    let away = route(&[(0.0, -60.0), (0.0, -25.0), (50.0, -15.0)]);
    let site = site(&[east(), north(), away]);
    let vehicle = on(&site, PathId::new(1), [30.0, 5.0]);
    let undecided = Track::on(5, PathId::new(2), vehicle)
        .or(PathId::new(1), 30.0)
        .unwrap();
    let decided = Track::on(5, PathId::new(2), vehicle);
    let mut run = Run::new(&site, WORST);
    let feared = run.observe(ego(&site, [40.0, 8.0]), &[undecided], 0.0);
    assert!(feared.margin < 1e5);
    let free = run.observe(ego(&site, [40.8, 8.0]), &[decided], 0.0);
    assert!(free.margin > 1e5, "{free:?}");
}

#[test]
fn a_repeated_call_gives_the_same_decision_and_an_earlier_one_says_so() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    committed(&mut run);
    let first = run.decide(NEXT, &[(1, OTHER)], 3.0);
    run.millis -= 100;
    assert_eq!(run.decide([0.0, 0.0], &[], -3.0), first);
    run.millis -= 200;
    let earlier = run.decide(NEXT, &[(1, OTHER)], 3.0);
    assert_eq!(earlier.fault, Some(Fault::Backwards));
    assert_eq!(earlier.acceleration, first.acceleration);
}

#[test]
fn a_late_call_is_reported_and_the_plan_kept_if_it_holds() {
    let site = crossing();
    for (own, other, kept) in [
        ([53.09, 10.9], [11.5, 5.0], true),
        ([53.09, 10.9], [56.0, 8.0], false),
    ] {
        let mut run = Run::new(&site, WORST);
        committed(&mut run);
        run.millis += 200;
        let decision = run.decide(own, &[(1, other)], f32::NAN);
        assert!(
            matches!(decision.fault, Some(Fault::OffPeriod { .. })),
            "{decision:?}"
        );
        assert_eq!(decision.plan.is_some(), kept, "{decision:?}");
    }
}

#[test]
fn readiness_says_what_stands_in_the_way_and_remembers_nothing() {
    let site = crossing();
    let run = Run::new(&site, WORST);
    let now = Instant::from_millis(1);
    let tracks = [track(&site, 1, [50.0, 5.0])];
    let mut seen = Observation {
        ego: ego(&site, [30.0, 5.0]),
        tracks: &tracks,
    };
    assert!(run.shield.ready(now, &seen).unwrap() >= 0.0);
    assert_eq!(run.shield.plan(), None);
    seen.ego = ego(&site, [50.0, 10.0]);
    let why = run.shield.ready(now, &seen).unwrap_err();
    assert!(matches!(why, NotReady::NoPlan { margin, .. } if margin < 0.0));
    assert!(
        why.to_string()
            .starts_with("no plan is safe: other 1 may arrive"),
        "{why}"
    );
}

#[test]
fn a_plan_survives_a_new_contract_if_it_holds_under_it() {
    let site = crossing();
    for (braking, kept) in [(3.0, true), (2.0, false)] {
        let mut run = Run::new(&site, WORST);
        // It can just stop.
        let first = run.decide([36.0, 10.0], &[(1, [58.0, 0.0])], -3.0);
        assert_eq!(first.plan, Some(Plan { go: 0 }));
        let contract = WORST
            .to_builder()
            .ego_braking(braking)
            .follower_braking(4.0);
        run.shield.set_contract(contract.build().unwrap()).unwrap();
        let decision = run.decide([36.99, 9.9], &[(1, [58.0, 0.0])], f32::NAN);
        assert_eq!(decision.plan.is_some(), kept, "{decision:?}");
    }
}

#[test]
fn a_lane_entered_by_somebody_elses_courtesy_is_judged_afresh_when_that_fails() {
    let site = site(&[east(), ramp()]);
    let lane = zone(&site, 1);
    let mut run = Run::new(&site, WORST);
    // Centimetres before the lane's entry and nearly at rest, the other comes fast: the ego stays out, or says so.
    let near = [lane.ego.from - 0.03, 0.5];
    let other = [lane.other.from - 8.0, 13.0];
    run.decide(near, &[(1, other)], -3.0);
    let inside = [lane.ego.from + 0.02, 0.5];
    let decision = run.decide(inside, &[(1, [other[0] + 1.3, 13.0])], 3.0);
    assert!(decision.margin < 0.0, "{decision:?}");
    assert_eq!(decision.cause, Cause::Fallback(Fault::NoPlan));
}

#[test]
fn one_that_has_left_its_zone_is_no_newcomer_however_its_sensors_err() {
    let site = crossing();
    let contract = WORST.to_builder().position_error(0.3).build().unwrap();
    let mut run = Run::new(&site, contract);
    let end = zone(&site, 1).other.to;
    // It stands just behind its zone, and is seen now behind and now in front of its end.
    for step in 0..40_u8 {
        let error = if step % 2 == 0 { 0.29 } else { -0.29 };
        let own = [30.0 + 0.8 * f32::from(step), 8.0];
        let decision = run.decide(own, &[(1, [end + 0.31 + error, 0.0])], 0.0);
        assert!(decision.plan.is_some(), "step {step}: {decision}");
        assert_eq!(decision.breach, None);
    }
}

#[test]
fn a_contract_that_fears_no_more_keeps_the_plan_that_is_being_carried_out() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    committed(&mut run);
    // What is seen is worse than what the plan was verified for, by less than a breach.
    let decision = run.decide(NEXT, &[(1, [10.51, 5.005])], 0.0);
    assert!(decision.plan.is_some());
    for contract in [
        WORST,
        WORST
            .to_builder()
            .other_max_speed(15.0)
            .follower_reaction(0.4)
            .build()
            .unwrap(),
    ] {
        run.shield.set_contract(contract).unwrap();
        assert!(!run.shield.replaced);
    }
    let bolder = WORST.to_builder().ego_braking(4.0).build().unwrap();
    run.shield.set_contract(bolder).unwrap();
    assert!(run.shield.replaced);
}

#[test]
fn a_leader_in_a_queue_behind_a_kink_is_no_follower() {
    // The kink makes the band of the lane wider than two vehicles are long.
    let bent = route(&[(0.0, 0.0), (30.0, 0.0), (30.0, 60.0)]);
    let site = site(&[bent.clone(), bent]);
    for gap in [0.3_f32, 1.0, 1.9] {
        let mut run = Run::new(&site, WORST);
        let decision = run.decide([60.0, 0.0], &[(1, [65.0 + gap, 0.0])], 3.0);
        assert!(decision.acceleration <= 0.0, "{gap} m: {decision}");
        assert!(decision.margin < 2.0, "{gap} m: {decision}");
    }
}

#[test]
fn those_who_queue_behind_the_ego_take_nobodys_place() {
    let site = site(&[east(), east(), north()]);
    let mut run = Run::new(&site, WORST);
    let behind = |i: u16| {
        let place = on(&site, PathId::new(1), [50.0 - 5.5 * f32::from(i), 0.0]);
        Track::on(10 + i, PathId::new(1), place)
    };
    let mut tracks: std::vec::Vec<_> = (1..=9).map(behind).collect();
    tracks.push(track(&site, 2, [30.0, 5.0]));
    for _ in 0..3 {
        let decision = run.observe(ego(&site, [50.0, 0.0]), &tracks, 0.0);
        assert_eq!(decision.unwatched, None);
        assert!(
            decision.plan.is_some() && decision.margin < 1e5,
            "{decision:?}"
        );
    }
}

#[test]
fn a_candidate_that_is_refused_leaves_nobody_out() {
    let away = route(&[(0.0, -60.0), (0.0, -25.0), (50.0, -15.0)]);
    let site = site(&[east(), north(), away]);
    let mut run = Run::new(&site, WORST);
    let crossing = on(&site, PathId::new(1), [40.0, 8.0]);
    run.observe(
        ego(&site, [30.0, 8.0]),
        &[Track::on(7, PathId::new(1), crossing)],
        -3.0,
    );
    // Reported on another path, with the pose of the old one.
    let moved = on(&site, PathId::new(1), [40.8, 8.0]);
    let decision = run.observe(
        ego(&site, [30.8, 7.9]),
        &[Track::on(7, PathId::new(2), moved)],
        0.0,
    );
    assert!(decision.fault.is_some());
    assert!(decision.margin < 1e5, "{decision:?}");
}

#[test]
fn commands_that_follow_each_other_within_the_latency_may_all_still_act() {
    let mut memory = Memory::new();
    for (millis, command) in [(0, 2.0), (100, 1.0), (110, -3.0), (120, -2.0)] {
        memory.command(&WORST, command, Instant::from_millis(millis));
    }
    let acts = |millis| memory.inherited(&WORST, Instant::from_millis(millis));
    assert_eq!(acts(130).bounds(), [-3.0, 2.0]);
    assert_eq!(acts(220).bounds(), [-2.0; 2]);
}

#[test]
fn without_a_plan_the_ego_brakes_with_all_there_is() {
    let site = crossing();
    let contract = WORST.to_builder().ego_emergency(7.0).build().unwrap();
    let mut run = Run::new(&site, contract);
    let hopeless = run.decide([50.0, 10.0], &[(1, [50.0, 5.0])], 3.0);
    assert_eq!(hopeless.acceleration, -7.0, "{hopeless:?}");
    assert!(run.shield.plan().is_none());
    // With a plan nothing is harder than what plans count on.
    let mut run = Run::new(&site, contract);
    let planned = run.decide([36.0, 10.0], &[(1, [58.0, 0.0])], -20.0);
    assert_eq!(planned.acceleration, -3.0, "{planned:?}");
}

/// An ego at rest in a zone that somebody comes to from far away, just before another zone: `near` is how far (m) the one
/// there is from it. Without a plan, what does it do?
fn stands_between(near: f32) -> Decision {
    let beyond = route(&[(5.0, -60.0), (5.0, 60.0)]);
    let site = site(&[east(), north(), beyond]);
    let mut run = Run::new(&site, WORST);
    let own = [zone(&site, 2).ego.from - 0.05, 0.0];
    let before = run.decide(
        own,
        &[(2, [zone(&site, 2).other.from - near - 0.8, 8.0])],
        -3.0,
    );
    assert!(before.plan.is_some());
    let others = [
        (1, [zone(&site, 1).other.from - 50.0, 8.0]),
        (2, [zone(&site, 2).other.from - near, 8.0]),
    ];
    run.decide(own, &others, -3.0)
}

#[test]
fn whoever_leaves_a_zone_without_a_plan_enters_no_other_before_somebody() {
    let near = stands_between(8.0);
    assert_eq!(near.cause, Cause::Fallback(Fault::NoPlan));
    assert!(near.acceleration < 0.0, "{near}");
    // It can still pass both.
    let far = stands_between(50.0);
    assert!(far.plan.is_some(), "{far}");
}

/// One that is missing accelerated by the former contract until the last call, and by the new one since.
#[test]
fn what_others_did_under_a_former_contract_counts_by_it() {
    let site = crossing();
    let breach = |speed: f32| {
        let mut run = Run::new(&site, WORST);
        run.decide([20.0, 5.0], &[(1, [10.0, 5.0])], 0.0);
        run.decide([20.5, 5.0], &[], 0.0);
        let gentle = WORST
            .to_builder()
            .other_acceleration(1.0)
            .ego_acceleration(1.0)
            .ego_go(1.0);
        run.shield.set_contract(gentle.build().unwrap()).unwrap();
        run.decide([21.0, 5.0], &[(1, [11.02, speed])], 0.0).breach
    };
    assert_eq!(breach(5.39), None);
    assert_eq!(breach(5.43), Some(Breach::Other(1)));
}

#[test]
fn a_time_is_news_if_it_is_later_than_the_last_one() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    let at = Instant::from_millis;
    assert!(run.shield.is_new(at(0)));
    run.decide([20.0, 5.0], &[], 0.0);
    assert_eq!(
        [7_099, 7_100, 7_101].map(|now| run.shield.is_new(at(now))),
        [false, false, true]
    );
}

/// Half of the jitter either way is twice the jitter from one call to the next, and a microsecond for rounding.
#[test]
fn what_is_left_of_the_jitter_is_counted_from_twice_of_it() {
    let site = crossing();
    let contract = WORST.to_builder().jitter(0.01).build().unwrap();
    let mut run = Run::new(&site, contract);
    assert_eq!(run.decide([20.0, 5.0], &[], 0.0).headroom.period, None);
    run.millis += 5;
    let room = run.decide([20.5, 5.0], &[], 0.0).headroom.period.unwrap();
    assert!((room.left - 0.015_001).abs() < 1e-6, "{room:?}");
    assert!((room.share - 0.75).abs() < 1e-3, "{room:?}");
}

/// How many egos, of those with a plan when the contract is replaced, end up in the zone of one that stands there.
fn overruns(replaced: bool) -> u32 {
    const DELAY: usize = 10;
    let before = WORST.to_builder().latency(1.0).build().unwrap();
    let weaker = before.to_builder().ego_acceleration(0.5).ego_go(0.5);
    let weaker = weaker.build().unwrap();
    let site = crossing();
    let stands = zone(&site, 1);
    let mut overruns = 0;
    for start in 0..150_u8 {
        let mut run = Run::new(&site, before);
        let mut own = [0.2 * f32::from(start), 5.0];
        let mut flying = std::collections::VecDeque::from([0.0; DELAY]);
        let mut planned = true;
        for call in 0..120 {
            if call == 12 && replaced {
                run.shield.set_contract(weaker).unwrap();
            }
            let decision = run.decide(own, &[(1, [stands.other.from + 1.0, 0.0])], 3.0);
            planned &= call > 12 || decision.plan.is_some();
            flying.push_back(decision.acceleration);
            let [s, v] = own;
            let next = advance(kinematics::State { s, v }, flying.pop_front().unwrap());
            own = [next.s, next.v];
        }
        let inside = own[0] > stands.ego.from && own[0] < stands.ego.to;
        overruns += u32::from(planned && inside);
    }
    overruns
}

#[test]
fn commands_in_flight_lead_to_what_the_former_contract_says() {
    assert_eq!([overruns(false), overruns(true)], [0, 0]);
}

/// The ego is committed by a plan that just clears its zone, and then is found where it can neither do so nor stop.
#[test]
fn a_plan_is_judged_anew_against_all_if_the_ego_is_not_where_its_commands_lead() {
    let site = crossing();
    for (own, kept) in [(NEXT, true), ([51.0, 6.8], false)] {
        let mut run = Run::new(&site, WORST);
        let near = zone(&site, 1).other.from - 10.2;
        let first = run.decide([50.0, 10.0], &[(1, [near, 5.0])], 3.0);
        assert_eq!(first.cause, Cause::Policy);
        let decision = run.decide(own, &[(1, [near + 0.5, 5.0])], f32::NAN);
        assert_eq!(decision.breach.is_none(), kept, "{decision:?}");
        assert_eq!(decision.plan.is_some(), kept, "{decision:?}");
    }
}

/// A metre beside its path, a period after it committed itself, or half a period later.
#[test]
fn without_eyes_a_plan_is_given_up_that_is_late_or_of_another_contract() {
    let site = crossing();
    let plan = |late: u64, contract: Contract| {
        let mut run = Run::new(&site, WORST);
        let plan = committed(&mut run);
        run.shield.set_contract(contract).unwrap();
        run.millis += late;
        let mut own = ego(&site, NEXT);
        own.pose.position.y += 1.0;
        let decision = run.observe(own, &[], 0.0);
        assert!(
            decision.headroom.offset.unwrap().left < -0.9,
            "{decision:?}"
        );
        assert_eq!(decision.margin, 0.0);
        let brakes = -contract.ego.emergency;
        let carries_on = if decision.plan.is_some() { 3.0 } else { brakes };
        assert_eq!(decision.acceleration, carries_on);
        assert!(decision.plan.is_none_or(|left| left == plan.tail()));
        decision.plan.is_some()
    };
    let bolder = WORST.to_builder().ego_emergency(3.5).build().unwrap();
    assert!(plan(0, WORST));
    assert!(!plan(50, WORST) && !plan(0, bolder));
}

#[test]
fn a_late_call_is_named_with_the_time_since_the_last_one() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    run.decide([20.0, 5.0], &[], 0.0);
    run.millis += 200;
    let Some(Fault::OffPeriod { elapsed, period }) = run.decide([21.0, 5.0], &[], 0.0).fault else {
        panic!("it is late");
    };
    assert!((elapsed - 0.3).abs() < 1e-6 && period == 0.1, "{elapsed} s");
}

#[test]
fn a_margin_needs_two_numbers() {
    let site = crossing();
    let run = Run::new(&site, WORST);
    let seen = Observation {
        ego: ego(&site, [20.0, 5.0]),
        tracks: &[],
    };
    let margin = |previous, acceleration| run.shield.margin(&seen, previous, acceleration).err();
    assert_eq!(margin(0.0, 0.0), None);
    for (previous, acceleration) in [(f32::NAN, 0.0), (0.0, f32::INFINITY)] {
        assert_eq!(margin(previous, acceleration), Some(Fault::Proposal));
    }
}

/// Its line is 6 m before the zone that somebody stands in; the ego rests 3 m beyond it.
#[test]
fn one_that_rests_beyond_its_line_may_go_on_to_the_zone() {
    let mut builder = Site::builder();
    builder.tolerance(0.0);
    for route in [east(), north()] {
        builder.path(&route, Class::Car, Footprint::PAPER).unwrap();
    }
    let from = zone(&crossing(), 1).ego.from;
    builder.line(EGO, from - 6.0).unwrap();
    let site = builder.build().unwrap();
    let mut run = Run::new(&site, WORST);
    let (own, stands) = ([from - 3.0, 0.0], (1, [60.0, 0.0]));
    let first = run.decide(own, &[stands], 0.0);
    assert_eq!(first.plan, Some(Plan { go: 0 }));
    let decision = run.decide(own, &[stands], 0.5);
    assert_eq!(
        (decision.cause, decision.acceleration),
        (Cause::Policy, 0.5)
    );
}

#[test]
fn of_two_who_appear_before_one_zone_the_first_is_watched() {
    let site = crowded();
    let mut run = Run::<Sound, 1>::with_rules(&site, WORST);
    let on_second = |number| {
        let vehicle = on(&site, PathId::new(3), [10.0 + f32::from(number), 0.0]);
        Track::on(number, PathId::new(3), vehicle)
    };
    let decision = run.observe(ego(&site, [20.0, 0.0]), &[on_second(5), on_second(6)], 0.0);
    assert_eq!(decision.unwatched, Some(6));
}

#[test]
fn one_that_is_missing_and_two_of_one_number_stay_known_while_others_are_seen() {
    let second = route(&[(12.0, -60.0), (12.0, 60.0)]);
    let site = site(&[east(), north(), second]);
    let known = |run: &Run<'_>| run.shield.tracks.iter().map(|it| it.path).collect();
    let both: std::vec::Vec<_> = [1, 2].map(PathId::new).into();
    let mut run = Run::new(&site, WORST);
    let (one, two) = ((1, [20.0, 5.0]), (2, [20.0, 5.0]));
    run.decide([20.0, 0.0], &[one, two], 0.0);
    run.decide([20.0, 0.0], &[(2, [20.5, 5.0])], 0.0);
    let paths: std::vec::Vec<_> = known(&run);
    assert_eq!(paths, both);
    let mut run = Run::new(&site, WORST);
    let same = [1, 2].map(|path| {
        Track::on(
            7,
            PathId::new(path),
            on(&site, PathId::new(path), [20.0, 0.0]),
        )
    });
    for _ in 0..2 {
        run.observe(ego(&site, [20.0, 0.0]), &same, 0.0);
        let paths: std::vec::Vec<_> = known(&run);
        assert_eq!(paths, both);
    }
}

#[test]
fn the_ego_goes_before_a_track_on_all_of_its_paths_or_not() {
    let second = route(&[(0.0, -60.0), (0.0, -25.0), (50.0, 35.0)]);
    let site = site(&[east(), north(), second]);
    let mut run = Run::new(&site, WORST);
    let vehicle = on(&site, PathId::new(1), [20.0, 0.0]);
    let either = Track::on(5, PathId::new(1), vehicle);
    let tracks = [
        either.or(PathId::new(2), 20.0).unwrap(),
        track(&site, 1, [10.0, 0.0]),
    ];
    run.observe(ego(&site, [20.0, 0.0]), &tracks, 0.0);
    let mut goes = |claims: [u8; 3]| {
        for (other, claims) in run.shield.tracks.iter_mut().zip(claims) {
            other.claims = claims;
        }
        [5, 1, 9].map(|number| run.shield.goes_before(number))
    };
    const ALL: u8 = precedence::ALL;
    assert_eq!(goes([ALL, ALL, 0]), [true, false, false]);
    assert_eq!(goes([0, 0, ALL]), [false, true, false]);
    for one in [[ALL, 0, 0], [0, ALL, 0], [1, ALL, 1]] {
        assert_eq!(goes(one), [false; 3]);
    }
}

/// An ego that came from afar to rest at its line, and another that is there on its road.
fn at_their_lines(site: &Site) -> (Run<'_>, State) {
    let mut run = Run::new(site, Contract::ALL_WAY_STOP);
    let line = site.path(EGO).unwrap().line();
    run.decide([line - 40.0, 9.0], &[], -3.0);
    for _ in 0..3 {
        run.decide([line, 0.0], &[(1, [line, 0.0])], -3.0);
    }
    (run, [line, 0.0])
}

/// Periods for which the ego, and the other, have perhaps and surely rested.
fn rested(run: &Run<'_>) -> [[u16; 2]; 2] {
    let other = run.shield.tracks.iter().next().unwrap();
    [run.shield.presence.rested(), other.pair.other.rested()]
}

#[test]
fn periods_without_a_call_are_perhaps_of_rest_up_to_sixteen() {
    let site = crossing();
    for (periods, perhaps) in [(1, 4), (2, 5), (16, 19), (17, u16::MAX), (40, u16::MAX)] {
        let (mut run, rests) = at_their_lines(&site);
        run.millis += 100 * (periods - 1);
        run.decide(rests, &[(1, rests)], -3.0);
        let surely = if periods == 1 { 4 } else { 0 };
        assert_eq!(
            rested(&run),
            [[perhaps, surely], [u16::MAX, surely]],
            "{periods}"
        );
    }
}

#[test]
fn by_a_new_rule_or_period_rest_is_counted_anew() {
    let site = crossing();
    let rested_then = |contract: Contract| {
        let (mut run, _) = at_their_lines(&site);
        run.shield.set_contract(contract).unwrap();
        rested(&run)
    };
    let now = Contract::ALL_WAY_STOP.to_builder();
    let rule = Precedence::new(12.0, 5, 3.0, 20);
    assert_eq!(
        rested_then(now.slack(0.02).build().unwrap()),
        [[3, 3], [u16::MAX, 3]]
    );
    for contract in [now.precedence(Some(rule)), now.period(0.11)] {
        assert_eq!(rested_then(contract.build().unwrap()), [[u16::MAX, 0]; 2]);
    }
}

#[test]
fn an_ego_that_came_second_holds_the_zone_in_which_it_stands() {
    let site = crossing();
    let mut run = Run::new(&site, Contract::ALL_WAY_STOP);
    let line = site.path(EGO).unwrap().line();
    let other = (1, [line, 0.0]);
    run.decide([line - 40.0, 9.0], &[(1, [line - 40.0, 9.0])], -3.0);
    for _ in 0..12 {
        run.decide([line - 40.0, 9.0], &[other], -3.0);
    }
    let stands = [zone(&site, 1).ego.from + 4.0, 0.0];
    let mut claims = || {
        run.decide(stands, &[other], -3.0);
        run.shield.tracks.iter().next().unwrap().claims
    };
    let last = (0..12).map(|_| claims()).last();
    assert_eq!(last, Some(0b1));
}
