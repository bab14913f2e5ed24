//! What is feared of others, in numbers, with sensors that err.

use super::hazard::{Hazard, Who};
use super::margin::Going;
use super::unwatched::Closed;
use super::*;

/// Sensors err by 0.3 m and by 0.2 m/s.
fn errs(contract: Contract) -> Contract {
    let builder = contract.to_builder().position_error(0.3).speed_error(0.2);
    builder.slack(0.05).build().unwrap()
}

#[track_caller]
fn near(a: f32, b: f32) {
    assert!((a - b).abs() < 1e-3, "{a}, {b}");
}

/// The only hazard of one other on path 1, over whom the ego has the precedence that is named.
fn only(site: &Site, contract: Contract, own: State, other: State, claims: u8) -> Option<Hazard> {
    let hazards = hazards(site, &errs(contract), own, &[(1, other, claims)]);
    let found: std::vec::Vec<_> = hazards.iter().copied().collect();
    assert!(found.len() <= 1);
    found.first().copied()
}

#[test]
fn a_crossing_is_left_when_the_ego_is_seen_to_be_past_it() {
    let site = crossing();
    let zone = zone(&site, 1);
    let hazard = only(&site, WORST, [30.0, 6.0], [20.0, 5.0], 0).unwrap();
    let who = Who::Watched {
        number: 1,
        place: 0,
    };
    assert_eq!(
        (hazard.who, hazard.zone, hazard.suspect, hazard.yields),
        (who, 0, true, false)
    );
    near(hazard.target, zone.ego.to - 30.0 + 0.9);
    near(hazard.limit, zone.ego.from - 30.3);
    near(hazard.rest, zone.ego.from - 30.3);
    assert_eq!(hazard.rest_beyond, FAR);
    let Passage::Before { distance, speed } = hazard.passage else {
        panic!("{hazard:?}");
    };
    near(distance, zone.other.from - 20.3);
    near(speed, 5.2);
}

#[test]
fn a_zone_is_no_hazard_any_more_once_either_has_certainly_left_it() {
    let site = crossing();
    let zone = zone(&site, 1);
    let feared = |own: f32, other: f32| only(&site, WORST, [own, 1.0], [other, 1.0], 0).is_some();
    assert!(feared(zone.ego.to + 0.29, 20.0) && !feared(zone.ego.to + 0.31, 20.0));
    assert!(feared(20.0, zone.other.to + 0.29) && !feared(20.0, zone.other.to + 0.31));
}

#[test]
fn behind_a_leader_the_ego_stops_where_it_may_come_to_rest() {
    let site = site(&[east(), east()]);
    let lead = zone(&site, 1).lead;
    let hazard = only(&site, WORST, [20.0, 5.0], [50.0, 4.0], 0).unwrap();
    assert_eq!((hazard.target, hazard.passage), (FAR, Passage::Never));
    // 29.4 m between the two, of which the footprints take some, and what 3.8 m/s take at 8 m/s².
    near(hazard.limit, 29.4 + lead.from + 0.9025);
    near(hazard.rest, hazard.limit);
    // Too near to be behind it.
    let hazard = only(&site, WORST, [20.0, 5.0], [23.0, 4.0], 0).unwrap();
    near(hazard.limit, 2.4 + lead.from);
}

#[test]
fn in_a_lane_the_one_in_the_middle_is_not_ahead() {
    let site = site(&[east(), east()]);
    // The ego leads as it is sensed, by 0.3 m less than the other may be farther back.
    let leads = |own: f32| only(&site, WORST, [own, 5.0], [50.0, 4.0], 0).is_none();
    assert!(leads(50.01) && !leads(49.99));
}

