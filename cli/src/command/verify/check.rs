//! `cede verify check`.

use super::network::bytes;
use crate::failure::Failure;
use cede_nnv_check::Certificate;
use clap::Args;
use miette::{IntoDiagnostic, WrapErr};
use std::io::Write as _;
use std::path::PathBuf;

/// The text below the options in `cede help verify check`.
const HELP: &str = "\
Exit code 0 if the certificate is a proof, 1 if it is not. The certificate names the network and the property by
path, relative to the current folder, and by hash. --onnx and --vnnlib replace the paths; files of other content are
refused. What has been proved of what is printed.";

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
        let onnx = self.onnx.unwrap_or_else(|| certificate.onnx.path.clone());
        let vnnlib = self
            .vnnlib
            .unwrap_or_else(|| certificate.vnnlib.path.clone());
        let model = bytes(&onnx, "the network of the certificate")?;
        let text = bytes(&vnnlib, "the property of the certificate")?;
        let proved = certificate.check(&model, &text);
        let mut proved =
            proved.map_err(|e| Failure::Check(format!("{}: {e}", self.certificate.display())))?;
        (proved.onnx.path, proved.vnnlib.path) = (onnx, vnnlib);
        // A closed pipe (`| head`) is not an error.
        let _ = writeln!(std::io::stdout(), "{proved}");
        Ok(())
    }
}
