//! `cede reproduce`: the paper's table, from training to judgement, beside the paper's numbers.

mod job;
mod summary;

use super::train::Choice;
use crate::drivers::Contender;
use crate::failure::Failure;
use crate::judge::{ModeName, Plan, UntilName};
use crate::report::{self, Learned, Report};
use crate::source::{Source, not_empty};
use crate::threads::Threads;
use crate::{interrupt, settings};
use cede_controller::{Contract, Policy};
use cede_data::{Dataset, Encounter, Split, output};
use cede_sim::driver::{Baseline, Cede, DriverFactory, PolicyAlone};
use cede_sim::episode::Until;
use cede_sim::evaluate::{Drive, Label, Mode, Protocol, Row, Selection, evaluate};
use cede_train::run::curve::Curve;
use cede_train::run::{Algorithm, Settings};
use indicatif::{ProgressBar, ProgressStyle};
use job::Job;
use rayon::prelude::*;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

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
    rows: Vec<Choice>,
    /// Seeds to train each row from
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,
    /// One setting of a row that differs, as in `--set apg.width=64`; repeatable. See `cede train ROW
    /// --show-settings` for their names
    #[arg(long, value_name = "ROW.NAME=VALUE")]
    set: Vec<String>,
    /// Also train without each file in turn and judge on it: as many trainings more as there are files
    #[arg(long)]
    leave_one_file_out: bool,
    /// Also judge on all encounters of this site, in the same folder, which nothing is fitted to
    #[arg(long, value_name = "SITE")]
    transfer: Option<String>,
    /// Folder for the weights, the learning curves, the numbers and the report
    #[arg(long, default_value = "out/reproduce", value_name = "DIR")]
    out: PathBuf,
    /// Take up what an interrupted run has left in the folder
    #[arg(long)]
    resume: bool,
    /// Print one JSON object instead of the table; shares are fractions
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    threads: Threads,
}

/// Without a shield, and with one of each contract; by their names in the table.
const SHIELDS: [(&str, Option<Contract>); 3] = [
    ("off", None),
    ("all-way stop", Some(Contract::ALL_WAY_STOP)),
    ("worst case", Some(Contract::WORST_CASE)),
];

/// What a training left.
struct Trained {
    policy: Policy<'static>,
    curve: Curve,
}

/// A row with the seed that it was trained from; baselines have none.
#[derive(Serialize)]
struct Seeded {
    seed: Option<u64>,
    #[serde(flatten)]
    row: Row,
}

/// What `--json` prints, and what is kept in the folder.
#[derive(Serialize)]
struct Output<'a> {
    data: &'a str,
    site: &'a str,
    rows: &'a [Seeded],
    curves: &'a [Learned],
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    args.threads.start()?;
    if args.transfer.is_some() && args.source.is_synthetic() {
        return Err(Failure::ignored("--transfer", "--data synthetic"));
    }
    let rows = args.settled_rows()?;
    let dataset = args.source.load(1)?;
    if dataset.split(Split::Train).next().is_none() {
        return Err(Failure::input(
            "there is nothing to learn from: no encounters in the training files",
            "add training files to the folder, or name another site",
        ));
    }
    let elsewhere = args.elsewhere()?;
    let looks_beside = rows.iter().any(|(row, _)| row.looks_beside());
    let every = looks_beside.then(|| dataset.every_pair());
    let jobs = args.jobs(&rows, &dataset, every.as_ref(), elsewhere.as_ref());
    let trained = args
        .train(&jobs, &dataset.site.name)
        .inspect_err(|failure| {
            if let Failure::Interrupted = failure {
                eprintln!("saved to {}; go on with --resume", args.out.display());
            }
        })?;
    let mut report = Report::new(&dataset, &report::command());
    let mut rows = Vec::new();
    for judged in args.judged(&jobs, &trained)? {
        if judged.seed == 0 {
            report.add(&judged.row, &judged.drives);
        }
        rows.push(Seeded {
            seed: Some(judged.seed),
            row: judged.row,
        });
    }
    let baselines = args.baselines(&dataset).judge(&dataset, |row, drives| {
        report.add(row, drives);
    })?;
    rows.extend(baselines.into_iter().map(|row| Seeded { seed: None, row }));
    let curves = curves(&jobs, &trained);
    report.learned(&curves);
    report.write(&args.out.join("report.html"))?;
    args.print(&dataset, &rows, &curves)
}

