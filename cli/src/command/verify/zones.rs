//! `cede verify zones`.

mod named;

use super::checked::{Check, Checked, Finding, open};
use crate::failure::Failure;
use crate::input;
use crate::progress;
use crate::safety::Kind;
use crate::source;
use crate::threads::Threads;
use cede_data::output;
use cede_verify::zones::example::with_zones;
use cede_verify::zones::{self, Failing, RESERVE, Site, Verdict};
use clap::Args;
use named::Named;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The text below the options in `cede help verify zones`.
const HELP: &str = "\
Shows that the zones of a junction cover every overlap of two footprints that are enlarged by its tolerance, and 1 cm
more on every side for rounding: branch and bound in interval arithmetic, which reads what the junction publishes and
shares no code with what makes zones. Exit code 1 if an overlap is outside of all zones, or if that is not shown.

A FILE is JSON: {\"tolerance\": 0.1, \"paths\": [{\"points\": [[x, y], …], \"arc\": [s, …], \"length\": 5, \"width\": 2}, …],
\"pairs\": [{\"ego\": 0, \"other\": 1, \"zones\": [{\"ego\": [from, to], \"other\": [from, to], \"lead\": [from, to],
\"lane\": false}]}]}. Without `pairs` its zones are made by the controller. --write FILE writes one.";

/// Options of `cede verify zones`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Zones {
    /// A file with a junction, or junctions by name: crossing, four-arm, tee, bends, demo, campaign [default: all names]
    #[arg(value_name = "FILE|NAME")]
    which: Vec<PathBuf>,
    /// The junctions of the recorded encounters in this folder
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Sites of the recordings, separated by commas
    #[arg(
        long,
        value_name = "NAME[,NAME…]",
        value_delimiter = ',',
        requires = "data",
        default_value = "EP0"
    )]
    site: Vec<String>,
    /// Maximum number of parts that the places of two paths are divided into.
    #[arg(long, default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    parts: u64,
    /// Write what the junction publishes to this file, and check nothing.
    #[arg(long, value_name = "FILE", conflicts_with = "json")]
    write: Option<PathBuf>,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

/// Junctions that go by a name.
pub(super) const NAMES: [&str; 6] = named::NAMES;

/// What a file should be.
const WHAT: &str = "a junction as JSON, see `cede help verify zones`";

/// What to do about what is not shown.
const MEND: &str = "more --parts may show it";

/// What was found of some junctions.
struct Row {
    name: String,
    junctions: usize,
    pairs: usize,
    zones: usize,
    parts: u64,
    seconds: f64,
    /// What is not covered: the junction's number, the paths, and why.
    failed: Vec<Failed>,
}

struct Failed {
    junction: usize,
    checked: zones::Checked,
}

impl Zones {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        if let Some(file) = &self.write {
            return self.publish(file);
        }
        self.threads.start()?;
        self.check()?.tell(self.json)
    }

    /// The junctions that are asked for.
    fn chosen(&self) -> Result<Vec<Named>, Failure> {
        let mut chosen = Vec::new();
        for which in &self.which {
            chosen.push(match Named::by_name(&which.to_string_lossy()) {
                Some(named) => named,
                None => Named::one(which.display(), read(which)?),
            });
        }
        if let Some(folder) = &self.data {
            for name in &self.site {
                chosen.push(Named::recorded(&source::recorded(folder, name)?));
            }
        }
        if chosen.is_empty() {
            chosen.extend(NAMES.iter().filter_map(|name| Named::by_name(name)));
        }
        Ok(chosen)
    }

    fn publish(&self, file: &Path) -> Result<(), Failure> {
        let chosen = self.chosen()?;
        let [Named { sites, .. }] = chosen.as_slice() else {
            return Err(Failure::Usage("--write: name one junction".to_owned()));
        };
        let [site] = sites.as_slice() else {
            return Err(Failure::Usage(
                "--write: there are several by this name".to_owned(),
            ));
        };
        let unusable = |error| Failure::input(error, "this is a defect of Cede");
        let text = serde_json::to_string_pretty(site).map_err(unusable)?;
        output::write(file, |file| file.write_all(text.as_bytes()))?;
        Ok(())
    }

    fn row(&self, named: &Named) -> Result<Row, Failure> {
        note!("{} …", named.name);
        let began = Instant::now();
        let pairs = named
            .sites
            .iter()
            .map(|site| site.each().count())
            .sum::<usize>();
        let bar = progress::bar(pairs as u64, "{bar:40} {pos}/{len} pairs of paths");
        let mut row = Row {
            name: named.name.clone(),
            junctions: named.sites.len(),
            pairs: 0,
            zones: 0,
            parts: 0,
            seconds: 0.0,
            failed: Vec::new(),
        };
        for (junction, site) in named.sites.iter().enumerate() {
            let unusable = |error| input::unusable(Path::new(&named.name), error, WHAT);
            let found =
                zones::check(site, RESERVE, self.parts, |_| bar.inc(1)).map_err(unusable)?;
            for checked in found {
                row.pairs += 1;
                row.zones += checked.zones;
                row.parts += checked.parts;
                if checked.verdict != Verdict::Covered {
                    row.failed.push(Failed { junction, checked });
                }
            }
        }
        bar.finish_and_clear();
        row.seconds = began.elapsed().as_secs_f64();
        Ok(row)
    }
}

