//! `cede reproduce`: the paper's table, from training to judgement, beside the paper's numbers.

use crate::failure::Failure;
use crate::interrupt;
use crate::source::Source;
use crate::table;
use cede_controller::{Contract, Policy};
use cede_sim::data::Split;
use cede_sim::driver::{Cede, DriverFactory, PolicyAlone};
use cede_sim::episode::Until;
use cede_sim::evaluate::{Drive, Label, Mode, Protocol, Row, Selection, evaluate};
use cede_sim::{Dataset, Encounter, Sight, output, weights};
use cede_train::episodes::Course;
use cede_train::network::Network;
use cede_train::pilot::Pilot;
use cede_train::provenance::{Provenance, data_hash};
use cede_train::run::{Algorithm, Lessons, Run, Settings};
use comfy_table::{ContentArrangement, Table, presets};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Options of `cede reproduce`.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    source: Source,
    /// Rows to train: bc, sac, sacer-v, sacer-svo, apg, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "bc,sacer-v,sacer-svo", value_parser = named)]
    rows: Vec<Algorithm>,
    /// Seeds to train each row from
    #[arg(long, default_value_t = 5)]
    seeds: u64,
    /// Also train without each file in turn and judge on it: as many trainings more as there are files
    #[arg(long)]
    leave_one_file_out: bool,
    /// Also judge on all encounters of this site, in the same folder, which nothing is fitted to
    #[arg(long, value_name = "SITE")]
    transfer: Option<String>,
    /// Folder for the weights and the rows of every seed
    #[arg(long, default_value = "out/reproduce", value_name = "DIR")]
    out: PathBuf,
}

fn named(name: &str) -> Result<Algorithm, String> {
    let known = Algorithm::ALL.into_iter().find(|a| a.name() == name);
    known.ok_or_else(|| {
        let all = Algorithm::ALL.map(Algorithm::name).join(", ");
        format!("no row is called `{name}`; there are: {all}")
    })
}

/// From a member's seed to the next one's: more than anyone has seeds.
const MEMBER: u64 = 1 << 32;

/// Without a shield, and with one of each contract; by their names in the table.
const SHIELDS: [(&str, Option<Contract>); 3] = [
    ("off", None),
    ("all-way stop", Some(Contract::ALL_WAY_STOP)),
    ("worst case", Some(Contract::WORST_CASE)),
];

/// One training and what it is judged on.
struct Job<'d> {
    algorithm: Algorithm,
    seed: u64,
    training: Vec<&'d Encounter>,
    /// Encounters by the name of what they are a selection of.
    judged: Vec<(String, Vec<&'d Encounter>)>,
    /// The weights of this one are kept.
    keep: bool,
}

/// A row with the seed that it was trained from.
#[derive(Serialize)]
struct Seeded {
    seed: u64,
    #[serde(flatten)]
    row: Row,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    interrupt::defer();
    let dataset = args.source.load(1)?;
    let elsewhere = args.elsewhere()?;
    let jobs = args.jobs(&dataset, elsewhere.as_ref());
    let bar = ProgressBar::new(jobs.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} trainings, {eta} left") {
        bar.set_style(style);
    }
    bar.tick();
    let results: Vec<_> = jobs
        .par_iter()
        .map(|job| {
            let rows = job.run(args);
            bar.inc(1);
            rows
        })
        .collect::<Result<_, _>>()?;
    bar.finish_and_clear();
    let rows = gathered(results.into_iter().flatten().collect());
    output::write(&args.out.join("rows.json"), |file| {
        serde_json::to_writer_pretty(file, &rows).map_err(Into::into)
    })?;
    println!("{}", render(&rows, dataset.site.name == "EP0"));
    println!(
        "\nweights and the rows of every seed: {}",
        args.out.display()
    );
    Ok(())
}

impl Args {
    fn elsewhere(&self) -> Result<Option<Dataset>, Failure> {
        let load = |site| Dataset::load(Path::new(&self.source.data), site);
        Ok(self.transfer.as_deref().map(load).transpose()?)
    }

