//! Cede's own network, on a cache line's boundary as `include_weights!` puts it.

use crate::{INPUTS, Layer, Run};
use cede_controller::Mlp;
use cede_controller::weights::Aligned;

/// The network in Cede, for widths up to 128.
///
/// # Panics
/// For layers of another shape.
#[must_use]
pub fn cede(layers: &[Layer]) -> Run {
    let width = layers[0].shape[1];
    let mut words = Box::new(Aligned([0; Mlp::words(INPUTS, 128)]));
    let values = layers
        .iter()
        .flat_map(|layer| layer.biases.iter().chain(&layer.weights));
    for (word, value) in words.0.iter_mut().zip(values) {
        *word = value.to_bits();
    }
    let words = &Box::leak(words).0[..Mlp::words(INPUTS, width)];
    let network = Mlp::new(words, INPUTS, width).expect("the shape fits");
    Box::new(move |inputs| Ok(network.forward(inputs)))
}
