//! Synthetic beside recorded encounters, in the numbers of `docs/synthetic.md`.
//!
//! `cargo run --release -p cede-sim --example compare -- ../shared/interaction [ENCOUNTERS] [SEED]`

use cede_data::{DataError, Dataset, Distribution, Encounter, Manoeuvre, Summary};
use cede_sim::driver::Logistic;
use std::path::Path;

fn main() -> Result<(), DataError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = arguments
        .first()
        .map_or("../shared/interaction", String::as_str);
    let number = |i: usize| arguments.get(i).and_then(|text| text.parse().ok());
    let synthetic = Dataset::synthetic(number(1).unwrap_or(3000), number(2).unwrap_or(1) as u64);
    let sets = [
        ("EP0", Dataset::load(Path::new(folder), "EP0")?),
        ("T, all-way stop", of_class(&synthetic, "-T-AWS-")),
        ("MA", Dataset::load(Path::new(folder), "MA")?),
        ("X, all-way stop", of_class(&synthetic, "-X-AWS-")),
        ("GL", Dataset::load(Path::new(folder), "GL")?),
        ("two-way stop", of_class(&synthetic, "-TWS-")),
        ("all synthetic", synthetic),
    ];
    statistics(&sets);
    transfer(&sets);
    Ok(())
}

/// The site class's left-turners against oncoming traffic: what the recorded encounters are.
fn of_class(data: &Dataset, class: &str) -> Dataset {
    let mut data = data.clone();
    data.encounters
        .retain(|e| e.id.site.contains(class) && left_meets_oncoming(e));
    let files: Vec<u16> = data.encounters.iter().map(|e| e.id.file).collect();
    data.recordings
        .retain(|recording| files.contains(&recording.file));
    data
}

fn left_meets_oncoming(encounter: &Encounter) -> bool {
    let [left, other] = [0, 1].map(|i| &encounter.participants[i]);
    let (a, b) = (
        left.route.pose(0.0).direction,
        other.route.pose(0.0).direction,
    );
    left.manoeuvre == Manoeuvre::Left && other.manoeuvre != Manoeuvre::Left && a.dot(&b) < -0.5
}

fn statistics(sets: &[(&str, Dataset)]) {
    let summaries: Vec<Summary> = sets.iter().map(|(_, data)| Summary::of(data)).collect();
    let row = |name: &str, cell: &dyn Fn(&Summary) -> String| {
        let cells: Vec<String> = summaries.iter().map(cell).collect();
        println!("| {name} | {} |", cells.join(" | "));
    };
    let names: Vec<&str> = sets.iter().map(|(name, _)| *name).collect();
    println!(
        "| | {} |\n|---{}|",
        names.join(" | "),
        "|---".repeat(names.len())
    );
    row("encounters", &|s| s.encounters.to_string());
    row("different left-turners, others", &|s| {
        format!("{}, {}", s.left_turners, s.others)
    });
    let percent =
        |part: usize, s: &Summary| format!("{:.0} %", 100.0 * part as f64 / s.encounters as f64);
    row("left-turner first", &|s| percent(s.left_first, s));
    row("left-turner starts at rest", &|s| {
        percent(s.left_starts_at_rest, s)
    });
    row("other starts at rest", &|s| {
        percent(s.other_starts_at_rest, s)
    });
    row("length, s", &|s| quantiles(&s.length_s));
    row("PET, s", &|s| quantiles(&s.pet_s));
    row("first speed of the left-turner, m/s", &|s| {
        quantiles(&s.left_speed)
    });
    row("first speed of the other, m/s", &|s| {
        quantiles(&s.other_speed)
    });
    row("first distance of the left-turner, m", &|s| {
        quantiles(&s.left_distance_m)
    });
    row("first distance of the other, m", &|s| {
        quantiles(&s.other_distance_m)
    });
    row("acceleration, m/s²", &|s| quantiles(&s.acceleration));
    row("within ±3 m/s²", &|s| {
        format!("{:.2} %", 100.0 * s.acceleration_within_bounds)
    });
    row("vehicles around", &|s| quantiles(&s.bystanders));
}

/// Tenth, half and nine tenths.
fn quantiles(d: &Distribution) -> String {
    format!("{:.1} / {:.1} / {:.1}", d.p10, d.median, d.p90)
}

/// How well a logistic model fitted on one set tells who goes first in another.
fn transfer(sets: &[(&str, Dataset)]) {
    println!(
        "\nWho goes first, by the logistic model; fitted on the row's encounters, judged on the column's:\n"
    );
    let names: Vec<&str> = sets.iter().map(|(name, _)| *name).collect();
    println!(
        "| | {} |\n|---{}|",
        names.join(" | "),
        "|---".repeat(names.len())
    );
    for (name, data) in sets {
        let training: Vec<&Encounter> = data.encounters.iter().collect();
        let Some(model) = Logistic::fit(&training) else {
            continue;
        };
        let right = |set: &Dataset| {
            let hits = set
                .encounters
                .iter()
                .filter(|e| model.first(e) == e.first)
                .count();
            format!("{:.1} %", 100.0 * hits as f64 / set.encounters.len() as f64)
        };
        let cells: Vec<String> = sets.iter().map(|(_, set)| right(set)).collect();
        println!("| {name} | {} |", cells.join(" | "));
    }
}
