//! Somebody who may be where nobody can see.

use super::headroom::go;
use super::*;
use crate::observation::Sight;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use std::vec::Vec;

/// The roads from the south that cross the ego's.
const ROADS: [u8; 2] = [1, 2];

/// Somebody who is out of sight at first.
#[derive(Clone, Copy, Debug)]
struct Stranger {
    /// Metres behind the edge of sight, and the speed in units of what anybody there may have.
    start: State,
    /// It wants another acceleration after so many periods.
    moods: [f32; 8],
}

#[derive(Clone, Debug)]
struct Case {
    own: State,
    proposals: [f32; 8],
    /// The share of the latency after which commands take effect.
    late: f32,
    /// How far along each road the sensors see, one after the other, and the most speed (m/s) out of sight.
    edges: [[f32; 8]; 2],
    speed: f32,
    strangers: [Stranger; 2],
    errors: [State; 8],
    exact: bool,
}

/// Accelerations between braking and going, often at the ends.
fn pedal(low: f32, high: f32) -> impl Strategy<Value = f32> {
    prop_oneof![Just(low), Just(high), low..high]
}

fn strangers() -> impl Strategy<Value = Stranger> {
    let behind = 0.0_f32..20.0;
    let speed = prop_oneof![Just(1.0_f32), 0.0_f32..1.0];
    let moods = prop::array::uniform8(pedal(-8.0, 3.0));
    (behind, speed, moods).prop_map(|(behind, speed, moods)| Stranger {
        start: [behind, speed],
        moods,
    })
}

fn cases() -> impl Strategy<Value = Case> {
    let error = prop::array::uniform2(-1.0_f32..=1.0);
    let world = (
        prop::array::uniform2(prop::array::uniform8(5.0_f32..52.0)),
        prop_oneof![Just(15.0_f32), 4.0_f32..15.0],
        prop::array::uniform2(strangers()),
    );
    let own = (
        [0.0_f32..40.0, 0.0_f32..12.0],
        prop::array::uniform8(pedal(-3.0, 3.0)),
        0.0_f32..=1.0,
        prop::array::uniform8(error),
        any::<bool>(),
    );
    (world, own).prop_map(
        |((edges, speed, strangers), (own, proposals, late, errors, exact))| Case {
            own,
            proposals,
            late,
            edges,
            speed,
            strangers,
            errors,
            exact,
        },
    )
}

/// What goes wrong after the first plan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Wrong {
    overlaps: u32,
    without_plan: u32,
    breaches: u32,
}

/// Drives through both roads, with what is in sight `told` or not.
fn drive(case: &Case, told: bool) -> Wrong {
    let second = route(&[(14.0, -60.0), (14.0, 60.0)]);
    let site = site(&[east(), north(), second]);
    let error = if case.exact { 0.0 } else { 0.2 };
    let contract = WORST.to_builder().position_error(error).speed_error(error);
    let mut run = Run::new(&site, contract.build().unwrap());
    let mut own = case.own.map(f64::from);
    let mut others = [0, 1].map(|i| {
        let Stranger {
            start: [behind, share],
            ..
        } = case.strangers[i];
        [case.edges[i][0] - behind, share * case.speed].map(f64::from)
    });
    let (mut seen, mut before, mut guarded) = ([false; 2], 0.0, false);
    let mut wrong = Wrong::default();
    for step in 0..160 {
        let now = Instant::from_millis(run.millis + 100);
        // The view changes abruptly.
        let edge = |i: usize| case.edges[i][(step / 7) % 8];
        let [e, f] = case.errors[step % 8].map(|it| it * error);
        let sensed = |[s, v]: [f64; 2]| [s as f32 + e, v as f32 + f];
        let mut tracks = Vec::new();
        for i in 0..2 {
            if others[i][0] as f32 >= edge(i) && others[i][0] < 119.0 {
                seen[i] = true;
                tracks.push(track(&site, ROADS[i], sensed(others[i])));
            }
        }
        if told {
            let sights = [0, 1].map(|i| Sight {
                path: PathId::new(ROADS[i]),
                from: edge(i),
                speed: case.speed,
            });
            run.shield.set_sight(now, &sights).unwrap();
        }
        let seen_own = ego(&site, sensed(own));
        let decision = run.observe(seen_own, &tracks, case.proposals[(step / 5) % 8]);
        guarded |= decision.plan.is_some();
        wrong.without_plan += u32::from(guarded && decision.plan.is_none());
        wrong.breaches += u32::from(decision.breach.is_some());
        let (command, late) = (f64::from(decision.acceleration), 0.1 * f64::from(case.late));
        own = go(go(own, before, late), command, 0.1 - late);
        for (i, other) in others.iter_mut().enumerate() {
            let wanted = f64::from(case.strangers[i].moods[(step / 6) % 8]);
            let cap = if seen[i] { 15.0 } else { f64::from(case.speed) };
            *other = go(*other, wanted.min((cap - other[1]).max(0.0) / 0.1), 0.1);
            let zone = zone(&site, ROADS[i]);
            let inside =
                |span: Span, s: f64| (f64::from(span.from)..f64::from(span.to)).contains(&s);
            let overlap = inside(zone.ego, own[0]) && inside(zone.other, other[0]);
            wrong.overlaps += u32::from(guarded && overlap);
        }
        before = command;
        if own[0] > 100.0 {
            break;
        }
    }
    wrong
}

proptest! {
    #[test]
    fn whoever_comes_out_of_sight_was_expected(case in cases()) {
        prop_assert_eq!(drive(&case, true), Wrong::default());
    }
}

