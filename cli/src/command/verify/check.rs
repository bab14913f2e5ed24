//! `cede verify check`.

use super::network::read;
use crate::failure::Failure;
use cede_nnv_check::Certificate;
use clap::Args;
use miette::{IntoDiagnostic, WrapErr};
use std::io::Write as _;
use std::path::PathBuf;

/// The text below the options in `cede help verify check`.
const HELP: &str = "\
Exit code 0 if the certificate is a proof, 1 if it is not. The certificate names the network and the property
relative to the current folder; --onnx and --vnnlib replace these paths.";

/// Options of `cede verify check`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Check {
    /// The certificate.
    #[arg(value_name = "CERT")]
    certificate: PathBuf,
    /// The network, if its path has changed.
    #[arg(long, value_name = "FILE")]
    onnx: Option<PathBuf>,
    /// The property, if its path has changed.
    #[arg(long, value_name = "FILE")]
    vnnlib: Option<PathBuf>,
}

impl Check {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let text = std::fs::read_to_string(&self.certificate).into_diagnostic();
        let certificate = text.and_then(|text| Certificate::from_text(&text).into_diagnostic());
        let certificate = certificate
            .wrap_err_with(|| format!("cannot use {}", self.certificate.display()))
            .map_err(Failure::Input)?;
        let onnx = self.onnx.unwrap_or_else(|| certificate.onnx.clone());
        let vnnlib = self.vnnlib.unwrap_or_else(|| certificate.vnnlib.clone());
        let (network, property) = read(&onnx, &vnnlib)?;
        let regions = certificate.check(&network, &property);
        let regions =
            regions.map_err(|e| Failure::Check(format!("{}: {e}", self.certificate.display())))?;
        // A closed pipe (`| head`) is not an error.
        let _ = writeln!(std::io::stdout(), "proved: {regions} regions checked");
        Ok(())
    }
}
