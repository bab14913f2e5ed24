//! Checks a policy file, a contract and a vehicle, as a program for continuous integration.
#![forbid(unsafe_code)]

mod arguments;
mod numbers;

use arguments::{Arguments, Input};
use cede_testing::Report;
use clap::Parser;
use std::process::ExitCode;

/// The exit status of bad input; 1 is that of a check that fails.
const BAD_INPUT: u8 = 2;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if arguments.list {
        for (id, sentence) in cede_testing::checks() {
            println!("{id}\n    {sentence}");
        }
        return ExitCode::SUCCESS;
    }
    if arguments.print_contract {
        return print_contract(&arguments);
    }
    match run(&arguments) {
        Ok(report) if report.passed() => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(message) => refuse(&message),
    }
}

/// Says what is wrong with the input.
fn refuse(message: &str) -> ExitCode {
    eprintln!("error: {message}");
    ExitCode::from(BAD_INPUT)
}

fn print_contract(arguments: &Arguments) -> ExitCode {
    let printed = Input::read(arguments).and_then(|input| {
        serde_json::to_string_pretty(&input.contract).map_err(|error| error.to_string())
    });
    match printed {
        Ok(text) => {
            println!("{text}");
            ExitCode::SUCCESS
        }
        Err(message) => refuse(&message),
    }
}

/// Runs the checks, says what comes of them and writes the files that are asked for.
fn run(arguments: &Arguments) -> Result<Report, String> {
    let input = Input::read(arguments)?;
    let suite = input.suite(arguments)?;
    if !arguments.quiet {
        println!("{}", input.describe());
    }
    let report = suite.run();
    println!("{report}");
    write(arguments.junit.as_deref(), &report.to_junit())?;
    write(arguments.json.as_deref(), &report.to_json())?;
    Ok(report)
}

fn write(path: Option<&std::path::Path>, text: &str) -> Result<(), String> {
    let Some(path) = path else { return Ok(()) };
    std::fs::write(path, text).map_err(|error| format!("cannot write {}: {error}", path.display()))
}
