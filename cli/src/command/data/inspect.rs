//! `cede data inspect`: the recordings in numbers and as a drawing.

use crate::failure::Failure;
use crate::plural::Count;
use crate::scene;
use crate::source::{Source, not_empty};
use crate::svg;
use cede_data::{Distribution, RightsSummary, Rule, Summary};
use std::path::PathBuf;

/// Options of `cede data inspect`.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    source: Source,
    /// Path of the drawing (SVG)
    #[arg(long, default_value = "out/scene.svg", value_name = "FILE.svg", value_parser = svg::path)]
    draw: PathBuf,
    /// Seed of synthetic encounters [default: 0]
    #[arg(long)]
    seed: Option<u64>,
    /// Print the numbers as one JSON object
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let dataset = args.source.load_one_seeded("--seed", args.seed, 0)?;
    super::name_passed_over(&dataset);
    let summary = Summary::of(&dataset);
    svg::save(&args.draw, &scene::svg(&dataset))?;
    if args.json {
        super::print_json(&summary)?;
    } else {
        print(&summary);
    }
    not_empty(&dataset)
}

fn print(summary: &Summary) {
    let encounters = Count(summary.encounters, "encounter");
    println!("{}: {encounters}\n", summary.site);
    println!("file  minutes  vehicles  encounters");
    for file in &summary.files {
        let minutes = file.duration_s / 60.0;
        let (vehicles, encounters) = (file.vehicles, file.encounters);
        println!(
            "{:>4}  {minutes:>7.1}  {vehicles:>8}  {encounters:>10}",
            file.file
        );
    }
    let manoeuvres = summary
        .manoeuvres
        .iter()
        .map(|(name, n)| format!("{n} {name}"));
    println!(
        "\nall vehicles       {}",
        manoeuvres.collect::<Vec<_>>().join(", ")
    );
    println!("left-turners       {} different", summary.left_turners);
    println!("others             {} different", summary.others);
    println!(
        "conflicts          {} crossing, {} merging",
        summary.crossing, summary.merging
    );
    let share = |name: &str, part: usize| {
        let percent = 100.0 * part as f64 / summary.encounters.max(1) as f64;
        println!("{name:<26} {part:>5} ({percent:.1} %)");
    };
    share("left-turner first", summary.left_first);
    share("left-turner starts at rest", summary.left_starts_at_rest);
    share("other starts at rest", summary.other_starts_at_rest);
    rights(&summary.rights);
    println!("\n                              mean     min     p10  median     p90     max");
    row("length, s", &summary.length_s);
    row("PET, s", &summary.pet_s);
    row("first speed left, m/s", &summary.left_speed);
    row("first speed other, m/s", &summary.other_speed);
    row("first distance left, m", &summary.left_distance_m);
    row("first distance other, m", &summary.other_distance_m);
    row("acceleration, m/s²", &summary.acceleration);
    if summary.limit.n > 0 {
        row("speed limit, m/s", &summary.limit);
    }
    row("vehicles around", &summary.bystanders);
    let within = 100.0 * summary.acceleration_within_bounds;
    println!("\naccelerations within ±3 m/s²: {within:.2} %");
}

/// Who goes first by the rules of the road, and how often that vehicle did.
fn rights(rights: &[RightsSummary]) {
    println!(
        "\nleft-turner    other          rule             goes first  encounters  left-turner was first"
    );
    for summary in rights {
        let RightsSummary { left, other, .. } = summary;
        let rule = match summary.rule {
            Rule::Unknown => "not known",
            Rule::AllWayStop => "all-way stop",
            Rule::Regulation => "regulation",
            Rule::MinorRoad => "minor road",
            Rule::LeftTurn => "left turn",
            Rule::Right => "right first",
            Rule::Open => "none",
        };
        let percent = 100.0 * summary.left_first as f64 / summary.encounters.max(1) as f64;
        println!(
            "{left:<15}{other:<15}{rule:<17}{:<12}{:>10}  {percent:>18.1} %",
            summary.first.unwrap_or("–"),
            summary.encounters
        );
    }
}

fn row(name: &str, d: &Distribution) {
    print!("{name:<26}");
    for value in [d.mean, d.min, d.p10, d.median, d.p90, d.max] {
        print!("{value:>8.2}");
    }
    println!();
}
