//! The bound against single executions, the predicates against the shield, and bounds that must not be shown.

use super::predicate::{INPUTS, Input, Predicate, Region};
use super::rounded::Rounded;
use super::{bound, shortfall};
use crate::interval::Interval;
use cede_controller::Real;
use cede_controller::dangerous::unchecked;
use cede_controller::junction::PACE;
use cede_controller::junction::zone::{FAR, Zone};
use cede_controller::shield::actuation::Inherited;
use cede_controller::shield::{Contract, Shield, choice, margin};
use cede_controller::{
    Class, Footprint, Junction, Observation, PathId, Point, Route, Track, Vehicle,
};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const WORST: Contract = Contract::WORST_CASE;
const SENSED: Contract = match Contract::builder()
    .position_error(0.3)
    .speed_error(0.3)
    .build()
{
    Ok(contract) => contract,
    Err(_) => panic!("a number is out of its range"),
};

/// How far `computed` is from the real number in `exact`, at least.
fn distance(computed: f32, exact: Interval) -> f64 {
    let computed = f64::from(computed);
    (exact.lo - computed).max(computed - exact.hi).max(0.0)
}

fn point(value: f32) -> Interval {
    Interval::point(value.into())
}

/// An operation on what there is so far and another number.
#[derive(Clone, Copy, Debug)]
enum Step {
    Add,
    Sub,
    From,
    Mul,
    Div,
    Root,
    Square,
    Min,
    Max,
}

const STEPS: [Step; 9] = [
    Step::Add,
    Step::Sub,
    Step::From,
    Step::Mul,
    Step::Div,
    Step::Root,
    Step::Square,
    Step::Min,
    Step::Max,
];

impl Step {
    fn apply<R: Real>(self, x: R, y: R) -> R {
        match self {
            Self::Add => x + y,
            Self::Sub => x - y,
            Self::From => y - x,
            Self::Mul => x * y,
            Self::Div => x / (y * y).max(R::of(1e-3)),
            Self::Root => x.max(R::of(0.0)).sqrt(),
            Self::Square => x * x + y,
            Self::Min => Real::min(x, y),
            Self::Max => Real::max(x, y),
        }
    }
}

/// Numbers of every size, subnormal ones and simple ones among them.
fn numbers() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -300.0_f32..300.0,
        1 => prop::num::f32::SUBNORMAL,
        1 => (-1e-3_f32..1e-3).prop_map(|x| x * x * x),
        1 => prop::sample::select(vec![0.0, 0.5, 1.0, 3.0, -2.0, f32::MIN_POSITIVE]),
    ]
}

/// A box around a number, from a point to a wide one.
fn around(at: f32, share: (f32, f32)) -> [f32; 2] {
    let width = at.abs() + 1e-3;
    [at - share.0 * width, at + share.1 * width]
}

