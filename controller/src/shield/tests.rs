//! Properties of the shield on its own: total, dimensionless, symmetric, monotone; and what it says.

use super::choice::most;
use super::hazard::Passage;
use super::*;
use crate::decision::{Breach, Cause};
use crate::geometry::{Footprint, Point, Pose, unit};
use crate::headroom::Headroom;
use crate::junction::zone::{FAR, Span};
use crate::junction::{Class, RightOfWay, Route, Zone};
use crate::observation::{Track, Vehicle};
use proptest::prelude::*;
use std::string::ToString;

mod actuation;
mod distances;
mod door;
mod edges;
mod headroom;
mod hidden;
mod memory;
mod turns;
mod walkers;
mod without_room;

const WORST: Contract = Contract::WORST_CASE;

/// The ego's path is the first.
type Site = Junction<4, 16, 1>;

const EGO: PathId = PathId::new(0);

/// Arc length and speed.
type State = [f32; 2];

fn route(points: &[(f32, f32)]) -> Route<4> {
    Route::new(points.iter().map(|&(x, y)| Point::new(x, y))).unwrap()
}

/// The ego's road from west to east; its centre is at arc length 60.
fn east() -> Route<4> {
    route(&[(-60.0, 0.0), (60.0, 0.0)])
}

fn north() -> Route<4> {
    route(&[(0.0, -60.0), (0.0, 60.0)])
}

/// Joins the ego's road at its centre.
fn ramp() -> Route<4> {
    route(&[(-50.0, -40.0), (0.0, 0.0), (60.0, 0.0)])
}

/// The junction of the ego's route and the others', whose vehicles keep to them exactly. Those that are named go
/// before the ego, or after it.
fn site_with(routes: &[Route<4>], rights: &[(usize, RightOfWay)]) -> Site {
    let mut builder = Site::builder();
    builder.tolerance(0.0);
    for route in routes {
        builder.path(route, Class::Car, Footprint::PAPER).unwrap();
    }
    for &(other, right_of_way) in rights {
        let other = PathId::new(other as u8);
        match right_of_way {
            RightOfWay::Ego => builder.right_of_way(EGO, other).unwrap(),
            RightOfWay::Other => builder.right_of_way(other, EGO).unwrap(),
            RightOfWay::Unsettled => {}
        }
    }
    builder.build().unwrap()
}

fn site(routes: &[Route<4>]) -> Site {
    site_with(routes, &[])
}

fn crossing() -> Site {
    site(&[east(), north()])
}

/// The first zone of the ego's path with path `other`.
fn zone(site: &Site, other: u8) -> Zone {
    let conflict = site.conflict(EGO, PathId::new(other)).unwrap();
    *conflict.zones().next().unwrap()
}

fn on(site: &Site, path: PathId, [s, speed]: State) -> Vehicle {
    let pose = site.polyline(path).unwrap().pose(s);
    Vehicle { s, speed, pose }
}

fn ego(site: &Site, state: State) -> Vehicle {
    on(site, EGO, state)
}

/// Track `number` on the path with the same number.
fn track(site: &Site, number: u8, state: State) -> Track {
    let path = PathId::new(number);
    Track::on(number.into(), path, on(site, path, state))
}

/// A shield at work: each call is a period after the last one.
struct Run<'j, R: Rules = Sound, const N: usize = 8> {
    site: &'j Site,
    shield: Shield<'j, N, R>,
    millis: u64,
}

impl<'j> Run<'j> {
    fn new(site: &'j Site, contract: Contract) -> Self {
        Self::with_rules(site, contract)
    }
}

impl<'j, R: Rules, const N: usize> Run<'j, R, N> {
    fn with_rules(site: &'j Site, contract: Contract) -> Self {
        let shield = Shield::with_rules(contract, site, EGO).unwrap();
        let millis = 7_000;
        Self {
            site,
            shield,
            millis,
        }
    }

    /// The decision of the next period, among others of which each is on the path of its number.
    fn decide(&mut self, own: State, others: &[(u8, State)], proposal: f32) -> Decision {
        let tracks: std::vec::Vec<_> = others
            .iter()
            .map(|&(number, state)| track(self.site, number, state))
            .collect();
        let ego = ego(self.site, own);
        self.observe(ego, &tracks, proposal)
    }

