//! Properties of the shield on its own: total, dimensionless, symmetric, monotone; and what it says.

use super::*;
use crate::geometry::{Footprint, Point, Pose, unit};
use crate::junction::conflict::RightOfWay;
use crate::junction::route::Route;
use crate::junction::scene::Path;
use crate::junction::zone::Span;
use crate::observation::Vehicle;
use proptest::prelude::*;
use std::format;
use std::string::ToString;

const WORST: Contract = Contract::WORST_CASE;

fn route(points: &[(f32, f32)]) -> Route<4> {
    Route::new(points.iter().map(|&(x, y)| Point::new(x, y))).unwrap()
}

fn path(route: &Route<4>) -> Path<'_, 4> {
    Path {
        route,
        footprint: Footprint::PAPER,
    }
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

fn crossing() -> Scene<2> {
    Scene::new(path(&east()), &[path(&north())]).unwrap()
}

fn vehicle(s: f32, speed: f32) -> Vehicle {
    let pose = Pose {
        position: Point::new(0.0, 0.0),
        direction: unit(1.0, 0.0),
    };
    Vehicle { s, speed, pose }
}

fn seen(ego: Vehicle, other: Vehicle) -> Observation<2> {
    Observation {
        ego,
        others: [Some(other), None],
    }
}

fn margin(scene: &Scene<2>, ego: Vehicle, other: Vehicle, acceleration: f32) -> f32 {
    margin_by::<Sound>(scene, ego, other, acceleration)
}

fn margin_by<R: Rules>(scene: &Scene<2>, ego: Vehicle, other: Vehicle, acceleration: f32) -> f32 {
    let shield = Shield::<2, R>::with_rules(WORST);
    shield
        .margin(scene, &seen(ego, other), 0.0, acceleration)
        .unwrap()
}

#[test]
fn an_intervention_explains_itself() {
    let mut shield = Shield::new(WORST);
    let scene = crossing();
    // 8 m before its zone at 6 m/s; the other 9 m before its own at 6 m/s.
    let decision = shield.filter(&scene, &seen(vehicle(48.46, 6.0), vehicle(47.46, 6.0)), 3.0);
    assert!(decision.acceleration < 3.0 && decision.margin >= 0.0);
    assert_eq!(
        decision.to_string(),
        "shielded: other 0 may arrive in 1.2 s, clearing needs 1.8 s"
    );
}

#[test]
fn good_proposals_pass_unchanged() {
    let mut shield = Shield::new(WORST);
    let far = seen(vehicle(20.0, 8.0), vehicle(0.0, 8.0));
    let decision = shield.filter(&crossing(), &far, 1.23);
    assert_eq!(
        (decision.acceleration, decision.cause),
        (1.23, Cause::Policy)
    );
    assert_eq!(shield.plan(), Some(Plan { go: 0 }));
}

#[test]
fn a_zone_that_the_other_has_left_is_free_for_ever() {
    let scene = crossing();
    assert!(margin(&scene, vehicle(56.0, 3.0), vehicle(63.0, 0.0), 3.0) < 0.0);
    assert!(margin(&scene, vehicle(56.0, 3.0), vehicle(64.0, 0.0), 3.0) >= 0.0);
}