fn shares() -> impl Strategy<Value = (f32, f32)> {
    prop_oneof![
        Just((0.0, 0.0)),
        (0.0_f32..1e-6, 0.0_f32..1e-6),
        (0.0_f32..0.5, 0.0_f32..0.5)
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn operations_stay_within_the_bound(
        start in numbers(),
        steps in prop::collection::vec((prop::sample::select(STEPS.to_vec()), numbers()), 1..6),
        share in shares(),
    ) {
        let mut computed = start;
        let mut exact = point(start);
        let mut bounded = Rounded::input(around(start, share));
        for (step, number) in steps {
            computed = step.apply(computed, number);
            exact = step.apply(exact, point(number));
            bounded = step.apply(bounded, Rounded::input(around(number, share)));
        }
        prop_assert!(distance(computed, exact) <= bounded.error, "{computed} {exact:?} {bounded:?}");
        prop_assert!(bounded.exact.meets(exact));
    }

    #[test]
    fn margins_stay_within_the_bound(
        number in 0..Predicate::ALL.len(),
        sensed in any::<bool>(),
        shares in prop::array::uniform6(0.0_f32..=1.0),
        width in shares(),
        near in prop::option::of(-3_i32..=3),
    ) {
        let predicate = Predicate::ALL[number];
        let contract = if sensed { SENSED } else { WORST };
        let domain = predicate.domain(&contract);
        let mut at = [0.0; INPUTS];
        for ((at, [lo, hi]), share) in at.iter_mut().zip(domain).zip(shares) {
            *at = lo + share * (hi - lo);
        }
        if let Some(steps) = near {
            stand_at_the_target(&contract, &mut at, steps);
        }
        let region: Region = std::array::from_fn(|i| {
            let [lo, hi] = around(at[i], width);
            [lo.max(domain[i][0]).min(at[i]), hi.min(domain[i][1]).max(at[i])]
        });
        let computed = predicate.margin(&contract, at);
        let exact = predicate.margin(&contract, at.map(point));
        let bounded = predicate.margin(&contract, region.map(Rounded::input));
        // A box may be too wide to show that a root has no negative argument; a point never is.
        prop_assert!(bounded.error.is_finite() || width != (0.0, 0.0));
        prop_assert!(distance(computed, exact) <= bounded.error, "{computed} {exact:?} {bounded:?}");
        prop_assert!(bounded.exact.meets(exact));
    }

    #[test]
    fn the_predicates_at_a_crossing_are_the_shields(
        s in 0.0_f32..60.0, speed in 0.0_f32..20.0, other in 0.0_f32..60.0, other_speed in 0.0_f32..15.0,
        previous in -3.0_f32..3.0, command in -3.0_f32..3.0,
    ) {
        let (ego, road) = (route(&[(-60.0, 0.0), (60.0, 0.0)]), route(&[(0.0, -60.0), (0.0, 60.0)]));
        let [zone] = zones(&ego, &road, Class::Car)[..] else { panic!("one zone") };
        prop_assume!(s < zone.ego.to && other < zone.other.to);
        let command = command.min(choice::most(&WORST, speed, previous));
        let given = |distance, fifth, target| [speed, previous, command, distance, fifth, target];
        let target = zone.ego.to - s;
        let stops = Predicate::Stops.margin(&WORST, given(zone.ego.from - s, 0.0, 0.0));
        let crosses = Predicate::Crosses.margin(&WORST, given(zone.other.from - other, other_speed, target));
        let beyond = Predicate::StopsAfterGoing.margin(&WORST, given(FAR, periods(&given(0.0, 0.0, target)), 0.0));
        let shield = shield_margin(&ego, (&road, Class::Car), (s, speed), (other, other_speed), [previous, command]);
        prop_assert_eq!(Real::max(stops, Real::min(crosses, beyond)), shield);
    }

    #[test]
    fn the_predicate_at_a_pedestrians_crossing_is_the_shields(
        s in 0.0_f32..60.0, speed in 0.0_f32..20.0, other in 0.0_f32..120.0, walking in 0.0_f32..3.0,
        previous in -3.0_f32..3.0, command in -3.0_f32..3.0,
    ) {
        let (ego, crossing) = (route(&[(-60.0, 0.0), (60.0, 0.0)]), route(&[(0.0, -60.0), (0.0, 60.0)]));
        let [zone] = zones(&ego, &crossing, Class::Pedestrian)[..] else { panic!("one zone") };
        prop_assume!(s < zone.ego.to);
        let command = command.min(choice::most(&WORST, speed, previous));
        let given = |distance, fifth, target| [speed, previous, command, distance, fifth, target];
        let target = zone.ego.to - s;
        let stops = Predicate::Stops.margin(&WORST, given(zone.ego.from - s, 0.0, 0.0));
        let away = Real::max(zone.other.from - other, other - zone.other.to);
        let crosses = Predicate::CrossesBeforeWalker.margin(&WORST, given(away, PACE, target));
        let beyond = Predicate::StopsAfterGoing.margin(&WORST, given(FAR, periods(&given(0.0, 0.0, target)), 0.0));
        let crossing = (&crossing, Class::Pedestrian);
        let shield = shield_margin(&ego, crossing, (s, speed), (other, walking), [previous, command]);
        prop_assert_eq!(Real::max(stops, Real::min(crosses, beyond)), shield);
    }

    #[test]
    fn the_predicates_at_a_lane_are_the_shields(
        s in 0.0_f32..55.0, speed in 0.0_f32..20.0, other in 0.0_f32..100.0, other_speed in 0.0_f32..15.0,
        previous in -3.0_f32..3.0, command in -3.0_f32..3.0,
    ) {
        let ego = route(&[(-50.0, -40.0), (0.0, 0.0), (60.0, 0.0)]);
        let road = route(&[(-60.0, 0.0), (60.0, 0.0)]);
        let [zone] = zones(&ego, &road, Class::Car)[..] else { panic!("one zone") };
        prop_assume!(zone.is_lane() && s < zone.ego.from && other < zone.other.to);
        let command = command.min(choice::most(&WORST, speed, previous));
        let given = |distance, fifth, target| [speed, previous, command, distance, fifth, target];
        let stop = zone.ego.from - s;
        let gap = zone.lead.from - (s - other);
        let behind = if gap < 0.0 { gap } else { gap + margin::earliest_rest(&WORST, other_speed) };
        let expected = if behind > stop {
            Predicate::StopsBehind.margin(&WORST, given(gap, other_speed, 0.0))
        } else {
            let ahead = zone.ego.from - other - zone.lead.to;
            let enters = Predicate::EntersAhead.margin(&WORST, given(ahead, other_speed, stop));
            let beyond = Predicate::StopsAfterGoing.margin(&WORST, given(FAR, periods(&given(0.0, 0.0, stop)), 0.0));
            Real::max(Predicate::Stops.margin(&WORST, given(stop, 0.0, 0.0)), Real::min(enters, beyond))
        };
        let shield = shield_margin(&ego, (&road, Class::Car), (s, speed), (other, other_speed), [previous, command]);
        prop_assert_eq!(expected, shield);
    }
}

/// Moves the target to where the command leaves the ego, but for a few units in the last place: the
/// root that gives the time is near zero if the ego is then at rest.
fn stand_at_the_target(contract: &Contract, at: &mut [f32; INPUTS], steps: i32) {
    let [speed, previous, command, ..] = at;
    *speed *= 0.05;
    let least = margin::departure(
        contract,
        *speed,
        &Inherited::all(contract, [*previous; 2]),
        *command,
    )
    .least;
    at[5] = f32::from_bits(least.distance.to_bits().saturating_add_signed(steps));
}

/// For how many periods the plan goes that clears a hazard.
fn periods([speed, previous, command, _, _, target]: &[f32; INPUTS]) -> f32 {
    let departure = margin::departure(
        &WORST,
        *speed,
        &Inherited::all(&WORST, [*previous; 2]),
        *command,
    );
    let (clears, _) = margin::clearing(&WORST, departure.least, *target);
    margin::periods(&WORST, clears).into()
}

fn route(points: &[(f32, f32)]) -> Route<4> {
    Route::new(points.iter().map(|&(x, y)| Point::new(x, y))).unwrap()
}

const EGO: PathId = PathId::new(0);
const ROAD: PathId = PathId::new(1);

fn junction(ego: &Route<4>, road: &Route<4>, class: Class) -> Junction<2, 8> {
    let mut builder = Junction::builder();
    builder.tolerance(0.0);
    for (route, class) in [(ego, Class::Car), (road, class)] {
        builder.path(route, class, Footprint::PAPER).unwrap();
    }
    builder.build().unwrap()
}

fn zones(ego: &Route<4>, road: &Route<4>, class: Class) -> Vec<Zone> {
    let junction = junction(ego, road, class);
    let conflict = junction.conflict(EGO, ROAD).unwrap();
    conflict.zones().copied().collect()
}

fn shield_margin(
    ego: &Route<4>,
    (road, class): (&Route<4>, Class),
    own: (f32, f32),
    other: (f32, f32),
    [previous, command]: [f32; 2],
) -> f32 {
    let vehicle = |route: &Route<4>, (s, speed)| Vehicle {
        s,
        speed,
        pose: route.pose(s),
    };
    let seen = Observation {
        ego: vehicle(ego, own),
        tracks: &[Track::on(1, ROAD, vehicle(road, other)).class(class)],
    };
    let junction = junction(ego, road, class);
    let shield = Shield::<1>::enter(WORST, &junction, EGO).unwrap();
    shield.margin(&seen, previous, command).unwrap()
}

#[test]
fn every_unit_in_the_last_place_is_needed() {
    // Operands without an error: what the bound allows is the operation's own rounding, and it is reached.
    for step in [Step::Add, Step::Mul, Step::Div, Step::Root, Step::Square] {
        let mut share: f64 = 0.0;
        for i in 1..2_000_u16 {
            let (x, y) = (1.0 + f32::from(i) * 7.3e-5, 1.7 + f32::from(i) * 1.9e-4);
            let bounded = step.apply(Rounded::of(x), Rounded::of(y));
            let exact = step.apply(point(x), point(y));
            share = share.max(distance(step.apply(x, y), exact) / bounded.error);
        }
        assert!((0.5..=1.0).contains(&share), "{step:?}: {share}");
    }
}

#[test]
fn the_slack_covers_rounding() {
    for predicate in [
        Predicate::Stops,
        Predicate::StopsBehind,
        Predicate::StopsAfterGoing,
        Predicate::Crosses,
        Predicate::CrossesBeforeWalker,
    ] {
        for contract in [WORST, SENSED] {
            let bound = bound(predicate, &contract, 200_000);
            assert!(
                bound.covered_by(contract.slack()),
                "{predicate:?}: {bound:?}"
            );
            assert!(bound.seen <= bound.error && 0.0 < bound.seen);
        }
    }
    assert!(shortfall(&WORST) < 1e-5);
}

#[test]
fn no_slack_covers_nothing_and_the_box_is_named() {
    let contract = unchecked(Contract::builder().slack(0.0));
    for predicate in Predicate::ALL {
        let bound = bound(predicate, &contract, 5_000);
        assert!(!bound.covered_by(contract.slack()));
        let (worst, domain) = (bound.worst, predicate.domain(&contract));
        assert!(
            worst
                .iter()
                .zip(domain)
                .all(|(w, d)| d[0] <= w[0] && w[0] <= w[1] && w[1] <= d[1])
        );
        assert_ne!(worst, domain);
    }
}

/// A passenger car: `contracts/passenger-car.toml`.
const INEXACT: Contract = match SENSED
    .to_builder()
    .latency(0.2)
    .jitter(0.003)
    .ego_acceleration(2.4)
    .ego_go(1.5)
    .ego_braking(5.0)
    .ego_emergency(7.0)
    .ego_lag(0.2)
    .ego_gain(0.1)
    .ego_disturbance(0.3)
    .other_max_speed(16.0)
    .other_braking(9.0)
    .follower_reaction(1.0)
    .build()
{
    Ok(contract) => contract,
    Err(_) => panic!("a number is out of its range"),
};

/// Boxes without a bound are cut until they have one.
#[test]
fn a_drivetrain_that_is_not_exact_has_a_bound() {
    for predicate in Predicate::ALL {
        let bound = bound(predicate, &INEXACT, 100_000);
        assert!(bound.error < 1.0, "{predicate:?}: {bound:?}");
    }
}

#[test]
fn the_same_on_any_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| bound(Predicate::EntersAhead, &SENSED, 20_000))
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn without_end_is_far_enough() {
    // Where nothing stands in the way the shield says yes, rightly; `FAR` behind, it says no.
    for predicate in Predicate::ALL {
        let inputs = predicate.inputs();
        let distance = inputs.iter().position(|&i| i == Input::Distance);
        let distance = distance.unwrap();
        for contract in [WORST, SENSED] {
            for speed in 0..20_u8 {
                let mut region = predicate.domain(&contract);
                region[0] = [f32::from(speed), f32::from(speed + 1)];
                region[distance] = [FAR; 2];
                let ahead = predicate.margin(&contract, region.map(Rounded::input));
                assert!(ahead.exact.lo > 0.0, "{predicate:?}");
                region[distance] = [-FAR; 2];
                let behind = predicate.margin(&contract, region.map(Rounded::input));
                assert!(behind.exact.hi + behind.error < 0.0, "{predicate:?}");
            }
        }
    }
}

