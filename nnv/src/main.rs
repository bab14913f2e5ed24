//! The program `nnv`: an ONNX network and a VNN-LIB property in, a verdict and a certificate out.
#![forbid(unsafe_code)]

use cede_nnv::{Answer, Branching, SearchOptions, verify, within};
use cede_nnv_check::{Certificate, Source, onnx, vnnlib};
use clap::{Parser, ValueEnum};
use std::error::Error;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// What may pass beyond the timeout before nothing is waited for any more.
const GRACE: Duration = Duration::from_millis(500);

/// Verifies a property of a feed-forward ReLU network, in real-number semantics. Prints unsat
/// (proved), sat (refuted; a witness follows), timeout or unknown.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// The network, ONNX
    #[arg(long, value_name = "FILE")]
    onnx: PathBuf,
    /// The property, VNN-LIB 1.0
    #[arg(long, value_name = "FILE")]
    vnnlib: PathBuf,
    /// Give up after so many seconds, the reading of the files included
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    timeout: f64,
    /// Threads to search on; all cores by default
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Seed of the search for counterexamples
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// What to cut regions across
    #[arg(long, value_enum, default_value_t = Cut::Auto)]
    branching: Cut,
    /// Write a certificate of `unsat`
    #[arg(long, value_name = "FILE")]
    certificate: Option<PathBuf>,
}

/// See [`Branching`].
#[derive(Clone, Copy, ValueEnum)]
enum Cut {
    Auto,
    Inputs,
    Phases,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match in_time(arguments) {
        Ok(text) => {
            // A reader that has seen enough may close the pipe.
            let _ = writeln!(std::io::stdout(), "{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("nnv: {error}");
            ExitCode::from(2)
        }
    }
}

/// The verdict, and the witness if there is one.
fn in_time(arguments: Arguments) -> Result<String, String> {
    let timeout = Duration::try_from_secs_f64(arguments.timeout)
        .map_err(|e| format!("--timeout {}: {e}", arguments.timeout))?;
    let work = move || run(&arguments, timeout).map_err(|error| error.to_string());
    within(timeout.saturating_add(GRACE), work).unwrap_or_else(|| Ok(Answer::Timeout.text()))
}

fn run(arguments: &Arguments, timeout: Duration) -> Result<String, Box<dyn Error>> {
    let start = Instant::now();
    let Arguments { onnx, vnnlib, .. } = arguments;
    let model = named(onnx, std::fs::read(onnx))?;
    let network = named(onnx, onnx::read(&model))?;
    let text = named(vnnlib, std::fs::read(vnnlib))?;
    let property = named(vnnlib, vnnlib::read_bytes(&text))?;
    let options = SearchOptions::default()
        .timeout(timeout.saturating_sub(start.elapsed()))
        .seed(arguments.seed)
        .branching(match arguments.branching {
            Cut::Auto => Branching::Auto,
            Cut::Inputs => Branching::Inputs,
            Cut::Phases => Branching::Phases,
        })
        .record(arguments.certificate.is_some());
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads)
        .build()?;
    let report = pool.install(|| verify(&network, &property, options))?;
    if let (Some(path), Answer::Unsat) = (&arguments.certificate, &report.answer) {
        let program = concat!("nnv ", env!("CARGO_PKG_VERSION"));
        let (onnx, vnnlib) = (Source::new(onnx, &model), Source::new(vnnlib, &text));
        let certificate = Certificate::new(program, onnx, vnnlib, report.proofs);
        named(path, std::fs::write(path, certificate.to_text()))?;
    }
    Ok(report.answer.text())
}

/// Names the file in an error.
fn named<T, E: Error>(path: &Path, result: Result<T, E>) -> Result<T, String> {
    result.map_err(|error| format!("cannot use {}: {error}", path.display()))
}
