//! The one exception of the package.

use core::fmt::Display;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

pyo3::create_exception!(
    cede,
    Error,
    PyValueError,
    "Something that cede was given cannot be used. The text names the field, its value and its range; \
     `field` and `value` are set where one number is to blame."
);

/// The exception that says `text`.
pub(crate) fn error(text: impl Display) -> PyErr {
    Error::new_err(text.to_string())
}

/// The exception about the number `field`, which is `value`.
pub(crate) fn wrong_number(py: Python<'_>, field: &str, value: f32, text: impl Display) -> PyErr {
    let error = error(text);
    let object = error.value(py);
    // Nothing prevents attributes on an exception; if it did, the text still says both.
    let _ = object.setattr("field", field);
    let _ = object.setattr("value", decimal(value));
    error
}

/// The number that `value` shows as: 0.1 for the `f32` nearest to 0.1.
pub(crate) fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// The one of `all` with this name.
pub(crate) fn named<T: Copy>(what: &str, name: &str, all: &[(&str, T)]) -> PyResult<T> {
    match all.iter().find(|(known, _)| *known == name) {
        Some(&(_, found)) => Ok(found),
        None => {
            let names: Vec<_> = all.iter().map(|(known, _)| *known).collect();
            Err(error(format!(
                "{what} = `{name}` is none of: {}",
                names.join(", ")
            )))
        }
    }
}
