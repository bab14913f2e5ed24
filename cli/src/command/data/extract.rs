//! `cede data extract`: the encounters as rows of a CSV.

use crate::failure::Failure;
use crate::source::{Source, not_empty};
use cede_controller::ConflictKind;
use cede_data::{Dataset, Encounter, Manoeuvre, Role, Rule, STEP_MS, Summary, output};
use cede_sim::criticality::{AreaOf, Criticality};
use serde::Serialize;
use std::path::PathBuf;

/// Options of `cede data extract`.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    source: Source,
    /// Write the encounters to this CSV file
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Seed of synthetic encounters [default: 0]
    #[arg(long)]
    seed: Option<u64>,
    /// Print the counts as one JSON object
    #[arg(long)]
    json: bool,
}

/// A row of the file: the columns of INTERACTION's list of selected scenarios, then further columns.
#[derive(Serialize)]
struct EncounterRow<'d> {
    #[serde(rename = "Scenario")]
    scenario: &'d str,
    #[serde(rename = "File_id")]
    file: String,
    #[serde(rename = "StartTime_ms")]
    start_ms: u64,
    #[serde(rename = "EndTime_ms")]
    end_ms: u64,
    #[serde(rename = "Ego_agent_id")]
    left: u32,
    #[serde(rename = "Reactive_agent_id")]
    other: u32,
    /// The vehicle that goes first by the rules of the road; at an all-way stop if both arrive at once. Where
    /// no rule decides, the other: a left-turner yields to oncoming traffic.
    #[serde(rename = "Agent_with_right_of_way")]
    right_of_way: u32,
    #[serde(rename = "First_agent_id")]
    first: u32,
    #[serde(rename = "Length_steps")]
    steps: u32,
    #[serde(rename = "PET_s")]
    pet: String,
    #[serde(rename = "Conflict")]
    kind: &'static str,
    #[serde(rename = "Ego_manoeuvre")]
    left_manoeuvre: Manoeuvre,
    #[serde(rename = "Reactive_manoeuvre")]
    other_manoeuvre: Manoeuvre,
    #[serde(rename = "Right_of_way_by")]
    rule: Rule,
    #[serde(rename = "Ego_control")]
    left_control: &'static str,
    #[serde(rename = "Reactive_control")]
    other_control: &'static str,
    #[serde(rename = "Conflict_x_m")]
    x: String,
    #[serde(rename = "Conflict_y_m")]
    y: String,
    /// The measures of [`Criticality`]; empty where the record does not say them.
    #[serde(rename = "TTC_s")]
    ttc: String,
    #[serde(rename = "Ego_encroachment_s")]
    left_encroachment: String,
    #[serde(rename = "Reactive_encroachment_s")]
    other_encroachment: String,
    #[serde(rename = "Post_encroachment_s")]
    post_encroachment: String,
    #[serde(rename = "Gap_m")]
    gap: String,
    #[serde(rename = "Required_deceleration_mps2")]
    deceleration: String,
    #[serde(rename = "Conflict_area")]
    area: &'static str,
}

impl<'d> EncounterRow<'d> {
    fn of(dataset: &'d Dataset, encounter: &'d Encounter) -> Self {
        let vehicle = |role| encounter.judged(role);
        let critical = Criticality::of(dataset, encounter);
        let number = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:.3}"));
        let [left_encroachment, other_encroachment] = critical.encroachment.map(number);
        let site = &dataset.site;
        Self {
            // A recording with a place of its own is called by that.
            scenario: match encounter.id.site == site.name {
                true => &site.folder,
                false => &encounter.id.site,
            },
            file: format!("{:03}", encounter.id.file),
            start_ms: encounter.start_ms,
            end_ms: encounter.start_ms + STEP_MS * u64::from(encounter.steps),
            left: encounter.id.left,
            other: encounter.id.other,
            right_of_way: vehicle(encounter.rights.first.unwrap_or(Role::Other)).track,
            first: vehicle(encounter.first).track,
            steps: encounter.steps,
            // The record has steps of 0.1 s.
            pet: format!("{:.1}", encounter.pet),
            kind: match encounter.kind {
                ConflictKind::Crossing => "crossing",
                ConflictKind::Merging => "merging",
                ConflictKind::Following => "following",
                ConflictKind::None => "none",
            },
            left_manoeuvre: vehicle(Role::Left).manoeuvre,
            other_manoeuvre: vehicle(Role::Other).manoeuvre,
            rule: encounter.rights.rule,
            left_control: vehicle(Role::Left).entry.control.name(),
            other_control: vehicle(Role::Other).entry.control.name(),
            x: format!("{:.3}", encounter.conflict_point.x),
            y: format!("{:.3}", encounter.conflict_point.y),
            ttc: number(critical.ttc),
            left_encroachment,
            other_encroachment,
            post_encroachment: number(critical.post_encroachment),
            gap: number(Some(critical.gap)),
            deceleration: number(critical.deceleration),
            area: critical.area.map_or("none", AreaOf::name),
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(path) = &args.out {
        output::check(path)?;
    }
    let dataset = args.source.load_one_seeded("--seed", args.seed, 0)?;
    super::name_passed_over(&dataset);
    not_empty(&dataset)?;
    if let Some(path) = &args.out {
        output::write(path, |out| {
            let mut csv = csv::Writer::from_writer(out);
            for encounter in &dataset.encounters {
                csv.serialize(EncounterRow::of(&dataset, encounter))?;
            }
            csv.flush()
        })?;
    }
    if args.json {
        return super::print_json(&Summary::of(&dataset).files);
    }
    print_counts(&dataset);
    Ok(())
}

fn print_counts(dataset: &Dataset) {
    for file in Summary::of(dataset).files {
        println!("file {:03}  {:>4} pairs", file.file, file.encounters);
    }
    println!("total     {:>4} pairs", dataset.encounters.len());
}
