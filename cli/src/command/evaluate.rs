//! `cede evaluate`: judges drivers on recorded or synthetic encounters and prints the table.

mod episodes;
mod traffic;

use crate::contract::{self, Named};
use crate::drivers::{Degrees, Drivers, Name};
use crate::failure::Failure;
use crate::judge::{ModeName, Plan, ShieldName, UntilName};
use crate::report::{Report, command};
use crate::source::{Source, names};
use crate::table;
use crate::threads::Threads;
use cede_data::{Dataset, Split, output};
use cede_sim::driver::Baseline;
use cede_sim::evaluate::{Selection, TableRow};
use clap::ValueEnum;
use episodes::EpisodeFile;
use serde::Serialize;
use std::path::PathBuf;
use traffic::Share;

/// Options of `cede evaluate`.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    source: Source,
    /// Drivers to judge, separated by commas, or `all` [default: all]
    #[arg(long, value_name = "NAME[,NAME…]")]
    driver: Option<Drivers>,
    /// Encounters to judge on: train, validation, test, all, leave-one-file-out, seven-fold,
    /// separated by commas; by default those of the first three that contain encounters
    #[arg(long, value_delimiter = ',', value_name = "NAME[,NAME…]")]
    split: Vec<Selection>,
    /// Which vehicles are under test
    #[arg(long, value_enum, default_value_t = UnderTest::Joint)]
    mode: UnderTest,
    /// In traffic mode, the shares of the vehicles that are driven, one row each [default: 0.1,0.5,1]
    #[arg(long, value_delimiter = ',', value_name = "SHARE[,SHARE…]")]
    share: Vec<Share>,
    /// In ego mode, the driver of the other vehicle, which has no shield [default: replay]
    #[arg(long, value_name = "NAME")]
    partner: Option<Name>,
    /// When an episode ends [default: conflict]
    #[arg(long, value_enum)]
    until: Option<UntilName>,
    /// Whether the vehicle under test carries the shield; in traffic it always does [default: off]
    #[arg(long, value_enum)]
    shield: Option<ShieldName>,
    /// The shield's contract: what it assumes of the other vehicles [default: worst-case]
    #[arg(long, value_name = "NAME|FILE")]
    contract: Option<Named>,
    /// The policy of the driver `cede`
    #[arg(long, value_name = "FILE.cede")]
    weights: Option<PathBuf>,
    /// Social value orientations that the driver `cede` shows, one row each: 0 an egoist, 45 as learned, 90 an altruist
    #[arg(long, value_delimiter = ',', value_name = "DEGREES[,DEGREES…]")]
    svo: Vec<Degrees>,
    /// Seed of every random choice
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object instead of the table; shares are fractions
    #[arg(long)]
    json: bool,
    /// Also write one line per episode to a .csv or .parquet file
    #[arg(long, value_name = "FILE")]
    episodes: Option<EpisodeFile>,
    /// Also write the report: one HTML file with replays and charts
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

/// Which vehicles are under test.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum UnderTest {
    /// One driver for both vehicles of an encounter: the paper's protocol
    Joint,
    /// The driver for one vehicle of an encounter, in either role; another for the other
    Ego,
    /// A share of all vehicles of a recording; the others repeat their record, and mind who is in their way
    Traffic,
}

/// The output of `--json`.
#[derive(Serialize)]
struct Output<'a> {
    data: &'a str,
    site: &'a str,
    seed: u64,
    rows: &'a [TableRow],
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    args.threads.start()?;
    let mode = match args.mode {
        UnderTest::Joint => ModeName::Joint,
        UnderTest::Ego => ModeName::Ego,
        UnderTest::Traffic => return traffic::run(args),
    };
    if !args.share.is_empty() {
        return Err(Failure::Usage("--share needs --mode traffic".to_owned()));
    }
    let mut plan = args.plan(mode)?;
    args.check_outputs()?;
    let sites = args.source.occupied(args.source.load(args.seed)?)?;
    let mut report = args.report_on(&sites)?;
    let (mut records, mut rows) = (Vec::new(), Vec::new());
    for dataset in &sites {
        plan.selections = args.selections(dataset);
        rows.extend(plan.judge(dataset, |row, drives| {
            if args.episodes.is_some() {
                records.extend(episodes::records(row, drives));
            }
            if let Some(report) = &mut report {
                report.add(row, drives);
            }
        })?);
    }
    if rows.is_empty() {
        return Err(Failure::input(
            format!(
                "no encounters in these splits at any site in {}",
                args.source.data
            ),
            "name another --split, or add its files to the folders",
        ));
    }
    if let Some(file) = &args.episodes {
        file.write(&records)?;
    }
    if let (Some(mut report), Some(path)) = (report, &args.report) {
        if args.shielded() != ShieldName::Off {
            report.sweep(&sites[0], contract::or_worst_case(args.contract.as_ref())?)?;
        }
        report.write(path)?;
        note!("report in {}", path.display());
    }
    args.print(&sites, &rows)
}

