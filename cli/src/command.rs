//! The subcommands, one module each.

mod verify;

use crate::failure::Failure;
use clap::Subcommand;

/// What to do.
#[derive(Subcommand)]
pub enum Command {
    /// Proofs about networks, and the check of proofs.
    #[command(subcommand)]
    Verify(verify::Verify),
}

impl Command {
    /// Runs the command.
    pub fn run(self) -> Result<(), Failure> {
        match self {
            Self::Verify(verify) => verify.run(),
        }
    }
}
