//! `cede verify check`.

use crate::failure::Failure;
use crate::input::{self, unusable};
use cede_nnv_check::{Certificate, Proved, Source};
use clap::Args;
use std::path::PathBuf;

/// The text below the options in `cede help verify check`.
const HELP: &str = "\
Exit code 0 if the certificate is a proof, 1 if it is not. The certificate names the network and the property by
path, relative to the current folder, and by hash. --onnx and --vnnlib replace the paths; files of other content are
refused. What has been proved of what is printed.";

/// What the file should be.
const CERTIFICATE: &str = "a certificate that `cede verify network --certificate FILE` wrote";

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
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

impl Check {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let text = input::text(&self.certificate, CERTIFICATE)?;
        let mut certificate = Certificate::from_text(&text)
            .map_err(|error| unusable(&self.certificate, error, CERTIFICATE))?;
        for (file, given) in [
            (&mut certificate.onnx, self.onnx),
            (&mut certificate.vnnlib, self.vnnlib),
        ] {
            file.path = given.unwrap_or_else(|| file.path.clone());
        }
        let (onnx, vnnlib) = (&certificate.onnx.path, &certificate.vnnlib.path);
        let model = input::bytes(onnx, "the network of the certificate with --onnx")?;
        let text = input::bytes(vnnlib, "the property of the certificate with --vnnlib")?;
        let proved = certificate.check(&model, &text);
        let proved =
            proved.map_err(|e| Failure::Check(format!("{}: {e}", self.certificate.display())))?;
        if self.json {
            println!("{}", json(&proved));
        } else {
            println!("{proved}");
        }
        Ok(())
    }
}

fn json(proved: &Proved) -> serde_json::Value {
    let [inputs, outputs, layers, weights] = proved.network;
    let file =
        |source: &Source| serde_json::json!({ "path": source.path, "sha256": source.sha256 });
    serde_json::json!({
        "verdict": "proved", "semantics": "real", "onnx": file(&proved.onnx), "inputs": inputs, "outputs": outputs,
        "layers": layers, "weights": weights, "vnnlib": file(&proved.vnnlib), "boxes": proved.boxes,
        "unsafe_sets": proved.unsafe_sets, "program": proved.program, "regions": proved.regions,
    })
}
