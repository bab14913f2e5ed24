//! Drivers judged on encounters: the rows of `cede evaluate`.

use crate::contract::Contract;
use crate::dataset::{Dataset, role_name};
use crate::error::{error, named};
use crate::look::{self, FEATURES, Look};
use crate::policy::Policy;
use cede_controller::kinematics::State;
use cede_controller::policy::svo;
use cede_data::{Encounter, Role};
use cede_sim::driver::{self, Baseline, Cede, PolicyAlone, Shielded};
use cede_sim::episode::{End, Until};
use cede_sim::evaluate::{self as judge, Drive, Label, Mode, Protocol, Selection, TableRow};
use cede_sim::{Driver, DriverFactory, Meeting, View};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;
use serde::Serialize;
use std::sync::{Arc, Mutex};

/// The names of the drivers that need no file.
#[pyfunction]
pub(crate) fn driver_names() -> Vec<&'static str> {
    Baseline::ALL
        .iter()
        .map(|known| known.name())
        .chain(["cede"])
        .collect()
}

/// The row of the table of one driver, and its episodes, both as JSON.
#[pyfunction]
#[pyo3(signature = (driver, name, dataset, split, mode, until, partner, shield, seed, threads))]
#[allow(
    clippy::too_many_arguments,
    reason = "keywords, from one place in Python"
)]
pub(crate) fn evaluate(
    py: Python<'_>,
    driver: &Bound<'_, PyAny>,
    name: &str,
    dataset: &Dataset,
    split: &str,
    mode: &str,
    until: &str,
    partner: &str,
    shield: Option<Contract>,
    seed: u64,
    threads: usize,
) -> PyResult<(String, String)> {
    let contender = Contender::of(driver, name)?;
    let selection: Selection = split.parse().map_err(error)?;
    let plan = Plan {
        partner: (mode == "ego")
            .then(|| Contender::named(partner))
            .transpose()?,
        until: named(
            "until",
            until,
            &[("conflict", Until::Conflict), ("cleared", Until::Cleared)],
        )?,
        shield: shield.map(|contract| contract.0),
        seed,
    };
    named("mode", mode, &[("joint", ()), ("ego", ())])?;
    let label = Label {
        driver: name,
        site: &dataset.0.site.name,
        split: selection.name(),
        mode,
        until,
        shield: if shield.is_some() { "on" } else { "off" },
    };
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(error)?;
    let judged =
        py.detach(|| pool.install(|| plan.judge(&contender, &dataset.0, selection, label)));
    contender.raise()?;
    judged
}

/// How the driver is judged.
struct Plan {
    partner: Option<Contender>,
    until: Until,
    shield: Option<cede_controller::Contract>,
    seed: u64,
}

impl Plan {
    fn judge(
        &self,
        contender: &Contender,
        dataset: &cede_data::Dataset,
        selection: Selection,
        label: Label<'_>,
    ) -> PyResult<(String, String)> {
        let mut drives = Vec::new();
        for round in selection.rounds(dataset) {
            let factory = contender.fit(&round.training, self.shield)?;
            let partner = self.partner.as_ref();
            let partner = partner.map(|partner| partner.fit(&round.training, None));
            let partner = partner.transpose()?;
            let protocol = Protocol {
                mode: partner.as_deref().map_or(Mode::Joint, Mode::Ego),
                until: self.until,
                seed: self.seed,
            };
            drives.extend(judge::evaluate(&*factory, &round.judged, protocol).drives);
        }
        if drives.is_empty() {
            return Err(error(format!("split = `{selection}`: no encounters")));
        }
        let episodes: Vec<_> = drives.iter().map(Row::of).collect();
        Ok((json(&TableRow::of(label, &drives))?, json(&episodes)?))
    }
}

fn unfitted(wrong: driver::FitError) -> PyErr {
    let driver::FitError::NoTraining(baseline) = wrong;
    error(format!(
        "driver `{baseline}` is fitted on the training split, which is empty here"
    ))
}

fn json(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(error)
}

/// A driver that is judged.
#[expect(clippy::large_enum_variant, reason = "a handful of them exist")]
pub(crate) enum Contender {
    Baseline(Baseline),
    Cede(Policy),
    Called(Arc<Function>),
}

impl Contender {
    pub(crate) fn of(driver: &Bound<'_, PyAny>, name: &str) -> PyResult<Self> {
        if let Ok(policy) = driver.extract::<Policy>() {
            return Ok(Self::Cede(policy));
        }
        if driver.is_callable() {
            return Ok(Self::Called(Arc::new(Function {
                name: name.to_owned(),
                call: driver.clone().unbind(),
                failure: Mutex::new(None),
            })));
        }
        Self::named(&driver.extract::<String>()?)
    }

    /// The driver of a name that needs no file.
    fn named(name: &str) -> PyResult<Self> {
        match name {
            "cede" => Policy::embedded().map(Self::Cede),
            known => known.parse().map(Self::Baseline).map_err(error),
        }
    }