/// The junction in a file, with the controller's zones if it has none.
fn read(path: &Path) -> Result<Site, Failure> {
    let text = input::text(path, WHAT)?;
    let site: Site =
        serde_json::from_str(&text).map_err(|error| input::unusable(path, error, WHAT))?;
    if site.pairs.is_empty() {
        return with_zones(&site).map_err(|error| input::unusable(path, error, WHAT));
    }
    Ok(site)
}

impl Check for Zones {
    fn check(&self) -> Result<Checked, Failure> {
        let chosen = self.chosen()?;
        let rows: Vec<Row> = chosen
            .iter()
            .map(|named| self.row(named))
            .collect::<Result<_, _>>()?;
        let failed = rows.iter().filter(|row| !row.failed.is_empty());
        let failed = open(
            "zones do not cover every overlap",
            failed.map(|row| row.name.as_str()),
        );
        let of = |count: fn(&Row) -> usize| rows.iter().map(count).sum::<usize>();
        Ok(Checked {
            text: text(&rows),
            json: serde_json::json!({ "reserve_m": RESERVE, "junctions": rows.iter().map(Row::json).collect::<Vec<_>>() }),
            summary: format!(
                "{} zones of {} pairs of paths in {} junctions, {} not covered",
                of(|row| row.zones),
                of(|row| row.pairs),
                of(|row| row.junctions),
                of(|row| row.failed.len()),
            ),
            findings: rows.iter().map(Row::finding).collect(),
            open: failed,
        })
    }
}

fn text(rows: &[Row]) -> String {
    let mut lines = vec![format!(
        "{:<12} {:>9} {:>7} {:>7} {:>11} {:>8}",
        "", "junctions", "pairs", "zones", "parts", "seconds"
    )];
    for row in rows {
        lines.push(format!(
            "{:<12} {:>9} {:>7} {:>7} {:>11} {:>8.1}  {}",
            row.name,
            row.junctions,
            row.pairs,
            row.zones,
            row.parts,
            row.seconds,
            row.word()
        ));
        lines.extend(
            row.failed
                .iter()
                .map(|failed| format!("  {}", failed.text())),
        );
    }
    lines.join("\n")
}

impl Row {
    fn word(&self) -> &'static str {
        match self.failed.is_empty() {
            true => "covered",
            false => "not covered",
        }
    }

    fn finding(&self) -> Finding {
        let said = format!("{}: {} pairs of paths", self.word(), self.pairs);
        Finding::new(Kind::Zones, &self.name, self.failed.is_empty(), said)
    }

    fn json(&self) -> serde_json::Value {
        serde_json::json!({
            "name": self.name, "junctions": self.junctions, "pairs": self.pairs, "zones": self.zones,
            "parts": self.parts, "seconds": self.seconds,
            "failed": self.failed.iter().map(Failed::json).collect::<Vec<_>>(),
        })
    }
}

impl Failed {
    fn text(&self) -> String {
        let zones::Checked {
            ego,
            other,
            verdict,
            ..
        } = &self.checked;
        let why = match verdict {
            Verdict::Covered => "covered".to_owned(),
            Verdict::Uncovered(at) => format!("in no zone: {}", place(at)),
            Verdict::Open(at) => format!("not shown, {MEND}: {}", place(at)),
            Verdict::Corner(zone) => format!(
                "the lane that begins at {:.3} and {:.3} m has its entry outside of its band",
                zone.ego[0], zone.other[0]
            ),
        };
        format!("junction {}, paths {ego} and {other}: {why}", self.junction)
    }

    fn json(&self) -> serde_json::Value {
        let at = |word, at: &Failing| {
            serde_json::json!({
                "verdict": word, "ego_m": at.s, "other_m": at.t, "ego_heading_deg": at.heading,
                "other_heading_deg": at.other_heading, "apart_m": at.apart, "needed_m": at.needed,
            })
        };
        let verdict = match &self.checked.verdict {
            Verdict::Covered => serde_json::json!({ "verdict": "covered" }),
            Verdict::Uncovered(failing) => at("uncovered", failing),
            Verdict::Open(failing) => at("open", failing),
            Verdict::Corner(zone) => serde_json::json!({ "verdict": "corner", "zone": zone }),
        };
        serde_json::json!({
            "junction": self.junction, "ego": self.checked.ego, "other": self.checked.other, "why": verdict,
        })
    }
}

fn place(at: &Failing) -> String {
    format!(
        "ego at {:.3} m heading {:.1}°, other at {:.3} m heading {:.1}°, {:.3} m apart of {:.3} m",
        at.s, at.heading, at.t, at.other_heading, at.apart, at.needed
    )
}
