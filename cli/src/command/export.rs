//! `cede export`.

use crate::command::verify::policy::properties_of;
use crate::drivers;
use crate::failure::Failure;
use cede_controller::Weights;
use cede_data::output;
use cede_formats::quantise::quantise;
use cede_formats::{onnx, safetensors};
use clap::ValueEnum;
use std::path::{Path, PathBuf};

/// The text below the options in `cede help export`.
const HELP: &str = "\
ONNX: raw features in, accelerations (m/s²) out; normalisation and squashing are in the graph. Metadata:
cede.features, cede.feature_names, cede.perspective, cede.provenance_sha256.
Safetensors: the parameters of the network and of the normalisation, with the same metadata as JSON.
Integers: 16-bit weights and activations, 32-bit sums that cannot overflow. How many fractional bits the activations
have is chosen on states of the regions of docs/safety/policy.toml. `cede verify departure` bounds the difference.";

/// What to do about a policy that cannot be exported.
const F32: &str = "give a policy in f32 as `cede train` writes it";

/// Options of `cede export`.
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub(crate) struct Args {
    /// The policy (`.cede`); by default the embedded one
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// The format
    #[arg(long, required_unless_present = "quantise")]
    format: Option<Format>,
    /// Write a weights file (`.cede`) of integers instead, for cores without an FPU and for half the flash
    #[arg(long, conflicts_with = "format")]
    quantise: Option<Numbers>,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum Numbers {
    I16,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    Onnx,
    Safetensors,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let policy = drivers::policy(args.weights.as_deref())?;
    let weights = policy.weights();
    let bytes = match args.format {
        None => return quantised(weights, &args.out),
        Some(Format::Onnx) => onnx::export(weights).map_err(|error| Failure::input(error, F32))?,
        Some(Format::Safetensors) => {
            safetensors::write(weights).map_err(|error| Failure::input(error, F32))?
        }
    };
    output::write(&args.out, |file| file.write_all(&bytes))?;
    println!("{}", args.out.display());
    Ok(())
}

/// Writes a policy of integers.
fn quantised(weights: &Weights<'_>, out: &Path) -> Result<(), Failure> {
    let quantised = quantise(weights, &properties_of(None)?);
    let quantised = quantised.map_err(|error| Failure::input(error, F32))?;
    let bytes: Vec<u8> = quantised
        .words
        .iter()
        .flat_map(|word| word.to_le_bytes())
        .collect();
    output::write(out, |file| file.write_all(&bytes))?;
    let [inputs, first, second, third] = quantised.bits;
    println!(
        "{}: fractional bits of inputs and activations {inputs}, {first}, {second}, {third}; \
         accelerations depart by up to {:.4} m/s² in {} states",
        out.display(),
        quantised.departure,
        quantised.states
    );
    Ok(())
}
