//! Checks a policy that was trained elsewhere, from its ONNX file.
//!
//! `cargo run --release -p cede-testing --example onnx_policy -- driver.onnx`; without a file, the policy that ships is
//! written as one first.

use cede_controller::{Contract, Footprint, Policy};
use cede_formats::onnx;
use cede_testing::{Suite, Vehicle};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let bytes = match std::env::args().nth(1) {
        Some(path) => std::fs::read(path)?,
        None => onnx::export(Policy::new(cede_controller::policy::embedded::words())?.weights())?,
    };
    // From here on, ten lines for a test of your own.
    let words = onnx::import(&bytes, onnx::Told::default())?;
    let policy = Policy::new(&words)?;
    let contract = Contract::builder().ego_braking(4.0).latency(0.08).build()?;
    let vehicle = Vehicle::new(Footprint {
        length: 4.6,
        width: 1.9,
    })
    .braking(4.2)
    .latency(0.08);
    let report = Suite::new(policy, contract)
        .vehicle(vehicle)
        .cases(32)
        .seed(1)
        .run();
    println!("{report}");
    std::process::exit(report.exit_code());
}
