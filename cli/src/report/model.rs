//! The content of the page, as its JSON.

use super::gallery::Exhibit;
use super::sweep::Panel;
use super::why::{Class, words};
use crate::table::PAPER;
use cede_controller::ConflictKind;
use cede_controller::kinematics::State;
use cede_data::lanelet::LineKind;
use cede_data::{Encounter, EncounterId, Participant, Role, lanelet};
use cede_sim::episode::{End, Episode};
use cede_sim::evaluate::{Drive, TableRow};
use cede_sim::metrics::{recorded_states, svo_series};
use cede_train::driving::judge::Score;
use cede_train::run::curve::Point;
use serde::Serialize;
use std::collections::HashSet;

/// Maximum number of dots for the shield's interventions.
const MOST_DOTS: usize = 4000;

/// The whole page.
#[derive(Default, Serialize)]
pub(super) struct Page {
    /// What the page says, in a sentence; empty if there is nothing to compare.
    pub(super) verdict: String,
    pub(super) subtitle: String,
    pub(super) provenance: String,
    /// Names of the drivers in the order of their colours.
    pub(super) drivers: Vec<String>,
    pub(super) rows: Vec<TableRow>,
    pub(super) paper: Vec<PaperRow>,
    pub(super) map: Map,
    pub(super) cases: Vec<Case>,
    pub(super) distributions: Vec<Episodes>,
    pub(super) interventions: Vec<Interventions>,
    pub(super) sweep: Vec<Panel>,
    pub(super) learning: Vec<Curve>,
    pub(super) gallery: Vec<Exhibit>,
}

impl Page {
    /// Assigns a colour to `driver`, unless it has one.
    pub(super) fn name(&mut self, driver: &str) {
        if self.drivers.iter().all(|known| known != driver) {
            self.drivers.push(driver.to_owned());
        }
    }
}

/// A row of the paper, with the field names of [`TableRow`].
#[derive(Serialize)]
pub(super) struct PaperRow {
    driver: &'static str,
    split: &'static str,
    n: usize,
    priority_accuracy: f64,
    episode_length_error: f64,
    collisions: usize,
}

/// The paper's rows, if `site` is its site.
pub(super) fn paper(site: &str) -> Vec<PaperRow> {
    let rows = PAPER.iter().filter(|_| site == "EP0");
    let row = |&(driver, split, n, priority_accuracy, episode_length_error, collisions)| PaperRow {
        driver,
        split,
        n,
        priority_accuracy,
        episode_length_error,
        collisions,
    };
    rows.map(row).collect()
}

/// The site's map.
#[derive(Default, Serialize)]
pub(super) struct Map {
    lanes: Vec<Vec<[f64; 2]>>,
    lines: Vec<Line>,
}

#[derive(Serialize)]
struct Line {
    kind: &'static str,
    points: Vec<[f64; 2]>,
}

impl Map {
    pub(super) fn of(map: &lanelet::Map) -> Self {
        let points = |points: &Vec<[f64; 2]>| points.iter().map(|p| p.map(centi)).collect();
        let line = |line: &lanelet::Line| Line {
            kind: match line.kind {
                LineKind::Edge => "edge",
                LineKind::Solid => "solid",
                LineKind::Dashed => "dashed",
                LineKind::Stop => "stop",
                LineKind::Crosswalk => "crosswalk",
            },
            points: points(&line.points),
        };
        Self {
            lanes: map
                .lanelets
                .iter()
                .map(|lane| points(&lane.outline()))
                .collect(),
            lines: map.lines.iter().map(line).collect(),
        }
    }
}

/// An encounter to be replayed.
#[derive(Serialize)]
pub(super) struct Case {
    name: String,
    point: [f64; 2],
    vehicles: [Vehicle; 2],
    record: Motion,
    drives: Vec<Driven>,
    around: Vec<Bystander>,
    /// Whether it is shown for a bad moment of one driver alone.
    found: bool,
}

#[derive(Serialize)]
struct Vehicle {
    route: Vec<[f64; 2]>,
    conflict_s: f64,
}

/// The motion of both vehicles along their routes, step by step.
#[derive(Serialize)]
struct Motion {
    first: Option<&'static str>,
    length: u32,
    s: [Vec<f64>; 2],
    v: [Vec<f64>; 2],
    /// The left-turner's, in rad, until the first arrival.
    svo: Vec<f64>,
}

#[derive(Serialize)]
struct Driven {
    driver: String,
    end: &'static str,
    #[serde(flatten)]
    motion: Motion,
    /// The steps in which the shield overruled each vehicle's driver, and why.
    shielded: [Vec<(usize, Class, String)>; 2],
}

