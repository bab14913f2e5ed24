//! `cede train`: from encounters to a weights file.

use crate::failure::Failure;
use crate::settings::{checked, quoted, with};
use crate::source::Source;
use crate::threads::Threads;
use crate::training::{Identity, Training};
use cede_data::{Dataset, Encounter, Split, output};
use cede_formats::property::{Properties, StateProperty};
use cede_train::driving::episodes::Course;
use cede_train::driving::judge::judge;
use cede_train::run::curve::{Panel, Point};
use cede_train::run::log::Log;
use cede_train::run::provenance::{Provenance, data_hash};
use cede_train::run::{Algorithm, Lessons, Report, Run, Settings};
use clap::builder::PossibleValue;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Options of `cede train`.
#[derive(clap::Args)]
#[command(mut_arg("data", |data| data.required(false).required_unless_present("show_settings")))]
pub(crate) struct Args {
    #[command(flatten)]
    method: Method,
    #[command(flatten)]
    source: Option<Source>,
    /// The weights file to write; its provenance goes beside it, to FILE.txt, and checkpoints to
    /// FILE.checkpoint
    #[arg(
        long,
        value_name = "FILE.cede",
        required_unless_present = "show_settings"
    )]
    out: Option<PathBuf>,
    #[command(flatten)]
    options: Options,
    /// Print the algorithm's settings as TOML and stop; no other option is needed
    #[arg(long)]
    show_settings: bool,
}

/// How to learn.
#[derive(clap::Args)]
struct Method {
    /// How to learn
    #[arg(value_enum)]
    algorithm: Choice,
    /// Settings that differ from the defaults, as TOML
    #[arg(long, value_name = "FILE.toml")]
    settings: Option<PathBuf>,
    /// One setting that differs, as in `--set width=128` or `--set rates.policy=3e-4`; repeatable
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
}

/// What else can be said of a training.
#[derive(clap::Args)]
struct Options {
    /// Seed of the synthetic encounters; training has its own [default: 1]
    #[arg(long, value_name = "SEED")]
    data_seed: Option<u64>,
    /// In a refinement, hold the network to what it was wherever two vehicles of the training files
    /// cross or merge
    #[arg(long)]
    every_pair: bool,
    /// Properties that the policy is to have, for `apg` to learn beside driving
    #[arg(long, value_name = "FILE.toml")]
    claims: Option<PathBuf>,
    /// Seed of every random choice of the training
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Folder for the training curves: CSV, and TensorBoard's event file
    #[arg(long, value_name = "DIR")]
    log: Option<PathBuf>,
    /// Go on from the last checkpoint of the same run
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    threads: Threads,
}

/// A training as it was ordered.
struct Order<'a> {
    method: &'a Method,
    source: &'a Source,
    out: &'a Path,
    options: &'a Options,
}

/// An algorithm by its name.
#[derive(Clone, Copy)]
pub(super) struct Choice(pub(super) Algorithm);

impl clap::ValueEnum for Choice {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [Choice; 5] = {
            let [a, b, c, d, e] = Algorithm::ALL;
            [Choice(a), Choice(b), Choice(c), Choice(d), Choice(e)]
        };
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.name()))
    }
}

/// Time between two judgements for the progress bar.
const JUDGE_EVERY: Duration = Duration::from_secs(5);
/// Encounters of the judgement for the progress bar.
const JUDGED: usize = 60;

/// Seed of the synthetic encounters, where none is given.
const DATA_SEED: u64 = 1;

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let settings = args.method.settings()?;
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
    fn settings(&self) -> Result<Settings, Failure> {
        let mut settings = self.algorithm.0.settings();
        if let Some(path) = &self.settings {
            settings = with(&settings, &read(path)?, &path.display().to_string())?;
        }
        for set in &self.set {
            settings = with(&settings, &quoted(set), "--set")?;
        }
        checked(settings)
    }
}

