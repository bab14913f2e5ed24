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
use crate::report::{self, Learned, Report};
use crate::settings::AlgorithmName;
use crate::source::{self, Source};
use crate::threads::Threads;
use cede_data::{Dataset, Split};
use cede_sim::evaluate::{Drive, Selection, TableRow};
use std::path::{Path, PathBuf};
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
    /// Also train without each file in turn and judge on that file: one more training per file. Of several
    /// sites, one file of each is left out at a time
    #[arg(long)]
    leave_one_file_out: bool,
    /// Also train seven times without every seventh file of each site and judge on those
    #[arg(long, conflicts_with = "leave_one_file_out")]
    seven_fold: bool,
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

/// What the reports say of several seeds.
const SEED_NOTE: &str = "Trained drivers: seed 0 alone. Means over the seeds are in the terminal's tables; rows.json has every seed.";

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    args.threads.start()?;
    if args.transfer.is_some() && args.source.is_synthetic() {
        return Err(Failure::ignored("--transfer", "--data synthetic"));
    }
    cede_data::output::check(&args.out.join("rows.json"))?;
    let sites = args.source.occupied(args.source.load(1)?)?;
    let rows = plan::rows(args, args.source.is_several())?;
    sites.iter().try_for_each(trainable)?;
    let transfer = plan::transfer_site(args)?;
    let every_pair = plan::every_pair(&rows, &sites);
    let data = plan::Data {
        sites: &sites,
        every_pair: &every_pair,
        transfer: transfer.as_ref(),
    };
    let held_out = args.held_out();
    let jobs = data.jobs(&rows, args.seeds, held_out);
    let names = source::names(&sites);
    let trained = job::train_all(&jobs, &names, &args.out, args.resume).inspect_err(|failure| {
        if let Failure::Interrupted = failure {
            eprintln!("saved to {}; continue with --resume", args.out.display());
        }
    })?;

    let mut reports = Reports::new(&sites);
    if args.seeds > 1 {
        reports.tell_seed();
    }
    let mut rows = Vec::new();
    for judged in judge::policies(&jobs, &trained)? {
        if judged.seed == 0 {
            reports.add(&judged.row, &judged.drives);
        }
        rows.push(Seeded {
            seed: Some(judged.seed),
            row: judged.row,
        });
    }
    for dataset in &sites {
        let baselines = judge::baselines(dataset, held_out);
        let baselines = baselines.judge(dataset, |row, drives| reports.add(row, drives))?;
        rows.extend(baselines.into_iter().map(|row| Seeded { seed: None, row }));
    }

    let curves = output::curves(&jobs, &trained);
    reports.write(&curves, &args.out)?;
    let output = output::Output {
        data: &args.source.data,
        site: &names,
        rows: &rows,
        curves: &curves,
    };
    output.write(&args.out, args.json)
}

impl Args {
    /// The cross-validation that is asked for.
    fn held_out(&self) -> Option<Selection> {
        if self.leave_one_file_out {
            Some(Selection::LeaveOneFileOut)
        } else {
            self.seven_fold.then_some(Selection::SevenFold)
        }
    }
}

/// Checks that there is something to learn from at a site.
fn trainable(dataset: &Dataset) -> Result<(), Failure> {
    if dataset.split(Split::Train).next().is_some() {
        return Ok(());
    }
    Err(Failure::input(
        format!(
            "no encounters in the training files of {}",
            dataset.site.name
        ),
        "add training files to the folder, or name another site",
    ))
}

/// The reports: one a site.
struct Reports(Vec<(String, Report)>);

impl Reports {
    fn new(sites: &[Dataset]) -> Self {
        let command = report::command();
        let named = |site: &Dataset| (site.site.name.clone(), Report::new(site, &command));
        Self(sites.iter().map(named).collect())
    }

    fn tell_seed(&mut self) {
        for (_, report) in &mut self.0 {
            report.tell_seed(SEED_NOTE);
        }
    }

    /// Adds a row to the report of its site, or else to all reports: it is one of a site that nothing is
    /// trained on.
    fn add(&mut self, row: &TableRow, drives: &[Drive<'_>]) {
        let known = self.0.iter().any(|(site, _)| *site == row.site);
        for (_, report) in self
            .0
            .iter_mut()
            .filter(|(site, _)| !known || *site == row.site)
        {
            report.add(row, drives);
        }
    }

    /// Writes `report.html`, or for several sites `report-SITE.html` for each.
    fn write(self, curves: &[Learned], folder: &Path) -> Result<(), Failure> {
        let alone = self.0.len() == 1;
        for (site, mut report) in self.0 {
            let name = if alone {
                "report.html".to_owned()
            } else {
                format!("report-{site}.html")
            };
            report.learned(curves);
            report.write(&folder.join(name))?;
        }
        Ok(())
    }
}
