//! Decisions and their reasons.

use crate::error::decimal;
use cede_controller::{self as cede, Action, Breach, Cause, Condition, Intervention, Subject};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The ego's acceleration for the period that begins, and why it is what it is.
#[pyclass(frozen, module = "cede")]
pub(crate) struct Decision(pub(crate) cede::Decision);

#[pymethods]
impl Decision {
    #[getter]
    fn acceleration(&self) -> f32 {
        self.0.acceleration
    }

    #[getter]
    fn cause(&self) -> &'static str {
        match self.0.cause {
            Cause::Policy => "policy",
            Cause::Shielded(_) => "shielded",
            _ => "fallback",
        }
    }

    #[getter]
    fn action(&self) -> Option<&'static str> {
        match self.0.cause {
            Cause::Shielded(Intervention {
                action: Action::Nearest,
                ..
            }) => Some("nearest"),
            Cause::Shielded(Intervention {
                action: Action::Remembered,
                ..
            }) => Some("remembered"),
            _ => None,
        }
    }

    #[getter]
    fn reason(&self) -> Option<Reason> {
        match self.0.cause {
            Cause::Shielded(Intervention { reason, .. }) => Some(Reason(reason)),
            _ => None,
        }
    }

    #[getter]
    fn margin(&self) -> f32 {
        self.0.margin
    }

    #[getter]
    fn plan(&self) -> Option<u16> {
        self.0.plan.map(|plan| plan.go)
    }

    /// `"ego"`, or the number of the track.
    #[getter]
    fn breach<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(match self.0.breach {
            None => None,
            Some(Breach::Ego) => Some("ego".into_pyobject(py)?.into_any()),
            Some(Breach::Other(number)) => Some(number.into_pyobject(py)?.into_any()),
            Some(_) => None,
        })
    }

    /// What is wrong with the inputs, or else why neither policy nor shield decided.
    #[getter]
    fn fault(&self) -> Option<Fault> {
        let fallback = match self.0.cause {
            Cause::Fallback(fault) => Some(fault),
            _ => None,
        };
        self.0.fault.or(fallback).map(Fault)
    }

    /// Whether no plan is safe: the guarantee has ended.
    #[getter]
    fn no_plan(&self) -> bool {
        self.0.cause == Cause::Fallback(cede::Fault::NoPlan)
    }

    #[getter]
    fn unwatched(&self) -> Option<u16> {
        self.0.unwatched
    }

    /// How near each monitored condition of the contract is to its limit, by its name.
    #[getter]
    fn headroom<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (condition, room) in self.0.headroom.conditions() {
            if let Some(cede::Room {
                left, share, track, ..
            }) = room
            {
                dict.set_item(condition_name(condition), Room { left, share, track })?;
            }
        }
        Ok(dict)
    }

    #[getter]
    fn prediction(&self) -> Option<Prediction> {
        self.0.prediction.map(|p| Prediction {
            other: p.other,
            svo: p.svo,
            acceleration: p.acceleration,
            shown: p.shown.map(|shown| Estimate {
                svo: shown.svo,
                confidence: shown.confidence,
                acceleration: shown.acceleration,
            }),
        })
    }

    fn __str__(&self) -> String {
        self.0.to_string()
    }

    fn __repr__(&self) -> String {
        format!("Decision(acceleration={}, {})", self.0.acceleration, self.0)
    }
}

fn condition_name(condition: Condition) -> &'static str {
    match condition {
        Condition::EgoPosition => "ego-position",
        Condition::EgoSpeed => "ego-speed",
        Condition::OtherPosition => "other-position",
        Condition::OtherSpeed => "other-speed",
        Condition::Offset => "offset",
        Condition::Heading => "heading",
        Condition::Period => "period",
        _ => "",
    }
}

/// What is left of a tolerance.
#[pyclass(frozen, get_all, module = "cede")]
pub(crate) struct Room {
    left: f32,
    share: f32,
    track: Option<u16>,
}

#[pymethods]
impl Room {
    fn __repr__(&self) -> String {
        let Self { left, share, track } = self;
        let track = track.map_or_else(|| "None".to_owned(), |number| number.to_string());
        format!("Room(left={left}, share={share}, track={track})")
    }
}