    fn observe(&mut self, ego: Vehicle, tracks: &[Track], proposal: f32) -> Decision {
        self.millis += 100;
        let now = Instant::from_millis(self.millis);
        self.shield
            .filter(now, &Observation { ego, tracks }, proposal)
    }
}

fn margin(site: &Site, own: State, other: State, acceleration: f32) -> f32 {
    margin_by::<Sound>(site, own, &[(1, other)], acceleration)
}

fn margin_by<R: Rules>(site: &Site, own: State, others: &[(u8, State)], acceleration: f32) -> f32 {
    let shield = Shield::<8, R>::with_rules(WORST, site, EGO).unwrap();
    let others = others
        .iter()
        .map(|&(number, state)| track(site, number, state));
    let tracks: std::vec::Vec<_> = others.collect();
    let ego = ego(site, own);
    let seen = Observation {
        ego,
        tracks: &tracks,
    };
    shield.margin(&seen, 0.0, acceleration).unwrap()
}

/// The hazards of others that are seen for the first time, over each of whom the ego has the precedence that is named.
fn hazards(
    site: &Site,
    contract: &Contract,
    own: State,
    others: &[(u8, State, precedence::ZoneSet)],
) -> Hazards {
    let way = site.way(EGO).unwrap();
    let ego = ego(site, own);
    let own = Own::new(contract, &ego, -FAR);
    let seen: std::vec::Vec<_> = others
        .iter()
        .map(|&(number, state, _)| track(site, number, state))
        .collect();
    let seen = Observation { ego, tracks: &seen };
    let mut tracks = Tracks::<8>::new();
    let findings = tracks.note::<Sound>(contract, way, Instant::from_millis(1), &own, &seen);
    assert_eq!((findings.breach, findings.fault), (None, None));
    for (other, &(_, _, claims)) in tracks.iter_mut().zip(others) {
        other.claims = claims;
    }
    let mut hazards = Hazards::new();
    hazards.add::<8, Sound>(contract, way, (&own, &tracks), None);
    hazards
}

#[test]
fn an_intervention_explains_itself() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    // 8 m before its zone at 6 m/s; the other 9 m before its own at 6 m/s.
    let decision = run.decide([48.46, 6.0], &[(1, [47.46, 6.0])], 3.0);
    assert!(decision.acceleration < 3.0 && decision.margin >= 0.0);
    assert_eq!(
        decision.to_string(),
        "shielded: other 1 may arrive in 1.2 s, clearing needs 1.8 s"
    );
}

#[test]
fn good_proposals_pass_unchanged() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    let decision = run.decide([20.0, 8.0], &[(1, [0.0, 8.0])], 1.23);
    assert_eq!(
        (decision.acceleration, decision.cause),
        (1.23, Cause::Policy)
    );
    assert_eq!(decision.plan, Some(Plan { go: 0 }));
    assert_eq!(run.shield.plan(), decision.plan);
}

#[test]
fn a_zone_that_the_other_has_left_is_free_for_ever() {
    let site = crossing();
    assert!(margin(&site, [56.0, 3.0], [63.0, 0.0], 3.0) < 0.0);
    assert!(margin(&site, [56.0, 3.0], [64.0, 0.0], 3.0) >= 0.0);
}

/// What an ego does that goes blind when its only safe plan is to clear a zone: the periods planned, and the
/// commands for as many periods and one more.
fn blind<R: Rules>() -> (usize, std::vec::Vec<f32>) {
    let site = crossing();
    let mut run = Run::<R, 8>::with_rules(&site, WORST);
    let first = run.decide([50.0, 10.0], &[(1, [10.0, 5.0])], 3.0);
    assert_eq!(first.cause, Cause::Policy);
    let periods = usize::from(first.plan.unwrap().go);
    let commands = (0..=periods).map(|_| {
        let nothing = Vehicle {
            s: f32::NAN,
            ..ego(&site, [0.0, 0.0])
        };
        let decision = run.observe(nothing, &[], 0.0);
        assert!(matches!(decision.cause, Cause::Fallback(Fault::Input(_))));
        assert!(decision.plan.is_some());
        decision.acceleration
    });
    (periods, commands.collect())
}

