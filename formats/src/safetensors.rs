//! Policies as safetensors: the bare numbers, for programs that build their own network around them.
//!
//! | tensor | shape | what |
//! |---|---|---|
//! | `normalisation.centre`, `normalisation.scale` | inputs | the network sees (feature − centre) · scale, within ± 8 |
//! | `layers.0.weight` … `layers.3.weight` | outputs × inputs | as PyTorch's `Linear` has them; ReLU follows the first three |
//! | `layers.0.bias` … `layers.3.bias` | outputs | |
//!
//! Accelerations (m/s²) are 3·tanh of the first two outputs: of the ego and of the other, or of the
//! left-turner and of the other for a joint policy. The last two are the logarithms of their spreads
//! before squashing, which training alone uses. The one metadata entry, `cede`, is a JSON object: feature set,
//! names of the features, perspective, provenance.

use crate::layers::NotF32;
use crate::{description, layers};
use ::safetensors::tensor::{Dtype, SafeTensorError, TensorView};
use cede_controller::Weights;
use std::collections::BTreeMap;

/// A policy cannot be written as safetensors.
#[derive(Debug, thiserror::Error)]
pub enum SafetensorsError {
    /// The format cannot hold it, which is known of no policy.
    #[error("cannot be written as safetensors: {0}")]
    Format(#[from] SafeTensorError),
    /// Its network is one of integers.
    #[error(transparent)]
    NotF32(#[from] NotF32),
}

/// The file's bytes; the same policy gives the same bytes.
///
/// # Errors
/// If the network is one of integers; the library's, which no policy is known to cause.
pub fn write(weights: &Weights<'_>) -> Result<Vec<u8>, SafetensorsError> {
    let (centres, scales): (Vec<f32>, Vec<f32>) = weights.normalisation().unzip();
    let mut tensors = vec![
        tensor("normalisation.centre", vec![centres.len()], centres),
        tensor("normalisation.scale", vec![scales.len()], scales),
    ];
    for (i, layer) in layers::of(weights)?.into_iter().enumerate() {
        let (inputs, outputs) = (layer.inputs(), layer.outputs());
        let transposed = (0..inputs * outputs)
            .map(|at| layer.weights[at % inputs * outputs + at / inputs])
            .collect();
        let (weight, bias) = (format!("layers.{i}.weight"), format!("layers.{i}.bias"));
        tensors.push(tensor(&weight, vec![outputs, inputs], transposed));
        tensors.push(tensor(&bias, vec![outputs], layer.biases));
    }
    let views: Result<Vec<_>, _> = tensors
        .iter()
        .map(|t| TensorView::new(Dtype::F32, t.shape.clone(), &t.bytes).map(|v| (&t.name, v)))
        .collect();
    // One entry, as the library writes several in an order that changes from run to run.
    let text: BTreeMap<_, _> = description::of(weights).into_iter().collect();
    let metadata = serde_json::json!(text).to_string();
    let metadata = [("cede".to_owned(), metadata)].into_iter().collect();
    Ok(::safetensors::serialize(views?, Some(metadata))?)
}

struct Tensor {
    name: String,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

fn tensor(name: &str, shape: Vec<usize>, values: Vec<f32>) -> Tensor {
    Tensor {
        name: name.to_owned(),
        shape,
        bytes: values.into_iter().flat_map(f32::to_le_bytes).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::safetensors::SafeTensors;

    #[test]
    fn the_file_holds_every_number_and_what_they_are() {
        let weights = Weights::parse(cede_controller::policy::embedded::words()).unwrap();
        let bytes = write(&weights).unwrap();
        let file = SafeTensors::deserialize(&bytes).unwrap();
        let numbers = |name: &str| -> Vec<f32> {
            let data = file.tensor(name).unwrap().data().as_chunks::<4>().0;
            data.iter().map(|b| f32::from_le_bytes(*b)).collect()
        };
        let (centres, scales): (Vec<f32>, Vec<f32>) = weights.normalisation().unzip();
        assert_eq!(numbers("normalisation.centre"), centres);
        assert_eq!(numbers("normalisation.scale"), scales);
        for (i, layer) in weights
            .network()
            .as_f32()
            .unwrap()
            .layers()
            .into_iter()
            .enumerate()
        {
            let biases: Vec<f32> = layer.biases().collect();
            assert_eq!(numbers(&format!("layers.{i}.bias")), biases);
            let rows = numbers(&format!("layers.{i}.weight"));
            let inputs = rows.len() / biases.len();
            for (at, weight) in layer.weights().enumerate() {
                let (input, output) = (at / biases.len(), at % biases.len());
                assert_eq!(rows[output * inputs + input], weight);
            }
        }
        let (_, header) = SafeTensors::read_metadata(&bytes).unwrap();
        let told = header.metadata().as_ref().unwrap()["cede"].clone();
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        assert_eq!(told["cede.features"], weights.features().name());
        assert_eq!(told["cede.perspective"], "ego");
        assert_eq!(told["cede.provenance_sha256"].as_str().unwrap().len(), 64);
    }
}