#[test]
fn a_lane_is_entered_with_a_gap_ahead_of_the_other() {
    let site = site(&[east(), ramp()]);
    let lane = zone(&site, 1);
    let gap = |own: f32, contract, claims| {
        let hazard = only(&site, contract, [own, 6.0], [30.0, 5.0], claims).unwrap();
        near(hazard.target, lane.ego.from - own + 0.9);
        near(hazard.limit, lane.ego.from - own - 0.3);
        let Passage::Ahead {
            gap,
            speed,
            arrives,
        } = hazard.passage
        else {
            panic!("{hazard:?}");
        };
        near(speed, 5.2);
        (gap, arrives)
    };
    let (before, arrives) = gap(40.0, WORST, 0);
    near(before, lane.ego.from - 30.3 - lane.lead.to);
    assert_eq!(arrives, FAR);
    let (before, arrives) = gap(40.0, Contract::ALL_WAY_STOP, 0);
    near(before, lane.ego.from - 30.3 - lane.lead.to);
    let line = site.path(PathId::new(1)).unwrap().line();
    near(arrives, line - 12.0 - 30.3);
    assert_eq!(gap(40.0, Contract::ALL_WAY_STOP, precedence::ALL).1, FAR);
}

/// A half of the slack before its zone, at 3 m/s².
#[test]
fn precedence_opens_a_zone_before_which_the_other_can_stop() {
    let site = crossing();
    let stops = zone(&site, 1).other.from - 0.025 - 0.3 - 3.2 * 3.2 / 6.0;
    let open = |other: f32, claims| {
        let all_way = Contract::ALL_WAY_STOP;
        only(&site, all_way, [30.0, 6.0], [other, 3.0], claims).is_none()
    };
    assert!(open(stops - 0.002, precedence::ALL) && !open(stops + 0.002, precedence::ALL));
    assert!(!open(stops - 0.002, 0));
    assert!(
        only(
            &site,
            WORST,
            [30.0, 6.0],
            [stops - 1.0, 3.0],
            precedence::ALL
        )
        .is_some()
    );
}

#[test]
fn what_is_closed_is_never_entered() {
    let site = crossing();
    let contract = errs(WORST);
    let own = Own::new(&contract, &ego(&site, [30.0, 6.0]), -FAR);
    let hazard = Hazard::closed(
        &contract,
        &own,
        Closed {
            number: 9,
            from: 50.0,
        },
    );
    assert!(hazard.is_closed() && hazard.who == Who::Unwatched(9));
    assert!(!hazard.suspect && !hazard.yields);
    near(hazard.limit, 19.7);
    near(hazard.rest, 19.7);
    assert_eq!((hazard.target, hazard.passage), (FAR, Passage::Never));
}

#[test]
fn sensors_must_tell_a_quarter_of_the_lane_apart() {
    let site = site(&[east(), east()]);
    let enter = |error: f32| {
        let contract = WORST.to_builder().position_error(error).build().unwrap();
        Shield::<8>::enter(contract, &site, EGO).map(|_| ())
    };
    assert!(enter(2.49).is_ok());
    let path = PathId::new(0);
    let refused = EnterError::PositionError {
        path,
        value: 2.5,
        below: 2.5,
    };
    assert_eq!(enter(2.5), Err(refused));
}

/// Another on path 1, seen before.
fn known(site: &Site, contract: &Contract, state: State) -> other::Other {
    let vehicle = on(site, PathId::new(1), state);
    let mut other = other::Other::new(
        contract,
        1,
        PathId::new(1),
        &vehicle,
        Instant::from_millis(0),
    );
    other.news = other::News::None;
    other
}

#[test]
fn one_behind_keeps_its_distance_once_it_has_had_the_gap() {
    let site = site(&[east(), east()]);
    let zone = zone(&site, 1);
    let contract = errs(WORST);
    // At 10.2 m/s at most, behind an ego of 3.8 m/s at least.
    let needs = margin::safe_gap(&contract, 10.2_f32, 3.8);
    let gap = 60.0 - 0.3 - zone.lead.to - needs;
    let settled = |s: f32, change: fn(&mut other::Other)| {
        let own = Own::new(&contract, &ego(&site, [60.0, 4.0]), -FAR);
        let mut other = known(&site, &contract, [s, 10.0]);
        change(&mut other);
        lane::settle::<Sound>(&contract, [zone, zone].iter(), &own, &mut other);
        other.settled
    };
    assert_eq!(settled(gap - 0.3 - 0.005, |_| {}), 0b11);
    assert_eq!(settled(gap - 0.3 + 0.005, |_| {}), 0);
    assert_eq!(settled(58.0, |_| {}), 0);
    assert_eq!(settled(58.0, |other| other.counted = 0b10), 0b10);
    assert_eq!(
        settled(58.0, |other| other.news = other::News::Appeared),
        0b11
    );
    // It is not behind.
    assert_eq!(settled(61.0, |other| other.news = other::News::Appeared), 0);
}

