//! The shield in closed loop: it keeps vehicles apart, it lets them pass, and each of its rules is needed.
//! rapier2d judges every step, those of the broken shields as well.

use cede_controller::dangerous::{Rules, Sound, unchecked};
use cede_controller::shield::actuation::Inherited;
use cede_controller::shield::margin::{self, Departure};
use cede_controller::shield::reach::Reach;
use cede_controller::{Bounds, Contract, Plan, Zone};
use cede_sim::campaign::{Setup, Tally, campaign, unshielded};

/// One careless shielded vehicle among three adversaries, with exact sensors.
const ADVERSARIES: Setup = Setup::ADVERSARIES;

fn at_rest(contract: Contract) -> Setup {
    Setup {
        at_rest: true,
        steps: 600,
        ..Setup::everyone(contract, 2)
    }
}

fn assert_safe(name: &str, tally: &Tally) {
    assert!(tally.scenarios > 0, "{name}: {tally:?}");
    assert_eq!(tally.overlaps, 0, "{name}: {tally:?}");
    assert_eq!(tally.unverified, 0, "{name}: {tally:?}");
    assert_eq!(tally.false_breaches, 0, "{name}: {tally:?}");
}

#[test]
fn nobody_is_ever_in_a_zone_with_a_shielded_vehicle() {
    for (name, setup) in Setup::all() {
        assert_safe(name, &campaign::<Sound>(setup, 60, 1));
    }
}

/// 10⁷ steps, in some minutes: `cargo test --release -p cede-sim --test shield -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn ten_million_adversarial_steps_without_an_overlap() {
    let setups = Setup::all();
    let (mut seed, mut steps) = (1_000_000, 0);
    while steps < 10_000_000 {
        for (name, setup) in setups {
            let tally = campaign::<Sound>(setup, 1000, seed);
            assert_safe(name, &tally);
            steps += tally.steps;
            seed += 1000;
        }
        println!("{steps} steps");
    }
}

#[test]
fn without_the_shield_there_are_collisions() {
    let tally = unshielded(ADVERSARIES, 60, 1);
    assert!(tally.overlaps > 10, "{tally:?}");
}

#[test]
fn the_same_seed_gives_the_same_tally_on_any_number_of_threads() {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let one = alone
        .unwrap()
        .install(|| campaign::<Sound>(ADVERSARIES, 30, 5));
    assert_eq!(one, campaign::<Sound>(ADVERSARIES, 30, 5));
}

#[test]
fn two_vehicles_at_rest_pass_by_precedence_but_for_a_few_and_may_wait_for_ever_without() {
    let stop = campaign::<Sound>(at_rest(Contract::ALL_WAY_STOP), 100, 9);
    // A shield that begins at rest at its line does not know who rested how long: where neither of the two can
    // move so that it is seen, they wait.
    assert!(stop.cleared + 3 >= stop.scenarios, "{stop:?}");
    let worst = campaign::<Sound>(at_rest(Contract::WORST_CASE), 100, 9);
    assert!(worst.cleared < worst.scenarios, "{worst:?}");
}

/// Of three and more some still block each other for ever; docs/theorem.md says how.
#[test]
fn several_vehicles_at_rest_pass_by_precedence() {
    for (vehicles, stuck) in [(3, 1), (6, 7)] {
        let setup = Setup {
            vehicles,
            ..at_rest(Contract::ALL_WAY_STOP)
        };
        let tally = campaign::<Sound>(setup, 150, 9);
        println!(
            "{vehicles} at rest: {} of {}",
            tally.cleared, tally.scenarios
        );
        assert!(tally.cleared + stuck >= tally.scenarios, "{tally:?}");
    }
}

/// The table of docs/evidence.md: `cargo test --release -p cede-sim --test shield get_through -- --ignored --nocapture`.
#[test]
#[ignore = "prints a table, in some minutes"]
fn how_many_get_through() {
    for vehicles in [2, 3, 4, 6] {
        let at_rest = Setup {
            vehicles,
            ..at_rest(Contract::ALL_WAY_STOP)
        };
        let arriving = Setup {
            steps: 900,
            ..Setup::everyone(Contract::ALL_WAY_STOP, vehicles)
        };
        for (name, setup) in [("from rest", at_rest), ("arriving", arriving)] {
            let runs = [1, 100_001].map(|seed| campaign::<Sound>(setup, 3000, seed));
            let both = runs[0].plus(runs[1]);
            println!("{name}, {vehicles}: {} of {}", both.cleared, both.scenarios);
            assert_safe(name, &both);
        }
    }
}

