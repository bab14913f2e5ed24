//! `cede`: from recorded tracks to a trained, proved and reported driver, in one binary.

#[macro_use]
mod stdout;

mod arguments;
mod child;
mod command;
mod config;
mod contract;
mod drivers;
mod failure;
mod guide;
mod input;
mod interrupt;
mod judge;
mod left_out;
mod plural;
mod progress;
mod report;
mod safety;
mod scene;
mod settings;
mod source;
mod svg;
mod table;
mod threads;
mod training;
mod verdict;

use std::process::ExitCode;

fn main() -> ExitCode {
    interrupt::install();
    let done = arguments::parse().and_then(|arguments| {
        stdout::set_quiet(arguments.quiet);
        arguments
            .command
            .unwrap_or_default()
            .run(arguments::grammar)
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
