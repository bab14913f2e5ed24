//! What is checked: a policy, a contract and a vehicle.

use crate::vehicle::{Truth, Vehicle};
use cede_controller::{Contract, Policy};

/// A policy, a contract and a vehicle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Subject<'w> {
    pub(crate) policy: Policy<'w>,
    pub(crate) contract: Contract,
    pub(crate) vehicle: Vehicle,
}

impl Subject<'_> {
    /// The vehicle as it was measured.
    pub(crate) fn measured(&self) -> Truth {
        Truth::measured(&self.vehicle, &self.contract)
    }

    /// A vehicle that just keeps the contract.
    pub(crate) fn as_contracted(&self) -> Truth {
        Truth::as_contracted(&self.contract)
    }
}
