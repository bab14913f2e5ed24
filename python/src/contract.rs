//! Contracts from names, keywords and TOML.

use crate::error::{decimal, error, named, wrong_number};
use cede_controller::{Contract as Numbers, ContractBuilder, ContractError, Precedence};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// What the shield assumes of the world. A contract that exists is valid.
#[pyclass(frozen, eq, module = "cede", from_py_object)]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Contract(pub(crate) Numbers);

const NAMED: [(&str, Numbers); 2] = [
    ("worst-case", Numbers::WORST_CASE),
    ("all-way-stop", Numbers::ALL_WAY_STOP),
];

/// A number of the contract: its keyword, and how it is read and set.
type Number = (
    &'static str,
    fn(&Numbers) -> f32,
    fn(ContractBuilder, f32) -> ContractBuilder,
);

const NUMBERS: [Number; 19] = [
    ("period", Numbers::period, ContractBuilder::period),
    ("latency", Numbers::latency, ContractBuilder::latency),
    ("jitter", Numbers::jitter, ContractBuilder::jitter),
    (
        "position_error",
        Numbers::position_error,
        ContractBuilder::position_error,
    ),
    (
        "speed_error",
        Numbers::speed_error,
        ContractBuilder::speed_error,
    ),
    ("slack", Numbers::slack, ContractBuilder::slack),
    (
        "ego_max_speed",
        |c| c.ego().max_speed,
        ContractBuilder::ego_max_speed,
    ),
    (
        "ego_acceleration",
        |c| c.ego().acceleration,
        ContractBuilder::ego_acceleration,
    ),
    ("ego_go", |c| c.ego().go, ContractBuilder::ego_go),
    (
        "ego_braking",
        |c| c.ego().braking,
        ContractBuilder::ego_braking,
    ),
    (
        "ego_emergency",
        |c| c.ego().emergency,
        ContractBuilder::ego_emergency,
    ),
    ("ego_lag", |c| c.ego().lag, ContractBuilder::ego_lag),
    ("ego_gain", |c| c.ego().gain, ContractBuilder::ego_gain),
    (
        "ego_disturbance",
        |c| c.ego().disturbance,
        ContractBuilder::ego_disturbance,
    ),
    (
        "other_max_speed",
        |c| c.other().max_speed,
        ContractBuilder::other_max_speed,
    ),
    (
        "other_acceleration",
        |c| c.other().acceleration,
        ContractBuilder::other_acceleration,
    ),
    (
        "other_braking",
        |c| c.other().braking,
        ContractBuilder::other_braking,
    ),
    (
        "follower_reaction",
        |c| c.follower().reaction,
        ContractBuilder::follower_reaction,
    ),
    (
        "follower_braking",
        |c| c.follower().braking,
        ContractBuilder::follower_braking,
    ),
];

#[pymethods]
impl Contract {
    #[new]
    #[pyo3(signature = (base = "worst-case", **numbers))]
    fn new(py: Python<'_>, base: &str, numbers: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let base = named("base", base, &NAMED)?;
        Self(base).with_numbers(py, numbers)
    }

