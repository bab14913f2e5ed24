//! The subcommands, one module each.

use crate::failure::Failure;
use clap::Subcommand;

/// What to do.
#[derive(Subcommand)]
pub enum Command {}

impl Command {
    /// Runs the command.
    pub fn run(self) -> Result<(), Failure> {
        match self {}
    }
}
