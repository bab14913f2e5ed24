//! Cede from Python. The package `cede` wraps this module; `docs/python.md` describes both.

mod approach;
mod contract;
mod decision;
mod error;
mod junction;
mod observation;
mod policy;

use pyo3::prelude::*;

#[pymodule]
fn _cede(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<error::Error>())?;
    module.add_class::<contract::Contract>()?;
    module.add_class::<policy::Policy>()?;
    module.add_class::<junction::Builder>()?;
    module.add_class::<junction::Junction>()?;
    module.add_class::<junction::Conflict>()?;
    module.add_class::<observation::Vehicle>()?;
    module.add_class::<observation::Track>()?;
    module.add_class::<approach::Drive>()?;
    module.add_class::<approach::Approach>()?;
    module.add_class::<approach::Shield>()?;
    module.add_class::<decision::Decision>()?;
    module.add_class::<decision::Reason>()?;
    module.add_class::<decision::Fault>()?;
    module.add_class::<decision::Prediction>()?;
    Ok(())
}
