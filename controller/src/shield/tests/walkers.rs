//! Pedestrians, who may turn back.

use super::headroom::go;
use super::*;
use core::ops::Range;
use std::vec::Vec;

const PACE: f32 = 2.0;

/// A square: it may point anywhere.
const BODY: Footprint = Footprint {
    length: 0.6,
    width: 0.6,
};

/// The ego's road, and two crossings of 14 m over it.
fn crossings() -> Site {
    let mut builder = Site::builder();
    builder.tolerance(0.0);
    builder.path(&east(), Class::Car, Footprint::PAPER).unwrap();
    for x in [0.0, 18.0] {
        let over = route(&[(x, -7.0), (x, 7.0)]);
        let path = builder.path(&over, Class::Pedestrian, BODY).unwrap();
        builder.pace(path, PACE).unwrap();
    }
    builder.build().unwrap()
}

fn on_foot(site: &Site, number: u8, [s, speed]: State) -> Track {
    track(site, number, [s, speed]).class(Class::Pedestrian)
}

#[derive(Clone, Debug)]
struct Case {
    own: State,
    proposals: [f32; 8],
    late: f32,
    /// Where the two are at first, and their velocities in units of their pace, one after the other.
    starts: [f32; 2],
    walks: [[f32; 12]; 2],
    /// Errors, and whether a pedestrian is missing.
    errors: [State; 8],
    missing: [[bool; 9]; 2],
}

fn cases() -> impl Strategy<Value = Case> {
    let pedal = || prop_oneof![Just(-3.0_f32), Just(3.0), -3.0_f32..3.0];
    let walk = || prop_oneof![Just(-1.0_f32), Just(0.0), Just(1.0), -1.0_f32..1.0];
    let uniform2 = prop::array::uniform2::<prop::strategy::BoxedStrategy<_>>;
    let own = (
        [0.0_f32..45.0, 0.0_f32..12.0],
        prop::array::uniform8(pedal()),
        0.0_f32..=1.0,
        prop::array::uniform8(prop::array::uniform2(-1.0_f32..=1.0)),
    );
    let world = (
        prop::array::uniform2(0.0_f32..14.0),
        uniform2(prop::array::uniform12(walk()).boxed()),
        prop::array::uniform2(prop::array::uniform9(prop::bool::weighted(0.3))),
    );
    (own, world).prop_map(
        |((own, proposals, late, errors), (starts, walks, missing))| Case {
            own,
            proposals,
            late,
            starts,
            walks,
            errors,
            missing,
        },
    )
}

/// Overlaps, steps without a plan after the first one, and breaches.
fn drive(case: &Case) -> [u32; 3] {
    let site = crossings();
    let contract = WORST.to_builder().position_error(0.2).speed_error(0.2);
    let mut run = Run::new(&site, contract.build().unwrap());
    let (mut own, mut before, mut guarded) = (case.own.map(f64::from), 0.0, false);
    let mut walkers = case.starts.map(f64::from);
    let mut wrong = [0; 3];
    for step in 0..160 {
        let [e, f] = case.errors[step % 8].map(|it| 0.2 * it);
        let velocity = |i: usize| case.walks[i][(step / 4) % 12] * PACE;
        let tracks: Vec<_> = (0..2)
            .filter(|&i| step == 0 || !case.missing[i][step % 9])
            .map(|i| {
                let seen = [walkers[i] as f32 + e, velocity(i).abs() + f];
                on_foot(&site, i as u8 + 1, seen)
            })
            .collect();
        let seen_own = ego(&site, [own[0] as f32 + e, own[1] as f32 + f]);
        let decision = run.observe(seen_own, &tracks, case.proposals[(step / 5) % 8]);
        guarded |= decision.plan.is_some();
        wrong[1] += u32::from(guarded && decision.plan.is_none());
        wrong[2] += u32::from(decision.breach.is_some());
        let (command, late) = (f64::from(decision.acceleration), 0.1 * f64::from(case.late));
        own = go(go(own, before, late), command, 0.1 - late);
        before = command;
        for (i, s) in walkers.iter_mut().enumerate() {
            *s = (*s + 0.1 * f64::from(velocity(i))).clamp(0.0, 14.0);
            let zone = zone(&site, i as u8 + 1);
            let inside =
                |span: Span, s: f64| (f64::from(span.from)..f64::from(span.to)).contains(&s);
            let overlap = inside(zone.ego, own[0]) && inside(zone.other, *s);
            wrong[0] += u32::from(guarded && overlap);
        }
        if own[0] > 100.0 {
            break;
        }
    }
    wrong
}

proptest! {
    #[test]
    fn whoever_turns_back_was_expected_to(case in cases()) {
        prop_assert_eq!(drive(&case), [0; 3]);
    }
}

/// What is decided 3.7 m before the crossing, at 4 m/s, of a pedestrian at `s` (m).
fn before_the_crossing(s: f32) -> Decision {
    let site = crossings();
    let mut run = Run::new(&site, WORST);
    let own = [zone(&site, 1).ego.from - 3.7, 4.0];
    run.observe(ego(&site, own), &[on_foot(&site, 1, [s, 1.0])], 3.0)
}

