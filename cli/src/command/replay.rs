//! `cede replay`: one encounter of a recording, as numbers and as an animated page.

use crate::failure::Failure;
use crate::report::Report;
use cede_sim::driver::Replay;
use cede_sim::episode::Until;
use cede_sim::evaluate::{Label, Mode, Protocol, Row, evaluate};
use cede_sim::metrics::{recorded_states, svo_series};
use cede_sim::{Dataset, Encounter, Role};
use std::path::PathBuf;
use std::str::FromStr;

/// Rows of the table are so many steps (0.5 s) apart.
const EVERY: usize = 5;

/// Options of `cede replay`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// A recording: INTERACTION's vehicle_tracks_NNN.csv, or a CSV of track,t,x,y
    file: PathBuf,
    /// Site of the recording: `EP0`, `MA`, or the path of a site description
    #[arg(long, default_value = "EP0")]
    site: String,
    /// Tracks of the left-turner and of the other; by default the two that came closest in time
    #[arg(long, value_name = "LEFT,OTHER")]
    pair: Option<Pair>,
    /// Where the page goes
    #[arg(long, default_value = "out/replay.html", value_name = "FILE")]
    out: PathBuf,
}

#[derive(Clone, Copy)]
struct Pair {
    left: u32,
    other: u32,
}

impl FromStr for Pair {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let tracks = text.split_once(',');
        let parsed = tracks.and_then(|(left, other)| {
            Some(Self {
                left: left.trim().parse().ok()?,
                other: other.trim().parse().ok()?,
            })
        });
        parsed.ok_or("two track numbers are needed, as in 25,26")
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let dataset = Dataset::load(&args.file, &args.site)?;
    let encounter = args.choose(&dataset)?;
    print(encounter);
    let protocol = Protocol {
        mode: Mode::Joint,
        until: Until::Cleared,
        seed: 0,
    };
    let drives = evaluate(&Replay, &[encounter], protocol);
    let label = Label {
        driver: "replay",
        split: "all",
        mode: "joint",
        until: "cleared",
        shield: "off",
    };
    let id = &encounter.id;
    let file = args.file.display();
    let command = format!(
        "cede replay {file} --site {} --pair {},{}",
        args.site, id.left, id.other
    );
    let mut report = Report::showing(vec![encounter], &dataset, &command);
    report.add(&Row::of(label, &drives), &drives);
    report.write(&args.out)?;
    println!("\nAnimated in {}", args.out.display());
    Ok(())
}

impl Args {
    fn choose<'d>(&self, dataset: &'d Dataset) -> Result<&'d Encounter, Failure> {
        let all = || dataset.encounters.iter();
        let chosen = match self.pair {
            None => all().min_by(|a, b| a.pet.total_cmp(&b.pet)),
            Some(Pair { left, other }) => all().find(|e| (e.id.left, e.id.other) == (left, other)),
        };
        chosen.ok_or_else(|| {
            let pairs = all().map(|e| format!("{},{}", e.id.left, e.id.other));
            let pairs = pairs.collect::<Vec<_>>().join("  ");
            let file = self.file.display();
            match self.pair {
                Some(Pair { left, other }) => Failure::input(
                    format!("{file}: tracks {left} and {other} do not make an encounter"),
                    format!("name one of these with --pair: {pairs}"),
                ),
                None => Failure::input(
                    format!("{file}: no left-turner meets anybody here"),
                    "name another file, or the site whose description fits with --site",
                ),
            }
        })
    }
}

fn print(encounter: &Encounter) {
    let first = match encounter.first {
        Role::Left => "left-turner",
        Role::Other => "other",
    };
    println!(
        "Left-turner {}, other {}: {first} first after {:.1} s, the next {:.1} s later.\n",
        encounter.id.left,
        encounter.id.other,
        f64::from(encounter.steps) * 0.1,
        encounter.pet
    );
    println!("            left-turner            other       SVO of the");
    println!("  t, s   to go, m     m/s   to go, m     m/s   left-turner, °");
    let mut orientations = svo_series(encounter, recorded_states(encounter));
    for (step, states) in recorded_states(encounter).enumerate() {
        let orientation = orientations.next();
        if step % EVERY != 0 {
            continue;
        }
        let [left, other] = Role::BOTH.map(|role| {
            let state = states[role as usize];
            (encounter.judged(role).conflict_s - state.s, state.v)
        });
        let degrees = orientation.map_or(String::new(), |phi| format!("{:.0}", phi.to_degrees()));
        println!(
            "{:>6.1}   {:>8.1}  {:>6.1}   {:>8.1}  {:>6.1}   {degrees:>14}",
            step as f64 * 0.1,
            left.0,
            left.1,
            other.0,
            other.1
        );
    }
}
