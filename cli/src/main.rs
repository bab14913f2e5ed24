//! `cede`: from recorded tracks to a trained, proved and reported driver, in one binary.

#[macro_use]
mod stdout;

mod command;
mod contract;
mod drivers;
mod failure;
mod input;
mod interrupt;
mod judge;
mod left_out;
mod plural;
mod report;
mod scene;
mod settings;
mod source;
mod table;
mod threads;
mod training;
mod verdict;

use clap::Parser;
use std::process::ExitCode;

/// Decides how a vehicle crosses an unsignalized intersection.
///
/// Without a command: the demo. It drives the embedded scenarios, prints the
/// table and writes the report.
///
/// Exit codes: 0 success, 1 a check failed, 2 usage, 3 unusable input or output, 4 interrupted.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Option<command::Command>,
}

fn main() -> ExitCode {
    interrupt::install();
    match Cli::parse().command.unwrap_or_default().run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