#[test]
fn one_that_comes_out_of_sight_is_no_farther_and_no_faster_than_who_was_expected() {
    let site = crossing();
    let contract = errs(WORST);
    let emerged = |s: f32, speed: f32, holds: bool| {
        let mut other = known(&site, &contract, [10.0, 5.0]);
        let span = |to: f32| Span { from: 0.0, to };
        let source = Bounds {
            s: span(s),
            speed: span(speed),
        };
        other.emerge(source, holds);
        assert_eq!(other.base, other.bounds);
        other
    };
    let other = emerged(10.1, 5.1, true);
    assert_eq!((other.bounds.s.to, other.bounds.speed.to), (10.1, 5.1));
    assert_eq!((other.news, other.counted), (other::News::Emerged, u8::MAX));
    for (s, speed) in [(9.0, 4.0), (11.0, 6.0)] {
        let other = emerged(s, speed, false);
        near(other.bounds.s.to, 10.3);
        near(other.bounds.speed.to, 5.2);
        assert_eq!((other.news, other.counted), (other::News::None, 0));
    }
}

/// One that was at 10 m with 5 m/s, to within errors, and is seen at `s` with `speed` at the same time.
fn met(s: f32, speed: f32, gone: bool) -> (other::Other, findings::Findings) {
    let site = crossing();
    let contract = errs(WORST);
    let mut other = known(&site, &contract, [10.0, 5.0]);
    (other.counted, other.settled, other.fresh, other.gone) = (0b1, 0b1, false, gone);
    let (seen, mut findings) = (on(&site, PathId::new(1), [s, speed]), Default::default());
    other.meet(&contract, &seen, Instant::from_millis(0), &mut findings);
    (other, findings)
}

#[test]
fn one_that_is_seen_again_is_where_it_can_be_or_broke_the_contract_or_is_another() {
    for gone in [false, true] {
        let (other, findings) = met(9.8, 5.0, gone);
        assert_eq!((other.news, findings.breach), (other::News::None, None));
        assert!(findings.headroom.other_position.is_some());
        assert_eq!((other.counted, other.settled, other.gone), (0b1, 0b1, gone));
        // It never moves backwards.
        near(other.bounds.s.from, 9.7);
        near(other.bounds.s.to, 10.1);
        near(other.base.s.from, 9.5);
    }
    for (s, speed) in [(20.0, 5.0), (10.0, 9.0), (9.0, 5.0)] {
        let (other, findings) = met(s, speed, false);
        assert_eq!((other.news, findings.breach), (other::News::Broke, Some(1)));
        assert_eq!((other.counted, other.settled), (0, 0));
        near(other.bounds.s.from, s - 0.3);
        let (other, findings) = met(s, speed, true);
        assert_eq!((other.news, findings.breach), (other::News::Appeared, None));
        assert!(!other.gone && !other.fresh);
    }
}

#[test]
fn one_that_is_watched_again_is_where_it_can_be_or_broke_the_contract_or_is_another() {
    let site = crossing();
    let contract = errs(WORST);
    let follows = |s: f32, from: f32, holds: bool| {
        let first = known(&site, &contract, [10.0, 5.0]);
        let place = unwatched::Place::Known {
            base: first.bounds,
            at: first.at,
            settled: 0b10,
        };
        let mut entry = unwatched::Entry {
            number: 1,
            path: PathId::new(1),
            place,
            from,
            seen: false,
            holds,
        };
        let mut other = known(&site, &contract, [s, 5.0]);
        other.news = other::News::Appeared;
        let mut findings = findings::Findings::default();
        let seen = on(&site, PathId::new(1), [s, 5.0]);
        other.follow::<Sound>(&contract, &seen, &mut entry, &mut findings);
        (
            other.news,
            findings.breach,
            [other.settled, other.counted],
            entry.holds,
        )
    };
    use other::News::{Appeared, Watched};
    for from in [50.0, FAR] {
        assert_eq!(
            follows(10.2, from, true),
            (Watched, None, [0b10, u8::MAX], true)
        );
        assert_eq!(
            follows(10.2, from, false),
            (Watched, None, [0b10, 0], false)
        );
    }
    assert_eq!(follows(20.0, 50.0, true), (Watched, Some(1), [0, 0], false));
    // Who has left is not back again.
    assert_eq!(follows(20.0, FAR, true), (Appeared, None, [0, 0], false));
}

