//! onnxruntime, from the library that `ORT_DYLIB_PATH` names, on one thread.

use crate::{Failure, INPUTS, Run};
use ort::environment::Environment;
use ort::session::{Session, builder::GraphOptimizationLevel};
use ort::value::TensorRef;
use std::ffi::OsStr;
use std::sync::OnceLock;

/// onnxruntime allows one environment a process.
static ENVIRONMENT: OnceLock<Environment> = OnceLock::new();

fn environment(library: &OsStr) -> Result<&'static Environment, Failure> {
    if let Some(environment) = ENVIRONMENT.get() {
        return Ok(environment);
    }
    let environment = ort::init_from(library)?.build()?;
    Ok(ENVIRONMENT.get_or_init(|| environment))
}

/// The network in onnxruntime; `None` if there is no library.
///
/// # Errors
/// onnxruntime's.
pub fn onnxruntime(onnx: &[u8]) -> Result<Option<Run>, Failure> {
    let Some(library) = std::env::var_os("ORT_DYLIB_PATH") else {
        return Ok(None);
    };
    let mut session = Session::builder(environment(&library)?)?
        .with_intra_threads(1)
        .map_err(|error| error.to_string())?
        .with_optimization_level(GraphOptimizationLevel::Level3)
        .map_err(|error| error.to_string())?
        .commit_from_memory(onnx)?;
    Ok(Some(Box::new(move |inputs| {
        let x = TensorRef::from_array_view(([1, INPUTS], inputs.as_slice()))?;
        let outputs = session.run(ort::inputs!["x" => x])?;
        let (_, y) = outputs["y"].try_extract_tensor::<f32>()?;
        Ok(y.try_into()?)
    })))
}
