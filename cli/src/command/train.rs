//! `cede train`: from encounters to a weights file.
//!
//! `order` runs a training from its options, `provenance` describes it, and `bar` shows its progress.

mod bar;
mod order;
mod provenance;

use crate::failure::Failure;
use crate::input;
use crate::settings::{AlgorithmName, check, quoted, with};
use crate::source::Source;
use crate::threads::Threads;
use cede_train::run::TrainSettings;
use order::Order;
use std::path::PathBuf;

/// Options of `cede train`.
#[derive(clap::Args)]
#[command(mut_arg("data", |data| data.required(false).required_unless_present("show_settings")))]
pub(crate) struct Args {
    #[command(flatten)]
    method: Method,
    #[command(flatten)]
    source: Option<Source>,
    /// The weights file to write; FILE.txt receives its provenance, FILE.checkpoint the
    /// checkpoints
    #[arg(
        long,
        value_name = "FILE.cede",
        required_unless_present = "show_settings"
    )]
    out: Option<PathBuf>,
    #[command(flatten)]
    options: Options,
    /// Print the algorithm's settings as TOML and exit; no other option is needed. With several sites in
    /// --site those are printed that are used for several sites
    #[arg(long)]
    show_settings: bool,
}

/// The algorithm and its settings.
#[derive(clap::Args)]
struct Method {
    /// The algorithm
    #[arg(value_enum)]
    algorithm: AlgorithmName,
    /// Settings that differ from the defaults, as TOML
    #[arg(long, value_name = "FILE.toml")]
    settings: Option<PathBuf>,
    /// Change one setting, as in `--set width=128` or `--set rates.policy=3e-4`; repeatable
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
}

/// The remaining options of a training.
#[derive(clap::Args)]
struct Options {
    /// Seed of the synthetic encounters; --seed is that of the training [default: 1]
    #[arg(long, value_name = "SEED")]
    data_seed: Option<u64>,
    /// In a refinement, penalise deviation from the unrefined network wherever two vehicles of the
    /// training files cross or merge
    #[arg(long)]
    every_pair: bool,
    /// Properties of the policy that `apg` learns in addition to driving
    #[arg(long, value_name = "FILE.toml")]
    claims: Option<PathBuf>,
    /// Seed of every random choice of the training
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Folder for the training curves: CSV, and TensorBoard's event file
    #[arg(long, value_name = "DIR")]
    log: Option<PathBuf>,
    /// Continue from the last checkpoint of the same run
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    threads: Threads,
}

/// What the file of `--settings` should be.
const SETTINGS: &str = "settings as --show-settings prints them";
/// Default seed of the synthetic encounters.
const DATA_SEED: u64 = 1;

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let several = args.source.as_ref().is_some_and(Source::is_several);
    let settings = args.method.settings(several)?;
    match (&args.source, &args.out) {
        (Some(source), Some(out)) if !args.show_settings => {
            let order = Order {
                method: &args.method,
                source,
                out,
                options: &args.options,
            };
            order.run(settings)
        }
        _ => {
            print!("{}", settings.text());
            Ok(())
        }
    }
}

impl Method {
    /// The settings for one site or for `several`.
    fn settings(&self, several: bool) -> Result<TrainSettings, Failure> {
        let mut settings = if several {
            self.algorithm.0.several_sites()
        } else {
            self.algorithm.0.settings()
        };
        if let Some(path) = &self.settings {
            settings = with(
                &settings,
                &input::text(path, SETTINGS)?,
                &path.display().to_string(),
            )?;
        }
        for set in &self.set {
            settings = with(&settings, &quoted(set), "--set")?;
        }
        check(&settings)?;
        Ok(settings)
    }
}