/// Both with a metre to spare.
#[test]
fn the_first_zone_that_neither_has_left_is_entered_next() {
    let second = route(&[(20.0, -60.0), (20.0, 60.0)]);
    let mut site = site(&[east(), north(), second]);
    let way_zone = zone(&site, 1);
    let farther = zone(&site, 2);
    // Two zones of one path.
    site.conflicts_mut()[1].zones[1] = Some(farther);
    let contract = errs(WORST);
    let way = site.way(EGO).unwrap();
    let enters = |own: f32, s: f32, settled: u8| {
        let mut other = known(&site, &contract, [s, 5.0]);
        other.settled = settled;
        [
            other.entry::<Sound>(way, own, 1.0),
            other.unsettled::<Sound>(way, own, 1.0),
        ]
    };
    let (near, far) = (Some(way_zone.ego.from), Some(farther.ego.from));
    assert_eq!(enters(20.0, 20.0, 0), [near, near]);
    assert_eq!(enters(20.0, 20.0, 0b01), [near, far]);
    assert_eq!(enters(20.0, 20.0, 0b10), [near, near]);
    assert_eq!(enters(20.0, 20.0, 0b11), [near, None]);
    assert_eq!(enters(way_zone.ego.to + 0.99, 20.0, 0), [near, near]);
    assert_eq!(enters(way_zone.ego.to + 1.01, 20.0, 0), [far, far]);
    assert_eq!(enters(20.0, way_zone.other.to + 1.29, 0), [near, near]);
    assert_eq!(enters(20.0, way_zone.other.to + 1.31, 0), [None, None]);
}

#[test]
fn what_is_found_counts_if_it_is_as_near_as_what_the_plan_does_next() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    let own = Own::new(&WORST, &ego(&site, [20.0, 5.0]), -FAR);
    let inherited = Inherited::all(&WORST, [0.0; 2]);
    let scene = scene::Scene {
        ego: &own,
        hazards: &mut Hazards::new(),
        inherited: &inherited,
        most: 2.5,
        going: Going::of(&WORST),
    };
    assert!(run.shield.is_nearer(&scene, 1.0, -3.0), "there is no plan");
    let plan = Plan { go: 3 };
    run.shield.memory.verified(plan, Instant::from_millis(0));
    // It goes at 2.5 m/s².
    for (wanted, found, nearer) in [
        (1.0, -0.4, true),
        (1.0, -0.6, false),
        (2.0, 1.6, true),
        (2.0, 1.4, false),
        (0.5, 2.5, true),
    ] {
        let is = run.shield.is_nearer(&scene, wanted, found);
        assert_eq!(is, nearer, "{found} for {wanted}");
    }
}

/// From where the ego is sensed to its line, less what sensors may err by.
#[test]
fn the_line_is_as_near_as_it_may_be() {
    let mut builder = Site::builder();
    builder.tolerance(0.0);
    for route in [east(), north()] {
        builder.path(&route, Class::Car, Footprint::PAPER).unwrap();
    }
    builder.line(EGO, 40.0).unwrap();
    let site = builder.build().unwrap();
    let (contract, way) = (errs(WORST), site.way(EGO).unwrap());
    let mut hazards = hazards(&site, &contract, [20.0, 1.0], &[(1, [20.0, 5.0], 0)]);
    let own = Own::new(&contract, &ego(&site, [20.0, 1.0]), -FAR);
    let mut scene = scene::Scene {
        ego: &own,
        hazards: &mut hazards,
        inherited: &Inherited::all(&contract, [0.0; 2]),
        most: 2.5,
        going: Going::of(&contract),
    };
    scene.wait_at_line::<Sound>(&contract, way, false);
    near(hazards.nearest_rest(), 40.0 - 20.0 - 0.3);
}

