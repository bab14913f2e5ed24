//! What is in a data set, in numbers: recorded and synthetic ones are compared by these.

use super::{Dataset, STEP_MS};
use crate::encounter::{Encounter, Participant, Sample};
use crate::rights::Rule;
use crate::role::{Manoeuvre, Role};
use cede_controller::ConflictKind;
use cede_controller::kinematics::{MAX_ACCELERATION, STEP};
use serde::Serialize;
use std::collections::{BTreeMap, HashSet};

/// A vehicle slower than this (m/s) is at rest.
pub const REST: f32 = 0.5;

/// A data set in numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Name of the site.
    pub site: String,
    /// The recording files.
    pub files: Vec<FileSummary>,
    /// Number of encounters.
    pub encounters: usize,
    /// Number of different left-turners in them.
    pub left_turners: usize,
    /// Number of different others in them.
    pub others: usize,
    /// Encounters whose routes cross.
    pub crossing: usize,
    /// Encounters whose routes merge.
    pub merging: usize,
    /// Encounters in which the left-turner went first.
    pub left_first: usize,
    /// Encounters in which the left-turner starts at rest.
    pub left_starts_at_rest: usize,
    /// Encounters in which the other starts at rest.
    pub other_starts_at_rest: usize,
    /// Vehicles around an encounter, besides the two.
    pub bystanders: Distribution,
    /// Recorded length of the encounters, s.
    pub length_s: Distribution,
    /// Time between the two arrivals at the conflict point, s.
    pub pet_s: Distribution,
    /// First speed of the left-turners, m/s.
    pub left_speed: Distribution,
    /// First speed of the others, m/s.
    pub other_speed: Distribution,
    /// First distance of the left-turners to their arrival at the conflict point, m.
    pub left_distance_m: Distribution,
    /// First distance of the others, m.
    pub other_distance_m: Distribution,
    /// Change of speed over each step until the end of the encounters, m/s².
    pub acceleration: Distribution,
    /// Share of those within ±3 m/s².
    pub acceleration_within_bounds: f64,
    /// Who goes first by the rules of the road, and how often that vehicle did; the most frequent first.
    pub rights: Vec<RightsSummary>,
    /// Speed limit of the judged vehicles' ways through the map, m/s; of those that have one.
    pub limit: Distribution,
    /// How many of all recorded vehicles do what.
    pub manoeuvres: BTreeMap<&'static str, usize>,
}

/// The encounters in which the same rule says the same.
#[derive(Clone, Debug, Serialize)]
pub struct RightsSummary {
    /// What obliges the left-turner to give way.
    pub left: &'static str,
    /// What obliges the other.
    pub other: &'static str,
    /// The rule by which it is known who goes first.
    pub rule: Rule,
    /// Who goes first by it, if it decides: `left` or `other`.
    pub first: Option<&'static str>,
    /// Number of such encounters.
    pub encounters: usize,
    /// In how many of them the left-turner went first.
    pub left_first: usize,
}

/// A recording file in numbers.
#[derive(Clone, Debug, Serialize)]
pub struct FileSummary {
    /// Its number.
    pub file: u16,
    /// From the first row to the last, s.
    pub duration_s: f64,
    /// Vehicles in it.
    pub vehicles: usize,
    /// Encounters in it.
    pub encounters: usize,
}

/// A distribution in a few numbers; all 0 without values.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Distribution {
    /// Number of values.
    pub n: usize,
    /// Arithmetic mean.
    pub mean: f64,
    /// Smallest value.
    pub min: f64,
    /// A tenth of the values are smaller.
    pub p10: f64,
    /// Half of the values are smaller.
    pub median: f64,
    /// Nine tenths of the values are smaller.
    pub p90: f64,
    /// Largest value.
    pub max: f64,
}

impl Distribution {
    /// Of these values; quantiles by the nearest rank.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        let Some(last) = values.len().checked_sub(1) else {
            return Self::default();
        };
        let quantile = |q: f64| values[(q * last as f64).round() as usize];
        Self {
            n: values.len(),
            mean: values.iter().sum::<f64>() / values.len() as f64,
            min: values[0],
            p10: quantile(0.1),
            median: quantile(0.5),
            p90: quantile(0.9),
            max: values[last],
        }
    }
}