impl Order<'_> {
    fn run(&self, settings: Settings) -> Result<(), Failure> {
        let algorithm = self.method.algorithm.0;
        if self.options.every_pair && !algorithm.looks_beside() {
            return Err(Failure::ignored("--every-pair", algorithm.name()));
        }
        let (claims, text) = self.claims(algorithm)?;
        self.options.threads.start()?;
        let dataset = self
            .source
            .load_seeded("--data-seed", self.options.data_seed, DATA_SEED)?;
        let own: Vec<&Encounter> = dataset.split(Split::Train).collect();
        if own.is_empty() {
            return Err(Failure::input(
                "there is nothing to learn from: no encounters in the training files",
                "add training files to the folder, or name another site",
            ));
        }
        let every = self.options.every_pair.then(|| dataset.every_pair());
        let beside = every.iter().flat_map(|every| every.split(Split::Train));
        let beside: Vec<&Encounter> = beside.collect();
        let encounters = || own.iter().chain(&beside).copied();
        let hash = data_hash(encounters(), &text);
        let lessons = Lessons {
            claims,
            ..Lessons::new(&own, &beside)
        };
        let identity = Identity {
            data: hash,
            algorithm,
            seed: self.options.seed,
            settings,
        };
        let provenance = self.provenance(&identity, encounters().count());
        let mut training = self.begin(identity, &lessons, self.panel(&dataset, &lessons))?;
        self.advance(&mut training, &lessons)?;
        self.write(&training.run, &provenance)?;
        training.clean();
        Ok(())
    }

    /// What is to be claimed of the policy, and the text that says so.
    fn claims(&self, algorithm: Algorithm) -> Result<(Vec<StateProperty>, String), Failure> {
        let Some(path) = &self.options.claims else {
            return Ok(Default::default());
        };
        if !matches!(algorithm, Algorithm::Apg) {
            return Err(Failure::ignored("--claims", algorithm.name()));
        }
        let text = read(path)?;
        let properties = Properties::read(&text)
            .map_err(|error| Failure::input(format!("{}: {error}", path.display()), "mend it"))?;
        Ok((properties.property, text))
    }

    fn log(&self) -> Result<Option<Log>, Failure> {
        let open = |folder: &PathBuf| {
            Log::open(folder, self.options.resume).map_err(|error| unwritable(folder, &error))
        };
        self.options.log.as_ref().map(open).transpose()
    }

    fn checkpoint(&self) -> PathBuf {
        self.out.with_extension("checkpoint")
    }

    /// What the curve is drawn from; without `--log` there is none.
    fn panel<'e>(&self, dataset: &'e Dataset, lessons: &'e Lessons<'e>) -> Option<Panel<'e>> {
        self.options.log.as_ref().map(|_| Panel {
            train: &lessons.courses,
            validation: dataset.split(Split::Validation).map(Course::new).collect(),
        })
    }

    fn begin<'e>(
        &self,
        identity: Identity,
        lessons: &'e Lessons<'e>,
        panel: Option<Panel<'e>>,
    ) -> Result<Training<'e>, Failure> {
        let checkpoint = self.checkpoint();
        if self.options.resume {
            Training::resume(identity, lessons, panel, checkpoint)
        } else {
            Ok(Training::new(identity, lessons, panel, checkpoint))
        }
    }

    fn advance(&self, training: &mut Training<'_>, lessons: &Lessons<'_>) -> Result<(), Failure> {
        let mut log = self.log()?;
        let mut bar = Bar::new(lessons);
        let done = training.finish(|report, run, point| {
            bar.show(report, run);
            let (Some(log), Some(folder)) = (&mut log, &self.options.log) else {
                return Ok(());
            };
            let judged = point.map(scalars).unwrap_or_default();
            let added = log
                .add(report.done, &report.scalars)
                .and_then(|()| log.add(report.done, &judged));
            added.map_err(|error| unwritable(folder, &error))
        });
        bar.finish();
        if let Err(Failure::Interrupted) = done {
            eprintln!(
                "saved to {}; go on with --resume",
                self.checkpoint().display()
            );
        }
        done
    }

    fn provenance(&self, identity: &Identity, encounters: usize) -> Provenance {
        let algorithm = self.method.algorithm.0.name();
        let mut command = format!("cede train {algorithm}");
        let data = if self.source.is_synthetic() {
            let (least, seed) = (
                self.source.encounters(),
                self.options.data_seed.unwrap_or(DATA_SEED),
            );
            command += &format!(" --data synthetic --encounters {least} --data-seed {seed}");
            format!("synthetic, seed {seed}")
        } else {
            command += &format!(" --data DIR --site {}", self.source.site());
            format!("recordings of {}", self.source.site())
        };
        if self.options.every_pair {
            command += " --every-pair";
        }
        if let Some(path) = &self.options.claims {
            command += &format!(" --claims {}", path.display());
        }
        command += &format!(" --seed {}", self.options.seed);
        for set in &self.method.set {
            command += &format!(" --set {set}");
        }
        if self.method.settings.is_some() {
            command += " --settings FILE.toml";
        }
        Provenance {
            algorithm: algorithm.to_owned(),
            settings: identity.settings.text(),
            seed: self.options.seed,
            data,
            encounters,
            data_hash: identity.data,
            command: command + " --out FILE.cede",
        }
    }

    fn write(&self, run: &Run<'_>, provenance: &Provenance) -> Result<(), Failure> {
        let words = run.view().weights(provenance.hash()).map_err(|error| {
            let problem = format!("the trained network is not usable: {error}");
            Failure::input(problem, "lower the learning rates, or change the width")
        })?;
        write(self.out, &words)?;
        output::write(&self.out.with_extension("txt"), |file| {
            file.write_all(provenance.text().as_bytes())
        })?;
        println!("{}", self.out.display());
        Ok(())
    }
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| {
        let problem = format!("cannot read {}: {error}", path.display());
        Failure::input(problem, "check the path")
    })
}