/// What an ego does that goes blind when its only safe plan is to clear a zone: the periods planned, and the
/// commands for as many periods and one more.
fn blind<R: Rules>() -> (usize, std::vec::Vec<f32>) {
    let mut shield = Shield::<2, R>::with_rules(WORST);
    let scene = crossing();
    let fast = seen(vehicle(50.0, 10.0), vehicle(10.0, 5.0));
    assert_eq!(shield.filter(&scene, &fast, 3.0).cause, Cause::Policy);
    let periods = usize::from(shield.plan().unwrap().go);
    let nothing = seen(vehicle(f32::NAN, 0.0), vehicle(0.0, 0.0));
    let commands = (0..=periods).map(|_| {
        let decision = shield.filter(&scene, &nothing, 0.0);
        assert_eq!(decision.cause, Cause::Fallback(Fault::Ego));
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
    let scene = Scene::<2>::new(path(&east()), &[path(&north()), path(&second)]).unwrap();
    let seen = Observation {
        ego: vehicle(54.0, 5.0),
        others: [Some(vehicle(0.0, 5.0)), Some(vehicle(60.0, 0.0))],
    };
    let margin = |shield: Result<f32, Fault>| shield.unwrap();
    let sound = Shield::<2>::new(WORST);
    assert!(margin(sound.margin(&scene, &seen, 0.0, 0.0)) >= 0.0);
    let wrong = Shield::<2, FarthestFirst>::with_rules(WORST);
    assert!(margin(wrong.margin(&scene, &seen, 0.0, 0.0)) < 0.0);
}

#[test]
fn a_broken_contract_is_reported_and_the_plan_is_void() {
    let mut shield = Shield::new(WORST);
    let scene = crossing();
    shield.filter(&scene, &seen(vehicle(50.0, 10.0), vehicle(10.0, 5.0)), 3.0);
    // The other jumps to its zone; the ego can neither stop nor clear.
    let jumped = seen(vehicle(51.0, 10.0), vehicle(56.0, 5.0));
    let decision = shield.filter(&scene, &jumped, 3.0);
    assert_eq!(decision.breach, Some(crate::decision::Breach::Other(0)));
    assert_eq!(decision.cause, Cause::Fallback(Fault::Unverified));
    assert_eq!((decision.acceleration, shield.plan()), (-3.0, None));
    // Recovery: as soon as a plan is safe again, everything is as it was.
    let gone = seen(vehicle(52.0, 9.7), vehicle(64.0, 5.0));
    let decision = shield.filter(&scene, &gone, 1.0);
    assert_eq!(decision.cause, Cause::Policy);
    assert!(shield.plan().is_some());
}

#[test]
fn a_speed_limiter_breaks_no_contract() {
    let mut shield = Shield::new(WORST);
    let scene = crossing();
    let mut breach = |s, speed| {
        let decision = shield.filter(&scene, &seen(vehicle(s, speed), vehicle(0.0, 0.0)), 3.0);
        decision.breach
    };
    for (s, speed) in [(0.0, 14.8), (1.489, 14.99), (2.989, 15.0)] {
        assert_eq!(breach(s, speed), None, "{speed} m/s");
    }
    let too_slow = breach(4.484, 14.9);
    assert_eq!(too_slow, Some(crate::decision::Breach::Ego));
}

#[test]
fn what_the_ego_gets_through_at_least_knows_of_its_speed_limiter() {
    let least = |max_speed| {
        let mut contract = WORST;
        contract.ego.max_speed = max_speed;
        let departure = margin::departure(&contract, 14.9, [3.0; 2], 3.0);
        (departure.least.speed, departure.most.speed)
    };
    let (limited, fastest) = least(15.0);
    assert_eq!(limited, 15.0);
    assert!(fastest > 15.4, "whether it is limited is not relied on");
    assert!(
        least(100.0).0 > 15.4,
        "the limit is what makes the difference"
    );
}

#[test]
fn an_ego_that_stands_in_a_zone_gets_out_of_it() {
    let mut shield = Shield::new(WORST);
    let (inside, scene) = (vehicle(60.0, 0.0), crossing());
    let decision = shield.filter(&scene, &seen(inside, vehicle(54.0, 5.0)), 0.0);
    assert_eq!(decision.cause, Cause::Fallback(Fault::Unverified));
    assert_eq!(decision.acceleration, 3.0);
    let mut shield = Shield::new(WORST);
    let decision = shield.filter(&scene, &seen(inside, vehicle(58.0, 0.0)), 0.0);
    assert_eq!(
        decision.acceleration, -3.0,
        "the other is in its zone as well"
    );
}

#[test]
fn behind_a_leader_the_ego_can_always_stop() {
    let scene = Scene::<2>::new(path(&east()), &[path(&east())]).unwrap();
    // 10 m/s: 16.7 m to stop, and the latency; the leader, 5 m long, stops within 6.25 m at 8 m/s².
    let accepts =
        |gap: f32, a| margin(&scene, vehicle(0.0, 10.0), vehicle(gap + 5.0, 10.0), a) >= 0.0;
    assert!(accepts(14.0, -3.0) && !accepts(11.0, -3.0));
    assert!(accepts(14.0, 0.0) && !accepts(13.0, 3.0));
}

/// Precedence was once granted at any distance: the ego then ran into one that had entered the lane ahead
/// of it, with a safe gap, and braked there.
#[test]
fn precedence_into_a_lane_is_granted_only_where_the_other_cannot_enter_ahead() {
    let contract = Contract::ALL_WAY_STOP;
    let scene = Scene::<2>::new(path(&east()), &[path(&ramp())]).unwrap();
    let zone = *scene.conflicts()[0].zones().next().unwrap();
    let mut claims = Claims::default();
    claims.0[0] = u8::MAX;
    let passage = |ego: f32| {
        let seen = seen(vehicle(ego, 0.0), vehicle(zone.other.from - 1.0, 0.0));
        let mut hazards = Hazards::new();
        hazards.add::<2, Sound>(&contract, &scene, &seen, claims);
        hazards.iter().next().map(|hazard| hazard.passage)
    };
    let line = zone.other.from + zone.lead.from;
    assert!(line < zone.ego.from);
    assert!(matches!(passage(line - 0.1), Some(Passage::Ahead { .. })));
    assert_eq!(passage(line + 0.1), None);
}

/// Once the ego had to clear also the zones in which it had precedence: it waited before a crossing
/// for a lane behind it to become free, and others waited for it.
#[test]
fn an_ego_with_precedence_may_wait_in_the_zone() {
    let scene = Scene::<2>::new(path(&east()), &[path(&north())]).unwrap();
    let zone = *scene.conflicts()[0].zones().next().unwrap();
    let inside = seen(
        vehicle(zone.ego.from + 2.0, 0.0),
        vehicle(zone.other.from - 0.1, 0.0),
    );
    let mut claims = Claims::default();
    claims.0[0] = u8::MAX;
    let mut hazards = Hazards::new();
    hazards.add::<2, Sound>(&Contract::ALL_WAY_STOP, &scene, &inside, claims);
    assert_eq!(hazards.iter().count(), 0);
    hazards.add::<2, Sound>(&WORST, &scene, &inside, Claims::default());
    assert_eq!(hazards.iter().count(), 1);
}

/// Where the ego, 5 m before two crossings that overlap, has to stop for the second other, by the right of way over it, if
/// it has precedence over the first; and where the two zones begin.
fn stops_for(right_of_way: RightOfWay) -> (f32, [f32; 2]) {
    let others = [north(), route(&[(2.0, -60.0), (2.0, 60.0)])];
    let mut scene = Scene::<2>::new(path(&east()), &others.each_ref().map(path)).unwrap();
    scene.set_right_of_way(1, right_of_way);
    let zone = |i: usize| *scene.conflicts()[i].zones().next().unwrap();
    let ego = vehicle(zone(0).ego.from - 5.0, 0.0);
    let others = [0, 1].map(|i| Some(vehicle(zone(i).other.from - 0.1, 0.0)));
    let mut claims = Claims::default();
    claims.0[0] = u8::MAX;
    let mut hazards = Hazards::new();
    let seen = Observation { ego, others };
    hazards.add::<2, Sound>(&Contract::ALL_WAY_STOP, &scene, &seen, claims);
    let limit = hazards.nearest_limit();
    (limit, [0, 1].map(|i| zone(i).ego.from - ego.s))
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
fn gains_at_a_merge<R: Rules>(ego: Vehicle, other: Vehicle, worse: Vehicle, a: f32) -> bool {
    let scene = Scene::<2>::new(path(&east()), &[path(&ramp())]).unwrap();
    let zone = *scene.conflicts()[0].zones().next().unwrap();
    assert!(zone.is_lane());
    let rests = worse.s + margin::earliest_rest(&WORST, worse.speed) + zone.lead.from;
    let [before, after] = [other, worse].map(|other| margin_by::<R>(&scene, ego, other, a));
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
    let ego = vehicle(54.0, 8.0);
    let gains = gains_at_a_merge::<Reversed>(ego, vehicle(20.0, 2.0), vehicle(20.0, 12.0), 0.0);
    assert!(gains);
}

/// The scene and the contract in units of length that are `factor` times as long.
fn scaled(mut scene: Scene<2>, mut contract: Contract, factor: f32) -> (Scene<2>, Contract) {
    let far = crate::junction::zone::FAR;
    let scale = |x: &mut f32| {
        if x.abs() < far {
            *x *= factor;
        }
    };
    for conflict in scene.conflicts_mut() {
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
        &mut contract.other.max_speed,
        &mut contract.other.acceleration,
        &mut contract.other.braking,
        &mut contract.follower.braking,
    ] {
        *length *= factor;
    }
    (scene, contract)
}

prop_compose! {
    fn any_vehicle()(bits in any::<[u32; 6]>()) -> Vehicle {
        let [s, speed, x, y, dx, dy] = bits.map(f32::from_bits);
        let pose = Pose { position: Point::new(x, y), direction: unit(dx, dy) };
        Vehicle { s, speed, pose }
    }
}

prop_compose! {
    /// One that is believed, but may be anywhere at any speed.
    fn wild_vehicle()(
        s in prop_oneof![-16_384.0_f32..16_384.0, -10.0_f32..130.0],
        speed in prop_oneof![-1.0_f32..100.0, Just(0.0_f32), Just(-0.0_f32), Just(f32::MIN_POSITIVE)],
    ) -> Vehicle {
        vehicle(s, speed)
    }
}

fn mixed_vehicle() -> impl Strategy<Value = Vehicle> {
    prop_oneof![1 => any_vehicle(), 8 => wild_vehicle()]
}

fn any_scene() -> impl Strategy<Value = Scene<2>> {
    let meet = |others: &[Route<4>]| {
        let others: std::vec::Vec<_> = others.iter().map(path).collect();
        Scene::new(path(&east()), &others).unwrap()
    };
    prop_oneof![
        Just(meet(&[north()])),
        Just(meet(&[ramp()])),
        Just(meet(&[north(), ramp()])),
        Just(meet(&[east(), route(&[(60.0, 0.0), (-60.0, 0.0)])])),
    ]
}

fn contract_of(bits: [u32; 16]) -> Contract {
    let mut contract = Contract::ALL_WAY_STOP;
    let numbers = [
        &mut contract.period,
        &mut contract.latency,
        &mut contract.position_error,
        &mut contract.speed_error,
        &mut contract.slack,
        &mut contract.ego.max_speed,
        &mut contract.ego.acceleration,
        &mut contract.ego.go,
        &mut contract.ego.braking,
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
        scene in any_scene(),
        steps in prop::collection::vec((mixed_vehicle(), prop::option::of(mixed_vehicle()),
            prop::option::of(mixed_vehicle()), any::<u32>()), 1..6),
        precedence in any::<bool>(),
    ) {
        let contract = if precedence { Contract::ALL_WAY_STOP } else { WORST };
        let mut shield = Shield::<2>::new(contract);
        for (ego, a, b, proposal) in steps {
            let observation = Observation { ego, others: [a, b] };
            let decision = shield.filter(&scene, &observation, f32::from_bits(proposal));
            prop_assert!((-3.0..=3.0).contains(&decision.acceleration), "{decision:?}");
            prop_assert!(decision.margin.is_finite(), "{decision:?}");
            prop_assert!(!format!("{decision}").contains("NaN"), "{decision}");
        }
    }

    #[test]
    fn whatever_the_contract_it_is_refused_or_kept(
        bits in any::<[u32; 16]>(), scene in any_scene(),
        ego in wild_vehicle(), other in wild_vehicle(), proposal in -5.0_f32..5.0,
    ) {
        if let Ok(contract) = contract_of(bits).to_builder().build() {
            let mut shield = Shield::<2>::new(contract);
            let decision = shield.filter(&scene, &seen(ego, other), proposal);
            let range = -contract.ego.braking..=contract.ego.acceleration;
            prop_assert!(range.contains(&decision.acceleration), "{contract:?} {decision:?}");
            prop_assert!(!decision.margin.is_nan(), "{contract:?} {decision:?}");
        }
    }

    /// Units do not matter: with lengths in other units (a power of two, so that nothing is rounded)
    /// the decision is the same.
    #[test]
    fn scaling_all_lengths_scales_the_decision(
        scene in any_scene(), ego_s in 0.0_f32..70.0, ego_v in 0.0_f32..15.0,
        other_s in 0.0_f32..70.0, other_v in 0.0_f32..15.0, proposal in -3.0_f32..3.0,
        doubled in any::<bool>(),
    ) {
        let factor = if doubled { 2.0 } else { 0.25 };
        let (big, contract) = scaled(scene.clone(), WORST, factor);
        let decide = |scene: &Scene<2>, contract, k: f32| {
            let mut shield = Shield::<2>::new(contract);
            let observation = seen(vehicle(ego_s * k, ego_v * k), vehicle(other_s * k, other_v * k));
            shield.filter(scene, &observation, proposal * k)
        };
        let (a, b) = (decide(&scene, WORST, 1.0), decide(&big, contract, factor));
        // Leaving a zone in which the ego stands depends on half a metre.
        prop_assume!(a.cause != Cause::Fallback(Fault::Unverified));
        prop_assert_eq!(a.acceleration * factor, b.acceleration);
        // A margin without a hazard is "far", in any unit.
        prop_assert!(a.margin.abs() > 1e5 || a.margin * factor == b.margin, "{a:?} {b:?}");
    }

    /// Two straight roads at right angles: whichever is the ego's, the decision is the same.
    #[test]
    fn swapping_the_roads_changes_nothing(
        ego_s in 20.0_f32..80.0, ego_v in 0.0_f32..15.0,
        other_s in 20.0_f32..80.0, other_v in 0.0_f32..15.0, a in -3.0_f32..3.0,
    ) {
        let swapped = Scene::new(path(&north()), &[path(&east())]).unwrap();
        let (ego, other) = (vehicle(ego_s, ego_v), vehicle(other_s, other_v));
        prop_assert_eq!(margin(&crossing(), ego, other, a), margin(&swapped, ego, other, a));
    }

    /// Of two vehicles that see each other, at most one may pass a crossing before the other.
    #[test]
    fn two_vehicles_are_never_both_allowed_to_go_first(
        s in 30.0_f32..70.0, v in 0.0_f32..15.0, t in 30.0_f32..70.0, w in 0.0_f32..15.0,
    ) {
        let scene = crossing();
        let zone = *scene.conflicts()[0].zones().next().unwrap();
        let goes = |s: f32, v: f32, t: f32, w: f32| {
            let departure = margin::departure(&WORST, v, [0.0; 2], 3.0);
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
        ego_s in 20.0_f32..70.0, ego_v in 0.0_f32..15.0, other_s in 0.0_f32..60.0,
        other_v in 0.0_f32..15.0, nearer in 0.0_f32..10.0, faster in 0.0_f32..5.0, a in -3.0_f32..3.0,
    ) {
        let scene = crossing();
        let ego = vehicle(ego_s, ego_v);
        let base = margin(&scene, ego, vehicle(other_s, other_v), a);
        let end = scene.conflicts()[0].zones().next().unwrap().other.to - 0.01;
        let near = if other_s + nearer < end { other_s + nearer } else { end };
        prop_assert!(margin(&scene, ego, vehicle(near, other_v), a) <= base + 1e-4);
        prop_assert!(margin(&scene, ego, vehicle(other_s, other_v + faster), a) <= base + 1e-4);
    }

    /// Nor does one who comes nearer or faster to a merge, as long as it cannot come to rest ahead of
    /// where the ego would enter: from there on it is a leader, behind whom there is more room the
    /// farther and the faster it is.
    #[test]
    fn a_nearer_or_faster_other_at_a_merge_allows_no_more(
        ego_s in 20.0_f32..70.0, ego_v in 0.0_f32..15.0, other_s in 0.0_f32..70.0,
        other_v in 0.0_f32..15.0, nearer in 0.0_f32..10.0, faster in 0.0_f32..5.0, a in -3.0_f32..3.0,
    ) {
        let (ego, other) = (vehicle(ego_s, ego_v), vehicle(other_s, other_v));
        prop_assert!(!gains_at_a_merge::<Sound>(ego, other, vehicle(other_s + nearer, other_v), a));
        prop_assert!(!gains_at_a_merge::<Sound>(ego, other, vehicle(other_s, other_v + faster), a));
    }

    /// Nor does a nearer or slower leader.
    #[test]
    fn a_nearer_or_slower_leader_allows_no_more(
        ego_v in 0.0_f32..15.0, gap in 0.0_f32..40.0, leader_v in 0.0_f32..15.0,
        nearer in 0.0_f32..10.0, slower in 0.0_f32..5.0, a in -3.0_f32..3.0,
    ) {
        let scene = Scene::<2>::new(path(&east()), &[path(&east())]).unwrap();
        let ego = vehicle(10.0, ego_v);
        let ahead = |gap: f32, v: f32| vehicle(15.1 + gap, if v > 0.0 { v } else { 0.0 });
        let base = margin(&scene, ego, ahead(gap, leader_v), a);
        let near = if gap > nearer { gap - nearer } else { 0.0 };
        prop_assert!(margin(&scene, ego, ahead(near, leader_v), a) <= base + 1e-4);
        prop_assert!(margin(&scene, ego, ahead(gap, leader_v - slower), a) <= base + 1e-4);
    }
}