/// The learning curves of what was trained on the training split.
fn curves(jobs: &[Job<'_>], trained: &[Trained]) -> Vec<Learned> {
    let whole = jobs
        .iter()
        .zip(trained)
        .filter(|(job, _)| job.without.is_none());
    whole
        .map(|(job, trained)| Learned {
            driver: job.algorithm.name(),
            seed: job.seed,
            points: trained.curve.points.clone(),
        })
        .collect()
}

/// What the drivers of one row and seed did on one split.
struct Judged<'d> {
    /// Its name in [`SHIELDS`].
    shield: &'static str,
    split: String,
    algorithm: Algorithm,
    seed: u64,
    drives: Vec<Drive<'d>>,
    row: Row,
}

impl Args {
    /// The splits that are there.
    fn splits(dataset: &Dataset) -> Vec<Split> {
        [Split::Train, Split::Validation, Split::Test]
            .into_iter()
            .filter(|&split| dataset.split(split).next().is_some())
            .collect()
    }

    fn elsewhere(&self) -> Result<Option<Dataset>, Failure> {
        let Some(site) = &self.transfer else {
            return Ok(None);
        };
        let dataset = Dataset::load(Path::new(&self.source.data), site)?;
        not_empty(&dataset)?;
        Ok(Some(dataset))
    }

    /// The rows, each once, with their settings.
    ///
    /// # Errors
    /// A setting is not sound, or belongs to no row that is trained.
    fn settled_rows(&self) -> Result<Vec<(Algorithm, Settings)>, Failure> {
        let mut rows: Vec<Algorithm> = Vec::new();
        for Choice(row) in &self.rows {
            if !rows.contains(row) {
                rows.push(*row);
            }
        }
        settings::of_rows(&rows, &self.set)
    }