/// A point of the curve as scalars to plot.
fn scalars(point: &Point) -> Vec<(&'static str, f32)> {
    let train = [
        ("train/reward per step", point.train.reward),
        ("train/priority accuracy", point.train.priority_accuracy),
        ("train/length error", point.train.length_error),
    ];
    let validation = point.validation.map(|score| {
        [
            ("validation/reward per step", score.reward),
            ("validation/priority accuracy", score.priority_accuracy),
            ("validation/length error", score.length_error),
        ]
    });
    let validation = validation.into_iter().flatten();
    train.into_iter().chain(validation).collect()
}

fn unwritable(folder: &Path, error: &std::io::Error) -> Failure {
    let problem = format!("cannot write to {}: {error}", folder.display());
    Failure::input(problem, "free some space or name another folder")
}

fn write(path: &Path, words: &[u32]) -> Result<(), Failure> {
    output::write(path, |file| {
        words
            .iter()
            .try_for_each(|word| file.write_all(&word.to_le_bytes()))
    })?;
    Ok(())
}

/// Progress on stderr, unseen where that is no terminal.
struct Bar<'l> {
    bar: ProgressBar,
    lessons: &'l Lessons<'l>,
    judged: Option<Instant>,
    score: String,
    begun: Instant,
    episodes: u64,
    updates: u64,
}

impl<'l> Bar<'l> {
    fn new(lessons: &'l Lessons<'l>) -> Self {
        let bar = ProgressBar::new(0);
        let style = ProgressStyle::with_template("{bar:30} {percent} % {eta} left, {msg}");
        Self {
            bar: style.map_or_else(|_| bar.clone(), |style| bar.clone().with_style(style)),
            lessons,
            judged: None,
            score: String::new(),
            begun: Instant::now(),
            episodes: 0,
            updates: 0,
        }
    }

    fn show(&mut self, report: &Report, run: &Run<'_>) {
        self.episodes += report.episodes;
        self.updates += report.updates;
        self.bar.set_length(report.total);
        self.bar.set_position(report.done);
        if self.bar.is_hidden() {
            return;
        }
        if self.judged.is_none_or(|last| last.elapsed() > JUDGE_EVERY) {
            let courses = &self.lessons.courses;
            let score = judge(&courses[..courses.len().min(JUDGED)], run.view());
            self.score = format!(
                "priority accuracy {:.0} %, length error {:.2}",
                100.0 * score.priority_accuracy,
                score.length_error
            );
            self.judged = Some(Instant::now());
        }
        let seconds = self.begun.elapsed().as_secs_f64().max(1e-3);
        self.bar.set_message(format!(
            "{:.0} episodes/s, {:.0} updates/s, {}",
            self.episodes as f64 / seconds,
            self.updates as f64 / seconds,
            self.score
        ));
    }

    fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