#[test]
fn without_eyes_the_ego_carries_out_its_plan() {
    let (periods, commands) = blind::<Sound>();
    assert!(periods > 5, "{periods}");
    let (last, going) = commands.split_last().unwrap();
    assert!(going.iter().all(|&a| a == 3.0));
    assert_eq!(*last, -3.0);
}

struct Stale;
impl Rules for Stale {
    fn tail(plan: Plan) -> Plan {
        plan
    }
}

#[test]
fn a_stale_plan_is_noticed() {
    let (_, commands) = blind::<Stale>();
    assert_eq!(commands.last(), Some(&3.0), "it should have braked");
}

struct FarthestFirst;
impl Rules for FarthestFirst {
    fn sooner(a: f32, b: f32) -> bool {
        a > b
    }
}

#[test]
fn zones_in_the_wrong_order_are_noticed() {
    // Too fast to stop before the first zone; the second, 20 m on, is taken for ever.
    let second = route(&[(35.0, -60.0), (35.0, 60.0)]);
    let site = site(&[east(), north(), second]);
    let others = [(1, [0.0, 5.0]), (2, [60.0, 0.0])];
    assert!(margin_by::<Sound>(&site, [54.0, 5.0], &others, 0.0) >= 0.0);
    assert!(margin_by::<FarthestFirst>(&site, [54.0, 5.0], &others, 0.0) < 0.0);
}

#[test]
fn a_speed_limiter_breaks_no_contract() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    let mut breach = |s, speed| run.decide([s, speed], &[(1, [0.0, 0.0])], 3.0).breach;
    for (s, speed) in [(0.0, 14.0), (1.415, 14.3), (2.8525, 14.45), (4.2975, 14.45)] {
        assert_eq!(breach(s, speed), None, "{speed} m/s");
    }
    assert_eq!(breach(5.7, 13.7), Some(Breach::Ego));
}

#[test]
fn no_command_makes_the_ego_faster_than_its_limit() {
    for (latency, error) in [(0.1, 0.0), (0.03, 0.0), (0.0, 0.2)] {
        let contract = WORST.to_builder().latency(latency).speed_error(error);
        let contract = contract.build().unwrap();
        let (mut speed, mut before) = (10.0_f32, 3.0_f32);
        for step in 0..200 {
            let sensed = speed + if step % 2 == 0 { error } else { -error };
            let command = most(&contract, sensed, before);
            speed += before * latency + command * (0.1 - latency);
            before = command;
            assert!(
                speed <= 15.0 + 1e-4,
                "{speed} m/s with {latency} s, {error} m/s"
            );
        }
        assert!(speed > 13.0, "{speed} m/s is far from the limit");
    }
}

#[test]
fn an_ego_is_fast_when_a_reduced_go_takes_effect() {
    for (period, latency) in [(0.1, 0.1), (1.0, 0.5), (1.0, 1.0)] {
        let contract = WORST.to_builder().period(period).latency(latency);
        let contract = contract.build().unwrap();
        let ego = contract.ego;
        for speed in (0..=150).map(|i| 0.1 * i as f32) {
            let brakes = most(&contract, speed, -ego.braking);
            let then = speed - ego.braking * latency;
            assert!(
                brakes >= ego.go || then >= margin::unlimited::<f32>(&contract),
                "{speed} m/s, {latency} s: {brakes} m/s² at {then} m/s"
            );
        }
    }
}

#[test]
fn what_the_ego_gets_through_at_least_knows_of_its_limit() {
    let least = |limit| {
        let mut contract = WORST;
        contract.ego.max_speed = limit;
        margin::departure(&contract, 14.9, &Inherited::all(&contract, [3.0; 2]), 3.0)
            .least
            .speed
    };
    assert_eq!(least(15.0), 14.9);
    assert!(
        least(100.0) > 15.4,
        "the limit is what makes the difference"
    );
}

#[test]
fn an_ego_that_stands_in_a_zone_gets_out_of_it() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    let decision = run.decide([60.0, 0.0], &[(1, [54.0, 5.0])], 0.0);
    assert_eq!(decision.cause, Cause::Fallback(Fault::NoPlan));
    assert_eq!(decision.acceleration, 3.0);
    let mut run = Run::new(&site, WORST);
    let decision = run.decide([60.0, 0.0], &[(1, [58.0, 0.0])], 0.0);
    assert_eq!(
        decision.acceleration, -3.0,
        "the other is in its zone as well"
    );
}

