//! candle: tensors on its CPU device.

use crate::{Failure, INPUTS, Layer, Run};
use candle_core::{Device, Tensor};

/// The network in candle.
///
/// # Errors
/// candle's.
pub fn candle(layers: &[Layer]) -> Result<Run, Failure> {
    let device = Device::Cpu;
    let layers: Vec<(Tensor, Tensor)> = layers
        .iter()
        .map(|layer| {
            let weights =
                Tensor::from_slice(&layer.weights, (layer.shape[0], layer.shape[1]), &device)?;
            Ok((
                weights,
                Tensor::from_slice(&layer.biases, (1, layer.shape[1]), &device)?,
            ))
        })
        .collect::<Result<_, Failure>>()?;
    Ok(Box::new(move |inputs| {
        let mut x = Tensor::from_slice(inputs, (1, INPUTS), &device)?;
        for (i, (weights, biases)) in layers.iter().enumerate() {
            x = x.matmul(weights)?.add(biases)?;
            if i + 1 < layers.len() {
                x = x.relu()?;
            }
        }
        let outputs = x.flatten_all()?.to_vec1()?;
        outputs.try_into().map_err(|_| "not four outputs".into())
    }))
}
