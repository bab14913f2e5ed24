//! `cede verify network`.

use crate::failure::Failure;
use crate::input::{self, unusable};
use crate::threads::Threads;
use cede_data::output;
use cede_nnv::{self as verifier, Answer, Branching, Report, SearchOptions};
use cede_nnv_check::{self as trusted, Certificate, Source};
use clap::{Args, ValueEnum};
use std::io::Write as _;
use std::path::PathBuf;
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
    /// The property, VNN-LIB 1.0 or 2.0.
    #[arg(long, value_name = "FILE")]
    vnnlib: PathBuf,
    /// Time limit in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds)]
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
        let timeout = Duration::from_secs_f64(self.timeout);
        if let Some(path) = &self.certificate {
            output::check(path)?;
        }
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
        let model = input::bytes(&self.onnx, ONNX)?;
        let text = input::bytes(&self.vnnlib, VNNLIB)?;
        let network = trusted::onnx::read(&model);
        let network = network.map_err(|error| unusable(&self.onnx, error, ONNX))?;
        let property = trusted::vnnlib::read_bytes(&text);
        let property = property.map_err(|error| unusable(&self.vnnlib, error, VNNLIB))?;
        let options = SearchOptions::default()
            .timeout(timeout.saturating_sub(start.elapsed()))
            .seed(self.seed)
            .branching(self.branching.into())
            .record(self.certificate.is_some());
        let report = verifier::verify(&network, &property, options);
        let mut report = report.map_err(|error| {
            let (onnx, vnnlib) = (self.onnx.display(), self.vnnlib.display());
            let mend = "give a network and a property of its inputs and outputs";
            Failure::input(format!("{onnx} and {vnnlib}: {error}"), mend)
        })?;
        if let (Some(path), Answer::Unsat) = (&self.certificate, &report.answer) {
            let program = concat!("cede ", env!("CARGO_PKG_VERSION"));
            let onnx = Source::new(&self.onnx, &model);
            let vnnlib = Source::new(&self.vnnlib, &text);
            let proofs = std::mem::take(&mut report.proofs);
            let text = Certificate::new(program, onnx, vnnlib, proofs).to_text();
            output::write(path, |file| file.write_all(text.as_bytes()))?;
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
const ONNX: &str = "--onnx a feed-forward network in ONNX";
const VNNLIB: &str = "--vnnlib a property in VNN-LIB 1.0 or 2.0";

/// Reads a time limit.
fn seconds(text: &str) -> Result<f64, String> {
    let limit = super::LONGEST as f64;
    let seconds = text.parse().ok();
    let within = seconds.filter(|seconds| (0.0..=limit).contains(seconds));
    within.ok_or_else(|| format!("not a number of seconds from 0 to {limit}"))
}