#[test]
fn without_a_plan_the_ego_does_not_leave_its_zone_into_somebody_in_plain_sight() {
    let second = route(&[(8.0, -60.0), (8.0, 60.0)]);
    let site = site(&[east(), north(), second]);
    let mut run = Run::new(&site, WORST);
    // 0.6 m in its first zone; the second one, 4.4 m on, is occupied by one that stands.
    let nose = zone(&site, 1).ego.from + 0.6;
    let decision = run.decide([nose, 6.5], &[(1, [50.0, 5.0]), (2, [60.0, 0.0])], f32::NAN);
    assert_eq!(decision.cause, Cause::Fallback(Fault::NoPlan));
    assert_eq!(decision.acceleration, -3.0);
}

#[test]
fn behind_a_leader_the_ego_can_always_stop() {
    let site = site(&[east(), east()]);
    // 10 m/s: 16.7 m to stop, and the latency; the leader, 5 m long, stops within 6.25 m at 8 m/s².
    let accepts = |gap: f32, a| margin(&site, [1.0, 10.0], [gap + 6.0, 10.0], a) >= 0.0;
    assert!(accepts(14.0, -3.0) && !accepts(11.0, -3.0));
    assert!(accepts(14.0, 0.0) && !accepts(13.0, 3.0));
}

/// Until it has arrived, one that has to wait may enter the lane ahead of it, with a safe gap.
#[test]
fn precedence_opens_a_lane_once_the_ego_has_arrived() {
    let site = site(&[east(), ramp()]);
    let lane = zone(&site, 1);
    let passage = |own: f32| {
        let other = (1, [lane.other.from - 1.0, 0.0], precedence::ALL);
        let hazards = hazards(&site, &Contract::ALL_WAY_STOP, [own, 0.0], &[other]);
        hazards.iter().next().map(|hazard| hazard.passage)
    };
    let arrival = site.path(EGO).unwrap().line() - Precedence::ALL_WAY_STOP.distance;
    assert!(matches!(
        passage(arrival - 0.1),
        Some(Passage::Ahead { .. })
    ));
    assert_eq!(passage(arrival + 0.1), None);
}

/// One that has arrived may count on the ego to stay out of the lane. Without a rule of precedence nobody does.
#[test]
fn without_precedence_the_ego_enters_a_lane_only_before_the_other_can_arrive() {
    let site = site(&[east(), ramp()]);
    let lane = zone(&site, 1);
    let line = site.path(PathId::new(1)).unwrap().line();
    let arrives = |contract: &Contract, before: f32, claims| {
        let other = (1, [line - before, 0.0], claims);
        let own = [lane.ego.from - 5.0, 8.0];
        let hazards = hazards(&site, contract, own, &[other]);
        match hazards.iter().next().map(|hazard| hazard.passage) {
            Some(Passage::Ahead { arrives, .. }) => arrives,
            other => panic!("{other:?}"),
        }
    };
    let all_way = &Contract::ALL_WAY_STOP;
    assert!((arrives(all_way, 30.0, 0) - 18.0).abs() < 1e-3);
    assert!(arrives(all_way, 5.0, 0) < 0.0);
    assert_eq!(arrives(&Contract::WORST_CASE, 5.0, 0), FAR);
}

/// A line that the junction is told, and the ego's rest.
#[test]
fn the_ego_waits_at_its_line_unless_it_is_far_beyond_it() {
    let mut hazards = hazards(
        &crossing(),
        &Contract::WORST_CASE,
        [zone(&crossing(), 1).ego.from - 20.0, 0.0],
        &[(1, [20.0, 5.0], 0)],
    );
    let rest = |hazards: &Hazards| hazards.nearest_rest();
    assert!((rest(&hazards) - 20.0).abs() < 0.2);
    // 15 m to the line, and it can stop after 2 m.
    hazards.wait_at(15.0, 2.0, false);
    assert_eq!(rest(&hazards), 15.0);
    // It has crept over its line.
    hazards.wait_at(-0.1, 0.05, false);
    assert_eq!(rest(&hazards), 0.05);
    let before = hazards.clone();
    hazards.wait_at(3.0, 4.5, false);
    assert_eq!(hazards, before);
    // On its way by a plan that goes, it does not take to one that rests inside.
    hazards.wait_at(-1.0, 4.5, true);
    assert_eq!(rest(&hazards), -1.0);
}

