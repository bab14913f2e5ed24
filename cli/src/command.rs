//! The subcommands, one module each.

mod demo;
mod evaluate;
mod verify;

use crate::failure::Failure;
use clap::Subcommand;

/// What to do.
#[derive(Default, Subcommand)]
pub(crate) enum Command {
    /// Drive the embedded scenarios, print the table and write the report (the default)
    #[default]
    Demo,
    /// Judge drivers on recorded or synthetic encounters
    Evaluate(evaluate::Args),
    /// Prove properties of networks, and check proofs
    #[command(subcommand)]
    Verify(verify::Verify),
}

impl Command {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self {
            Self::Demo => demo::run(),
            Self::Evaluate(args) => evaluate::run(&args),
            Self::Verify(verify) => verify.run(),
        }
    }
}