/// It is 0.2 m beyond it, if sensors err so, and comes to rest farther on.
#[test]
fn one_that_creeps_over_its_line_rests_where_it_can() {
    let mut builder = Site::builder();
    builder.tolerance(0.0);
    for route in [east(), north()] {
        builder.path(&route, Class::Car, Footprint::PAPER).unwrap();
    }
    builder.line(EGO, 40.0).unwrap();
    let site = builder.build().unwrap();
    let (contract, way, own) = (errs(WORST), site.way(EGO).unwrap(), [39.9, 1.0]);
    let inherited = Inherited::all(&contract, [0.0; 2]);
    let mut hazards = hazards(&site, &contract, own, &[(1, [20.0, 5.0], 0)]);
    let mut scene = scene::Scene {
        ego: &Own::new(&contract, &ego(&site, own), -FAR),
        hazards: &mut hazards,
        inherited: &inherited,
        most: 2.5,
        going: margin::Going::of(&contract),
    };
    scene.wait_at_line::<Sound>(&contract, way, false);
    let brakes = margin::departure(&contract, own[1], &inherited, -3.0).braking;
    let rest = margin::rest(&contract, brakes, 0.0);
    near(hazards.nearest_rest(), rest + contract.slack);
}

#[test]
fn a_remembered_plan_holds_with_a_fifth_of_the_slack_less() {
    let own = Own {
        s: 0.0,
        speed: 6.0,
        least: 0.0,
    };
    let inherited = Inherited::all(&WORST, [0.0; 2]);
    let brakes = margin::departure(&WORST, own.speed, &inherited, -3.0).braking;
    let rest = margin::rest(&WORST, brakes, 0.0);
    let holds = |spare: f32| {
        let mut hazards = Hazards::new();
        let scene = scene::Scene {
            ego: &own,
            hazards: &mut hazards,
            inherited: &inherited,
            most: 3.0,
            going: margin::Going::of(&WORST),
        };
        let closed = Closed {
            number: 1,
            from: rest + WORST.slack + spare,
        };
        scene.holds::<Sound>(&WORST, Plan { go: 0 })(&Hazard::closed(&WORST, &own, closed))
    };
    assert!(holds(0.0) && holds(-0.0019) && !holds(-0.0021));
}

/// The ego, 14 m long, is on both crossings at once of one that crosses its path, turns, and crosses it again.
#[test]
fn the_ego_waits_before_both_crossings_unless_it_is_in_the_first() {
    // A half circle of 12 m across.
    let turn = [0_u8, 1, 2, 3, 4, 5].map(|i| {
        let (sin, cos) = (f32::from(i) * core::f32::consts::PI / 5.0).sin_cos();
        Point::new(6.0 - 6.0 * cos, 30.0 + 6.0 * sin)
    });
    let ends = [0.0, 12.0].map(|x| Point::new(x, -60.0));
    let back = [ends[0]].into_iter().chain(turn).chain([ends[1]]);
    let back = Route::<8>::new(back).unwrap();
    let lorry = Footprint {
        length: 14.0,
        width: 2.5,
    };
    let mut builder = Site::builder();
    builder.tolerance(0.0);
    builder.path(&east(), Class::Lorry, lorry).unwrap();
    (builder.path(&back, Class::Car, Footprint::PAPER)).unwrap();
    let site = builder.build().unwrap();
    let way = site.way(EGO).unwrap();
    let conflict = way.conflict(PathId::new(1)).unwrap();
    let zones: std::vec::Vec<_> = conflict.zones().copied().collect();
    let [first, second] = zones[..] else {
        panic!("{zones:?}");
    };
    assert!(first.ego.from < second.ego.from && second.ego.from < first.ego.to);
    let rest = |own: f32| {
        let hazards = hazards(&site, &errs(WORST), [own, 0.0], &[(1, [20.0, 5.0], 0)]);
        let found = hazards.iter().find(|hazard| hazard.zone == 1).unwrap();
        near(found.limit, second.ego.from - own - 0.3);
        found.rest
    };
    near(rest(20.0), first.ego.from - 20.0 - 0.3);
    let inside = first.ego.from + 0.5;
    near(rest(inside), second.ego.from - inside - 0.3);
}

