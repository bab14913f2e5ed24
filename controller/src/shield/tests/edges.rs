//! Corners of the memory: vehicles without room, numbers that are used again, refused states, the end of time.

use super::without_room::{crowded, drive, numbered};
use super::*;

/// The next states of an ego that is committed to the crossing, and commands 3 m/s².
const FIRST: State = [50.0, 10.0];
const NEXT: State = [51.015, 10.3];
const THEN: State = [52.06, 10.6];

#[test]
fn a_number_that_is_used_again_is_there_once() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    // In its zone, then past it for good.
    run.decide([49.0, 10.0], &[(1, [63.0, 15.0])], -3.0);
    let first = run.decide(FIRST, &[(1, [64.5, 15.0])], 3.0);
    assert_eq!(first.cause, Cause::Policy);
    // Another vehicle, far away.
    let decision = run.decide(NEXT, &[(1, [1.0, 5.0])], f32::NAN);
    assert_eq!((decision.fault, decision.unwatched), (None, None));
    assert!(decision.plan.is_some(), "{decision:?}");
}

#[test]
fn one_that_takes_the_room_of_another_newcomer_is_no_longer_unwatched() {
    let site = crowded();
    let mut run = Run::<Sound, 1>::with_rules(&site, WORST);
    let own = ego(&site, [20.0, 0.0]);
    let x = |s| numbered(&site, 1, 1, [s, 0.0]);
    let old = |s| numbered(&site, 3, 3, [s, 10.0]);
    let new = numbered(&site, 9, 3, [1.0, 0.0]);
    run.observe(own, &[old(63.0)], 0.0);
    let decision = run.observe(own, &[old(64.0), x(1.0)], 0.0);
    // The old one has left: its room is X's.
    assert_eq!(decision.unwatched, None);
    let mut run = Run::<Sound, 1>::with_rules(&site, WORST);
    run.observe(own, &[old(62.0)], 0.0);
    assert_eq!(
        run.observe(own, &[old(63.0), x(1.0)], 0.0).unwatched,
        Some(1)
    );
    // The old one leaves; the new one comes first, and X, whose zone comes sooner, gets its place.
    let decision = run.observe(own, &[old(64.0), new, x(1.0)], 0.0);
    assert_eq!(decision.unwatched, Some(9));
    // X has left: nothing of it stays.
    let decision = run.observe(own, &[new, x(2.0)], 0.0);
    assert_eq!(decision.unwatched, Some(9));
}

#[test]
fn a_refused_state_of_one_without_room_voids_nothing() {
    let site = crowded();
    fn kept<const N: usize>(site: &Site) -> bool {
        let mut run = Run::<Sound, N>::with_rules(site, WORST);
        run.decide(FIRST, &[(1, [10.0, 5.0])], 3.0);
        let decision = run.decide(NEXT, &[(1, [10.5, 5.0]), (2, [0.0, 5.0])], f32::NAN);
        assert!(decision.plan.is_some());
        let decision = run.decide(THEN, &[(1, [11.0, 5.0]), (2, [0.5, f32::NAN])], f32::NAN);
        assert!(decision.fault.is_some());
        decision.plan.is_some()
    }
    assert!(kept::<8>(&site));
    assert!(kept::<1>(&site));
}

#[test]
fn one_without_room_that_has_just_left_closes_nothing_when_it_goes() {
    let site = crowded();
    let contract = WORST.to_builder().position_error(0.5).build().unwrap();
    let mut run = Run::<Sound, 1>::with_rules(&site, contract);
    let first = (1, [1.0, 0.0]);
    let own = [20.0, 0.0];
    let end = zone(&site, 3).other.to;
    assert_eq!(
        run.decide(own, &[first, (3, [end - 0.4, 10.0])], 0.0)
            .unwatched,
        Some(3)
    );
    // It is past its zone, and may seem not to be in the next observation.
    assert_eq!(
        run.decide(own, &[first, (3, [end + 0.6, 10.0])], 0.0)
            .unwatched,
        None
    );
    // It is out of sight.
    assert_eq!(run.decide(own, &[first], 0.0).unwatched, None);
}

