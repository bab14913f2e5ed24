//! `cede-attack run`.

use super::{count, family};
use cede_attack::campaign::Round;
use cede_attack::report::Report;
use cede_attack::scenario::{FAMILIES, Family};
use cede_controller::dangerous::Sound;
use clap::Args as ClapArgs;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::Instant;

/// Attacks until the shields have decided so many times.
///
/// The result depends on the seed and the number of steps, not on the number of threads.
#[derive(ClapArgs)]
pub(crate) struct Args {
    /// Decisions of shields, as in 2e8.
    #[arg(long, default_value = "1e6", value_parser = count)]
    steps: u64,
    /// Scenario number i of each family has this seed plus i.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; as many as there are cores, unless it is given.
    #[arg(long)]
    threads: Option<usize>,
    /// Only this family; may be given more than once.
    #[arg(long = "family", value_parser = family)]
    families: Vec<&'static Family>,
    /// Prints the report as JSON.
    #[arg(long)]
    json: bool,
}

impl Args {
    pub(crate) fn run(self) -> bool {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads.unwrap_or(0));
        match pool.build() {
            Ok(pool) => pool.install(|| self.attack()),
            Err(error) => {
                eprintln!("threads: {error}");
                false
            }
        }
    }

    fn attack(&self) -> bool {
        let all: Vec<&Family> = FAMILIES.iter().collect();
        let families = if self.families.is_empty() {
            &all
        } else {
            &self.families
        };
        let bar = progress(self.steps);
        let began = Instant::now();
        let mut report = Report::new(families);
        let mut round = Round::from(self.seed);
        while report.steps() < self.steps {
            report.add(&round.next::<Sound>(families));
            bar.set_position(report.steps().min(self.steps));
            if !bar.is_hidden() {
                bar.set_message(format!("{} bad", report.bad()));
            }
        }
        bar.finish_and_clear();
        report.seconds = began.elapsed().as_secs_f64();
        if self.json {
            println!("{}", report.json());
        } else {
            print!("{report}");
        }
        report.bad() == 0
    }
}

fn progress(steps: u64) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = "{bar:30} {human_pos} of {human_len} steps, {per_sec}, {eta} left, {msg}";
    let style = ProgressStyle::with_template(style);
    ProgressBar::new(steps).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