/// The largest difference (m) met in so many draws of an ego that comes to rest at its very target, or next to it:
/// the largest there are, as far as is known, because the time to the target is a root near zero.
fn felt(predicate: Predicate, contract: &Contract, draws: u32) -> f64 {
    let mut rng = Pcg64::seed_from_u64(1);
    let ranges = [
        0.0..20.0,
        -3.0..3.0,
        -3.0..3.0,
        0.0..50.0,
        8.0..20.0,
        0.0..1.0,
    ];
    let mut difference = |_| {
        let mut at: [f32; INPUTS] = ranges.clone().map(|range| rng.random_range(range));
        stand_at_the_target(contract, &mut at, rng.random_range(-3..=3));
        let exact = predicate.margin(contract, at.map(point));
        distance(predicate.margin(contract, at), exact)
    };
    (0..draws).map(&mut difference).fold(0.0, f64::max)
}

const FELT_MOST: [(Predicate, f64); 2] = [
    (Predicate::Crosses, 3.8e-3),
    (Predicate::EntersAhead, 7.5e-3),
];

#[test]
fn an_ego_at_rest_at_its_target_feels_rounding_most() {
    for (predicate, most) in FELT_MOST {
        let met = felt(predicate, &WORST, 300_000);
        assert!((1e-3..most).contains(&met), "{predicate:?}: {met}");
    }
}

/// `cargo test --release -p cede-verify --lib felt -- --ignored --nocapture`.
#[test]
#[ignore = "takes a minute"]
fn how_much_rounding_is_felt() {
    for contract in [WORST, SENSED] {
        for (predicate, most) in FELT_MOST {
            let met = felt(predicate, &contract, 20_000_000);
            println!("{}: {:.2} mm", predicate.name(), 1e3 * met);
            assert!(met < most, "{predicate:?}: {met}");
        }
    }
}
