//! tract: the ONNX model, optimised, with one state for all runs.

use crate::{Failure, INPUTS, Run};
use tract_onnx::prelude::*;

/// The network in tract.
///
/// # Errors
/// tract's.
pub fn tract(onnx: &[u8]) -> Result<Run, Failure> {
    let model = tract_onnx::onnx()
        .model_for_read(&mut &*onnx)?
        .into_optimized()?;
    let mut state = model.into_runnable()?.spawn()?;
    Ok(Box::new(move |inputs| {
        let x = Tensor::from_shape(&[1, INPUTS], inputs)?;
        let outputs = state.run(tvec!(x.into()))?;
        let outputs = outputs.first().ok_or("no output")?;
        Ok(outputs.try_as_plain_ram()?.as_slice::<f32>()?.try_into()?)
    }))
}
