//! `cede import`.

use crate::failure::Failure;
use crate::input;
use cede_controller::policy::features::LIMIT;
use cede_controller::{FeatureSet, Perspective, Policy};
use cede_data::output;
use cede_formats::cede;
use cede_formats::description::{features_named, perspective_name, perspective_named};
use cede_formats::onnx::{self, ImportError, Told};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::path::PathBuf;

/// The text below the options in `cede help import`.
fn help() -> String {
    let sets = FeatureSet::ALL.map(|set| format!("{} {}", set.name(), set.count()));
    format!("\
Supported graphs: a chain, in this order, of
  1. Sub, Add, Mul and Div with constants, and one Clip to ± a number: the normalisation; each may be missing
  2. one to three hidden layers of at most 128 neurons: Gemm, or MatMul and Add, then Relu
  3. an output layer: Gemm, or MatMul and Add
  4. Tanh, and Mul by 3: each may be missing, as accelerations are always 3·tanh of the outputs, in m/s²
Identity, Dropout and Flatten (axis 1) may occur anywhere. Constants are float, double or int64, inside the file.

Inputs: the features of one set, in its order. Their numbers: {sets}; `cede export`
writes their names to the metadata.
Outputs, 2 or 4, or for an ego policy 1: the first vehicle's command, the second's, and two that are ignored.
A joint policy's vehicles are the left-turner and the other. An ego policy's second output is the
acceleration that it expects of the other; without it, the other is expected to keep its speed.

Metadata: cede.features (one of these sets) and cede.perspective (ego, joint). --features and
--perspective override them. Without cede.features, --features is required; cede.perspective defaults to ego.

Weights must be within ± 1000. A graph without Clip gets one; the limits of each feature are printed.",
        sets = sets.join(", ")
    )
}

/// Options of `cede import`.
#[derive(clap::Args)]
#[command(after_help = help())]
pub(crate) struct Args {
    /// The policy, ONNX
    #[arg(long, value_name = "FILE")]
    onnx: PathBuf,
    /// The network's features; by default those of the file's metadata
    #[arg(long, value_name = "SET", value_parser = feature_sets())]
    features: Option<FeatureSet>,
    /// Whose commands the outputs are; by default that of the file's metadata, else ego
    #[arg(long, value_name = "WHOSE", value_parser = perspectives())]
    perspective: Option<Perspective>,
    /// The weights file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// The sets by their names.
fn feature_sets() -> impl TypedValueParser<Value = FeatureSet> {
    let names = PossibleValuesParser::new(FeatureSet::ALL.map(FeatureSet::name));
    names.try_map(|name| features_named(&name).ok_or("unknown"))
}

/// The perspectives by their names.
fn perspectives() -> impl TypedValueParser<Value = Perspective> {
    let names = [Perspective::Ego, Perspective::Joint].map(perspective_name);
    PossibleValuesParser::new(names).try_map(|name| perspective_named(&name).ok_or("unknown"))
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let path = args.onnx.display();
    let bytes = input::bytes(&args.onnx, "a policy in ONNX")?;
    let told = Told {
        features: args.features,
        perspective: args.perspective,
    };
    let words = onnx::import(&bytes, told)
        .map_err(|error| Failure::input(format!("cannot use {path}: {error}"), mend(&error)))?;
    let policy =
        cede::keep(&words).map_err(|error| Failure::input(error, "report this as a bug"))?;
    let mut file: Vec<u8> = Vec::with_capacity(4 * words.len());
    file.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    output::write(&args.out, |out| out.write_all(&file))?;
    describe(&policy);
    println!("{}", args.out.display());
    Ok(())
}

fn mend(error: &ImportError) -> &'static str {
    match error {
        ImportError::Unstated | ImportError::Inputs { .. } => {
            "say which with --features raw, route, traffic, scene or rights"
        }
        ImportError::Depth(_) | ImportError::Width { .. } => {
            "train a smaller network, or distil this one"
        }
        ImportError::Outputs { .. } => "export the means of the commands alone",
        ImportError::Weights(_) => "keep weights within ± 1000 and normalise the features",
        _ => "see `cede help import` for the supported graphs",
    }
}

/// A summary of the imported network, with the range in which each feature has an effect.
fn describe(policy: &Policy<'_>) {
    let weights = policy.weights();
    println!(
        "{} policy over the features `{}`, hidden layers {} wide",
        perspective_name(weights.perspective()),
        weights.features().name(),
        weights.network().width()
    );
    for (label, (centre, scale)) in weights.features().labels().zip(weights.normalisation()) {
        let reach = LIMIT / scale.abs();
        let (low, high) = (centre - reach, centre + reach);
        println!("  {label:<20} limited to {low:.1} … {high:.1}");
    }
}
