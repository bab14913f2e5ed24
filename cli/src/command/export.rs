//! `cede export`.

use crate::drivers;
use crate::failure::Failure;
use cede_data::output;
use cede_formats::{onnx, safetensors};
use clap::ValueEnum;
use std::path::PathBuf;

/// The text below the options in `cede help export`.
const HELP: &str = "\
ONNX: raw features in, accelerations (m/s²) out; normalisation and squashing are in the graph. Metadata:
cede.features, cede.feature_names, cede.perspective, cede.provenance_sha256.
Safetensors: the parameters of the network and of the normalisation, with the same metadata as JSON.";

/// Options of `cede export`.
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub(crate) struct Args {
    /// The policy (`.cede`); by default the embedded one
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// The format
    #[arg(long)]
    format: Format,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    Onnx,
    Safetensors,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let policy = drivers::policy(args.weights.as_deref())?;
    let bytes = match args.format {
        Format::Onnx => onnx::export(policy.weights()),
        Format::Safetensors => safetensors::write(policy.weights())
            .map_err(|error| Failure::input(error, "report this as a bug"))?,
    };
    output::write(&args.out, |file| file.write_all(&bytes))?;
    println!("{}", args.out.display());
    Ok(())
}
