//! One training: data, claims, checkpoints, logs and weights.

use super::bar::Bar;
use super::{DATA_SEED, Method, Options, provenance};
use crate::failure::Failure;
use crate::input;
use crate::source::Source;
use crate::training::{Identity, Training};
use cede_data::{Dataset, Encounter, Split, output};
use cede_formats::property::{Properties, StateProperty};
use cede_train::driving::episodes::Course;
use cede_train::run::curve::{Panel, Point};
use cede_train::run::log::Log;
use cede_train::run::provenance::{Provenance, data_hash};
use cede_train::run::{Algorithm, Lessons, Run, TrainSettings};
use std::path::{Path, PathBuf};

/// What the file of `--claims` should be.
const CLAIMS: &str = "properties as docs/safety/policy.toml has them";

/// A training with its options.
pub(super) struct Order<'a> {
    pub(super) method: &'a Method,
    pub(super) source: &'a Source,
    pub(super) out: &'a Path,
    pub(super) options: &'a Options,
}

impl Order<'_> {
    /// Trains and writes the weights with their provenance.
    ///
    /// # Errors
    /// An option would be ignored, a file cannot be used or written, the training diverges, or the user
    /// has interrupted the command.
    pub(super) fn run(&self, settings: TrainSettings) -> Result<(), Failure> {
        let algorithm = self.method.algorithm.0;
        if self.options.every_pair && !algorithm.uses_auxiliary_encounters() {
            return Err(Failure::ignored("--every-pair", algorithm.name()));
        }
        let (claims, text) = self.claims(algorithm)?;
        output::check(self.out)?;
        self.options.threads.start()?;
        let sites = self
            .source
            .load_seeded("--data-seed", self.options.data_seed, DATA_SEED)?;
        let own: Vec<&Encounter> = training(&sites).collect();
        if own.is_empty() {
            return Err(Failure::input(
                "no encounters in the training files",
                "add training files to the folder, or name another site",
            ));
        }
        let pairs: Vec<Dataset> = if self.options.every_pair {
            sites.iter().map(Dataset::every_pair).collect()
        } else {
            Vec::new()
        };
        let auxiliary: Vec<&Encounter> = training(&pairs).collect();
        let encounters = || own.iter().chain(&auxiliary).copied();
        let hash = data_hash(encounters(), &text);
        let lessons = Lessons {
            claims,
            ..Lessons::new(&own, &auxiliary)
        };
        let identity = Identity {
            data: hash,
            algorithm,
            seed: self.options.seed,
            settings,
        };
        let provenance = provenance::of(
            self.method,
            (self.source, encounters().count()),
            self.options,
            &identity,
        );
        let mut training = self.begin(identity, &lessons, self.panel(&sites, &lessons))?;
        self.advance(&mut training, &lessons)?;
        self.write(&training.run, &provenance)?;
        training.clean();
        Ok(())
    }

    /// The properties of `--claims`, and the text of the file.
    fn claims(&self, algorithm: Algorithm) -> Result<(Vec<StateProperty>, String), Failure> {
        let Some(path) = &self.options.claims else {
            return Ok(Default::default());
        };
        if !matches!(algorithm, Algorithm::Apg) {
            return Err(Failure::ignored("--claims", algorithm.name()));
        }
        let text = input::text(path, CLAIMS)?;
        let properties =
            Properties::read(&text).map_err(|error| input::unusable(path, error, CLAIMS))?;
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

    /// The encounters for the learning curve; `None` without `--log`.
    fn panel<'e>(&self, sites: &'e [Dataset], lessons: &'e Lessons<'e>) -> Option<Panel<'e>> {
        self.options.log.as_ref().map(|_| Panel {
            train: &lessons.courses,
            validation: sites
                .iter()
                .flat_map(|site| site.split(Split::Validation))
                .map(Course::new)
                .collect(),
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
                "saved to {}; continue with --resume",
                self.checkpoint().display()
            );
        }
        done
    }

    fn write(&self, run: &Run<'_>, provenance: &Provenance) -> Result<(), Failure> {
        let words = run.view().weights(provenance.hash()).map_err(|error| {
            let problem = format!("the trained network cannot be used: {error}");
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

/// The encounters of the training files of all `sites`.
fn training(sites: &[Dataset]) -> impl Iterator<Item = &Encounter> {
    sites.iter().flat_map(|site| site.split(Split::Train))
}

/// The scalars of a point of the curve.
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
