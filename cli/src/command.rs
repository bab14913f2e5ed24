//! The subcommands, one module each.

mod completions;
mod data;
mod demo;
mod evaluate;
mod export;
mod import;
mod man;
mod play;
mod replay;
mod reproduce;
mod train;
mod verify;

use crate::failure::Failure;
use clap::Subcommand;

/// The subcommand.
#[derive(Default, Subcommand)]
pub(crate) enum Command {
    /// Drive the embedded scenarios, print the table and write the report (the default)
    #[default]
    Demo,
    /// Read recordings: find their encounters, print and draw their content
    #[command(subcommand)]
    Data(data::Data),
    /// Judge drivers on recorded or synthetic encounters
    Evaluate(evaluate::Args),
    /// Show one encounter of a recording, as numbers and as an animated page
    Replay(replay::Args),
    /// Drive other cars around the controller's in a browser, and try to hit it
    Play(play::Args),
    /// Train a policy
    Train(train::Args),
    /// Train and judge the rows of the paper's table
    Reproduce(reproduce::Args),
    /// Write a policy as ONNX or safetensors
    Export(export::Args),
    /// Convert an ONNX policy that was trained elsewhere to a weights file
    Import(import::Args),
    /// Prove properties, check proofs, and collect all evidence
    #[command(subcommand)]
    Verify(verify::Verify),
    /// Print the completions of a shell
    Completions(completions::Args),
    /// Write the manual pages
    Man(man::Args),
}

impl Command {
    /// Runs the command.
    pub(crate) fn run(self, grammar: fn() -> clap::Command) -> Result<(), Failure> {
        match self {
            Self::Completions(args) => completions::run(&args, grammar()),
            Self::Data(data) => data.run(),
            Self::Demo => demo::run(),
            Self::Evaluate(args) => evaluate::run(&args),
            Self::Export(args) => export::run(&args),
            Self::Import(args) => import::run(&args),
            Self::Man(args) => man::run(&args, grammar()),
            Self::Play(args) => play::run(&args),
            Self::Replay(args) => replay::run(&args),
            Self::Train(args) => train::run(&args),
            Self::Reproduce(args) => reproduce::run(&args),
            Self::Verify(verify) => verify.run(),
        }
    }
}
