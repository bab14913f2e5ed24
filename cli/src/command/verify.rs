//! `cede verify`: proofs, and the check of proofs.

mod check;
mod network;

use crate::failure::Failure;
use clap::Subcommand;

/// Proves or refutes properties; exit code 0 whatever the answer, as long as there is one.
#[derive(Subcommand)]
pub(crate) enum Verify {
    /// Does an input of the property's box give an unsafe output of the network?
    Network(network::Network),
    /// Checks a certificate with code that shares nothing with the prover's.
    Check(check::Check),
}

impl Verify {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self {
            Self::Network(network) => network.run(),
            Self::Check(check) => check.run(),
        }
    }
}
