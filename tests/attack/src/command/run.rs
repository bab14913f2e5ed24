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

/// Attacks until the shields have decided so many times, or for so long.
///
/// For a number of steps the result depends on that and the seed, not on the number of threads. The long run is
/// `cede-attack run --steps 1e9 --json`.
#[derive(ClapArgs)]
pub(crate) struct Args {
    /// Decisions of shields, as in 2e8; 1e6 unless --seconds is given.
    #[arg(long, value_parser = count, conflicts_with = "seconds")]
    steps: Option<u64>,
    /// Seconds after which no new round begins.
    #[arg(long, value_parser = count)]
    seconds: Option<u64>,
    /// Scenario number i of each family has this seed plus i.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; as many as there are cores, unless it is given.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Only this family; may be given more than once.
    #[arg(long = "family", value_parser = family)]
    families: Vec<&'static Family>,
    /// Prints the report as JSON.
    #[arg(long)]
    json: bool,
}

impl Args {
    pub(crate) fn run(self) -> bool {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads.unwrap_or(0).into());
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
        let began = Instant::now();
        let limit = self.seconds.or(self.steps).unwrap_or(1_000_000);
        let bar = progress(limit, self.seconds.is_some());
        let mut report = Report::new(self.seed, families);
        let mut round = Round::from(self.seed);
        let done = |report: &Report| match self.seconds {
            Some(_) => began.elapsed().as_secs(),
            None => report.steps(),
        };
        while done(&report) < limit {
            report.add(&round.next::<Sound>(families));
            bar.set_position(done(&report).min(limit));
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

fn progress(limit: u64, seconds: bool) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let unit = if seconds { "s" } else { "steps" };
    let style = format!("{{bar:30}} {{human_pos}} of {{human_len}} {unit}, {{eta}} left, {{msg}}");
    let style = ProgressStyle::with_template(&style);
    ProgressBar::new(limit).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
