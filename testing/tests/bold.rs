//! A contract that is bolder than the vehicle is caught, and the message names the number and its mend.

use cede_controller::{Contract, Footprint, Policy};
use cede_testing::{Report, Suite, Vehicle};

fn report(contract: Contract, vehicle: Vehicle) -> Report {
    let policy = Policy::new(cede_controller::policy::embedded::words()).unwrap();
    let suite = Suite::new(policy, contract).vehicle(vehicle).cases(200);
    suite
        .only("contract-fits-vehicle")
        .only("no-overlap")
        .only("no-overlap-contracted")
        .run()
}

/// What is said of the check `id`: the message and its mend.
fn said(report: &Report, id: &str) -> (String, String) {
    let failure = report
        .outcome(id)
        .unwrap()
        .failure()
        .unwrap_or_else(|| panic!("{id}: {report}"));
    (failure.message.clone(), failure.mend.clone().unwrap())
}

#[test]
fn brakes_weaker_than_the_contract_overlap_and_the_mend_is_tried() {
    let contract = Contract::builder().ego_braking(6.0).build().unwrap();
    let report = report(contract, Vehicle::new(Footprint::PAPER).braking(4.0));
    assert_eq!(report.exit_code(), 1);
    let mend = "change ego.braking in the contract from 6 to 4: the vehicle's braking is 4";
    assert_eq!(said(&report, "contract-fits-vehicle").1, mend);
    let (message, tried) = said(&report, "no-overlap");
    assert!(message.contains("overlap after"), "{message}");
    assert_eq!(
        tried,
        format!("{mend}; with that, this case has no overlap")
    );
    // The contract itself is sound.
    assert!(
        report
            .outcome("no-overlap-contracted")
            .unwrap()
            .failure()
            .is_none()
    );
}

#[test]
fn the_case_that_shows_it_has_two_vehicles_at_most() {
    let contract = Contract::builder().ego_braking(6.0).build().unwrap();
    let report = report(contract, Vehicle::new(Footprint::PAPER).braking(4.0));
    let failure = report.outcome("no-overlap").unwrap().failure().unwrap();
    let case = failure.case.as_ref().unwrap();
    assert!(
        case.contains("Other 1: ") && !case.contains("Other 2: "),
        "{case}"
    );
    assert!(case.contains("m/s) overlap after"), "{case}");
}

#[test]
fn a_latency_that_the_vehicle_exceeds_names_the_period_too() {
    let report = report(
        Contract::WORST_CASE,
        Vehicle::new(Footprint::PAPER).latency(1.2),
    );
    let (_, mend) = said(&report, "contract-fits-vehicle");
    assert!(
        mend.starts_with("change latency in the contract from 0.1 to 1.2"),
        "{mend}"
    );
    assert!(
        mend.contains("change as well: latency = 1.2 is outside [0, 1]"),
        "{mend}"
    );
}
