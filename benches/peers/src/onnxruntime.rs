//! onnxruntime, from the library that `ORT_DYLIB_PATH` names, on one thread.

use crate::{Failure, INPUTS, Run};
use ort::session::{Session, builder::GraphOptimizationLevel};
use ort::value::TensorRef;

/// The network in onnxruntime; `None` if there is no library.
///
/// # Errors
/// onnxruntime's.
pub fn onnxruntime(onnx: &[u8]) -> Result<Option<Run>, Failure> {
    if std::env::var_os("ORT_DYLIB_PATH").is_none() {
        return Ok(None);
    }
    let mut session = Session::builder()?
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