#[test]
fn one_without_room_was_not_behind_the_ego_when_it_was_first_seen() {
    let far = route(&[(40.0, -60.0), (40.0, 60.0)]);
    let site = site(&[east(), far, ramp()]);
    let lane = zone(&site, 2);
    assert!(lane.is_lane());
    fn planned<const N: usize>(site: &Site, from: f32, t: f32) -> [bool; 3] {
        let mut run = Run::<Sound, N>::with_rules(site, WORST);
        let far = (1, [1.0, 0.0]);
        let a = run.decide([from - 0.8, 5.0], &[far], -3.0);
        let b = run.decide([from - 0.315, 4.7], &[far, (2, [t, 12.0])], -3.0);
        let c = run.decide([from + 0.14, 4.4], &[far, (2, [t + 1.2, 12.0])], -3.0);
        assert_eq!(c.breach, None);
        [a, b, c].map(|it| it.plan.is_some())
    }
    // The one behind is fast, and 3 m from the ego's bumper when that slides into the lane.
    let t = lane.ego.from - lane.lead.to - 3.0;
    assert_eq!(planned::<8>(&site, lane.ego.from, t), [true, false, false]);
    assert_eq!(planned::<1>(&site, lane.ego.from, t), [true, false, false]);
}

#[test]
fn one_without_room_that_breaks_the_contract_is_judged_afresh() {
    let site = crowded();
    fn next<const N: usize>(site: &Site) -> (Option<Breach>, bool) {
        let mut run = Run::<Sound, N>::with_rules(site, WORST);
        run.decide(FIRST, &[(1, [10.0, 5.0])], 3.0);
        let decision = run.decide(NEXT, &[(1, [10.5, 5.0]), (2, [0.0, 5.0])], f32::NAN);
        assert!(decision.plan.is_some());
        let decision = run.decide(THEN, &[(1, [11.0, 5.0]), (2, [54.0, 8.0])], f32::NAN);
        (decision.breach, decision.plan.is_some())
    }
    assert_eq!(next::<8>(&site), (Some(Breach::Other(2)), false));
    assert_eq!(next::<1>(&site), (Some(Breach::Other(2)), false));
}

#[test]
fn a_number_of_one_without_room_that_is_used_again_is_a_newcomers() {
    let site = crowded();
    let contract = WORST.to_builder().position_error(0.3).build().unwrap();
    fn kept<const N: usize>(site: &Site, contract: Contract) -> bool {
        let end = zone(site, 2).other.to;
        let mut run = Run::<Sound, N>::with_rules(site, contract);
        // Number 2 has left, by less than sensors err in two observations.
        let decision = run.decide(FIRST, &[(1, [5.0, 1.0]), (2, [end + 0.5, 0.0])], 3.0);
        assert_eq!(decision.cause, Cause::Policy);
        // Number 2 is another one now, at its zone.
        let decision = run.decide(NEXT, &[(1, [5.1, 1.0]), (2, [54.0, 8.0])], f32::NAN);
        // Nobody is said to have jumped.
        assert_eq!(decision.breach, None);
        decision.plan.is_some()
    }
    assert!(!kept::<8>(&site, contract));
    assert!(!kept::<1>(&site, contract));
}

#[test]
fn two_of_one_number_without_room_are_both_feared() {
    let site = crowded();
    let all = |order: [State; 2]| {
        let mut run = Run::<Sound, 1>::with_rules(&site, WORST);
        run.decide(FIRST, &[(1, [10.0, 5.0])], 3.0);
        let [a, b] = order.map(|state| (2, state));
        run.decide(NEXT, &[(1, [10.5, 5.0]), a, b], f32::NAN)
    };
    let (far, near, past) = ([0.0, 5.0], [54.0, 8.0], [90.0, 5.0]);
    for order in [[near, past], [past, near], [near, far], [far, near]] {
        let decision = all(order);
        assert_eq!(decision.unwatched, Some(2), "{order:?}");
        assert!(decision.plan.is_none(), "{order:?}");
    }
}

#[test]
fn the_end_of_time_is_a_time() {
    let site = crossing();
    let mut shield = Shield::<8>::enter(WORST, &site, EGO).unwrap();
    let seen = Observation {
        ego: ego(&site, [20.0, 0.0]),
        tracks: &[],
    };
    shield.filter(Instant::from_micros(0), &seen, 0.0);
    shield.filter(Instant::from_micros(u64::MAX), &seen, 0.0);
}

#[test]
fn one_that_has_left_and_goes_beyond_its_path_voids_nothing() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    let decision = run.decide(FIRST, &[(1, [119.5, 10.0])], 3.0);
    assert_eq!(decision.cause, Cause::Policy);
    let decision = run.decide(NEXT, &[(1, [120.5, 10.0])], f32::NAN);
    assert!(decision.fault.is_some());
    assert!(decision.plan.is_some(), "{decision:?}");
    let decision = run.decide(THEN, &[(1, [121.5, 10.0])], f32::NAN);
    assert!(decision.plan.is_some(), "{decision:?}");
}

