//! The command line: its grammar, and what it says.

use crate::command::Command;
use crate::failure::Failure;
use crate::{config, guide};
use clap::{CommandFactory, FromArgMatches, Parser};

/// Decides how a vehicle crosses an unsignalized intersection.
///
/// Without a command: the demo. It drives the embedded scenarios, prints the
/// table and writes the report.
///
/// Exit codes: 0 success, 1 a check failed, 2 usage, 3 unusable input or output, 4 interrupted.
#[derive(Parser)]
#[command(version)]
pub(crate) struct Arguments {
    /// Say nothing but the result and errors
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

/// The grammar of the command line.
pub(crate) fn grammar() -> clap::Command {
    let grammar = config::with_option(Arguments::command());
    let help = guide::template(&grammar);
    grammar.help_template(help)
}

/// What the command line says, with the options of its configuration file. Ends the program after printing help.
///
/// # Errors
/// The configuration file cannot be used.
pub(crate) fn parse() -> Result<Arguments, Failure> {
    let arguments = config::expand(&grammar(), std::env::args_os().collect())?;
    let matches = arguments.matches(grammar())?;
    Arguments::from_arg_matches(&matches).map_err(|error| error.exit())
}
