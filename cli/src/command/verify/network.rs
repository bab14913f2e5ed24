//! `cede verify network`.

use crate::failure::Failure;
use crate::threads::Threads;
use cede_data::output;
use cede_nnv::{self as verifier, Answer, Branching, Report, SearchOptions};
use cede_nnv_check::{self as trusted, Certificate, Source};
use clap::{Args, ValueEnum};
use miette::{IntoDiagnostic, miette};
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
        let timeout = Duration::try_from_secs_f64(self.timeout).map_err(|_| {
            Failure::Input(miette!(
                help = "give seconds, for example 60",
                "--timeout {}",
                self.timeout
            ))
        })?;
        self.threads.start()?;
        let json = self.json;
        let start = Instant::now();
        let work = move || self.told(timeout, start);
        let told = verifier::within(timeout.saturating_add(GRACE), work).unwrap_or_else(|| {
            let answer = Answer::Timeout;
            Ok(if json {
                as_json(&answer, None, start)
            } else {
                answer.text()
            })
        })?;
        // A closed pipe (`| head`) is not an error.
        let _ = writeln!(std::io::stdout(), "{told}");
        Ok(())
    }

    /// Verifies, and gives what is to be printed.
    fn told(&self, timeout: Duration, start: Instant) -> Result<String, Failure> {
        let (model, text) = (bytes(&self.onnx, ONNX)?, bytes(&self.vnnlib, VNNLIB)?);
        let network = trusted::onnx::read(&model).into_diagnostic();
        let network = network.map_err(named(&self.onnx, ONNX))?;
        let property = trusted::vnnlib::read_bytes(&text).into_diagnostic();
        let property = property.map_err(named(&self.vnnlib, VNNLIB))?;
        let options = SearchOptions::default()
            .timeout(timeout.saturating_sub(start.elapsed()))
            .seed(self.seed)
            .branching(self.branching.into())
            .record(self.certificate.is_some());
        let report = verifier::verify(&network, &property, options).into_diagnostic();
        let mut report = report.map_err(Failure::Input)?;
        if let (Some(path), Answer::Unsat) = (&self.certificate, &report.answer) {
            let program = concat!("cede ", env!("CARGO_PKG_VERSION"));
            let onnx = Source::new(&self.onnx, &model);
            let vnnlib = Source::new(&self.vnnlib, &text);
            let proofs = std::mem::take(&mut report.proofs);
            let text = Certificate::new(program, onnx, vnnlib, proofs).to_text();
            output::write(path, |file| file.write_all(text.as_bytes()))
                .into_diagnostic()
                .map_err(Failure::Input)?;
        }
        Ok(if self.json {
            as_json(&report.answer, Some(&report), start)
        } else {
            report.answer.text()
        })
    }
}

/// The answer as a JSON object; without a report if the time was over before there was one.
fn as_json(answer: &Answer, report: Option<&Report>, start: Instant) -> String {
    let witness = match answer {
        Answer::Sat(w) => {
            serde_json::json!({ "x": w.input(), "exact": w.decimals(), "y": w.outputs() })
        }
        _ => serde_json::Value::Null,
    };
    let branching = report.map(|report| match report.branching {
        Branching::Inputs => "inputs",
        Branching::Phases => "phases",
        _ => "auto",
    });
    serde_json::json!({
        "answer": answer.word(), "semantics": "real", "regions": report.map(|r| r.regions),
        "branching": branching, "seconds": start.elapsed().as_secs_f64(), "witness": witness,
    })
    .to_string()
}

/// What may pass beyond the time limit before nothing is waited for any more.
const GRACE: Duration = Duration::from_millis(500);
const ONNX: &str = "--onnx: a feed-forward network in ONNX";
const VNNLIB: &str = "--vnnlib: a property in VNN-LIB 1.0";

/// A file's bytes.
pub(crate) fn bytes(path: &Path, help: &'static str) -> Result<Vec<u8>, Failure> {
    std::fs::read(path)
        .into_diagnostic()
        .map_err(named(path, help))
}

/// Names the file, and what it should be, in an error.
fn named(path: &Path, help: &'static str) -> impl Fn(miette::Report) -> Failure {
    let place = path.display().to_string();
    move |error| Failure::Input(error.wrap_err(format!("cannot use {place} ({help})")))
}