    pub(crate) fn fit(
        &self,
        training: &[&Encounter],
        shield: Option<cede_controller::Contract>,
    ) -> PyResult<Box<dyn DriverFactory>> {
        let bare: Box<dyn DriverFactory> = match (self, shield) {
            (Self::Cede(policy), None) => Box::new(PolicyAlone::new(policy.0)),
            (Self::Cede(policy), Some(contract)) => {
                return Ok(Box::new(Cede::new(policy.0, contract)));
            }
            (Self::Baseline(baseline), _) => baseline.fit(training).map_err(unfitted)?,
            (Self::Called(function), _) => Box::new(Calls(function.clone())),
        };
        Ok(match shield {
            None => bare,
            Some(contract) => Box::new(Shielded::new(bare, contract)),
        })
    }

    /// Raises what the driver has raised.
    pub(crate) fn raise(&self) -> PyResult<()> {
        let Self::Called(function) = self else {
            return Ok(());
        };
        function.failure().take().map_or(Ok(()), Err)
    }
}

/// A driver written in Python.
pub(crate) struct Function {
    name: String,
    call: Py<PyAny>,
    /// The first exception that it raised; then nothing is asked any more.
    failure: Mutex<Option<PyErr>>,
}

impl Function {
    fn failure(&self) -> std::sync::MutexGuard<'_, Option<PyErr>> {
        self.failure
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

struct Calls(Arc<Function>);

impl DriverFactory for Calls {
    fn name(&self) -> &str {
        &self.0.name
    }

    fn driver<'m>(&self, meeting: &'m Meeting<'_>, _: usize, _: u64) -> Box<dyn Driver + 'm> {
        Box::new(Caller {
            function: self.0.clone(),
            look: Look::of(meeting.encounter),
            svo: svo::FIRST,
        })
    }
}

struct Caller {
    function: Arc<Function>,
    look: Look,
    /// The left-turner's SVO at the last step.
    svo: f32,
}

impl Driver for Caller {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        let Some(seen) = self.see(view) else {
            return 0.0;
        };
        if self.function.failure().is_some() {
            return 0.0;
        }
        let asked = Python::attach(|py| self.function.call.call1(py, (seen,))?.extract(py));
        asked.unwrap_or_else(|raised: PyErr| {
            self.function.failure().get_or_insert(raised);
            0.0
        })
    }
}

impl Caller {
    fn see(&mut self, view: &View<'_>) -> Option<Seen> {
        let states = [view.state(0)?, view.state(1)?];
        let poses = Role::BOTH.map(|role| {
            let vehicle = view.encounter.judged(role);
            vehicle.route.pose(states[role as usize].s)
        });
        self.svo = self.look.pair(0, states, poses, self.svo).svo();
        let pair = self.look.pair(view.ego, states, poses, self.svo);
        let mut observation = [0.0; FEATURES];
        look::write(&pair, &mut observation);
        let seen = |i: usize| {
            let State { s, v } = states[i];
            (s, v, self.look.distance(i, states[i]))
        };
        let ((s, speed, distance), (other_s, other_speed, other_distance)) =
            (seen(view.ego), seen(1 - view.ego));
        Some(Seen {
            step: view.step,
            role: role_name(Role::BOTH[view.ego]),
            s,
            speed,
            distance,
            other_s,
            other_speed,
            other_distance,
            svo: pair.svo(),
            observation,
        })
    }
}

/// What a driver written in Python sees when it decides.
#[pyclass(frozen, name = "View", module = "cede")]
pub(crate) struct Seen {
    #[pyo3(get)]
    step: u32,
    #[pyo3(get)]
    role: &'static str,
    #[pyo3(get)]
    s: f32,
    #[pyo3(get)]
    speed: f32,
    #[pyo3(get)]
    distance: f32,
    #[pyo3(get)]
    other_s: f32,
    #[pyo3(get)]
    other_speed: f32,
    #[pyo3(get)]
    other_distance: f32,
    #[pyo3(get)]
    svo: f32,
    observation: [f32; FEATURES],
}

#[pymethods]
impl Seen {
    /// What the environments show a policy in this state.
    #[getter]
    fn observation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        self.observation.to_vec().into_pyarray(py)
    }
}

pub(crate) fn end_name(end: End) -> &'static str {
    match end {
        End::Finished => "finished",
        End::Collision => "collision",
        End::TimeOut => "time-out",
    }
}

/// One episode of the evaluation.
#[derive(Serialize)]
struct Row<'a> {
    site: &'a str,
    file: u16,
    left: u32,
    other: u32,
    ego: Option<&'static str>,
    end: &'static str,
    first: Option<&'static str>,
    recorded_first: &'static str,
    steps: u32,
    recorded_steps: u32,
    correct: bool,
    length_error: f64,
    position_rmse: f64,
    min_ttc: Option<f64>,
    shielded: f64,
}

impl<'a> Row<'a> {
    fn of(drive: &Drive<'a>) -> Self {
        let (encounter, measures) = (drive.encounter, &drive.measures);
        Self {
            site: &encounter.id.site,
            file: encounter.id.file,
            left: encounter.id.left,
            other: encounter.id.other,
            ego: drive.ego.map(role_name),
            end: end_name(drive.episode.end),
            first: drive.episode.first().map(role_name),
            recorded_first: role_name(encounter.first),
            steps: drive.episode.steps(),
            recorded_steps: encounter.steps,
            correct: measures.correct,
            length_error: measures.length_error,
            position_rmse: measures.position_rmse,
            min_ttc: measures.min_ttc,
            shielded: measures.shielded,
        }
    }
}