/// Whether the suite notices that `R` is broken, on set-ups that are safe with the sound rules. Most mistakes show soon.
fn caught<R: Rules>() -> bool {
    let setups = Setup::all();
    let runs = [(60, 1), (1540, 61)]
        .into_iter()
        .flat_map(|(count, seed)| setups.iter().map(move |&(_, setup)| (setup, count, seed)));
    runs.map(|(setup, count, seed)| campaign::<R>(setup, count, seed))
        .any(|tally| tally.overlaps > 0 || tally.unverified > 0)
}

macro_rules! mutant {
    ($test:ident, $name:ident, $($rule:tt)*) => {
        struct $name;
        impl Rules for $name {
            $($rule)*
        }
        #[test]
        fn $test() {
            assert!(caught::<$name>());
        }
    };
}

mutant! { a_margin_of_the_wrong_sign_is_caught, MarginSign,
    fn stops_short(contract: &Contract, limit: f32, rest: f32) -> f32 {
        -margin::stops_short(contract, limit, rest)
    }
}
mutant! { a_zone_that_ends_where_it_begins_is_caught, ZoneEnd,
    fn cleared_at(zone: &Zone) -> f32 {
        zone.ego.from
    }
}
mutant! { an_arrival_time_without_acceleration_is_caught, Coasting,
    fn rush(_: &Contract, speed: f32, time: f32) -> Reach<f32> {
        Reach { distance: speed * time, speed }
    }
}
mutant! { a_zone_given_up_when_the_other_enters_it_is_caught, LeftTooEarly,
    fn left(zone: &Zone, other: f32) -> bool {
        other >= zone.other.from
    }
}
mutant! { a_stale_plan_is_caught, StalePlan,
    fn tail(plan: Plan) -> Plan {
        plan
    }
}
mutant! { a_dropped_latency_is_caught, NoLatency,
    fn departure(contract: &Contract, speed: f32, inherited: &Inherited<f32>, command: f32) -> Departure<f32> {
        let prompt = unchecked(contract.to_builder().latency(0.0));
        margin::departure(&prompt, speed, &Inherited::all(&prompt, inherited.bounds()), command)
    }
}
mutant! { a_stop_without_the_first_period_is_caught, StopsNow,
    fn departure(contract: &Contract, speed: f32, inherited: &Inherited<f32>, command: f32) -> Departure<f32> {
        Departure {
            braking: Reach::start(speed),
            ..margin::departure(contract, speed, inherited, command)
        }
    }
}
mutant! { hazards_in_the_wrong_order_are_caught, WrongOrder,
    fn sooner(a: f32, b: f32) -> bool {
        a > b
    }
}
mutant! { entering_a_lane_without_a_gap_is_caught, NoGap,
    fn safe_gap(_: &Contract, _: f32, _: f32) -> f32 {
        0.0
    }
}
mutant! { a_leader_that_is_trusted_to_brake_gently_is_caught, GentleLeader,
    fn earliest_rest(contract: &Contract, speed: f32) -> f32 {
        2.0 * margin::earliest_rest(contract, speed)
    }
}
mutant! { a_plan_that_forgets_to_stop_after_the_zone_is_caught, RestsWhereItClears,
    fn rest(_: &Contract, from: Reach<f32>, _: f32) -> f32 {
        from.distance
    }
}
mutant! { a_missing_vehicle_that_is_taken_to_stand_still_is_caught, StandsStill,
    fn coast(_: &Contract, bounds: Bounds, _: f32) -> Bounds {
        bounds
    }
}
mutant! { an_ego_that_is_always_taken_for_the_one_ahead_is_caught, AlwaysAhead,
    fn is_ahead(_: &Zone, _: f32) -> bool {
        true
    }
}

struct LeftForgotten;
impl Rules for LeftForgotten {
    fn left(_: &Zone, _: f32) -> bool {
        false
    }
}

#[test]
fn a_zone_whose_clearing_is_forgotten_is_caught_by_who_gets_through() {
    // Before the first has come to the end of its path, where it is taken away.
    let setup = Setup {
        steps: 250,
        ..at_rest(Contract::ALL_WAY_STOP)
    };
    let sound = campaign::<Sound>(setup, 100, 9);
    let forgetful = campaign::<LeftForgotten>(setup, 100, 9);
    assert!(
        forgetful.cleared < sound.cleared,
        "{forgetful:?}, {sound:?}"
    );
}