impl Args {
    /// The plan of the evaluation, which has no selections yet: they depend on the site.
    fn plan(&self, mode: ModeName) -> Result<Plan, Failure> {
        if self.partner.is_some() && mode == ModeName::Joint {
            return Err(Failure::ignored("--partner", "--mode joint"));
        }
        let weights = self.weights.as_deref();
        let partner = self.partner.unwrap_or(Name::Baseline(Baseline::Replay));
        let drivers = self.driver.clone().unwrap_or_else(Drivers::all);
        Ok(Plan {
            contenders: drivers.contenders(weights, &self.svo)?,
            lenient: drivers.lenient,
            selections: Vec::new(),
            mode,
            partner: partner.contender(weights)?,
            until: self.until.unwrap_or(UntilName::Conflict),
            shields: self.shielded().shields(self.contract.as_ref())?,
            seed: self.seed,
        })
    }

    /// What to judge `dataset` on; without `--split` every split that contains encounters. Of `--site all`, splits
    /// without encounters are left out, and stderr says so.
    fn selections(&self, dataset: &Dataset) -> Vec<Selection> {
        if self.split.is_empty() {
            return present(dataset);
        }
        let mut selections = Vec::new();
        for &selection in &self.split {
            if selections.contains(&selection) {
                continue;
            }
            if self.source.is_all() && is_empty(selection, dataset) {
                note!(
                    "left out: site {} has no encounters in `{selection}`",
                    dataset.site.name
                );
                continue;
            }
            selections.push(selection);
        }
        selections
    }

    fn shielded(&self) -> ShieldName {
        self.shield.unwrap_or(ShieldName::Off)
    }

    /// Checks that the files can be written, before the work.
    fn check_outputs(&self) -> Result<(), Failure> {
        let episodes = self.episodes.iter().map(EpisodeFile::path);
        for path in episodes.chain(self.report.as_deref()) {
            output::check(path)?;
        }
        Ok(())
    }

    /// The report of `--report`.
    ///
    /// # Errors
    /// There are several sites: a report draws one map.
    fn report_on(&self, sites: &[Dataset]) -> Result<Option<Report>, Failure> {
        match (&self.report, sites) {
            (None, _) => Ok(None),
            (Some(_), [site]) => Ok(Some(Report::new(site, &command()))),
            (Some(_), _) => Err(Failure::Usage(
                "a report shows one site: leave out --report, or name one site".to_owned(),
            )),
        }
    }

    fn print(&self, sites: &[Dataset], rows: &[TableRow]) -> Result<(), Failure> {
        if self.json {
            let output = Output {
                data: &self.source.data,
                site: &names(sites),
                seed: self.seed,
                rows,
            };
            let text = serde_json::to_string_pretty(&output);
            let text = text.map_err(|error| Failure::input(error, "report this as a bug"))?;
            println!("{text}");
        } else {
            print!("{}", table::render(rows));
        }
        Ok(())
    }
}

/// Whether `selection` has nothing to judge on.
fn is_empty(selection: Selection, dataset: &Dataset) -> bool {
    let rounds = selection.rounds(dataset);
    rounds.iter().all(|round| round.judged.is_empty())
}

/// The splits that contain encounters.
fn present(dataset: &Dataset) -> Vec<Selection> {
    [Split::Train, Split::Validation, Split::Test]
        .into_iter()
        .filter(|&split| dataset.split(split).next().is_some())
        .map(Selection::Split)
        .collect()
}