/// It entered by a plan that passes before the other, and its driver then dawdles. The zone begins beyond the line, and
/// an ego that stood between the two would stand in the way of others.
#[test]
fn an_ego_that_has_entered_does_not_stop_inside_while_its_plan_passes() {
    let mut builder = Site::builder();
    builder.tolerance(0.0);
    for route in [east(), north()] {
        builder.path(&route, Class::Car, Footprint::PAPER).unwrap();
    }
    let line = zone(&crossing(), 1).ego.from - 6.0;
    builder.line(EGO, line).unwrap();
    let site = builder.build().unwrap();
    let end = zone(&site, 1).ego.to;
    let mut own = [line - 0.1, 0.0];
    // As near as it may be when the ego sets off.
    let starts = (0_u8..60).rev().map(|s| [f32::from(s), 8.0]);
    let mut other = (starts.into_iter())
        .find(|&other| margin(&site, own, other, 3.0) >= 0.0)
        .unwrap();
    let mut run = Run::new(&site, WORST);
    while own[0] < end {
        let entered = own[0] > line + 0.5;
        let proposal = if entered { 0.0 } else { 3.0 };
        let decision = run.decide(own, &[(1, other)], proposal);
        assert!(decision.plan.is_some());
        assert!(decision.acceleration >= 0.0, "{own:?} {decision:?}");
        let speed = (own[1] + 0.1 * decision.acceleration).max(0.0);
        own = [own[0] + 0.05 * (own[1] + speed), speed];
        other[0] += 0.1 * other[1];
    }
    assert!(other[0] < zone(&site, 1).other.from);
}

/// An ego that had to clear also the zones in which it has precedence would wait before a crossing
/// for a lane behind it to become free, and others would wait for it.
#[test]
fn an_ego_with_precedence_may_wait_in_the_zone() {
    let site = crossing();
    let crossed = zone(&site, 1);
    let (own, other) = (
        [crossed.ego.from + 2.0, 0.0],
        [crossed.other.from - 0.1, 0.0],
    );
    let count = |contract, claims| {
        hazards(&site, contract, own, &[(1, other, claims)])
            .iter()
            .count()
    };
    assert_eq!(count(&Contract::ALL_WAY_STOP, precedence::ALL), 0);
    assert_eq!(count(&WORST, 0), 1);
}

/// Where the ego, 5 m before two crossings that overlap, has to stop for the second other, by the right of way over it, if
/// it has precedence over the first; and where the two zones begin.
fn stops_for(right_of_way: RightOfWay) -> (f32, [f32; 2]) {
    let routes = [east(), north(), route(&[(2.0, -60.0), (2.0, 60.0)])];
    let site = site_with(&routes, &[(2, right_of_way)]);
    let zones = [1, 2].map(|i| zone(&site, i));
    let own = [zones[0].ego.from - 5.0, 0.0];
    let rest = |i: usize| [zones[i].other.from - 0.1, 0.0];
    let others = [(1, rest(0), precedence::ALL), (2, rest(1), 0)];
    let limit = hazards(&site, &Contract::ALL_WAY_STOP, own, &others).nearest_rest();
    (limit, zones.map(|zone| zone.ego.from - own[0]))
}

#[test]
fn an_ego_with_precedence_holds_up_others_only_for_whom_it_yields_to() {
    let (limit, [_, second]) = stops_for(RightOfWay::Other);
    assert_eq!(limit, second);
    for right_of_way in [RightOfWay::Ego, RightOfWay::Unsettled] {
        let (limit, [first, second]) = stops_for(right_of_way);
        assert!(limit == first && first < second);
    }
}

/// Whether the ego is allowed more at a merge by an other that is `worse` than `other`, though it cannot
/// come to rest ahead of where the ego would enter.
fn gains_at_a_merge<R: Rules>(own: State, other: State, worse: State, a: f32) -> bool {
    let site = site(&[east(), ramp()]);
    let zone = zone(&site, 1);
    assert!(zone.is_lane());
    let rests = worse[0] + margin::earliest_rest(&WORST, worse[1]) + zone.lead.from;
    let [before, after] = [other, worse].map(|other| margin_by::<R>(&site, own, &[(1, other)], a));
    rests <= zone.ego.from && after > before + 1e-4
}