#[derive(Serialize)]
struct Bystander {
    appears: u32,
    size: [f64; 2],
    route: Vec<[f64; 2]>,
    s: Vec<f64>,
}

impl Case {
    pub(super) fn of(encounter: &Encounter) -> Self {
        // The longest episode takes twice as long as the record.
        let shown = 2 * encounter.steps;
        let states: Vec<[State; 2]> = recorded_states(encounter)
            .take(shown as usize + 1)
            .collect();
        let point = encounter.conflict_point;
        let bystanders = encounter.participants.iter().skip(2);
        Self {
            name: case_name(encounter),
            point: [point.x, point.y].map(|c| centi(f64::from(c))),
            vehicles: Role::BOTH.map(|role| Vehicle {
                route: route(encounter.judged(role)),
                conflict_s: centi(f64::from(encounter.judged(role).conflict_s)),
            }),
            record: Motion::of(encounter, &states, Some(encounter.first), encounter.steps),
            drives: Vec::new(),
            around: bystanders.filter_map(|b| Bystander::of(b, shown)).collect(),
            found: false,
        }
    }

    /// Adds an episode, unless the driver has one already.
    pub(super) fn add(&mut self, driver: String, drive: &Drive<'_>) {
        if self.drives.iter().any(|driven| driven.driver == driver) {
            return;
        }
        let episode = &drive.episode;
        let overruled = |role: Role| {
            let steps = episode.actions.iter().enumerate();
            steps
                .filter_map(|(i, both)| {
                    let cause = both[role as usize].cause;
                    Some((i, Class::of(cause)?, words(role, cause)))
                })
                .collect()
        };
        self.drives.push(Driven {
            driver,
            end: end(episode),
            motion: Motion::of(
                drive.encounter,
                &episode.states,
                episode.first(),
                drive.measures.length,
            ),
            shielded: Role::BOTH.map(overruled),
        });
    }

    /// The case as one that is shown for a bad moment alone.
    pub(super) fn found(self) -> Self {
        Self {
            found: true,
            ..self
        }
    }

    /// Adds the episodes of the same encounter in `other` of drivers that have none here.
    pub(super) fn merge(&mut self, other: Self) {
        for driven in other.drives {
            if self
                .drives
                .iter()
                .all(|known| known.driver != driven.driver)
            {
                self.drives.push(driven);
            }
        }
    }

    pub(super) fn was_driven(&self) -> bool {
        !self.drives.is_empty()
    }
}

fn case_name(encounter: &Encounter) -> String {
    let EncounterId {
        file, left, other, ..
    } = encounter.id;
    let kind = match encounter.kind {
        ConflictKind::Merging => "merging",
        _ => "crossing",
    };
    let first = match encounter.first {
        Role::Left => "left-turner",
        Role::Other => "other",
    };
    format!("({file}, {left}, {other}): {kind}, {first} first")
}

fn end(episode: &Episode) -> &'static str {
    match episode.end {
        End::Finished => "finished",
        End::Collision => "collision",
        End::TimeOut => "time-out",
    }
}

impl Motion {
    fn of(encounter: &Encounter, states: &[[State; 2]], first: Option<Role>, length: u32) -> Self {
        let series = |value: fn(State) -> f32| {
            [0, 1].map(|i| {
                states
                    .iter()
                    .map(|both| centi(f64::from(value(both[i]))))
                    .collect()
            })
        };
        let svo = svo_series(encounter, states.iter().copied());
        Self {
            first: first.map(|role| match role {
                Role::Left => "left",
                Role::Other => "other",
            }),
            length,
            s: series(|state| state.s),
            v: series(|state| state.v),
            svo: svo.map(|phi| centi(f64::from(phi))).collect(),
        }
    }
}

impl Bystander {
    fn of(vehicle: &Participant, shown: u32) -> Option<Self> {
        let steps = shown.checked_sub(vehicle.appears)?;
        let size = vehicle.footprint;
        Some(Self {
            appears: vehicle.appears,
            size: [size.length, size.width].map(|m| centi(f64::from(m))),
            route: route(vehicle),
            s: vehicle
                .record
                .iter()
                .take(steps as usize + 1)
                .map(|sample| centi(f64::from(sample.s)))
                .collect(),
        })
    }
}

fn route(vehicle: &Participant) -> Vec<[f64; 2]> {
    let points = vehicle.route.points().iter();
    points
        .map(|p| [p.x, p.y].map(|c| centi(f64::from(c))))
        .collect()
}

