//! `cede verify`: proofs, and the check of proofs.

mod campaign;
mod check;
mod lemmas;
mod margins;
mod network;
mod policy;
mod reach;
mod shield;

use crate::failure::Failure;
use clap::Subcommand;

/// Proves or refutes properties, and checks proofs.
#[derive(Subcommand)]
pub(crate) enum Verify {
    /// Does an input of the property's box give an unsafe output of the network?
    Network(network::Network),
    /// Does the policy have the properties that are claimed of it?
    Policy(policy::Policy),
    /// Where can policy, shield and kinematics get to in an encounter?
    Reach(reach::Reach),
    /// How far can rounding move the shield's margins?
    Margins(margins::Margins),
    /// Do the steps of the shield's theorem hold, by an SMT solver?
    Lemmas(lemmas::Lemmas),
    /// Checks a certificate with code that shares nothing with the prover's.
    Check(check::Check),
    /// What would the shield have allowed recorded drivers?
    Shield(shield::Shield),
    /// Does a shielded vehicle survive among others that do their worst?
    Campaign(campaign::Campaign),
}

impl Verify {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self {
            Self::Network(network) => network.run(),
            Self::Policy(policy) => policy.run(),
            Self::Reach(reach) => reach.run(),
            Self::Margins(margins) => margins.run(),
            Self::Lemmas(lemmas) => lemmas.run(),
            Self::Check(check) => check.run(),
            Self::Shield(shield) => shield.run(),
            Self::Campaign(campaign) => campaign.run(),
        }
    }
}
