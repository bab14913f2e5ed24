//! Recordings, maps and encounters as columns of numbers.

use crate::error::{error, named};
use crate::junction::kind_name;
use crate::names::control_name;
use cede_data::lanelet::LineKind;
use cede_data::{self as data, Encounter, Manoeuvre, Participant, Role, Split};
use cede_sim::criticality::{AreaOf, Criticality};
use numpy::{IntoPyArray, PyArray2};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::ffi::CString;
use std::path::PathBuf;
use std::sync::Arc;

/// A line of a map: what it is, and its points.
type Line<'py> = (&'static str, Bound<'py, PyArray2<f64>>);

/// A lanelet of a map: left bound, right bound, successors, speed limit.
type Lanelet<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Vec<usize>,
    Option<f64>,
);

/// A site's recordings and the encounters in them.
#[pyclass(frozen, module = "cede")]
pub(crate) struct Dataset(pub(crate) Arc<data::Dataset>);

const SPLITS: [(&str, Split); 4] = [
    ("train", Split::Train),
    ("validation", Split::Validation),
    ("test", Split::Test),
    ("all", Split::All),
];

#[pymethods]
impl Dataset {
    /// At least `encounters` synthetic encounters, the same for the same seed.
    #[staticmethod]
    #[pyo3(signature = (encounters = 1000, seed = 0))]
    fn synthetic(py: Python<'_>, encounters: usize, seed: u64) -> PyResult<Self> {
        if encounters == 0 {
            return Err(error("encounters = 0 is outside [1, 500000]"));
        }
        Ok(Self(Arc::new(
            py.detach(|| data::Dataset::synthetic(encounters, seed)),
        )))
    }

    /// The recordings of `site` in `folder`, as `cede evaluate --data` reads them. A site that nothing describes is a
    /// warning.
    #[staticmethod]
    #[pyo3(signature = (folder, site = "EP0"))]
    fn load(py: Python<'_>, folder: PathBuf, site: &str) -> PyResult<Self> {
        let loaded = py
            .detach(|| data::Dataset::load(&folder, site))
            .map_err(|wrong| error(format!("{wrong}: {}", wrong.mend())))?;
        if let Some(remark) = loaded.site.remark() {
            let remark = CString::new(remark)?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &remark, 1)?;
        }
        Ok(Self(Arc::new(loaded)))
    }

    #[getter]
    fn site(&self) -> &str {
        &self.0.site.name
    }

    /// Number of encounters.
    fn __len__(&self) -> usize {
        self.0.encounters.len()
    }

    /// Columns of the recorded states, one row a vehicle and 0.1 s.
    fn recording_columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        recordings(py, &self.0)
    }

    /// Columns of the encounters, one row each.
    #[pyo3(signature = (split = "all"))]
    fn encounter_columns<'py>(&self, py: Python<'py>, split: &str) -> PyResult<Bound<'py, PyDict>> {
        encounters(py, &self.of(split)?)
    }

    /// Columns of the states in the encounters: one row a vehicle and step.
    #[pyo3(signature = (split = "all"))]
    fn state_columns<'py>(&self, py: Python<'py>, split: &str) -> PyResult<Bound<'py, PyDict>> {
        states(py, &self.of(split)?)
    }

    /// Columns of how critical the recorded encounters were, one row each.
    #[pyo3(signature = (split = "all"))]
    fn criticality_columns<'py>(
        &self,
        py: Python<'py>,
        split: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let all = self.of(split)?;
        let of = |encounter: &&Encounter| Criticality::of(&self.0, encounter);
        let measured: Vec<_> = py.detach(|| all.par_iter().map(of).collect());
        criticality(py, &all, &measured)
    }

    /// The route of a vehicle of encounter number `encounter`: points (m), shape (n, 2).
    #[pyo3(signature = (encounter, vehicle, split = "all"))]
    fn route<'py>(
        &self,
        py: Python<'py>,
        encounter: usize,
        vehicle: usize,
        split: &str,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let all = self.of(split)?;
        let found = all.get(encounter).and_then(|e| e.participants.get(vehicle));
        let found = found.ok_or_else(|| {
            error(format!(
                "no vehicle {vehicle} in an encounter {encounter} of {}",
                all.len()
            ))
        })?;
        let points: Vec<_> = found
            .route
            .points()
            .iter()
            .map(|p| vec![p.x, p.y])
            .collect();
        PyArray2::from_vec2(py, &points).map_err(error)
    }

    /// The lanelets of the map: the points of the left and the right bound of each in m, the lanelets that it leads
    /// into, as indices, and its speed limit in m/s.
    fn map_lanelets<'py>(&self, py: Python<'py>) -> PyResult<Vec<Lanelet<'py>>> {
        let bound = |points: &[[f64; 2]]| {
            let points: Vec<_> = points.iter().map(|p| p.to_vec()).collect();
            PyArray2::from_vec2(py, &points).map_err(error)
        };
        let lanelets = self.0.map.iter().flat_map(|map| &map.lanelets);
        let lanelet = |lanelet: &data::lanelet::Lanelet| {
            let (left, right) = (bound(&lanelet.left)?, bound(&lanelet.right)?);
            Ok((left, right, lanelet.successors.clone(), lanelet.limit))
        };
        lanelets.map(lanelet).collect()
    }

    /// The lines of the map: what each is, and its points, shape (n, 2).
    fn map_lines<'py>(&self, py: Python<'py>) -> PyResult<Vec<Line<'py>>> {
        let lines = self.0.map.iter().flat_map(|map| &map.lines);
        lines
            .map(|line| {
                let points: Vec<_> = line.points.iter().map(|p| p.to_vec()).collect();
                Ok((
                    line_name(line.kind),
                    PyArray2::from_vec2(py, &points).map_err(error)?,
                ))
            })
            .collect()
    }

    fn __repr__(&self) -> String {
        let (encounters, recordings) = (self.0.encounters.len(), self.0.recordings.len());
        format!(
            "Dataset(site='{}', {encounters} encounters, {recordings} recordings)",
            self.site()
        )
    }
}

