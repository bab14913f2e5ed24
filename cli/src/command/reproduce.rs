//! `cede reproduce`: trains and judges the rows of the paper's table.
//!
//! `plan` lists the trainings, `job` runs one, `judge` evaluates the policies, and `output` prints and
//! stores the results.

mod job;
mod judge;
mod output;
mod plan;
mod summary;

use crate::failure::Failure;
use crate::report::{self, Report};
use crate::settings::AlgorithmName;
use crate::source::Source;
use crate::threads::Threads;
use cede_data::Split;
use std::path::PathBuf;
use summary::Seeded;

/// Options of `cede reproduce`.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    source: Source,
    /// Rows to train: bc, sac, sacer-v, sacer-svo, apg, separated by commas
    #[arg(
        long,
        value_delimiter = ',',
        value_enum,
        default_value = "bc,sacer-v,sacer-svo",
        hide_possible_values = true
    )]
    rows: Vec<AlgorithmName>,
    /// Seeds to train each row from
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,
    /// Change one setting of a row, as in `--set apg.width=64`; repeatable. `cede train ROW
    /// --show-settings` prints the names
    #[arg(long, value_name = "ROW.NAME=VALUE")]
    set: Vec<String>,
    /// Also train without each file in turn and judge on that file: one more training per file
    #[arg(long)]
    leave_one_file_out: bool,
    /// Also judge on all encounters of this site, in the same folder; nothing is trained on it
    #[arg(long, value_name = "SITE")]
    transfer: Option<String>,
    /// Folder for the weights, the learning curves, the numbers and the report
    #[arg(long, default_value = "out/reproduce", value_name = "DIR")]
    out: PathBuf,
    /// Continue an interrupted run in the same folder
    #[arg(long)]
    resume: bool,
    /// Print one JSON object instead of the table; shares are fractions
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    threads: Threads,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    args.threads.start()?;
    if args.transfer.is_some() && args.source.is_synthetic() {
        return Err(Failure::ignored("--transfer", "--data synthetic"));
    }
    let rows = plan::rows(args)?;
    let dataset = args.source.load(1)?;
    if dataset.split(Split::Train).next().is_none() {
        return Err(Failure::input(
            "no encounters in the training files",
            "add training files to the folder, or name another site",
        ));
    }
    let transfer = plan::transfer_site(args)?;
    let auxiliary = rows
        .iter()
        .any(|row| row.algorithm.uses_auxiliary_encounters());
    let every_pair = auxiliary.then(|| dataset.every_pair());
    let data = plan::Data {
        dataset: &dataset,
        every_pair: every_pair.as_ref(),
        transfer: transfer.as_ref(),
    };
    let jobs = data.jobs(&rows, args.seeds, args.leave_one_file_out);
    let trained = job::train_all(&jobs, &dataset.site.name, &args.out, args.resume).inspect_err(
        |failure| {
            if let Failure::Interrupted = failure {
                eprintln!("saved to {}; continue with --resume", args.out.display());
            }
        },
    )?;

    let mut report = Report::new(&dataset, &report::command());
    let mut rows = Vec::new();
    for judged in judge::policies(&jobs, &trained)? {
        if judged.seed == 0 {
            report.add(&judged.row, &judged.drives);
        }
        rows.push(Seeded {
            seed: Some(judged.seed),
            row: judged.row,
        });
    }
    let baselines = judge::baselines(&dataset, args.leave_one_file_out);
    let baselines = baselines.judge(&dataset, |row, drives| report.add(row, drives))?;
    rows.extend(baselines.into_iter().map(|row| Seeded { seed: None, row }));

    let curves = output::curves(&jobs, &trained);
    report.learned(&curves);
    report.write(&args.out.join("report.html"))?;
    let output = output::Output {
        data: &args.source.data,
        site: &dataset.site.name,
        rows: &rows,
        curves: &curves,
    };
    output.write(&args.out, args.json)
}