/// Why a proposal is refused.
#[pyclass(frozen, module = "cede")]
pub(crate) struct Reason(cede::Reason);

#[pymethods]
impl Reason {
    #[getter]
    fn kind(&self) -> &'static str {
        match self.0 {
            cede::Reason::Arrival { .. } => "arrival",
            cede::Reason::Entry { .. } => "entry",
            cede::Reason::Stop { .. } => "stop",
            cede::Reason::Hidden { .. } => "hidden",
            _ => "",
        }
    }

    #[getter]
    fn other(&self) -> Option<u16> {
        match self.0 {
            cede::Reason::Arrival { other, .. }
            | cede::Reason::Entry { other, .. }
            | cede::Reason::Stop { other, .. } => Some(other),
            _ => None,
        }
    }

    /// The path on which somebody may be out of sight.
    #[getter]
    fn path(&self) -> Option<u8> {
        match self.0 {
            cede::Reason::Hidden { path, .. } => Some(path),
            _ => None,
        }
    }

    /// Its numbers by their names.
    #[getter]
    fn numbers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let pairs = match self.0 {
            cede::Reason::Arrival {
                arrives, clears, ..
            }
            | cede::Reason::Hidden {
                arrives, clears, ..
            } => [("arrives", arrives), ("clears", clears)],
            cede::Reason::Entry { gap, needs, .. } => [("gap", gap), ("needs", needs)],
            cede::Reason::Stop {
                available, needs, ..
            } => [("available", available), ("needs", needs)],
            _ => return Ok(PyDict::new(py)),
        };
        let dict = PyDict::new(py);
        for (name, value) in pairs {
            dict.set_item(name, value)?;
        }
        Ok(dict)
    }

    fn __str__(&self) -> String {
        self.0.to_string()
    }

    fn __repr__(&self) -> String {
        format!("Reason({})", self.0)
    }
}

/// Why an input cannot be trusted, or that nothing is safe.
#[pyclass(frozen, module = "cede")]
pub(crate) struct Fault(cede::Fault);

impl Fault {
    fn input(&self) -> Option<cede::InputFault> {
        match self.0 {
            cede::Fault::Input(input) => Some(input),
            _ => None,
        }
    }
}

#[pymethods]
impl Fault {
    #[getter]
    fn kind(&self) -> &'static str {
        match self.0 {
            cede::Fault::NoPlan => "no-plan",
            cede::Fault::Input(_) => "input",
            cede::Fault::Backwards => "backwards",
            cede::Fault::OffPeriod { .. } => "off-period",
            cede::Fault::Proposal => "proposal",
            _ => "",
        }
    }

    /// Track number of the vehicle whose number is out of range; `None` is the ego.
    #[getter]
    fn track(&self) -> Option<u16> {
        match self.input()?.subject {
            Subject::Track(number) => Some(number),
            _ => None,
        }
    }

    #[getter]
    fn value(&self) -> Option<f64> {
        self.input().map(|input| decimal(input.value))
    }

    #[getter]
    fn range(&self) -> Option<(f64, f64)> {
        self.input()
            .map(|input| (decimal(input.low), decimal(input.high)))
    }

    fn __str__(&self) -> String {
        self.0.to_string()
    }

    fn __repr__(&self) -> String {
        format!("Fault({})", self.0)
    }
}

/// What the policy thinks of the other that restricts the ego most.
#[pyclass(frozen, get_all, module = "cede")]
pub(crate) struct Prediction {
    other: u16,
    svo: f32,
    acceleration: f32,
    shown: Option<Estimate>,
}

/// The orientation that an other has shown.
#[pyclass(frozen, get_all, module = "cede", from_py_object)]
#[derive(Clone, Copy)]
pub(crate) struct Estimate {
    svo: f32,
    confidence: f32,
    acceleration: f32,
}

#[pymethods]
impl Estimate {
    fn __repr__(&self) -> String {
        let Self {
            svo,
            confidence,
            acceleration,
        } = self;
        format!("Estimate(svo={svo}, confidence={confidence}, acceleration={acceleration})")
    }
}

#[pymethods]
impl Prediction {
    fn __repr__(&self) -> String {
        let Self {
            other,
            svo,
            acceleration,
            ..
        } = self;
        format!("Prediction(other={other}, svo={svo}, acceleration={acceleration})")
    }
}