    fn jobs<'d>(&self, dataset: &'d Dataset, elsewhere: Option<&'d Dataset>) -> Vec<Job<'d>> {
        let splits = [Split::Train, Split::Validation, Split::Test].map(Selection::Split);
        let mut jobs = Vec::new();
        for (&algorithm, seed) in self
            .rows
            .iter()
            .flat_map(|a| (0..self.seeds).map(move |s| (a, s)))
        {
            let judged = splits.iter().flat_map(|&selection| {
                let rounds = selection.rounds(dataset).into_iter();
                rounds.map(move |round| (selection.name().to_owned(), round.judged))
            });
            let transferred = elsewhere.map(|site| {
                let all = site.encounters.iter().collect();
                (format!("{}, all", site.site.name), all)
            });
            jobs.push(Job {
                algorithm,
                seed,
                training: dataset.split(Split::Train).collect(),
                judged: judged
                    .chain(transferred)
                    .filter(|(_, judged)| !judged.is_empty())
                    .collect(),
                keep: true,
            });
            if !self.leave_one_file_out {
                continue;
            }
            jobs.extend(
                Selection::LeaveOneFileOut
                    .rounds(dataset)
                    .into_iter()
                    .map(|round| Job {
                        algorithm,
                        seed,
                        training: round.training,
                        judged: vec![(Selection::LeaveOneFileOut.name().to_owned(), round.judged)],
                        keep: false,
                    }),
            );
        }
        jobs
    }
}

/// What one driver did on one split, or on one file of it.
struct Part<'d> {
    /// Which of [`SHIELDS`].
    shield: usize,
    split: String,
    algorithm: Algorithm,
    seed: u64,
    drives: Vec<Drive<'d>>,
}

impl Part<'_> {
    /// What parts of one row have in common; rows are sorted by it.
    fn row(&self) -> (usize, &str, &'static str, u64) {
        (self.shield, &self.split, self.algorithm.name(), self.seed)
    }
}

impl<'d> Job<'d> {
    fn run(&self, args: &Args) -> Result<Vec<Part<'d>>, Failure> {
        let settings = self.algorithm.reproduction();
        let lessons = Lessons {
            courses: match settings {
                Settings::Sac(_) => self.training.iter().map(|e| Course::new(e)).collect(),
                _ => Vec::new(),
            },
            sights: self.training.iter().map(|e| Sight::new(e)).collect(),
            own: self.training.len(),
            claims: Vec::new(),
        };
        let provenance = Provenance {
            algorithm: self.algorithm.name().to_owned(),
            settings: settings.text(),
            seed: self.seed,
            data: format!("recordings of {}", args.source.site),
            encounters: self.training.len(),
            data_hash: data_hash(self.training.iter().copied(), ""),
            command: "cede reproduce".to_owned(),
        };
        let mut members = Vec::new();
        for member in 0..self.algorithm.members() {
            // The first member is what `cede train` makes of this seed.
            let mut run = Run::new(settings.clone(), &lessons, self.seed + member * MEMBER);
            while run.advance().is_some() {
                interrupt::check()?;
            }
            members.push(run);
        }
        let networks: Vec<Network> = members.iter().map(|r| r.pilot().network.clone()).collect();
        let pilot = Pilot {
            network: &Network::mean(&networks),
            ..members[0].pilot()
        };
        let diverged = |error| {
            Failure::input(
                format!("{}: {error}", self.algorithm.name()),
                "try another seed",
            )
        };
        let words = pilot.weights(provenance.hash()).map_err(diverged)?;
        if self.keep {
            let name = format!("{}-{}.cede", self.algorithm.name(), self.seed);
            output::write(&args.out.join(name), |file| {
                words
                    .iter()
                    .try_for_each(|word| file.write_all(&word.to_le_bytes()))
            })?;
        }
        let policy = weights::keep(&words).map_err(diverged)?;
        let mut parts = Vec::new();
        for (split, judged) in &self.judged {
            for (shield, (_, contract)) in SHIELDS.into_iter().enumerate() {
                let protocol = Protocol {
                    mode: Mode::Joint,
                    until: Until::Conflict,
                    seed: self.seed,
                };
                let drives = evaluate(&*factory(policy, contract)?, judged, protocol);
                parts.push(Part {
                    shield,
                    split: split.clone(),
                    algorithm: self.algorithm,
                    seed: self.seed,
                    drives,
                });
            }
        }
        Ok(parts)
    }
}