#[test]
fn whoever_comes_out_of_sight_unexpected_is_met_or_ends_the_plan() {
    let mut runner = TestRunner::deterministic();
    let mut total = Wrong::default();
    for _ in 0..256 {
        let case = cases().new_tree(&mut runner).unwrap().current();
        let wrong = drive(&case, false);
        total.overlaps += wrong.overlaps;
        total.without_plan += wrong.without_plan;
    }
    assert!(total.overlaps > 0 && total.without_plan > 0, "{total:?}");
}

/// An ego before the ramp's lane, whose sight of the ramp ends `away` metres before it.
fn at_the_ramp(site: &Site, away: f32, own: State) -> Decision {
    let lane = zone(site, 1);
    let mut run = Run::new(site, WORST);
    let now = Instant::from_millis(run.millis + 100);
    let sight = Sight {
        path: PathId::new(1),
        from: lane.other.from - away,
        speed: 15.0,
    };
    run.shield.set_sight(now, &[sight]).unwrap();
    run.decide(own, &[], 3.0)
}

#[test]
fn a_lane_is_entered_only_with_the_gap_to_somebody_out_of_sight() {
    let site = site(&[east(), ramp()]);
    let own = [zone(&site, 1).ego.from - 4.0, 5.0];
    let near = at_the_ramp(&site, 10.0, own);
    assert_eq!(near.plan, None);
    assert_eq!(
        near.cause,
        Cause::Fallback(Fault::NoPlan),
        "it cannot stop either"
    );
    let waits = at_the_ramp(&site, 10.0, [own[0] - 2.0, 5.0]);
    assert_eq!(
        waits.to_string(),
        "shielded: somebody out of sight on path 1 may arrive in 0.2 s, clearing needs 1.0 s"
    );
    // Inside, it leads: whoever comes from behind keeps its distance.
    let inside = at_the_ramp(&site, 10.0, [zone(&site, 1).ego.from + 8.0, 5.0]);
    assert_eq!(inside.cause, Cause::Policy);
}

#[test]
fn what_is_said_of_the_sight_is_checked() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    let mut said = |path, from, speed| {
        let path = PathId::new(path);
        let sight = Sight { path, from, speed };
        let now = Instant::from_millis(run.millis);
        let refused = run.shield.set_sight(now, &[sight]).err();
        refused.map_or(std::string::String::new(), |error| error.to_string())
    };
    assert_eq!(said(1, 20.0, 15.0), "");
    assert!(said(7, 20.0, 15.0).starts_with("the sight of path 7,"));
    assert!(said(1, f32::NAN, 15.0).starts_with("the sight of path 1 from NaN m on: "));
    assert!(said(1, 20.0, 0.0).starts_with("0 m/s out of sight on path 1: "));
}

/// Whether one that appears near the edge of sight counts as one who was out of sight, and so leaves the plan as it is, if
/// somebody was on its path at the call before, whose state was refused or whose number has been forgotten.
fn emerges(refused: bool, forgotten: bool) -> bool {
    let site = crossing();
    let errs = WORST.to_builder().position_error(0.5).speed_error(1.0);
    let mut run = Run::new(&site, errs.build().unwrap());
    let mut call = |number, state: State| {
        run.millis += 100;
        let now = Instant::from_millis(run.millis);
        let (path, from, speed) = (PathId::new(1), 33.0, 3.0);
        let sight = Sight { path, from, speed };
        run.shield.set_sight(now, &[sight]).unwrap();
        let mut tracks = std::vec::Vec::new();
        if state[1].is_nan() || state[0] > 0.0 {
            let mut seen = track(&site, 1, [33.1, state[1]]);
            seen.number = number;
            tracks.push(seen);
        }
        let seen = Observation {
            ego: ego(&site, [20.0, 0.0]),
            tracks: &tracks,
        };
        run.shield.filter(now, &seen, 0.0);
        if forgotten {
            run.shield.forget(9);
        }
        run.shield
            .tracks
            .iter()
            .any(|it| it.news == super::super::other::News::Emerged)
    };
    call(9, [0.0, 0.0]);
    call(9, [0.0, 0.0]);
    if refused {
        call(9, [33.1, f32::NAN]);
    } else if forgotten {
        call(9, [33.1, 3.0]);
    }
    call(1, [33.1, 3.0])
}

#[test]
fn only_who_was_out_of_sight_comes_from_there() {
    assert!(emerges(false, false));
    assert!(!emerges(true, false), "it was in sight, and refused");
    assert!(!emerges(false, true), "it was in sight, by another number");
}

/// To forget one who is not there, or who has left, says nothing of those who come out of sight.
#[test]
fn whoever_is_forgotten_that_nobody_knows_was_not_in_sight() {
    let second = route(&[(14.0, -60.0), (14.0, 60.0)]);
    let site = site(&[east(), north(), second]);
    let emerges = |forgotten: u16, left: bool| {
        let mut run = Run::new(&site, WORST);
        let own = ego(&site, [20.0, 0.0]);
        let bystander = if left { [90.0, 0.0] } else { [30.0, 0.0] };
        for appears in [false, false, true] {
            let now = Instant::from_millis(run.millis + 100);
            let (path, from, speed) = (PathId::new(1), 33.0, 3.0);
            run.shield
                .set_sight(now, &[Sight { path, from, speed }])
                .unwrap();
            let tracks = [track(&site, 2, bystander), track(&site, 1, [33.1, 3.0])];
            run.observe(own, &tracks[..1 + usize::from(appears)], 0.0);
            if !appears {
                run.shield.forget(forgotten);
            }
        }
        let news = |it: &super::super::other::Other| it.news == super::super::other::News::Emerged;
        run.shield.tracks.iter().any(news)
    };
    assert!(emerges(77, false) && emerges(77, true) && emerges(2, true));
    assert!(!emerges(2, false), "it was in sight");
}
