//! Cede's own network, on a cache line's boundary as `include_weights!` puts it.

use crate::{INPUTS, Layer, Run};
use cede_controller::policy::weights::{Aligned, Draft};
use cede_controller::{FeatureSet, Mlp, Perspective};

/// Enough for the file of a network 128 wide: 17 words and two for each input lie around its parameters.
const ROOM: usize = Mlp::words(INPUTS, 128) + 17 + 2 * INPUTS;

/// The network in Cede, for widths up to 128.
///
/// # Panics
/// For layers of another shape.
#[must_use]
pub fn cede(layers: &[Layer]) -> Run {
    let parameters = layers
        .iter()
        .flat_map(|layer| layer.biases.iter().chain(&layer.weights));
    let draft = Draft {
        features: FeatureSet::Raw,
        perspective: Perspective::Ego,
        width: layers[0].shape[1],
        provenance: [0; 32],
        centres: &[0.0; INPUTS],
        scales: &[1.0; INPUTS],
        parameters: &parameters.copied().collect::<Vec<f32>>(),
    };
    let words = &mut Box::leak(Box::new(Aligned([0; ROOM]))).0;
    let network = draft.encode(words).expect("the shape fits").network;
    Box::new(move |inputs| Ok(network.forward(inputs)))
}
