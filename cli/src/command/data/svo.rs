//! `cede data svo`: people's social value orientation, in numbers and as a figure.

mod figure;

use crate::drivers::policy;
use crate::failure::Failure;
use crate::interrupt;
use crate::plural::Count;
use crate::source::Source;
use crate::svg;
use crate::threads::Threads;
use cede_data::output;
use cede_sim::orientations::{AccelerationError, Drivers, Moment, Study};
use std::path::PathBuf;

/// Options of `cede data svo`.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    source: Source,
    /// The policy that predicts the other's acceleration, and with it estimates the other's orientation
    #[arg(long, value_name = "FILE.cede")]
    weights: Option<PathBuf>,
    /// Path of the figure (SVG)
    #[arg(long, default_value = "out/svo.svg", value_name = "FILE.svg", value_parser = svg::path)]
    draw: PathBuf,
    /// Seed of synthetic encounters [default: 0]
    #[arg(long)]
    seed: Option<u64>,
    #[command(flatten)]
    threads: Threads,
    /// Print the numbers as one JSON array, one object a site
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    args.threads.start()?;
    let policy = policy(args.weights.as_deref())?;
    output::check(&args.draw)?;
    let sites = args.source.load_seeded("--seed", args.seed, 0)?;
    let sites = args.source.occupied(sites)?;
    let mut studies = Vec::new();
    for dataset in &sites {
        interrupt::check()?;
        super::name_passed_over(dataset);
        studies.push(Study::of(dataset, &policy));
    }
    figure::write(&args.draw, &studies)?;
    note!("drawn in {}", args.draw.display());
    if args.json {
        return super::print_json(&studies);
    }
    studies.iter().for_each(print);
    Ok(())
}

fn print(study: &Study) {
    println!("{}: {}\n", study.site, Count(study.encounters, "encounter"));
    drivers(&study.drivers);
    println!(
        "\nWho goes first, told so long before the conflict: area under the curve, 0.5 is a guess\n\
         before, s      n   SVO [95 %]           speeds   SVO less speeds  distances  arrivals  own arrival  estimated"
    );
    study
        .first
        .iter()
        .filter(|moment| moment.n > 0)
        .for_each(moment);
    acceleration(&study.acceleration);
    println!();
}

fn drivers(drivers: &Drivers) {
    println!("orientation, °                    mean    p10  median    p90");
    for (name, of) in [
        ("who went first", &drivers.first),
        ("left-turners", &drivers.left),
    ] {
        println!(
            "{name:<30} {:>7.1} {:>6.1} {:>7.1} {:>6.1}",
            of.mean, of.p10, of.median, of.p90
        );
    }
    println!(
        "below 45° went first           {:>5.1} %{}, by file{}",
        100.0 * drivers.egoists.unwrap_or(0.0),
        percent(drivers.egoists_interval),
        percent(drivers.egoists_interval_by_file),
    );
}

fn moment(moment: &Moment) {
    let area = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |x| format!("{x:.3}"));
    println!(
        "{:>9.1}  {:>5}   {} {:<14}  {:>6}   {:<15}  {:>9}  {:>8}  {:>11}  {:>9}",
        moment.before_s,
        moment.n,
        area(moment.svo),
        range(moment.svo_interval),
        area(moment.speeds),
        range(moment.svo_over_speeds_interval),
        area(moment.distances),
        area(moment.arrivals),
        area(moment.own_arrival),
        area(moment.estimated),
    );
}

fn acceleration(error: &AccelerationError) {
    println!(
        "\nThe other's acceleration over the next 0.1 s, {}: root mean square error, m/s²",
        Count(error.n, "step")
    );
    for (name, value) in [
        ("what the policy expects of the other", error.expected),
        ("the policy in the other's seat", error.seated),
        ("with its orientation, as estimated", error.estimated),
        ("as in the last step", error.persistent),
    ] {
        let value = value.map_or_else(|| "–".to_owned(), |x| format!("{x:.3}"));
        println!("  {name:<38} {value}");
    }
    for (name, less) in [
        ("what is expected", error.estimated_less_expected),
        ("the other's seat", error.estimated_less_seated),
    ] {
        if let Some((mean, interval)) = less {
            println!(
                "  squared error, estimated less {name}: {mean:+.4} m²/s⁴, by file {}",
                range(Some(interval))
            );
        }
    }
}

fn range(interval: Option<[f64; 2]>) -> String {
    interval.map_or_else(String::new, |[low, high]| format!("[{low:.3}, {high:.3}]"))
}

fn percent(interval: Option<[f64; 2]>) -> String {
    interval.map_or_else(
        || " –".to_owned(),
        |[low, high]| format!(" [{:.0}, {:.0}]", 100.0 * low, 100.0 * high),
    )
}
