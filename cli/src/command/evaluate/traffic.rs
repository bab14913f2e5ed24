//! `cede evaluate --mode traffic`: a share of the vehicles of each recording is driven, beside a plain profile.

use super::Args;
use crate::contract;
use crate::drivers;
use crate::failure::Failure;
use crate::plural::Count;
use crate::progress;
use crate::source::names;
use cede_data::{Dataset, Traffic};
use cede_sim::traffic::{Kind, Settings, Summary, run as drive};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};
use rayon::prelude::*;
use serde::Serialize;
use std::str::FromStr;

/// The shares if none is named.
const SHARES: [Share; 3] = [Share(0.1), Share(0.5), Share(1.0)];

const HEADER: [&str; 12] = [
    "driver",
    "share",
    "driven",
    "not ready",
    "stuck",
    "others stuck",
    "collisions (struck, both driven)",
    "delay, s",
    "others' delay, s",
    "longest wait, s",
    "shielded",
    "no plan",
];

/// A share of the vehicles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Share(f64);

impl FromStr for Share {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.trim().parse() {
            Ok(share) if (0.0..=1.0).contains(&share) => Ok(Self(share)),
            _ => Err(format!("`{text}` is not a share: a number from 0 to 1")),
        }
    }
}

/// The output of `--json`.
#[derive(Serialize)]
struct Output<'a> {
    data: &'a str,
    site: &'a str,
    seed: u64,
    rows: &'a [Summary],
}

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    refuse_ignored(args)?;
    if args.source.is_synthetic() {
        return Err(Failure::Usage(
            "--mode traffic needs recordings: name their folder with --data; `cede data synthesize --out DIR` writes some"
                .to_owned(),
        ));
    }
    let policy = drivers::policy(args.weights.as_deref())?;
    let policy = match args.svo.as_slice() {
        [] => policy,
        [degrees] => degrees.shown_by(policy)?,
        _ => return Err(Failure::Usage("--mode traffic takes one --svo".to_owned())),
    };
    let contract = contract::or_worst_case(args.contract.as_ref())?;
    let sites = args.source.load(args.seed)?;
    let shares = if args.share.is_empty() {
        &SHARES[..]
    } else {
        &args.share
    };
    let mut rows = Vec::new();
    for site in &sites {
        let settings = settings(shares, args.seed, policy, contract);
        rows.extend(judge(site, &settings)?);
    }
    if args.json {
        let output = Output {
            data: &args.source.data,
            site: &names(&sites),
            seed: args.seed,
            rows: &rows,
        };
        let text = serde_json::to_string_pretty(&output);
        let text = text.map_err(|error| Failure::input(error, "report this as a bug"))?;
        println!("{text}");
    } else {
        print!("{}", table(&rows));
    }
    Ok(())
}

/// Every driver at every share. At share 0 nobody is driven, so one is enough.
fn settings<'w>(
    shares: &[Share],
    seed: u64,
    policy: cede_controller::Policy<'w>,
    contract: cede_controller::Contract,
) -> Vec<Settings<'w>> {
    let kinds = |share: Share| match share {
        Share(0.0) => &[Kind::Profile][..],
        Share(_) => &[Kind::Profile, Kind::Cede],
    };
    let of = |&share: &Share| {
        kinds(share).iter().map(move |&kind| Settings {
            share: share.0,
            seed,
            kind,
            policy,
            contract,
        })
    };
    shares.iter().flat_map(of).collect()
}

/// One row for each of `settings`.
fn judge(dataset: &Dataset, settings: &[Settings<'_>]) -> Result<Vec<Summary>, Failure> {
    let recordings = &dataset.recordings;
    let traffic: Vec<Traffic> = recordings
        .par_iter()
        .map(|recording| Traffic::of(dataset, recording))
        .collect();
    if traffic.iter().all(|it| it.vehicles.is_empty()) {
        return Err(Failure::Check(format!(
            "{}: there are no vehicles in the recordings",
            dataset.site.name
        )));
    }
    let runs = (settings.len() * traffic.len()) as u64;
    let bar = progress::bar(runs, "{bar:30} {pos}/{len} recordings {msg}");
    bar.set_message(dataset.site.name.clone());
    let rows = settings.iter().map(|settings| {
        let outcomes: Vec<_> = traffic
            .par_iter()
            .map(|traffic| {
                let outcome = drive(traffic, settings);
                bar.inc(1);
                outcome
            })
            .collect();
        Summary::of(&dataset.site.name, settings, &outcomes)
    });
    let rows = rows.collect();
    bar.finish_and_clear();
    Ok(rows)
}

/// Options that say something of encounters.
fn refuse_ignored(args: &Args) -> Result<(), Failure> {
    let given = [
        ("--driver", args.driver.is_some()),
        ("--split", !args.split.is_empty()),
        ("--partner", args.partner.is_some()),
        ("--until", args.until.is_some()),
        ("--shield", args.shield.is_some()),
        ("--episodes", args.episodes.is_some()),
        ("--report", args.report.is_some()),
    ];
    match given.iter().find(|(_, given)| *given) {
        Some((option, _)) => Err(Failure::ignored(option, "--mode traffic")),
        None => Ok(()),
    }
}

fn table(rows: &[Summary]) -> String {
    let mut text = String::new();
    for block in rows.chunk_by(|a, b| a.site == b.site) {
        let mut table = Table::new();
        table
            .load_style(presets::ASCII_MARKDOWN)
            .set_content_arrangement(ContentArrangement::Disabled)
            .set_header(HEADER);
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        for row in block {
            table.add_row(cells(row));
        }
        let Some(first) = block.first() else { continue };
        let left_out = match first.left_out {
            0 => String::new(),
            n => format!("; left out, for a way that is no path of a junction: {n}"),
        };
        text += &format!(
            "{}: {} in {}, behind the shield{left_out}\n{table}\n\n",
            first.site,
            Count(first.vehicles, "vehicle"),
            Count(first.recordings, "recording")
        );
    }
    text
}

fn cells(row: &Summary) -> [String; 12] {
    let seconds =
        |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.1}"));
    let share = |value: Option<f64>| {
        value.map_or("–".to_owned(), |value| format!("{:.1} %", 1e2 * value))
    };
    let delay = match row.delay_interval_s {
        Some([low, high]) => format!("{} [{low:.1}, {high:.1}]", seconds(row.delay_s)),
        None => seconds(row.delay_s),
    };
    let driver = match row.driver {
        _ if row.driven == 0 => "nobody",
        Kind::Profile => "profile",
        Kind::Cede => "cede",
    };
    [
        driver.to_owned(),
        format!("{:.0} %", 1e2 * row.share),
        row.driven.to_string(),
        row.refused.to_string(),
        row.stuck.to_string(),
        row.others_stuck.to_string(),
        format!("{} ({}, {})", row.collisions, row.struck, row.both_driven),
        delay,
        seconds(row.others_delay_s),
        format!("{:.0}", row.longest_wait_s),
        share(row.shielded_share),
        share(row.no_plan_share),
    ]
}
