//! `cede`: from recorded tracks to a trained, proved and reported driver, in one binary.

mod command;
mod failure;

use clap::Parser;
use std::process::ExitCode;

/// Decides how a vehicle crosses an unsignalized intersection.
///
/// Exit codes: 0 fine, 1 a check failed, 2 usage, 3 bad input, 4 interrupted.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: command::Command,
}

fn main() -> ExitCode {
    match Cli::parse().command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