/// The ego, without a plan, stands in one zone; to be past the next one it has to be in the one after that.
#[test]
fn the_ego_leaves_its_zone_only_if_what_is_ahead_can_be_passed_or_stopped_before() {
    let free = Passage::Before {
        distance: 12.0,
        speed: 5.0,
    };
    let hazard = |limit, target, passage| Hazard {
        who: Who::Unwatched(0),
        zone: 0,
        suspect: false,
        yields: false,
        target,
        limit,
        rest: -9.0,
        rest_beyond: FAR,
        passage,
    };
    let own = Own {
        s: 0.0,
        speed: 1.0,
        least: 0.0,
    };
    let leaves = |all: &[Hazard]| {
        let mut scene = scene::Scene {
            ego: &own,
            hazards: &mut hazards::tests::just(all),
            inherited: &Inherited::all(&WORST, [0.0; 2]),
            most: 3.0,
            going: Going::of(&WORST),
        };
        scene.leaves::<Sound>(&WORST)
    };
    let inside = hazard(-2.0, 1.5, free);
    let next = hazard(0.2, 2.0, free);
    let occupied = |from: f32| hazard(from, from + 9.0, Passage::Never);
    assert!(leaves(&[inside]));
    assert!(leaves(&[inside, next]));
    assert!(leaves(&[inside, occupied(1.0)]));
    assert!(leaves(&[inside, next, occupied(12.0)]));
    assert!(!leaves(&[inside, next, occupied(1.0)]));
    assert!(!leaves(&[inside, occupied(0.2)]));
    // Another is in its zone, too, or it stands in none, or its nose alone is in one.
    assert!(!leaves(&[hazard(-2.0, 1.5, Passage::Never), next]));
    assert!(!leaves(&[next]));
    assert!(!leaves(&[hazard(-0.5, 1.5, free)]));
    // Another is at the edge of its zone, or right behind it.
    let distance = |distance| {
        let speed = 1.0;
        leaves(&[hazard(-2.0, 1.5, Passage::Before { distance, speed })])
    };
    assert!(distance(12.0) && !distance(0.0));
    let gap = |gap| {
        let (speed, arrives) = (0.0, FAR);
        let ahead = Passage::Ahead {
            gap,
            speed,
            arrives,
        };
        leaves(&[hazard(-2.0, 1.5, ahead)])
    };
    assert!(gap(12.0) && !gap(0.0));
}

/// A lane from 40 m of the ego and 30 m of the other on, in which they are 5 m apart.
const LANE: Zone = Zone {
    ego: Span {
        from: 40.0,
        to: FAR,
    },
    other: Span {
        from: 30.0,
        to: FAR,
    },
    lead: Span {
        from: -5.0,
        to: 5.0,
    },
    kind: crate::junction::ConflictKind::Merging,
};

/// The only hazard in [`LANE`] of an ego and an other that are seen exactly.
fn in_lane(contract: &Contract, own: State, other: State) -> Hazard {
    let mut site = site(&[east(), ramp()]);
    site.conflicts_mut()[1].zones = [Some(LANE), None, None];
    let hazards = hazards(&site, contract, own, &[(1, other, 0)]);
    *hazards.iter().next().unwrap()
}

#[test]
fn the_ego_follows_whom_it_may_rest_behind_beyond_the_entry_and_enters_ahead_of_others() {
    let follows = |other: State| in_lane(&WORST, [20.0, 5.0], other).passage == Passage::Never;
    // 20 m before the entry, and 5 m behind an other at 45 m.
    assert!(!follows([45.0, 0.0]) && follows([45.01, 0.0]));
    // 4 m/s take a metre at 8 m/s²; it comes to rest behind the other, wherever the lane begins.
    let hazard = in_lane(&WORST, [20.0, 5.0], [60.0, 4.0]);
    assert_eq!((hazard.limit, hazard.rest), (36.0, 36.0));
}