/// Fears the slow more than the fast.
struct Reversed;
impl Rules for Reversed {
    fn rush(contract: &Contract, speed: f32, time: f32) -> reach::Reach<f32> {
        margin::rush(contract, 15.0 - speed, time)
    }
}

#[test]
fn a_shield_that_fears_the_slow_more_is_found_out_at_a_merge() {
    let gains = |own: f32, other: f32| {
        gains_at_a_merge::<Reversed>([own, 8.0], [other, 2.0], [other, 12.0], 0.0)
    };
    assert!((40..56_u8).any(|own| (5..20_u8).any(|other| gains(own.into(), other.into()))));
}

/// The junction and the contract in units of length that are `factor` times as long.
fn scaled(routes: &[Route<4>], mut contract: Contract, factor: f32) -> (Site, Contract) {
    let far = crate::junction::zone::FAR;
    let scale = |x: &mut f32| {
        if x.abs() < far {
            *x *= factor;
        }
    };
    let long = |route: &Route<4>| {
        let points = route.points().iter().map(|point| *point * factor);
        Route::new(points).unwrap()
    };
    let long: std::vec::Vec<_> = routes.iter().map(long).collect();
    let (mut site, original) = (site(&long), site(routes));
    for (conflict, original) in site
        .conflicts_mut()
        .iter_mut()
        .zip(original.way(EGO).unwrap().conflicts())
    {
        *conflict = *original.1;
        for zone in conflict.zones.iter_mut().flatten() {
            let interval = |i: &mut Span| {
                scale(&mut i.from);
                scale(&mut i.to);
            };
            interval(&mut zone.ego);
            interval(&mut zone.other);
            interval(&mut zone.lead);
        }
    }
    for length in [
        &mut contract.position_error,
        &mut contract.speed_error,
        &mut contract.slack,
        &mut contract.ego.max_speed,
        &mut contract.ego.acceleration,
        &mut contract.ego.go,
        &mut contract.ego.braking,
        &mut contract.ego.emergency,
        &mut contract.other.max_speed,
        &mut contract.other.acceleration,
        &mut contract.other.braking,
        &mut contract.follower.braking,
    ] {
        *length *= factor;
    }
    (site, contract)
}

prop_compose! {
    fn any_vehicle()(bits in any::<[u32; 6]>()) -> Vehicle {
        let [s, speed, x, y, dx, dy] = bits.map(f32::from_bits);
        let pose = Pose { position: Point::new(x, y), direction: unit(dx, dy) };
        Vehicle { s, speed, pose }
    }
}

/// One that is believed, but may be anywhere at any speed.
fn wild() -> impl Strategy<Value = State> {
    let speed = prop_oneof![
        -1.0_f32..100.0,
        Just(0.0_f32),
        Just(-0.0_f32),
        Just(f32::MIN_POSITIVE)
    ];
    (0.0_f32..120.0, speed).prop_map(|(s, speed)| [s, speed])
}

/// A vehicle on path `path`: mostly one that is believed.
fn mixed() -> impl Strategy<Value = Result<State, Vehicle>> {
    prop_oneof![1 => any_vehicle().prop_map(Err), 8 => wild().prop_map(Ok)]
}

fn any_site() -> impl Strategy<Value = std::vec::Vec<Route<4>>> {
    prop_oneof![
        Just(std::vec![east(), north()]),
        Just(std::vec![east(), ramp()]),
        Just(std::vec![east(), north(), ramp()]),
        Just(std::vec![
            east(),
            east(),
            route(&[(60.0, 0.0), (-60.0, 0.0)])
        ]),
    ]
}

/// The vehicle on a path of the site, or what it is instead.
fn placed(site: &Site, path: u8, vehicle: Result<State, Vehicle>) -> Vehicle {
    vehicle.map_or_else(|wrong| wrong, |state| on(site, PathId::new(path), state))
}

