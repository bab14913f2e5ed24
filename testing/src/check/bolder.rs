//! The contract's numbers beside the vehicle's.

use super::{Context, Found};
use crate::report::{Failure, Verdict};
use crate::vehicle::{Bold, mend};

/// No number of the contract is bolder than the vehicle.
pub(super) fn fits(context: &Context<'_>, _: &'static str) -> Found {
    let (contract, vehicle) = (&context.subject.contract, &context.subject.vehicle);
    let bold = vehicle.bolder(contract);
    if bold.is_empty() {
        return Found::new(Verdict::Passed, 1);
    }
    let named: Vec<_> = bold.iter().map(Bold::to_string).collect();
    let more = match mend(contract, &bold) {
        Ok(_) => String::new(),
        Err(error) => format!("; then change as well: {error}"),
    };
    let fields: Vec<_> = bold.iter().map(|bold| bold.field).collect();
    let failure = Failure {
        message: format!(
            "the contract is bolder than the vehicle in {}",
            fields.join(", ")
        ),
        mend: Some(format!("{}{more}", named.join("; "))),
        case: None,
    };
    Found::new(Verdict::Failed(failure), 1)
}
