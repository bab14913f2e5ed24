//! Cede from Python. The package `cede` wraps this module; `docs/python.md` describes both.

mod approach;
mod batch;
mod contract;
mod dataset;
mod decision;
mod error;
mod evaluate;
mod junction;
mod look;
mod names;
mod observation;
mod policy;
mod replay;

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
    module.add_class::<decision::Room>()?;
    module.add_class::<decision::Fault>()?;
    module.add_class::<decision::Prediction>()?;
    module.add_class::<decision::Estimate>()?;
    module.add_class::<dataset::Dataset>()?;
    module.add_class::<batch::Batch>()?;
    module.add_class::<evaluate::Seen>()?;
    module.add(
        "FEATURES",
        cede_controller::FeatureSet::Route
            .labels()
            .collect::<Vec<_>>(),
    )?;
    module.add("SCALES", look::SCALES.to_vec())?;
    module.add_function(wrap_pyfunction!(evaluate::evaluate, module)?)?;
    module.add_function(wrap_pyfunction!(replay::replay, module)?)?;
    module.add_function(wrap_pyfunction!(evaluate::driver_names, module)?)?;
    Ok(())
}
