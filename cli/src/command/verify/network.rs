//! `cede verify network`.

use crate::failure::Failure;
use crate::threads::Threads;
use cede_data::output;
use cede_nnv::{self as verifier, Answer, Branching, Report, SearchOptions};
use cede_nnv_check::{self as trusted, Certificate};
use clap::{Args, ValueEnum};
use miette::{IntoDiagnostic, WrapErr, miette};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The text below the options in `cede help verify network`.
const HELP: &str = "\
The answer is about the network's real-number semantics: the exact values of its weights, and no rounding.
First line of stdout: unsat (proved), sat (refuted; a witness follows in the VNN-COMP format), timeout or unknown.";

/// Options of `cede verify network`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Network {
    /// The network, ONNX.
    #[arg(long, value_name = "FILE")]
    onnx: PathBuf,
    /// The property, VNN-LIB 1.0.
    #[arg(long, value_name = "FILE")]
    vnnlib: PathBuf,
    /// Time limit in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    timeout: f64,
    #[command(flatten)]
    threads: Threads,
    /// Seed of the search for counterexamples.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// What to split regions by: inputs, phases of ReLUs, or the better of both for the number of
    /// inputs.
    #[arg(long, value_enum, default_value_t = Cut::Auto)]
    branching: Cut,
    /// Write a certificate of `unsat` for `cede verify check`.
    #[arg(long, value_name = "FILE")]
    certificate: Option<PathBuf>,
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

/// See [`Branching`].
#[derive(Clone, Copy, ValueEnum)]
enum Cut {
    Auto,
    Inputs,
    Phases,
}

impl From<Cut> for Branching {
    fn from(cut: Cut) -> Self {
        match cut {
            Cut::Auto => Self::Auto,
            Cut::Inputs => Self::Inputs,
            Cut::Phases => Self::Phases,
        }
    }
}

impl Network {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let start = Instant::now();
        let (network, property) = read(&self.onnx, &self.vnnlib)?;
        let timeout = Duration::try_from_secs_f64(self.timeout).map_err(|_| {
            Failure::Input(miette!(
                help = "give seconds, for example 60",
                "--timeout {}",
                self.timeout
            ))
        })?;
        let options = SearchOptions::default()
            .timeout(timeout)
            .seed(self.seed)
            .branching(self.branching.into())
            .record(self.certificate.is_some());
        self.threads.start()?;
        let report = verifier::verify(&network, &property, options).into_diagnostic();
        let mut report = report.map_err(Failure::Input)?;
        if let (Some(path), Answer::Unsat) = (&self.certificate, &report.answer) {
            let proofs = std::mem::take(&mut report.proofs);
            let certificate = Certificate::new(&self.onnx, &self.vnnlib, proofs);
            let text = certificate.to_text();
            output::write(path, |file| file.write_all(text.as_bytes()))
                .into_diagnostic()
                .map_err(Failure::Input)?;
        }
        let seconds = start.elapsed().as_secs_f64();
        // A closed pipe (`| head`) is not an error.
        let _ = writeln!(
            std::io::stdout(),
            "{}",
            self.told(&network, &report, seconds)
        );
        Ok(())
    }

    fn told(&self, network: &trusted::Network, report: &Report, seconds: f64) -> String {
        if !self.json {
            return report.answer.text(network);
        }
        let witness = match &report.answer {
            Answer::Sat(x) => serde_json::json!({ "x": x, "y": network.run(x).values }),
            _ => serde_json::Value::Null,
        };
        serde_json::json!({
            "answer": report.answer.word(), "semantics": "real", "regions": report.regions,
            "seconds": seconds, "witness": witness,
        })
        .to_string()
    }
}

/// Reads a network and a property.
pub(crate) fn read(
    onnx: &Path,
    vnnlib: &Path,
) -> Result<(trusted::Network, trusted::Property), Failure> {
    let named = |path: &Path, help: &'static str| {
        let place = path.display().to_string();
        move |error: miette::Report| {
            Failure::Input(error.wrap_err(format!("cannot use {place} ({help})")))
        }
    };
    let bytes = std::fs::read(onnx).into_diagnostic();
    let network = bytes.and_then(|bytes| trusted::onnx::read(&bytes).into_diagnostic());
    let network = network.map_err(named(onnx, "--onnx: a feed-forward network in ONNX"))?;
    let text = std::fs::read_to_string(vnnlib).into_diagnostic();
    let property = text.and_then(|text| trusted::vnnlib::read(&text).into_diagnostic());
    let property = property
        .wrap_err("VNN-LIB")
        .map_err(named(vnnlib, "--vnnlib: a property in VNN-LIB 1.0"))?;
    Ok((network, property))
}