#[test]
fn one_who_has_crossed_is_still_near() {
    // The road is 2.6 m wide for the two, from 5.7 to 8.3 m.
    let far = before_the_crossing(14.0);
    assert_eq!(far.cause, Cause::Policy, "{far}");
    for near in [3.0, 10.0] {
        let decision = before_the_crossing(near);
        let text = decision.to_string();
        assert!(
            text.starts_with("shielded: other 1 may arrive in 0.")
                || text.starts_with("shielded: other 1 may arrive in 1."),
            "{near} m: {text}"
        );
    }
    let inside = before_the_crossing(7.0);
    assert_eq!(inside.to_string(), "shielded: other 1 is in its zone");
}

#[test]
fn a_pedestrian_may_point_anywhere_and_runs_out_of_its_pace() {
    let site = crossings();
    let mut run = Run::new(&site, WORST);
    let own = ego(&site, [20.0, 0.0]);
    let mut back = on_foot(&site, 1, [3.0, 1.0]);
    back.pose.direction = unit(0.0, -1.0);
    assert_eq!(run.observe(own, &[back], 0.0).fault, None);
    let jumped = on_foot(&site, 1, [4.0, 1.0]);
    assert_eq!(
        run.observe(own, &[jumped], 0.0).breach,
        Some(Breach::Other(1))
    );
}

#[test]
fn crossings_without_room_to_watch_are_closed_and_nobody_enters_by_one() {
    let site = crossings();
    let mut run = Run::new(&site, WORST);
    let tracks = at_the_end(&site, 2, 0..6);
    let decision = run.observe(ego(&site, [20.0, 5.0]), &tracks, 0.0);
    assert_eq!(decision.unwatched, Some(4));
    let refused = Shield::<8>::enter(WORST, &site, PathId::new(1));
    assert!(refused.is_err(), "only the first path can be entered");
}

/// A pedestrian for each of these numbers, who stands at the end of crossing `crossing`.
fn at_the_end(site: &Site, crossing: u8, numbers: Range<u16>) -> Vec<Track> {
    let numbered = |number| {
        let mut track = on_foot(site, crossing, [13.9, 0.0]);
        track.number = number;
        track
    };
    numbers.map(numbered).collect()
}

#[test]
fn a_crossing_without_room_to_watch_stays_closed_while_somebody_is_missing() {
    let site = crossings();
    let mut run = Run::new(&site, WORST);
    let tracks = at_the_end(&site, 2, 0..5);
    let own = ego(&site, [20.0, 0.0]);
    assert_eq!(run.observe(own, &tracks, 0.0).unwatched, Some(4));
    for _ in 0..50 {
        assert_eq!(run.observe(own, &tracks[..4], 0.0).unwatched, Some(4));
    }
    run.shield.forget(4);
    assert_eq!(run.observe(own, &tracks[..4], 0.0).unwatched, None);
}

#[test]
fn one_who_appears_and_is_not_watched_voids_a_plan_that_passes_its_crossing() {
    let site = crossings();
    let mut run = Run::new(&site, WORST);
    let tracks = at_the_end(&site, 2, 0..5);
    // Too near to stop.
    let own = [zone(&site, 2).ego.from - 4.0, 8.0];
    let decision = run.observe(ego(&site, own), &tracks[..4], 0.0);
    assert!(decision.plan.is_some_and(|plan| plan.go > 0), "{decision}");
    let own = [own[0] + 0.8, 8.0];
    let decision = run.observe(ego(&site, own), &tracks, 0.0);
    assert_eq!(decision.unwatched, Some(4));
    assert_eq!(decision.plan, None, "{decision}");
}

#[test]
fn whoever_is_at_a_crossing_that_the_ego_has_passed_takes_no_room() {
    let site = crossings();
    let mut run = Run::new(&site, WORST);
    let beyond = zone(&site, 1).ego.to + 0.5;
    let old = at_the_end(&site, 1, 10..14);
    run.observe(ego(&site, [beyond - 1.0, 1.0]), &old, 0.0);
    let decision = run.observe(ego(&site, [beyond, 1.0]), &at_the_end(&site, 2, 0..4), 0.0);
    assert_eq!(decision.unwatched, None);
}

/// Too near to stop, it can pass one who is at the end of the crossing, and nobody who is on the road.
#[test]
fn one_who_appears_on_the_road_voids_the_plan() {
    let site = crossings();
    let own = zone(&site, 1).ego.from - 4.0;
    for (s, kept) in [(13.9, true), (7.0, false)] {
        let mut run = Run::new(&site, WORST);
        let before = run.observe(ego(&site, [own, 8.0]), &[], 0.0);
        assert!(before.plan.is_some());
        let appeared = [on_foot(&site, 1, [s, 0.0])];
        let decision = run.observe(ego(&site, [own + 0.8, 8.0]), &appeared, 0.0);
        assert_eq!(decision.plan.is_some(), kept, "{decision}");
    }
}
