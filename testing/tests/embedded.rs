//! The policy that ships passes, under several contracts.

use cede_controller::{Contract, Footprint, Policy};
use cede_testing::{Suite, Vehicle};

fn policy() -> Policy<'static> {
    Policy::new(cede_controller::policy::embedded::words()).unwrap()
}

#[test]
fn the_embedded_policy_passes_in_the_worst_case() {
    let report = Suite::new(policy(), Contract::WORST_CASE).cases(24).run();
    report.assert_passed();
    assert_eq!(report.skipped().count(), 0);
}

#[test]
fn the_embedded_policy_passes_at_an_all_way_stop() {
    Suite::new(policy(), Contract::ALL_WAY_STOP)
        .cases(16)
        .seed(2)
        .run()
        .assert_passed();
}

#[test]
fn a_vehicle_better_than_its_contract_passes() {
    let contract = Contract::builder()
        .ego_braking(4.0)
        .latency(0.08)
        .build()
        .unwrap();
    let vehicle = Vehicle::new(Footprint {
        length: 4.6,
        width: 1.9,
    })
    .braking(4.2)
    .latency(0.06);
    Suite::new(policy(), contract)
        .vehicle(vehicle)
        .cases(16)
        .run()
        .assert_passed();
}
