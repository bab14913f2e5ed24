//! A network becomes one of integers.

use super::draft::Draft;
use crate::policy::fixed::{Bits, MAX_ACTIVATION, layer_words, pair, power_of_two, rows, sum_fits};
use crate::policy::mlp::OUTPUTS;

/// Neurons whose words lie together.
const GROUP: usize = 4;
/// Most fractional bits of a weight.
const MOST: u32 = 15;

/// Writes a draft's network as integers; `None` if it does not fit them. See [`Draft::encode_i16`].
pub(super) fn network(draft: &Draft<'_>, bits: [u32; 4], words: &mut [u32]) -> Option<()> {
    let (mut parameters, mut words) = (draft.parameters, words);
    let mut scales = Bits {
        activations: bits,
        weights: [0; 4],
    };
    let sizes = [
        draft.features.count(),
        draft.width,
        draft.width,
        draft.width,
    ];
    let neurons = [draft.width, draft.width, draft.width, OUTPUTS];
    for index in 0..4 {
        let (inputs, neurons) = (sizes[index], neurons[index]);
        let (own, rest) = parameters.split_at_checked((inputs + 1) * neurons)?;
        let (biases, weights) = own.split_at_checked(neurons)?;
        let (place, left) = words.split_at_mut_checked(layer_words(inputs, neurons))?;
        let layer = Layer {
            biases,
            weights,
            inputs: bits[index],
            outputs: bits.get(index + 1).copied(),
        };
        scales.weights[index] = (0..=MOST).rev().find(|&bits| layer.fits(bits))?;
        layer.write(scales.weights[index], place)?;
        (parameters, words) = (rest, left);
    }
    for (place, word) in words.iter_mut().zip(scales.words()) {
        *place = word;
    }
    scales.valid().then_some(())
}

/// A layer to be written, with the fractional bits of its inputs and of its activations, if it is a hidden one.
struct Layer<'a> {
    biases: &'a [f32],
    weights: &'a [f32],
    inputs: u32,
    outputs: Option<u32>,
}

impl Layer<'_> {
    /// Whether all weights fit 16 bits and no sum can exceed 32 if weights have so many fractional bits.
    fn fits(&self, bits: u32) -> bool {
        (0..self.biases.len()).all(|neuron| {
            let weights = || (0..self.number_of_inputs()).map(|i| self.weight(bits, neuron, i));
            self.bias(bits, neuron).is_some_and(|bias| {
                weights().all(|w| w.is_some()) && sum_fits(bias, weights().flatten())
            })
        })
    }

    fn write(&self, bits: u32, words: &mut [u32]) -> Option<()> {
        let inputs = self.number_of_inputs();
        let rows = rows(inputs);
        for (index, place) in words.iter_mut().enumerate() {
            let (group, in_group) = (index / (rows * GROUP), index % (rows * GROUP));
            let (row, neuron) = (in_group / GROUP, group * GROUP + in_group % GROUP);
            let weight = |input| {
                if input < inputs {
                    self.weight(bits, neuron, input)
                } else {
                    Some(0)
                }
            };
            *place = match row.checked_sub(1) {
                None => self.bias(bits, neuron)?.cast_unsigned(),
                Some(row) => pair(weight(2 * row)?, weight(2 * row + 1)?),
            };
        }
        Some(())
    }

    fn number_of_inputs(&self) -> usize {
        self.weights.len() / self.biases.len().max(1)
    }

    fn weight(&self, bits: u32, neuron: usize, input: usize) -> Option<i32> {
        let weight = self.weights.get(input * self.biases.len() + neuron)?;
        rounded(*weight, bits).filter(|w| w.abs() <= MAX_ACTIVATION)
    }

    /// The bias in units of the sum, with half of what the shift cuts off.
    fn bias(&self, bits: u32, neuron: usize) -> Option<i32> {
        let sum = bits + self.inputs;
        let half = match self.outputs {
            Some(outputs) => 1_i32.checked_shl(sum.checked_sub(outputs + 1)?)?,
            None => 0,
        };
        rounded(*self.biases.get(neuron)?, sum)?.checked_add(half)
    }
}

/// `value` in units of 2⁻ᵇ, to the nearest; `None` if it is not small enough for an `i32`.
fn rounded(value: f32, bits: u32) -> Option<i32> {
    let scaled = libm::roundf(value * power_of_two(bits));
    (scaled.abs() < power_of_two(30)).then_some(scaled as i32)
}