/// Rounded to thousandths.
fn milli(value: f32) -> f64 {
    (f64::from(value) * 1000.0).round() / 1000.0
}

/// Rounded to hundredths, which is enough for drawing and takes a third of the bytes.
fn centi(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// The learning curve of a row's driver, point by point.
#[derive(Serialize)]
pub(super) struct Curve {
    driver: &'static str,
    /// Shares of the training's work, in percent.
    done: Vec<f64>,
    train: Series,
    validation: Series,
}

#[derive(Default, Serialize)]
struct Series {
    reward: Vec<f64>,
    priority_accuracy: Vec<f64>,
}

impl Curve {
    pub(super) fn of(driver: &'static str, points: &[Point]) -> Self {
        let validation = points.iter().filter_map(|point| point.validation);
        Self {
            driver,
            done: points
                .iter()
                .map(|point| centi(100.0 * f64::from(point.share)))
                .collect(),
            train: Series::of(points.iter().map(|point| point.train)),
            validation: Series::of(validation),
        }
    }
}

impl Series {
    fn of(scores: impl Iterator<Item = Score>) -> Self {
        let mut series = Self::default();
        for score in scores {
            series.reward.push(milli(score.reward));
            series
                .priority_accuracy
                .push(milli(score.priority_accuracy));
        }
        series
    }
}

/// The distances in time in a driver's episodes.
#[derive(Serialize)]
pub(super) struct Episodes {
    driver: String,
    block: String,
    n: usize,
    /// PET (s) of the episodes in which both vehicles arrived, ascending.
    pet: Vec<f64>,
    /// Of the episodes in which the two would have touched, s, ascending.
    ttc: Vec<f64>,
    /// Of the same encounters as recorded, s, ascending.
    recorded_pet: Vec<f64>,
}

impl Episodes {
    pub(super) fn of(driver: &str, row: &TableRow, drives: &[Drive<'_>]) -> Self {
        let pet = |drive: &Drive<'_>| match drive.episode.arrivals {
            [Some(left), Some(other)] => Some(f64::from((left - other).abs()) * 0.1),
            _ => None,
        };
        let mut seen = HashSet::new();
        let recorded = drives.iter().map(|drive| drive.encounter);
        let recorded = recorded.filter(|encounter| seen.insert(&encounter.id));
        Self {
            driver: driver.to_owned(),
            block: block(row),
            n: drives.len(),
            pet: ascending(drives.iter().filter_map(pet)),
            ttc: ascending(drives.iter().filter_map(|drive| drive.measures.min_ttc)),
            recorded_pet: ascending(recorded.map(|encounter| f64::from(encounter.pet))),
        }
    }
}

fn block(row: &TableRow) -> String {
    format!("{}, {}, until {}", row.split, row.mode, row.until)
}

fn ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.map(centi).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Where the shield overruled a driver.
#[derive(Serialize)]
pub(super) struct Interventions {
    driver: String,
    block: String,
    /// Where, and why.
    points: Vec<([f64; 2], Class)>,
    /// The frequency of each class of reasons, in descending order.
    classes: Vec<(Class, usize)>,
    overruled: usize,
    steps: usize,
}

impl Interventions {
    /// `None` if the shield never intervened.
    pub(super) fn of(driver: &str, row: &TableRow, drives: &[Drive<'_>]) -> Option<Self> {
        let mut points = Vec::new();
        let mut classes: Vec<(Class, usize)> = Vec::new();
        let mut steps = 0;
        for drive in drives {
            let roles = drive.ego.map_or(Role::BOTH.to_vec(), |role| vec![role]);
            for (role, (actions, states)) in roles.into_iter().flat_map(|role| {
                let steps = drive.episode.actions.iter().zip(&drive.episode.states);
                steps.map(move |step| (role, step))
            }) {
                steps += 1;
                let Some(class) = Class::of(actions[role as usize].cause) else {
                    continue;
                };
                match classes.iter_mut().find(|(known, _)| *known == class) {
                    Some((_, count)) => *count += 1,
                    None => classes.push((class, 1)),
                }
                let route = &drive.encounter.judged(role).route;
                let place = route.pose(states[role as usize].s).position;
                points.push(([place.x, place.y].map(|c| centi(f64::from(c))), class));
            }
        }
        classes.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
        let overruled = points.len();
        // Thinned evenly, so that dots of all files remain.
        let every = overruled / MOST_DOTS + 1;
        let points = points.into_iter().step_by(every).collect();
        (overruled > 0).then(|| Self {
            driver: driver.to_owned(),
            block: block(row),
            points,
            classes,
            overruled,
            steps,
        })
    }
}
