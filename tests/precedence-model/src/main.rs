//! `cede-precedence-model --vehicles 3 --disturbances 2 --seconds 600`: the searches of the tests, as long as one likes.

use cede_controller::dangerous::Sound;
use cede_precedence_model::{Setting, Watched, deadlock, search, suite};
use clap::Parser;
use std::collections::BTreeMap;
use std::process::ExitCode;
use std::time::Duration;

/// Searches every state of vehicles that wait for each other, for two that rely on precedence over each other.
#[derive(Parser)]
struct Arguments {
    /// 2 or 3.
    #[arg(long, default_value_t = 2)]
    vehicles: u8,
    /// In how many steps in all somebody goes or begins to miss something.
    #[arg(long, default_value_t = 2)]
    disturbances: u8,
    /// Steps; 0 are as many as there are.
    #[arg(long, default_value_t = 0)]
    depth: usize,
    /// For each search.
    #[arg(long, default_value_t = 600)]
    seconds: u64,
    /// Only the search of this name.
    #[arg(long)]
    only: Option<String>,
}

impl Arguments {
    fn all<const N: usize>(&self, suite: Vec<(&str, Setting<N>)>) -> bool {
        let only = |name: &str| self.only.as_deref().is_none_or(|only| only == name);
        let mut sound = true;
        for (name, setting) in suite.into_iter().filter(|(name, _)| only(name)) {
            let limit = Duration::from_secs(self.seconds);
            let outcome = search(Watched::<N, Sound>::new(setting), self.depth, limit);
            println!("{name}: {outcome}");
            for way in outcome.both.iter().chain(&outcome.at_once) {
                println!("{way}");
            }
            sound &= outcome.both.is_none() && outcome.at_once.is_none();
        }
        sound
    }
}

/// Who waits for ever, by kind.
fn deadlocks<const N: usize>(within: u8) {
    let setting = Setting::<N>::new(10, 0);
    let stories = deadlock::stories::<N>(within);
    let mut kinds = BTreeMap::new();
    for story in &stories {
        if let Some(waits) = deadlock::waits(&setting, story, 400) {
            let kind = deadlock::kind(story, waits);
            if kind == deadlock::Kind::Other {
                println!("{story:?}: {waits:?}");
            }
            *kinds.entry(kind).or_insert(0) += 1;
        }
    }
    println!(
        "{} stories of arrivals, rights and late starts; somebody waits for ever:",
        stories.len()
    );
    for (kind, number) in kinds {
        println!("  {number}: {kind}");
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let sound = if arguments.vehicles == 3 {
        deadlocks::<3>(4);
        arguments.all(suite::three(arguments.disturbances))
    } else {
        deadlocks::<2>(6);
        arguments.all(suite::two(arguments.disturbances))
    };
    if sound {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