impl Dataset {
    /// The encounters of a split, in order.
    pub(crate) fn of(&self, split: &str) -> PyResult<Vec<&Encounter>> {
        Ok(self.0.split(named("split", split, &SPLITS)?).collect())
    }
}

fn line_name(kind: LineKind) -> &'static str {
    match kind {
        LineKind::Edge => "edge",
        LineKind::Solid => "solid",
        LineKind::Dashed => "dashed",
        LineKind::Stop => "stop",
        LineKind::Crosswalk => "crosswalk",
    }
}

/// Adds a column of `values`, whose memory NumPy takes over.
pub(crate) fn column<T: numpy::Element>(
    table: &Bound<'_, PyDict>,
    name: &str,
    values: impl Iterator<Item = T>,
) -> PyResult<()> {
    table.set_item(name, values.collect::<Vec<_>>().into_pyarray(table.py()))
}

fn words<'a>(
    table: &Bound<'_, PyDict>,
    name: &str,
    values: impl Iterator<Item = &'a str>,
) -> PyResult<()> {
    table.set_item(name, values.collect::<Vec<_>>())
}

fn recordings<'py>(py: Python<'py>, dataset: &data::Dataset) -> PyResult<Bound<'py, PyDict>> {
    let rows = || {
        dataset.recordings.iter().flat_map(|recording| {
            recording.tracks.iter().flat_map(move |track| {
                track
                    .states
                    .iter()
                    .zip(0_u64..)
                    .map(move |(state, i)| (recording, track, i, state))
            })
        })
    };
    let table = PyDict::new(py);
    column(&table, "file", rows().map(|(recording, ..)| recording.file))?;
    column(&table, "track", rows().map(|(_, track, ..)| track.id))?;
    column(
        &table,
        "time_ms",
        rows().map(|(_, track, i, _)| track.first_ms + data::STEP_MS * i),
    )?;
    column(&table, "x", rows().map(|(.., state)| state.x))?;
    column(&table, "y", rows().map(|(.., state)| state.y))?;
    column(&table, "vx", rows().map(|(.., state)| state.vx))?;
    column(&table, "vy", rows().map(|(.., state)| state.vy))?;
    column(&table, "heading", rows().map(|(.., state)| state.heading))?;
    column(&table, "length", rows().map(|(_, track, ..)| track.length))?;
    column(&table, "width", rows().map(|(_, track, ..)| track.width))?;
    Ok(table)
}