#[test]
fn one_that_has_arrived_counts_on_the_ego_until_that_is_in_the_lane() {
    let arrives = |own: f32| {
        let hazard = in_lane(&Contract::ALL_WAY_STOP, [own, 1.0], [own + 1.0, 1.0]);
        match hazard.passage {
            Passage::Ahead { arrives, .. } => arrives,
            other => panic!("{other:?}"),
        }
    };
    assert!(arrives(39.9) < FAR);
    assert_eq!(arrives(40.0), FAR);
}

#[test]
fn one_that_touches_its_leader_is_behind_it() {
    let behind = |other: f32| {
        let site = site(&[east(), ramp()]);
        let own = Own::new(&WORST, &ego(&site, [20.0, 5.0]), -FAR);
        lane::behind::<Sound>(&WORST, &LANE, &own, &known(&site, &WORST, [other, 4.0]))
    };
    assert_eq!([24.5, 25.0, 26.0].map(behind), [-0.5, 1.0, 2.0]);
}

#[test]
fn a_zone_beyond_those_that_precedence_opens_is_waited_for_where_it_begins() {
    let far = route(&[(20.0, -60.0), (20.0, 60.0)]);
    let site = site(&[east(), north(), far]);
    let [near, far] = [1, 2].map(|i| zone(&site, i));
    let own = near.ego.from - 5.0;
    let others = [
        (1, [near.other.from - 5.0, 0.0], precedence::ALL),
        (2, [20.0, 5.0], 0),
    ];
    let hazards = hazards(&site, &Contract::ALL_WAY_STOP, [own, 0.0], &others);
    assert_eq!(hazards.nearest_rest(), far.ego.from - own);
}

#[test]
fn a_plan_counts_on_each_lane_that_it_enters_ahead_of_somebody() {
    let site = site(&[east(), ramp(), north()]);
    let mut run = Run::new(&site, WORST);
    run.decide([20.0, 5.0], &[(1, [10.0, 5.0]), (2, [10.0, 5.0])], 0.0);
    let ahead = Passage::Ahead {
        gap: 50.0,
        speed: 5.0,
        arrives: FAR,
    };
    let before = Passage::Before {
        distance: 50.0,
        speed: 5.0,
    };
    let hazard = |place, zone, target, passage| Hazard {
        who: Who::Watched { number: 9, place },
        zone,
        suspect: false,
        yields: false,
        target,
        limit: 1.0,
        rest: 1.0,
        rest_beyond: FAR,
        passage,
    };
    let all = [
        hazard(0, 1, 5.0, ahead),
        hazard(0, 2, 10.0, ahead),
        hazard(1, 0, 10.1, ahead),
        hazard(1, 2, 9.0, before),
        hazard(7, 0, 9.0, ahead),
    ];
    let verified = super::super::verified::Verified {
        plan: Plan { go: 5 },
        margin: 1.0,
        passes: 10.0,
    };
    let hazards = hazards::tests::just(&all);
    run.shield.count_on(&hazards, verified);
    let counted: std::vec::Vec<_> = run.shield.tracks.iter().map(|it| it.counted).collect();
    assert_eq!(counted, [0b110, 0]);
}

/// What is seen by sensors that err by 0.3 m, which has left by 0.6 m more, will never seem not to have.
#[test]
fn one_that_has_certainly_left_is_no_news_and_gives_its_room_away() {
    let north = |x: f32| route(&[(x, -60.0), (x, 60.0)]);
    let site = site(&[east(), north(0.0), north(20.0)]);
    let end = zone(&site, 1).other.to;
    let seen = |beyond: f32| {
        let mut run = Run::<Sound, 1>::with_rules(&site, errs(WORST));
        run.decide([20.0, 0.0], &[(1, [end + beyond, 0.0])], 0.0);
        let news = run.shield.tracks.iter().next().unwrap().news;
        let second = [(1, [end + beyond, 0.0]), (2, [20.0, 0.0])];
        (news, run.decide([20.0, 0.0], &second, 0.0).unwatched)
    };
    assert_eq!(seen(0.89), (other::News::Appeared, Some(2)));
    assert_eq!(seen(0.91), (other::News::None, None));
}
