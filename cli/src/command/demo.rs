//! `cede` without a command: drives the embedded scenarios, prints the table and writes the report.

use crate::drivers::{Contender, Drivers};
use crate::failure::Failure;
use crate::judge::{ModeName, Plan, UntilName};
use crate::report::Report;
use crate::table;
use crate::verdict;
use cede_controller::Contract;
use cede_data::{Dataset, Split};
use cede_sim::driver::Baseline;
use cede_sim::evaluate::Selection;
use std::path::Path;

/// Encounters of the demo; the drivers are judged on the test split of them.
const ENCOUNTERS: usize = 1000;
/// Path of the report.
const REPORT: &str = "out/report.html";
/// Seed of the demo's encounters.
const SEED: u64 = 1;

/// Runs the demo.
pub(crate) fn run() -> Result<(), Failure> {
    let dataset = Dataset::synthetic(ENCOUNTERS, SEED);
    note!(
        "driving {} synthetic encounters …",
        dataset.encounters.len()
    );
    let mut report = Report::new(&dataset, "cede");
    let mut rows = Vec::new();
    for until in [UntilName::Conflict, UntilName::Cleared] {
        let plan = Plan {
            contenders: Drivers::all().contenders(None, &[])?,
            lenient: true,
            selections: vec![Selection::Split(Split::Test)],
            mode: ModeName::Joint,
            partner: Contender::Baseline(Baseline::Replay),
            until,
            shields: vec![None, Some(Contract::ALL_WAY_STOP)],
            seed: SEED,
        };
        rows.extend(plan.judge(&dataset, |row, drives| report.add(row, drives))?);
    }
    println!(
        "{}\nNo driver has seen these recordings: the policy has learned from other synthetic traffic, `logistic` and `mean-speed` from the training split.\n",
        verdict::sentence(&rows).unwrap_or_default()
    );
    println!("{}", table::compact(&rows));
    report.sweep(&dataset, Contract::WORST_CASE)?;
    let page = Path::new(REPORT);
    report.write(page)?;
    println!("Replays, charts and all measures: {REPORT}");
    Ok(())
}