fn factory(
    policy: Policy<'static>,
    contract: Option<Contract>,
) -> Result<Box<dyn DriverFactory>, Failure> {
    let Some(contract) = contract else {
        return Ok(Box::new(PolicyAlone::new(policy)));
    };
    let cede = Cede::new(policy, contract);
    let cede = cede.map_err(|error| Failure::input(error, "report this as a bug"))?;
    Ok(Box::new(cede))
}

/// A row for each seed, driver, split and shield; the files of leave-one-file-out put together.
fn gathered(mut parts: Vec<Part<'_>>) -> Vec<Seeded> {
    parts.sort_by(|a, b| a.row().cmp(&b.row()));
    let mut rows = Vec::new();
    let mut parts = parts.into_iter().peekable();
    while let Some(mut part) = parts.next() {
        while let Some(next) = parts.next_if(|next| next.row() == part.row()) {
            part.drives.extend(next.drives);
        }
        let label = Label {
            driver: part.algorithm.name(),
            split: &part.split,
            mode: "joint",
            until: "conflict",
            shield: SHIELDS[part.shield].0,
        };
        rows.push(Seeded {
            seed: part.seed,
            row: Row::of(label, &part.drives),
        });
    }
    rows
}

/// Mean ± standard deviation over the seeds, and the paper's rows.
fn render(rows: &[Seeded], paper: bool) -> String {
    let mut table = Table::new();
    table
        .load_style(presets::ASCII_MARKDOWN)
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header([
            "split",
            "shield",
            "driver",
            "n",
            "seeds",
            "priority accuracy",
            "length error",
            "collisions a seed",
            "time-outs a seed",
        ]);
    let group = |s: &Seeded| {
        (
            s.row.shield.clone(),
            s.row.split.clone(),
            s.row.driver.clone(),
        )
    };
    for same in rows.chunk_by(|a, b| group(a) == group(b)) {
        let row = &same[0].row;
        let over = |f: fn(&Row) -> Option<f64>| -> Vec<f64> {
            same.iter().filter_map(|s| f(&s.row)).collect()
        };
        let percent = over(|row| row.priority_accuracy.map(|share| 100.0 * share));
        table.add_row([
            row.split.clone(),
            row.shield.clone(),
            row.driver.clone(),
            row.n.to_string(),
            same.len().to_string(),
            spread(&percent, 1) + " %",
            spread(&over(|row| row.episode_length_error), 3),
            spread(&over(|row| Some(row.collisions as f64)), 1),
            spread(&over(|row| Some(row.time_outs as f64)), 1),
        ]);
    }
    if paper {
        for (driver, split, n, accuracy, length, collisions) in table::PAPER {
            table.add_row([
                split.to_owned(),
                "off".to_owned(),
                driver.to_owned(),
                n.to_string(),
                "1".to_owned(),
                format!("{:.1} %", 100.0 * accuracy),
                format!("{length:.3}"),
                collisions.to_string(),
                String::new(),
            ]);
        }
    }
    table.to_string()
}

/// Mean ± sample standard deviation; the mean alone if there is one value.
fn spread(values: &[f64], digits: usize) -> String {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    if values.len() < 2 {
        return format!("{mean:.digits$}");
    }
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    format!("{mean:.digits$} ± {:.digits$}", variance.sqrt())
}