#[test]
fn a_junction_may_have_256_paths() {
    let mut builder = Junction::<256, 512, 1>::builder();
    for i in 0..=255_u8 {
        let y = 10.0 * f32::from(i);
        let path = route(&[(0.0, y), (20.0, y)]);
        builder.path(&path, Class::Car, Footprint::PAPER).unwrap();
    }
    let junction = builder.build().unwrap();
    assert!(Shield::<8>::enter(WORST, &junction, EGO).is_ok());
}

/// A newcomer at rest 55 m before its zone appears while the ego, which is in it, carries out a plan that leaves it in a
/// second and rests behind a leader.
#[test]
#[ignore = "open: a plan is not credited with a zone that it leaves while it brakes"]
fn a_newcomer_that_cannot_reach_its_zone_in_time_voids_no_plan() {
    let site = site(&[
        east(),
        route(&[(0.0, -60.0), (0.0, 60.0)]),
        east(),
        route(&[(1.0, -60.0), (1.0, 60.0)]),
    ]);
    let mut voided = std::vec::Vec::new();
    for v in 4..9_u8 {
        let begin = || {
            let mut run = Run::new(&site, WORST);
            let own = [56.6, f32::from(v)];
            run.decide(own, &[(1, [20.0, 0.0])], 3.0);
            run.decide([own[0] + 0.1 * own[1], own[1]], &[(1, [20.0, 0.0])], 3.0);
            (run, [56.6 + 0.2 * f64::from(v) + 0.015, f64::from(v) + 0.3])
        };
        let old = |leader: f32| [(1, [20.0, 0.0]), (2, [leader, 0.0])];
        let narrow = |leader: &f32| {
            let (mut run, own) = begin();
            run.decide(own.map(|x| x as f32), &old(*leader), f32::NAN)
                .plan
                .is_some()
        };
        let Some(leader) = (6000..11900_u16).map(|i| f32::from(i) * 0.01).find(narrow) else {
            continue;
        };
        let (mut run, mut own) = begin();
        let mut effective = 3.0_f32;
        let mut seen = ego(&site, own.map(|x| x as f32));
        for frame in 0..25 {
            let mut copies = [0, 1].map(|_| Run {
                site: &site,
                shield: run.shield.copy(),
                millis: run.millis,
            });
            let place = own.map(|x| x as f32);
            let alone = copies[0].decide(place, &old(leader), f32::NAN);
            let with = [old(leader)[0], old(leader)[1], (3, [1.0, 0.0])];
            let with = copies[1].decide(place, &with, f32::NAN);
            if with.plan.is_none() && alone.plan.is_some() {
                voided.push((v, frame, place, alone.plan, with.breach));
            }
            // Its own state is refused from now on: it carries out the plan.
            let given = run.observe(seen, &[], f32::NAN).acceleration;
            seen.s = f32::NAN;
            own = drive(own, effective.into(), 0.1, 100.0);
            effective = given;
        }
    }
    assert!(voided.is_empty(), "{voided:?}");
}

/// Where the ego, at rest, has to stop for number 9, of whom these tracks are seen, one after the other, beside another who
/// is known before.
fn stops_for<const N: usize>(seen: &[&[Track]]) -> f32 {
    let site = crowded();
    let mut run = Run::<Sound, N>::with_rules(&site, WORST);
    let mut margin = |tracks: &[Track]| {
        let first = numbered(&site, 1, 3, [1.0, 0.0]);
        let all: std::vec::Vec<_> = core::iter::once(&first).chain(tracks).copied().collect();
        run.observe(ego(&site, [20.0, 0.0]), &all, 0.0).margin
    };
    margin(&[]);
    seen.iter().map(|tracks| margin(tracks)).last().unwrap()
}

#[test]
fn a_number_is_left_on_a_path_by_a_track_that_is_placed_and_names_another() {
    fn check<const N: usize>() {
        let site = crowded();
        let [near, far] = [2, 1].map(|path| numbered(&site, 9, path, [1.0, 0.0]));
        let alone = stops_for::<N>(&[&[near]]);
        assert!(stops_for::<N>(&[&[far]]) > alone + 0.5);
        assert!(stops_for::<N>(&[&[near], &[far]]) > alone + 0.5);
        let stays = |seen: &[&[Track]]| (stops_for::<N>(seen) - alone).abs() < 0.1;
        // Two of one number are both there; and one may be where its state is refused, or where nothing is seen of it.
        for both in [[near, far], [far, near]] {
            assert!(stays(&[&both]));
            assert!(stays(&[&[near], &both]));
        }
        let either = far.or(PathId::new(2), 1.0).unwrap();
        assert!(stays(&[&[near], &[either]]) && stays(&[&[near], &[]]));
    }
    check::<8>();
    check::<1>();
}
