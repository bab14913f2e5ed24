//! `cede import`.

use crate::failure::Failure;
use cede_controller::policy::features::LIMIT;
use cede_controller::{FeatureSet, Perspective, Policy};
use cede_data::output;
use cede_formats::cede;
use cede_formats::description::{features_named, perspective_name, perspective_named};
use cede_formats::onnx::{self, ImportError, Told};
use std::path::PathBuf;

/// The graph: Sub, Add, Mul, Div and one Clip to ± a number (all optional), one to three hidden layers of at most
/// 128 neurons with ReLU, an output layer, Tanh and Mul by 3 (optional). Accelerations are 3·tanh of the
/// network's first two outputs: for a joint policy the left-turner's and the other's, else the ego's and, where
/// there is a second, what it expects of the other.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The policy, ONNX
    #[arg(long, value_name = "FILE")]
    onnx: PathBuf,
    /// Features that the network is told: raw, route, traffic or scene; by default what the file's metadata say
    #[arg(long, value_name = "SET", value_parser = feature_set)]
    features: Option<FeatureSet>,
    /// Whose commands it gives: ego or joint; by default what the file's metadata say, else ego
    #[arg(long, value_name = "WHOSE", value_parser = perspective)]
    perspective: Option<Perspective>,
    /// The weights file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

fn feature_set(name: &str) -> Result<FeatureSet, String> {
    features_named(name).ok_or_else(|| {
        let names = FeatureSet::ALL.map(FeatureSet::name).join(", ");
        format!("no feature set is called `{name}`; there are: {names}")
    })
}

fn perspective(name: &str) -> Result<Perspective, String> {
    perspective_named(name).ok_or_else(|| "it is either ego or joint".to_owned())
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let path = args.onnx.display();
    let bytes = std::fs::read(&args.onnx).map_err(|error| {
        Failure::input(format!("cannot read {path}: {error}"), "check the path")
    })?;
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
            "say which with --features raw, route, traffic or scene"
        }
        ImportError::Depth(_) | ImportError::Width { .. } => {
            "train a smaller network, or distil this one"
        }
        ImportError::Outputs { .. } => "export the means of the commands alone",
        ImportError::Weights(_) => "keep weights within ± 1000 and normalise the features",
        _ => "see `cede help import` for the graphs that are understood",
    }
}

/// What was made of the graph, with the range in which it hears of each feature.
fn describe(policy: &Policy<'_>) {
    let weights = policy.weights();
    println!(
        "{} policy over the features `{}`, hidden layers {} wide",
        perspective_name(weights.perspective),
        weights.features.name(),
        weights.network.width()
    );
    for (label, (centre, scale)) in weights.features.labels().zip(weights.normalisation()) {
        let reach = LIMIT / scale.abs();
        let (low, high) = (centre - reach, centre + reach);
        println!("  {label:<20} limited to {low:.1} … {high:.1}");
    }
}
