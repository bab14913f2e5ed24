//! A shield in which a single rule is broken is caught, whichever rule it is.

use cede_controller::dangerous::Rules;
use cede_controller::shield::actuation::Inherited;
use cede_controller::shield::{Bounds, margin, reach::Reach};
use cede_controller::{Contract, Plan, Policy, Zone};
use cede_testing::{Report, Suite};

/// The check `id` of a shield with the rules `R`.
fn report<R: Rules + Clone + 'static>(id: &str) -> Report {
    let policy = Policy::new(cede_controller::policy::embedded::words()).unwrap();
    Suite::new(policy, Contract::WORST_CASE)
        .cases(6000)
        .only(id)
        .with_rules::<R>()
        .run()
}

/// Defines rules of which one is broken, and a test that a check catches it.
macro_rules! broken {
    ($test:ident, $rules:ident, $id:literal, { $($rule:item)* }) => {
        #[derive(Clone)]
        struct $rules;
        impl Rules for $rules { $($rule)* }

        #[test]
        fn $test() {
            let report = report::<$rules>($id);
            assert!(!report.passed(), "{report}");
        }
    };
}

broken!(
    others_that_are_slower_than_they_may_be,
    Slow,
    "no-overlap-contracted",
    {
        fn rush(contract: &Contract, speed: f32, time: f32) -> Reach<f32> {
            margin::rush(contract, speed, 0.7 * time)
        }
    }
);

broken!(a_stop_that_is_too_short, Short, "no-overlap-contracted", {
    fn stops_short(contract: &Contract, limit: f32, rest: f32) -> f32 {
        margin::stops_short(contract, limit + 2.0, rest)
    }
});

broken!(
    a_lane_entered_without_a_gap,
    NoGap,
    "no-overlap-contracted",
    {
        fn safe_gap(_: &Contract, _: f32, _: f32) -> f32 {
            0.0
        }
    }
);

broken!(
    a_leader_that_never_brakes,
    NoBrakes,
    "no-overlap-contracted",
    {
        fn earliest_rest(contract: &Contract, speed: f32) -> f32 {
            4.0 * margin::earliest_rest(contract, speed)
        }
    }
);

broken!(a_zone_left_too_soon, Early, "no-overlap-contracted", {
    fn cleared_at(zone: &Zone) -> f32 {
        0.5 * (zone.ego.from + zone.ego.to)
    }
});

broken!(
    another_that_has_left_on_entry,
    Gone,
    "no-overlap-contracted",
    {
        fn left(zone: &Zone, other: f32) -> bool {
            other >= zone.other.from
        }
    }
);

broken!(
    a_missing_track_that_stays_where_it_was,
    Frozen,
    "missing",
    {
        fn coast(_: &Contract, bounds: Bounds, _: f32) -> Bounds {
            bounds
        }
    }
);

broken!(
    a_plan_that_goes_on_for_ever,
    Stale,
    "no-overlap-contracted",
    {
        fn tail(plan: Plan) -> Plan {
            plan
        }
    }
);

broken!(rest_that_is_too_near, Near, "no-overlap-contracted", {
    fn rest(contract: &Contract, from: Reach<f32>, time: f32) -> f32 {
        0.5 * margin::rest(contract, from, time)
    }
});

broken!(always_ahead_in_a_lane, Ahead, "no-overlap-contracted", {
    fn is_ahead(_: &Zone, _: f32) -> bool {
        true
    }
});

broken!(
    commands_that_act_at_once,
    AtOnce,
    "no-overlap-contracted",
    {
        fn departure(
            contract: &Contract,
            speed: f32,
            inherited: &Inherited<f32>,
            command: f32,
        ) -> margin::Departure<f32> {
            let eager = contract.to_builder().latency(0.0).build();
            margin::departure(
                &eager.unwrap_or(*contract),
                speed,
                &Inherited::all(contract, [inherited.bounds()[0].min(command); 2]),
                command,
            )
        }
    }
);

#[test]
fn shrinking_leaves_two_vehicles_at_most() {
    for report in [
        report::<Slow>("no-overlap-contracted"),
        report::<Gone>("no-overlap-contracted"),
    ] {
        let failure = report.outcomes[0].failure().unwrap();
        let case = failure.case.as_ref().unwrap();
        assert!(
            case.contains("Other 1: ") && !case.contains("Other 2: "),
            "{case}"
        );
    }
}
