//! One encounter as it is driven, state by state.

use crate::contract::Contract;
use crate::dataset::{Dataset, column};
use crate::error::{error, named};
use crate::evaluate::Contender;
use cede_controller::Pose;
use cede_data::{Encounter, Participant, Sample, Split};
use cede_sim::episode::{Episode, Until};
use cede_sim::evaluate::{Mode, Protocol, evaluate};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A vehicle's number in the encounter, the step, where it is, whether a shield overruled its driver.
struct Row<'e> {
    index: u16,
    vehicle: &'e Participant,
    step: u32,
    sample: Sample,
    shielded: bool,
}

/// Columns of the states of all vehicles, and how the episode ended.
#[pyfunction]
#[pyo3(signature = (driver, name, dataset, split, encounter, until, shield, seed))]
#[allow(
    clippy::too_many_arguments,
    reason = "keywords, from one place in Python"
)]
pub(crate) fn replay<'py>(
    py: Python<'py>,
    driver: &Bound<'py, PyAny>,
    name: &str,
    dataset: &Dataset,
    split: &str,
    encounter: usize,
    until: &str,
    shield: Option<Contract>,
    seed: u64,
) -> PyResult<(Bound<'py, PyDict>, &'static str)> {
    let all = dataset.of(split)?;
    let missing = || {
        error(format!(
            "encounter = {encounter} is outside [0, {})",
            all.len()
        ))
    };
    let encounter = *all.get(encounter).ok_or_else(missing)?;
    let protocol = Protocol {
        mode: Mode::Joint,
        until: named(
            "until",
            until,
            &[("conflict", Until::Conflict), ("cleared", Until::Cleared)],
        )?,
        seed,
    };
    let contender = Contender::of(driver, name)?;
    let training: Vec<&Encounter> = dataset.0.split(Split::Train).collect();
    let factory = contender.fit(&training, shield.map(|contract| contract.0))?;
    let driven = py.detach(|| evaluate(&*factory, &[encounter], protocol));
    contender.raise()?;
    if let Some(refused) = driven.refused.first() {
        return Err(error(format!(
            "encounter {:?}: {}",
            encounter.id, refused.why
        )));
    }
    let drive = driven
        .drives
        .first()
        .ok_or_else(|| error("nothing was driven"))?;
    let rows = rows(encounter, &drive.episode);
    Ok((
        columns(py, &rows)?,
        crate::evaluate::end_name(drive.episode.end),
    ))
}

/// The judged vehicles as they were driven, then those around them as they were recorded.
fn rows<'e>(encounter: &'e Encounter, episode: &Episode) -> Vec<Row<'e>> {
    let mut rows = Vec::new();
    let steps = 0..u32::try_from(episode.states.len()).unwrap_or(u32::MAX);
    for (index, vehicle) in (0_u16..).zip(&encounter.participants) {
        let judged = usize::from(index);
        for step in steps.clone() {
            let state = episode.states[step as usize].get(judged);
            let action = episode
                .actions
                .get(step as usize)
                .and_then(|both| both.get(judged));
            let driven = state.map(|state| Sample {
                s: state.s,
                v: state.v,
                a: action.map_or(0.0, |action| action.acceleration),
            });
            if let Some(sample) = driven.or_else(|| vehicle.recorded(step)) {
                rows.push(Row {
                    index,
                    vehicle,
                    step,
                    sample,
                    shielded: action.is_some_and(cede_sim::episode::Action::shielded),
                });
            }
        }
    }
    rows
}

fn columns<'py>(py: Python<'py>, rows: &[Row<'_>]) -> PyResult<Bound<'py, PyDict>> {
    let pose = |row: &Row<'_>| row.vehicle.route.pose(row.sample.s);
    let heading = |pose: Pose| pose.direction.y.atan2(pose.direction.x);
    let table = PyDict::new(py);
    let each = || rows.iter();
    column(&table, "step", each().map(|row| row.step))?;
    column(&table, "vehicle", each().map(|row| row.index))?;
    column(&table, "track", each().map(|row| row.vehicle.track))?;
    column(&table, "s", each().map(|row| row.sample.s))?;
    column(
        &table,
        "distance",
        each().map(|row| row.vehicle.conflict_s - row.sample.s),
    )?;
    column(&table, "v", each().map(|row| row.sample.v))?;
    column(&table, "a", each().map(|row| row.sample.a))?;
    column(&table, "x", each().map(|row| pose(row).position.x))?;
    column(&table, "y", each().map(|row| pose(row).position.y))?;
    column(&table, "heading", each().map(|row| heading(pose(row))))?;
    column(
        &table,
        "length",
        each().map(|row| row.vehicle.footprint.length),
    )?;
    column(
        &table,
        "width",
        each().map(|row| row.vehicle.footprint.width),
    )?;
    column(&table, "shielded", each().map(|row| row.shielded))?;
    Ok(table)
}
