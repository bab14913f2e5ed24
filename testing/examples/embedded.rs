//! All checks of the policy that ships: `cargo run --release -p cede-testing --example embedded`.

use cede_controller::{Contract, Footprint, Policy};
use cede_testing::{Suite, Vehicle};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let policy = Policy::new(cede_controller::policy::embedded::words())?;
    let contract = Contract::builder().ego_braking(4.0).latency(0.08).build()?;
    let vehicle = Vehicle::new(Footprint {
        length: 4.6,
        width: 1.9,
    })
    .braking(4.2)
    .latency(0.08);
    let report = Suite::new(policy, contract)
        .vehicle(vehicle)
        .cases(64)
        .run();
    println!("{report}");
    std::process::exit(report.exit_code());
}
