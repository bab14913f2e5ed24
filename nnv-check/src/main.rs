//! The program `nnv-check`: a certificate in, what it proves of what out.
#![forbid(unsafe_code)]

use cede_nnv_check::{Certificate, Proved};
use clap::Parser;
use std::error::Error;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Checks a certificate of a neural-network verifier: that it is a proof, and of which network and
/// property. Exit code 0 if it is, 1 if it is not, 2 if a file cannot be read.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// The certificate
    #[arg(value_name = "CERT")]
    certificate: PathBuf,
    /// The network, if its path has changed
    #[arg(long, value_name = "FILE")]
    onnx: Option<PathBuf>,
    /// The property, if its path has changed
    #[arg(long, value_name = "FILE")]
    vnnlib: Option<PathBuf>,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(Ok(proved)) => {
            // A reader that has seen enough may close the pipe.
            let _ = writeln!(std::io::stdout(), "{proved}");
            ExitCode::SUCCESS
        }
        Ok(Err(error)) => {
            eprintln!("nnv-check: not proved: {error}");
            ExitCode::from(1)
        }
        Err(error) => {
            eprintln!("nnv-check: {error}");
            ExitCode::from(2)
        }
    }
}

type Checked = Result<Proved, cede_nnv_check::CertificateError>;

fn run(arguments: &Arguments) -> Result<Checked, String> {
    let path = &arguments.certificate;
    let certificate = named(path, std::fs::read_to_string(path))?;
    let certificate = named(path, Certificate::from_text(&certificate))?;
    let onnx = arguments.onnx.as_ref().unwrap_or(&certificate.onnx.path);
    let vnnlib = arguments
        .vnnlib
        .as_ref()
        .unwrap_or(&certificate.vnnlib.path);
    let network = named(onnx, std::fs::read(onnx))?;
    let property = named(vnnlib, std::fs::read(vnnlib))?;
    let mut checked = certificate.check(&network, &property);
    if let Ok(proved) = &mut checked {
        proved.onnx.path.clone_from(onnx);
        proved.vnnlib.path.clone_from(vnnlib);
    }
    Ok(checked)
}

/// Names the file in an error.
fn named<T, E: Error>(path: &Path, result: Result<T, E>) -> Result<T, String> {
    result.map_err(|error| format!("cannot use {}: {error}", path.display()))
}
