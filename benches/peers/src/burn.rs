//! burn: tensors on its CPU device, flex.

use crate::{Failure, INPUTS, Layer, Run};
use burn::tensor::{Device, Tensor, TensorData, activation::relu};

/// The network in burn.
///
/// # Errors
/// burn's.
pub fn burn(layers: &[Layer]) -> Result<Run, Failure> {
    let device = Device::flex();
    let layers: Vec<(Tensor<2>, Tensor<2>)> = layers
        .iter()
        .map(|layer| {
            let weights = TensorData::new(layer.weights.clone(), layer.shape);
            let biases = TensorData::new(layer.biases.clone(), [1, layer.shape[1]]);
            (
                Tensor::from_data(weights, &device),
                Tensor::from_data(biases, &device),
            )
        })
        .collect();
    Ok(Box::new(move |inputs| {
        let mut x = Tensor::<2>::from_data(TensorData::new(inputs.to_vec(), [1, INPUTS]), &device);
        for (i, (weights, biases)) in layers.iter().enumerate() {
            x = x.matmul(weights.clone()) + biases.clone();
            if i + 1 < layers.len() {
                x = relu(x);
            }
        }
        let outputs = x
            .into_data()
            .try_to_vec::<f32>()
            .map_err(|error| format!("{error:?}"))?;
        outputs.try_into().map_err(|_| "not four outputs".into())
    }))
}