fn contract_of(bits: [u32; 17]) -> Contract {
    let mut contract = Contract::ALL_WAY_STOP;
    let numbers = [
        &mut contract.period,
        &mut contract.latency,
        &mut contract.jitter,
        &mut contract.position_error,
        &mut contract.speed_error,
        &mut contract.slack,
        &mut contract.ego.max_speed,
        &mut contract.ego.acceleration,
        &mut contract.ego.go,
        &mut contract.ego.braking,
        &mut contract.ego.emergency,
        &mut contract.other.max_speed,
        &mut contract.other.acceleration,
        &mut contract.other.braking,
        &mut contract.follower.reaction,
        &mut contract.follower.braking,
    ];
    for (number, bits) in numbers.into_iter().zip(bits) {
        // Half of the numbers are in range, a quarter of the rest in any.
        if bits % 2 == 0 {
            *number = f32::from_bits(bits);
        } else if bits % 4 == 1 {
            *number *= (bits >> 2) as f32 / (u32::MAX >> 2) as f32 + f32::MIN_POSITIVE;
        }
    }
    contract
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn whatever_the_bits_the_acceleration_is_admissible(
        routes in any_site(),
        steps in prop::collection::vec((mixed(), prop::collection::vec(
            (mixed(), 0_u8..5, any::<bool>(), 0_u16..3), 0..12), any::<u32>(), 0_u64..400), 1..6),
        precedence in any::<bool>(),
    ) {
        let contract = if precedence { Contract::ALL_WAY_STOP } else { WORST };
        let site = site(&routes);
        let mut shield = Shield::<2>::enter(contract, &site, EGO).unwrap();
        let mut millis = 0;
        for (own, others, proposal, later) in steps {
            let tracks: std::vec::Vec<_> = others
                .into_iter()
                .map(|(vehicle, path, twice, number)| {
                    let known = path % routes.len() as u8;
                    let vehicle = placed(&site, known, vehicle);
                    let track = Track::on(number, PathId::new(if twice { path } else { known }), vehicle);
                    if twice { track.or(PathId::new(1), vehicle.s).unwrap() } else { track }
                })
                .collect();
            let observation = Observation { ego: placed(&site, 0, own), tracks: &tracks };
            millis += later;
            let now = Instant::from_millis(millis);
            let decision = shield.filter(now, &observation, f32::from_bits(proposal));
            prop_assert!((-3.0..=3.0).contains(&decision.acceleration), "{decision:?}");
            prop_assert!(decision.margin.is_finite(), "{decision:?}");
            let unplanned = decision.cause == Cause::Fallback(Fault::NoPlan);
            prop_assert_eq!(unplanned, decision.plan.is_none(), "{:?}", decision);
            prop_assert_eq!(decision.plan, shield.plan());
        }
    }

    #[test]
    fn whatever_the_contract_it_is_refused_or_kept(
        bits in any::<[u32; 17]>(), routes in any_site(), own in wild(), other in wild(), proposal in -5.0_f32..5.0,
    ) {
        if let Ok(contract) = contract_of(bits).to_builder().build() {
            let site = site(&routes);
            let Ok(mut shield) = Shield::<2>::enter(contract, &site, EGO) else { return Ok(()) };
            let tracks = [track(&site, 1, other)];
            let seen = Observation { ego: ego(&site, own), tracks: &tracks };
            let decision = shield.filter(Instant::from_millis(1), &seen, proposal);
            let range = -contract.ego.emergency..=contract.ego.acceleration;
            prop_assert!(range.contains(&decision.acceleration), "{contract:?} {decision:?}");
            prop_assert!(!decision.margin.is_nan(), "{contract:?} {decision:?}");
        }
    }

    /// Units do not matter: with lengths in other units (a power of two, so that nothing is rounded)
    /// the decision is the same.
    #[test]
    fn scaling_all_lengths_scales_the_decision(
        routes in any_site(), own_s in 0.0_f32..70.0, own_v in 0.0_f32..15.0,
        other_s in 0.0_f32..70.0, other_v in 0.0_f32..15.0, proposal in -3.0_f32..3.0,
        doubled in any::<bool>(),
    ) {
        let factor = if doubled { 2.0 } else { 0.25 };
        let (big, contract) = scaled(&routes, WORST, factor);
        let decide = |site: &Site, contract, k: f32| {
            let mut run = Run::new(site, contract);
            run.decide([own_s * k, own_v * k], &[(1, [other_s * k, other_v * k])], proposal * k)
        };
        let (a, b) = (decide(&site(&routes), WORST, 1.0), decide(&big, contract, factor));
        // Leaving a zone in which the ego stands depends on half a metre.
        prop_assume!(a.cause != Cause::Fallback(Fault::NoPlan));
        prop_assert_eq!(a.acceleration * factor, b.acceleration);
        // A margin without a hazard is "far", in any unit.
        prop_assert!(a.margin.abs() > 1e5 || a.margin * factor == b.margin, "{a:?} {b:?}");
    }

    /// Two straight roads at right angles: whichever is the ego's, the decision is the same.
    #[test]
    fn swapping_the_roads_changes_nothing(
        own in [20.0_f32..80.0, 0.0_f32..15.0], other in [20.0_f32..80.0, 0.0_f32..15.0], a in -3.0_f32..3.0,
    ) {
        let swapped = site(&[north(), east()]);
        prop_assert_eq!(margin(&crossing(), own, other, a), margin(&swapped, own, other, a));
    }

    /// Of two vehicles that see each other, at most one may pass a crossing before the other.
    #[test]
    fn two_vehicles_are_never_both_allowed_to_go_first(
        s in 30.0_f32..70.0, v in 0.0_f32..15.0, t in 30.0_f32..70.0, w in 0.0_f32..15.0,
    ) {
        let zone = zone(&crossing(), 1);
        let goes = |s: f32, v: f32, t: f32, w: f32| {
            let departure = margin::departure(&WORST, v, &Inherited::all(&WORST, [0.0; 2]), 3.0);
            let (clears, _) = margin::clearing(&WORST, departure.least, zone.ego.to - s);
            let rush = margin::rush(&WORST, w, clears);
            s < zone.ego.to && t < zone.other.to
                && margin::clears_before(&WORST, zone.other.from - t, rush) >= 0.0
        };
        prop_assert!(!(goes(s, v, t, w) && goes(t, w, s, v)));
    }

    /// A nearer or faster other never makes the shield allow more, until it has left its zone.
    #[test]
    fn a_nearer_or_faster_other_allows_no_more(
        own in [20.0_f32..70.0, 0.0_f32..15.0], other_s in 0.0_f32..60.0,
        other_v in 0.0_f32..15.0, nearer in 0.0_f32..10.0, faster in 0.0_f32..5.0, a in -3.0_f32..3.0,
    ) {
        let site = crossing();
        let base = margin(&site, own, [other_s, other_v], a);
        let end = zone(&site, 1).other.to - 0.01;
        let near = if other_s + nearer < end { other_s + nearer } else { end };
        prop_assert!(margin(&site, own, [near, other_v], a) <= base + 1e-4);
        prop_assert!(margin(&site, own, [other_s, other_v + faster], a) <= base + 1e-4);
    }

    /// Nor does one who comes nearer or faster to a merge, as long as it cannot come to rest ahead of
    /// where the ego would enter: from there on it is a leader, behind whom there is more room the
    /// farther and the faster it is.
    #[test]
    fn a_nearer_or_faster_other_at_a_merge_allows_no_more(
        own in [20.0_f32..70.0, 0.0_f32..15.0], other_s in 0.0_f32..70.0,
        other_v in 0.0_f32..15.0, nearer in 0.0_f32..10.0, faster in 0.0_f32..5.0, a in -3.0_f32..3.0,
    ) {
        let other = [other_s, other_v];
        prop_assert!(!gains_at_a_merge::<Sound>(own, other, [other_s + nearer, other_v], a));
        prop_assert!(!gains_at_a_merge::<Sound>(own, other, [other_s, other_v + faster], a));
    }

    /// Nor does a nearer or slower leader.
    #[test]
    fn a_nearer_or_slower_leader_allows_no_more(
        own_v in 0.0_f32..15.0, gap in 0.0_f32..40.0, leader_v in 0.0_f32..15.0,
        nearer in 0.0_f32..10.0, slower in 0.0_f32..5.0, a in -3.0_f32..3.0,
    ) {
        let site = site(&[east(), east()]);
        let ahead = |gap: f32, v: f32| [15.1 + gap, if v > 0.0 { v } else { 0.0 }];
        let margin = |other| margin(&site, [10.0, own_v], other, a);
        let base = margin(ahead(gap, leader_v));
        let near = if gap > nearer { gap - nearer } else { 0.0 };
        prop_assert!(margin(ahead(near, leader_v)) <= base + 1e-4);
        prop_assert!(margin(ahead(gap, leader_v - slower)) <= base + 1e-4);
    }
}