    /// `every` has the pairs that may be looked at beside those that are judged.
    fn jobs<'d>(
        &self,
        rows: &[(Algorithm, Settings)],
        dataset: &'d Dataset,
        every: Option<&'d Dataset>,
        elsewhere: Option<&'d Dataset>,
    ) -> Vec<Job<'d>> {
        let beside = |algorithm: Algorithm, training: &[&Encounter]| {
            let learned = |file| training.iter().any(|e| e.id.file == file);
            let every = every.filter(|_| algorithm.looks_beside()).into_iter();
            let every = every.flat_map(|every| &every.encounters);
            every.filter(|e| learned(e.id.file)).collect()
        };
        let mut judged: Vec<(String, Vec<&'d Encounter>)> = Vec::new();
        for split in Self::splits(dataset) {
            judged.push((
                Selection::Split(split).name().to_owned(),
                dataset.split(split).collect(),
            ));
        }
        if let Some(site) = elsewhere {
            let all = site.encounters.iter().collect();
            judged.push((format!("{}, all", site.site.name), all));
        }
        let seeded = (0..self.seeds).flat_map(|seed| rows.iter().map(move |row| (row, seed)));
        let jobs = seeded.flat_map(|((algorithm, settings), seed)| {
            let algorithm = *algorithm;
            let training: Vec<_> = dataset.split(Split::Train).collect();
            let whole = Job {
                algorithm,
                settings: settings.clone(),
                seed,
                without: None,
                beside: beside(algorithm, &training),
                training,
                validation: dataset.split(Split::Validation).collect(),
                judged: judged.clone(),
            };
            let folds = if self.leave_one_file_out {
                dataset.folds()
            } else {
                Vec::new()
            };
            let folds = folds.into_iter().map(move |fold| Job {
                algorithm,
                settings: settings.clone(),
                seed,
                without: Some(fold.file),
                beside: beside(algorithm, &fold.train),
                training: fold.train,
                validation: Vec::new(),
                judged: vec![(Selection::LeaveOneFileOut.name().to_owned(), fold.held_out)],
            });
            std::iter::once(whole).chain(folds)
        });
        jobs.collect()
    }

    /// Trains all `jobs`, as many at a time as there are threads.
    fn train(&self, jobs: &[Job<'_>], site: &str) -> Result<Vec<Trained>, Failure> {
        const FINE: f64 = 1e4;
        let bar = ProgressBar::new(jobs.len() as u64 * FINE as u64);
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent} % of {msg}, {eta} left")
        {
            bar.set_style(style);
        }
        bar.set_message(format!("{} trainings", jobs.len()));
        let done = Mutex::new(0.0);
        let progress = |share: f64| {
            if let Ok(mut done) = done.lock() {
                *done += share;
                bar.set_position((*done * FINE) as u64);
            }
        };
        let trained = jobs
            .par_iter()
            .with_max_len(1)
            .map(|job| job.train(site, &self.out, self.resume, &progress))
            .collect();
        bar.finish_and_clear();
        trained
    }

    /// What they do without and with the shield; the files of leave-one-file-out put together.
    fn judged<'d>(
        &self,
        jobs: &[Job<'d>],
        trained: &[Trained],
    ) -> Result<Vec<Judged<'d>>, Failure> {
        let mut all: Vec<Judged<'d>> = Vec::new();
        for (job, trained) in jobs.iter().zip(trained) {
            for ((split, encounters), (shield, contract)) in job
                .judged
                .iter()
                .flat_map(|j| SHIELDS.map(|shield| (j, shield)))
            {
                interrupt::check()?;
                let protocol = Protocol {
                    mode: Mode::Joint,
                    until: Until::Conflict,
                    seed: job.seed,
                };
                let factory = factory(trained.policy, contract);
                let drives = evaluate(&*factory, encounters, protocol);
                let same = |j: &&mut Judged<'_>| {
                    (j.shield, &j.split, j.algorithm, j.seed)
                        == (shield, split, job.algorithm, job.seed)
                };
                if let Some(known) = all.iter_mut().find(same) {
                    known.drives.extend(drives);
                } else {
                    all.push(Judged {
                        shield,
                        split: split.clone(),
                        algorithm: job.algorithm,
                        seed: job.seed,
                        row: Row::of(label(job.algorithm, split, shield), &[]),
                        drives,
                    });
                }
            }
        }
        for judged in &mut all {
            let label = label(judged.algorithm, &judged.split, judged.shield);
            judged.row = Row::of(label, &judged.drives);
        }
        Ok(all)
    }

    fn baselines(&self, dataset: &Dataset) -> Plan {
        let splits = Self::splits(dataset).into_iter().map(Selection::Split);
        let folds = self
            .leave_one_file_out
            .then_some(Selection::LeaveOneFileOut);
        Plan {
            contenders: Baseline::ALL.map(Contender::Baseline).into(),
            lenient: true,
            selections: splits.chain(folds).collect(),
            mode: ModeName::Joint,
            partner: Baseline::Replay,
            until: UntilName::Conflict,
            shields: vec![None],
            seed: 0,
        }
    }

    fn print(&self, dataset: &Dataset, rows: &[Seeded], curves: &[Learned]) -> Result<(), Failure> {
        let output = Output {
            data: &self.source.data,
            site: &dataset.site.name,
            rows,
            curves,
        };
        let text = serde_json::to_string_pretty(&output)
            .map_err(|error| Failure::input(error, "report this as a bug"))?;
        output::write(&self.out.join("rows.json"), |file| {
            file.write_all(text.as_bytes())
        })?;
        if self.json {
            println!("{text}");
        } else {
            print!("{}", summary::render(rows, dataset.site.name == "EP0"));
            println!(
                "report, weights and numbers of every seed: {}",
                self.out.display()
            );
        }
        Ok(())
    }
}

fn label<'a>(algorithm: Algorithm, split: &'a str, shield: &'a str) -> Label<'a> {
    Label {
        driver: algorithm.name(),
        split,
        mode: "joint",
        until: "conflict",
        shield,
    }
}

fn factory(policy: Policy<'static>, contract: Option<Contract>) -> Box<dyn DriverFactory> {
    match contract {
        None => Box::new(PolicyAlone::new(policy)),
        Some(contract) => Box::new(Cede::new(policy, contract)),
    }
}