fn encounters<'py>(py: Python<'py>, all: &[&Encounter]) -> PyResult<Bound<'py, PyDict>> {
    let rows = || all.iter();
    let table = PyDict::new(py);
    words(&table, "site", rows().map(|e| e.id.site.as_str()))?;
    column(&table, "file", rows().map(|e| e.id.file))?;
    column(&table, "left", rows().map(|e| e.id.left))?;
    column(&table, "other", rows().map(|e| e.id.other))?;
    words(&table, "kind", rows().map(|e| kind_name(e.kind)))?;
    words(&table, "first", rows().map(|e| role_name(e.first)))?;
    column(&table, "start_ms", rows().map(|e| e.start_ms))?;
    column(&table, "steps", rows().map(|e| e.steps))?;
    column(&table, "pet", rows().map(|e| e.pet))?;
    column(&table, "conflict_x", rows().map(|e| e.conflict_point.x))?;
    column(&table, "conflict_y", rows().map(|e| e.conflict_point.y))?;
    column(&table, "vehicles", rows().map(|e| e.participants.len()))?;
    words(
        &table,
        "right_of_way",
        rows().map(|e| e.rights.first.map_or("none", role_name)),
    )?;
    words(&table, "rule", rows().map(|e| e.rights.rule.name()))?;
    for role in Role::BOTH {
        let name = role_name(role);
        words(
            &table,
            &format!("{name}_manoeuvre"),
            rows().map(|e| manoeuvre(e.judged(role))),
        )?;
        let number = |what: &str, of: fn(&Participant) -> f32| {
            let values = rows().map(|e| of(e.judged(role)));
            column(&table, &format!("{name}_{what}"), values)
        };
        number("length", |vehicle| vehicle.footprint.length)?;
        number("width", |vehicle| vehicle.footprint.width)?;
        number("line", |vehicle| vehicle.entry.line.unwrap_or(f32::NAN))?;
        number("limit", |vehicle| vehicle.entry.limit.unwrap_or(f32::NAN))?;
        words(
            &table,
            &format!("{name}_control"),
            rows().map(|e| control_name(e.judged(role).entry.control)),
        )?;
        column(
            &table,
            &format!("{name}_speed"),
            rows().map(|e| first(e.judged(role)).1),
        )?;
        column(
            &table,
            &format!("{name}_distance"),
            rows().map(|e| first(e.judged(role)).0),
        )?;
    }
    Ok(table)
}

fn criticality<'py>(
    py: Python<'py>,
    all: &[&Encounter],
    measured: &[Criticality],
) -> PyResult<Bound<'py, PyDict>> {
    let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let rows = || measured.iter();
    let table = PyDict::new(py);
    words(&table, "site", all.iter().map(|e| e.id.site.as_str()))?;
    column(&table, "file", all.iter().map(|e| e.id.file))?;
    column(&table, "left", all.iter().map(|e| e.id.left))?;
    column(&table, "other", all.iter().map(|e| e.id.other))?;
    column(&table, "ttc", rows().map(|c| number(c.ttc)))?;
    for role in Role::BOTH {
        let name = format!("{}_et", role_name(role));
        let time = |c: &Criticality| number(c.encroachment[role as usize]);
        column(&table, &name, rows().map(time))?;
    }
    column(&table, "pet", rows().map(|c| number(c.post_encroachment)))?;
    column(&table, "gap", rows().map(|c| c.gap))?;
    column(
        &table,
        "deceleration",
        rows().map(|c| number(c.deceleration)),
    )?;
    words(
        &table,
        "area",
        rows().map(|c| c.area.map_or("none", AreaOf::name)),
    )?;
    Ok(table)
}

fn states<'py>(py: Python<'py>, all: &[&Encounter]) -> PyResult<Bound<'py, PyDict>> {
    let rows = || {
        all.iter().zip(0_u32..).flat_map(|(encounter, number)| {
            encounter
                .participants
                .iter()
                .zip(0_u16..)
                .flat_map(move |(vehicle, index)| {
                    let steps = vehicle.record.iter().zip(vehicle.appears..);
                    steps.map(move |(sample, step)| (number, index, vehicle, step, sample))
                })
        })
    };
    let position = |vehicle: &Participant, s| vehicle.route.pose(s).position;
    let table = PyDict::new(py);
    column(&table, "encounter", rows().map(|(number, ..)| number))?;
    column(&table, "vehicle", rows().map(|(_, index, ..)| index))?;
    column(
        &table,
        "track",
        rows().map(|(_, _, vehicle, ..)| vehicle.track),
    )?;
    column(&table, "step", rows().map(|(.., step, _)| step))?;
    column(&table, "s", rows().map(|(.., sample)| sample.s))?;
    column(&table, "v", rows().map(|(.., sample)| sample.v))?;
    column(&table, "a", rows().map(|(.., sample)| sample.a))?;
    column(
        &table,
        "x",
        rows().map(|(_, _, vehicle, _, sample)| position(vehicle, sample.s).x),
    )?;
    column(
        &table,
        "y",
        rows().map(|(_, _, vehicle, _, sample)| position(vehicle, sample.s).y),
    )?;
    Ok(table)
}

pub(crate) fn role_name(role: Role) -> &'static str {
    match role {
        Role::Left => "left",
        Role::Other => "other",
    }
}

fn manoeuvre(vehicle: &Participant) -> &'static str {
    match vehicle.manoeuvre {
        Manoeuvre::Left => "left",
        Manoeuvre::Straight => "straight",
        Manoeuvre::Right => "right",
        Manoeuvre::Unknown => "unknown",
    }
}

/// Distance to the conflict point (m) and speed (m/s) at the start.
fn first(vehicle: &Participant) -> (f32, f32) {
    let start = vehicle.record.first();
    start.map_or((f32::NAN, f32::NAN), |start| {
        (vehicle.conflict_s - start.s, start.v)
    })
}
