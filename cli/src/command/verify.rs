//! `cede verify`: proofs, the check of proofs, and all evidence in one report.

mod all;
mod beyond;
mod campaign;
mod check;
mod checked;
mod departure;
mod lemmas;
mod margins;
mod network;
pub(crate) mod policy;
mod reach;
mod shield;
mod zones;

use crate::failure::Failure;
use clap::Subcommand;
use clap::builder::RangedU64ValueParser;

/// The longest time limit, in seconds: eleven days.
const LONGEST: u64 = 1_000_000;

/// Reads a time limit.
fn seconds() -> RangedU64ValueParser<u64> {
    RangedU64ValueParser::new().range(1..=LONGEST)
}

/// Proves or refutes properties, checks proofs, and collects all evidence.
#[derive(Subcommand)]
pub(crate) enum Verify {
    /// All checks in one report: what is proved, tested, assumed, skipped and open?
    All(all::All),
    /// Does an input of the property's box give an unsafe output of the network?
    Network(network::Network),
    /// Does the policy have its claimed properties?
    Policy(policy::Policy),
    /// How far can the policy of integers be from the one in f32?
    Departure(departure::Departure),
    /// Which states can policy, shield and kinematics reach in an encounter?
    Reach(reach::Reach),
    /// How far can rounding move the shield's margins?
    Margins(margins::Margins),
    /// Do the zones of a junction cover every overlap?
    Zones(zones::Zones),
    /// Do the steps of the shield's theorem hold, by an SMT solver?
    Lemmas(lemmas::Lemmas),
    /// Checks a certificate, with code that is independent of the prover.
    Check(check::Check),
    /// Which share of recorded steps does the shield accept?
    Shield(shield::Shield),
    /// Do shielded vehicles stay free of collisions among adversaries?
    Campaign(campaign::Campaign),
    /// How often does the shield fail when a number of its contract does not hold?
    Beyond(beyond::Beyond),
}

impl Verify {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self {
            Self::All(all) => all.run(),
            Self::Network(network) => network.run(),
            Self::Policy(policy) => policy.run(),
            Self::Departure(departure) => departure.run(),
            Self::Reach(reach) => reach.run(),
            Self::Margins(margins) => margins.run(),
            Self::Zones(zones) => zones.run(),
            Self::Lemmas(lemmas) => lemmas.run(),
            Self::Check(check) => check.run(),
            Self::Shield(shield) => shield.run(),
            Self::Campaign(campaign) => campaign.run(),
            Self::Beyond(beyond) => beyond.run(),
        }
    }
}
