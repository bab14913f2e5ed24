//! `cede-attack`: attacks the shield, replays what it found, and shows that it would find something.

mod command;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Attacks the safety shield with kinematics, geometry and adversaries of its own.
///
/// Exit codes: 0 the shield held (or every broken one was caught), 1 it did not, 2 usage.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Run(command::run::Args),
    Replay(command::replay::Args),
    Sharp(command::sharp::Args),
    Outside(command::outside::Args),
    Zones(command::zones::Args),
    /// Lists the families of scenarios.
    Families,
}

fn main() -> ExitCode {
    let held = match Cli::parse().command {
        Command::Run(args) => args.run(),
        Command::Replay(args) => args.run(),
        Command::Sharp(args) => args.run(),
        Command::Outside(args) => args.run(),
        Command::Zones(args) => args.run(),
        Command::Families => command::families(),
    };
    if held {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
