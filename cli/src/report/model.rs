//! The content of the page, as its JSON.

use super::digits::{centi, milli};
use super::gallery::Exhibit;
use super::replayed::Case;
use super::sweep::Panel;
use super::why::Class;
use crate::table::PAPER;
use cede_data::lanelet::LineKind;
use cede_data::{Role, lanelet};
use cede_sim::evaluate::{Drive, TableRow};
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
    /// Of which of several trainings the rows are; empty if there is nothing to tell.
    pub(super) seed_note: String,
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
