//! `cede replay`: one encounter of a recording, as numbers and as an animated page.

mod numbers;

use crate::contract::Named;
use crate::drivers::{Contender, Degrees, Drivers};
use crate::failure::Failure;
use crate::judge::ShieldName;
use crate::left_out;
use crate::report::{Report, command};
use crate::source;
use cede_controller::Contract;
use cede_data::{Dataset, Encounter};
use cede_sim::episode::Until;
use cede_sim::evaluate::{Drive, Evaluation, Label, Mode, Protocol, TableRow, evaluate};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Options of `cede replay`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// A recording: INTERACTION's vehicle_tracks_NNN.csv, a CSV of track,t,x,y, or a CommonRoad scenario (.xml)
    file: PathBuf,
    /// Site of the recording: `EP0`, `MA`, or the path of a site description
    #[arg(long, default_value = "EP0")]
    site: String,
    /// Tracks of the left-turner and of the other; by default the two that came closest in time
    #[arg(long, value_name = "LEFT,OTHER")]
    pair: Option<TrackPair>,
    /// Drivers of both vehicles, separated by commas; drivers that learn are fitted to this recording
    #[arg(long, default_value = "replay", value_name = "NAME[,NAME…]")]
    driver: Drivers,
    /// Whether both vehicles carry the shield
    #[arg(long, value_enum, default_value_t = ShieldName::Off)]
    shield: ShieldName,
    /// The shield's contract: what it assumes of the other vehicles [default: worst-case]
    #[arg(long, value_name = "NAME|FILE")]
    contract: Option<Named>,
    /// The policy of the driver `cede`
    #[arg(long, value_name = "FILE.cede")]
    weights: Option<PathBuf>,
    /// Social value orientations that the driver `cede` shows, one replay each: 0 an egoist, 45 as learned, 90 an altruist
    #[arg(long, value_delimiter = ',', value_name = "DEGREES[,DEGREES…]")]
    svo: Vec<Degrees>,
    /// Path of the page (HTML)
    #[arg(long, default_value = "out/replay.html", value_name = "FILE")]
    out: PathBuf,
    /// Print one JSON object instead of the tables; shares are fractions
    #[arg(long)]
    json: bool,
}

/// The output of `--json`.
#[derive(Serialize)]
struct Output<'a> {
    file: u16,
    left: u32,
    other: u32,
    page: &'a Path,
    rows: &'a [TableRow],
}

/// The track numbers of an encounter's vehicles.
#[derive(Clone, Copy)]
struct TrackPair {
    left: u32,
    other: u32,
}

impl FromStr for TrackPair {
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
    let shields = args.shield.shields(args.contract.as_ref())?;
    let contenders = args.driver.contenders(args.weights.as_deref(), &args.svo)?;
    let dataset = source::recorded(&args.file, &args.site)?;
    let encounter = args.choose(&dataset)?;
    if !args.json {
        numbers::record(encounter);
    }
    let mut report = Report::showing(vec![encounter], &dataset, &args.command(encounter));
    let mut rows = Vec::new();
    for contender in contenders {
        for &shield in &shields {
            let (row, drives) = drive(&contender, shield, encounter, &dataset)?;
            if !args.json {
                drives.iter().for_each(|drive| numbers::drive(&row, drive));
            }
            report.add(&row, &drives);
            rows.push(row);
        }
    }
    report.write(&args.out)?;
    if args.json {
        return args.print_json(encounter, &rows);
    }
    println!("\nAnimated in {}", args.out.display());
    Ok(())
}

/// Drives `encounter`.
fn drive<'e>(
    contender: &Contender,
    shield: Option<Contract>,
    encounter: &'e Encounter,
    dataset: &Dataset,
) -> Result<(TableRow, Vec<Drive<'e>>), Failure> {
    let training: Vec<&Encounter> = dataset.encounters.iter().collect();
    let factory = contender.fit(&training, shield);
    let factory = factory.map_err(|error| Failure::input(error, "name another driver"))?;
    let protocol = Protocol {
        mode: Mode::Joint,
        until: Until::Cleared,
        seed: 0,
    };
    let Evaluation { drives, refused } = evaluate(&*factory, &[encounter], protocol);
    if let Some(refused) = refused.first() {
        let words = left_out::words(refused);
        return Err(Failure::input(words, "name another encounter with --pair"));
    }
    let label = Label {
        site: &encounter.id.site,
        driver: contender.name(),
        split: "all",
        mode: "joint",
        until: "cleared",
        shield: if shield.is_some() { "on" } else { "off" },
    };
    Ok((TableRow::of(label, &drives), drives))
}

impl Args {
    fn print_json(&self, encounter: &Encounter, rows: &[TableRow]) -> Result<(), Failure> {
        let output = Output {
            file: encounter.id.file,
            left: encounter.id.left,
            other: encounter.id.other,
            page: &self.out,
            rows,
        };
        let text = serde_json::to_string_pretty(&output)
            .map_err(|error| Failure::input(error, "report this as a bug"))?;
        println!("{text}");
        Ok(())
    }

    /// The command line that shows the same encounter.
    fn command(&self, encounter: &Encounter) -> String {
        let (left, other) = (encounter.id.left, encounter.id.other);
        let pair = match self.pair {
            Some(_) => String::new(),
            None => format!(" --pair {left},{other}"),
        };
        command() + &pair
    }

    /// The folder of the recording.
    fn folder(&self) -> &Path {
        match self.file.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }

    fn choose<'d>(&self, dataset: &'d Dataset) -> Result<&'d Encounter, Failure> {
        let all = || dataset.encounters.iter();
        let chosen = match self.pair {
            None => all().min_by(|a, b| a.pet.total_cmp(&b.pet)),
            Some(TrackPair { left, other }) => {
                all().find(|e| (e.id.left, e.id.other) == (left, other))
            }
        };
        chosen.ok_or_else(|| {
            let pairs = all().map(|e| format!("{},{}", e.id.left, e.id.other));
            let pairs = pairs.collect::<Vec<_>>().join("  ");
            let file = self.file.display();
            match self.pair {
                Some(TrackPair { left, other }) => Failure::input(
                    format!("{file}: tracks {left} and {other} are not an encounter"),
                    format!("name one of these with --pair: {pairs}"),
                ),
                None => Failure::input(
                    format!("{file}: it contains no encounter of site {}", dataset.site.name),
                    format!(
                        "name one that has, by the table of `cede data inspect --data {} --site {}`",
                        self.folder().display(),
                        self.site
                    ),
                ),
            }
        })
    }
}