impl Summary {
    /// Of `dataset`. Cost: one pass over its recordings.
    #[must_use]
    pub fn of(dataset: &Dataset) -> Self {
        let all = &dataset.encounters;
        let count = |holds: &dyn Fn(&Encounter) -> bool| all.iter().filter(|e| holds(e)).count();
        let distribution =
            |value: &dyn Fn(&Encounter) -> f64| Distribution::of(all.iter().map(value));
        let different = |role: Role| {
            let tracks = all.iter().map(|e| (e.id.file, e.judged(role).track));
            tracks.collect::<HashSet<_>>().len()
        };
        let speed = |e: &Encounter, role| first(e.judged(role)).v;
        let distance = |e: &Encounter, role| {
            let vehicle = e.judged(role);
            f64::from(vehicle.conflict_s - first(vehicle).s)
        };
        let accelerations = accelerations(all);
        let bounds = f64::from(MAX_ACCELERATION);
        let within = accelerations.iter().filter(|a| a.abs() <= bounds).count();
        Self {
            site: dataset.site.name.clone(),
            files: files(dataset),
            encounters: all.len(),
            left_turners: different(Role::Left),
            others: different(Role::Other),
            crossing: count(&|e| e.kind == ConflictKind::Crossing),
            merging: count(&|e| e.kind == ConflictKind::Merging),
            left_first: count(&|e| e.first == Role::Left),
            left_starts_at_rest: count(&|e| speed(e, Role::Left) < REST),
            other_starts_at_rest: count(&|e| speed(e, Role::Other) < REST),
            bystanders: distribution(&|e| e.participants.len() as f64 - 2.0),
            length_s: distribution(&|e| f64::from(e.steps) * STEP_MS as f64 * 1e-3),
            pet_s: distribution(&|e| f64::from(e.pet)),
            left_speed: distribution(&|e| f64::from(speed(e, Role::Left))),
            other_speed: distribution(&|e| f64::from(speed(e, Role::Other))),
            left_distance_m: distribution(&|e| distance(e, Role::Left)),
            other_distance_m: distribution(&|e| distance(e, Role::Other)),
            acceleration_within_bounds: within as f64 / accelerations.len().max(1) as f64,
            acceleration: Distribution::of(accelerations),
            rights: rights(all),
            limit: Distribution::of(limits(all)),
            manoeuvres: manoeuvres(dataset),
        }
    }
}

fn limits(encounters: &[Encounter]) -> impl Iterator<Item = f64> {
    let judged = encounters
        .iter()
        .flat_map(|e| Role::BOTH.map(|role| e.judged(role)));
    judged.filter_map(|vehicle| vehicle.entry.limit.map(f64::from))
}

fn rights(encounters: &[Encounter]) -> Vec<RightsSummary> {
    let mut all: Vec<RightsSummary> = Vec::new();
    for encounter in encounters {
        let [left, other] = Role::BOTH.map(|role| encounter.judged(role).entry.control.name());
        let rule = encounter.rights.rule;
        let first = encounter.rights.first.map(|role| match role {
            Role::Left => "left",
            Role::Other => "other",
        });
        let same = |known: &&mut RightsSummary| {
            (known.left, known.other, known.rule, known.first) == (left, other, rule, first)
        };
        let of_left = usize::from(encounter.first == Role::Left);
        if let Some(known) = all.iter_mut().find(same) {
            known.encounters += 1;
            known.left_first += of_left;
        } else {
            all.push(RightsSummary {
                left,
                other,
                rule,
                first,
                encounters: 1,
                left_first: of_left,
            });
        }
    }
    all.sort_by_key(|summary| std::cmp::Reverse(summary.encounters));
    all
}

fn first(vehicle: &Participant) -> Sample {
    let nowhere = Sample {
        s: 0.0,
        v: 0.0,
        a: 0.0,
    };
    vehicle.record.first().copied().unwrap_or(nowhere)
}

/// Recorded changes of speed of both vehicles, until the first of them arrives.
fn accelerations(encounters: &[Encounter]) -> Vec<f64> {
    let of_vehicle = |vehicle: &Participant, steps: u32| {
        let steps = vehicle.record.windows(2).take(steps as usize);
        let changes = steps.map(|pair| f64::from(pair[1].v - pair[0].v) / f64::from(STEP));
        changes.collect::<Vec<_>>()
    };
    encounters
        .iter()
        .flat_map(|e| Role::BOTH.map(|role| of_vehicle(e.judged(role), e.steps)))
        .flatten()
        .collect()
}

fn files(dataset: &Dataset) -> Vec<FileSummary> {
    let of_file = |file| dataset.encounters.iter().filter(move |e| e.id.file == file);
    let summary = |recording: &super::Recording| {
        let begin = recording.tracks.iter().map(|t| t.first_ms).min();
        let end = recording.tracks.iter().map(super::Track::last_ms).max();
        let duration_ms = end.unwrap_or(0) - begin.unwrap_or(0);
        FileSummary {
            file: recording.file,
            duration_s: duration_ms as f64 * 1e-3,
            vehicles: recording.tracks.len(),
            encounters: of_file(recording.file).count(),
        }
    };
    dataset.recordings.iter().map(summary).collect()
}

fn manoeuvres(dataset: &Dataset) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    for track in dataset.recordings.iter().flat_map(|r| &r.tracks) {
        let name = match dataset.site.manoeuvre(track) {
            Manoeuvre::Left => "left",
            Manoeuvre::Straight => "straight",
            Manoeuvre::Right => "right",
            Manoeuvre::Unknown => "unknown",
        };
        *counts.entry(name).or_default() += 1;
    }
    counts
}