    /// This contract with other numbers.
    #[pyo3(name = "replace", signature = (**numbers))]
    fn with_numbers(&self, py: Python<'_>, numbers: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut builder = self.0.to_builder();
        // `ego_braking` sets both; whoever names the other one, too, means it.
        for last in [false, true] {
            for (name, value) in numbers.into_iter().flatten() {
                let name = name.extract::<String>()?;
                if (name == "ego_emergency") == last {
                    builder = set(&self.0, builder, &name, &value)?;
                }
            }
        }
        let built = builder.build().map_err(|wrong| refused(py, &wrong))?;
        Ok(Self(built))
    }

    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Self> {
        toml::from_str(text)
            .map(Self)
            .map_err(|wrong| error(wrong.to_string().trim_end()))
    }

    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        let place = path.display();
        let text =
            std::fs::read_to_string(&path).map_err(|wrong| error(format!("{place}: {wrong}")))?;
        let read = toml::from_str(&text).map(Self);
        read.map_err(|wrong| error(format!("{place}: {}", wrong.to_string().trim_end())))
    }

    #[pyo3(name = "to_toml")]
    fn toml(&self) -> PyResult<String> {
        toml::to_string(&self.0).map_err(error)
    }

    #[getter]
    fn precedence<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(rule) = self.0.precedence() else {
            return Ok(None);
        };
        let dict = PyDict::new(py);
        dict.set_item("distance", decimal(rule.distance))?;
        dict.set_item("tie", rule.tie)?;
        dict.set_item("braking", decimal(rule.braking))?;
        dict.set_item("patience", rule.patience)?;
        Ok(Some(dict))
    }

    #[pyo3(name = "to_dict")]
    fn dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, value, _) in NUMBERS {
            dict.set_item(name, decimal(value(&self.0)))?;
        }
        dict.set_item("precedence", self.precedence(py)?)?;
        Ok(dict)
    }

    fn __getattr__(&self, name: &str) -> PyResult<f64> {
        let found = NUMBERS.iter().find(|(known, ..)| *known == name);
        found
            .map(|(_, value, _)| decimal(value(&self.0)))
            .ok_or_else(|| {
                pyo3::exceptions::PyAttributeError::new_err(format!(
                    "a contract has no number `{name}`"
                ))
            })
    }

    fn __repr__(&self) -> String {
        let numbers = NUMBERS.map(|(name, value, _)| format!("{name}={}", value(&self.0)));
        let rule = self.0.precedence().map_or("None".to_owned(), |rule| {
            let Precedence {
                distance,
                tie,
                braking,
                patience,
                ..
            } = rule;
            format!("dict(distance={distance}, tie={tie}, braking={braking}, patience={patience})")
        });
        format!("Contract({}, precedence={rule})", numbers.join(", "))
    }
}

/// Sets the number `name`, which is on the way from `base`.
fn set(
    base: &Numbers,
    builder: ContractBuilder,
    name: &str,
    value: &Bound<'_, PyAny>,
) -> PyResult<ContractBuilder> {
    if name == "precedence" {
        return Ok(builder.precedence(precedence(base, value)?));
    }
    let Some((.., set)) = NUMBERS.iter().find(|(known, ..)| *known == name) else {
        let names = NUMBERS.map(|(known, ..)| known).join(", ");
        return Err(error(format!(
            "a contract has no number `{name}`; it has: {names}, precedence"
        )));
    };
    let number = value
        .extract()
        .map_err(|_| error(format!("{name} = {value} is not a number")))?;
    Ok(set(builder, number))
}

/// The rule of precedence that `value` asks for: none, that of a named contract, or these numbers.
fn precedence(base: &Numbers, value: &Bound<'_, PyAny>) -> PyResult<Option<Precedence>> {
    if value.is_none() {
        return Ok(None);
    }
    if let Ok(name) = value.extract::<String>() {
        return Ok(named("precedence", &name, &NAMED)?.precedence());
    }
    let rule = base.precedence().unwrap_or(Precedence::ALL_WAY_STOP);
    let Precedence {
        mut distance,
        mut tie,
        mut braking,
        mut patience,
        ..
    } = rule;
    let wrong = || error("precedence is None, `all-way-stop` or a dict");
    for (key, value) in value.cast::<PyDict>().map_err(|_| wrong())? {
        match key.extract::<String>()?.as_str() {
            "distance" => distance = value.extract()?,
            "tie" => tie = value.extract()?,
            "braking" => braking = value.extract()?,
            "patience" => patience = value.extract()?,
            name => {
                let known = "distance, tie, braking, patience";
                return Err(error(format!(
                    "precedence has no number `{name}`; it has: {known}"
                )));
            }
        }
    }
    Ok(Some(Precedence::new(distance, tie, braking, patience)))
}

fn refused(py: Python<'_>, wrong: &ContractError) -> PyErr {
    wrong_number(py, wrong.field(), wrong.value(), wrong)
}
