//! The network in integers: weights and activations `i16`, sums `i32`. For cores without an FPU, and for half the flash.

use crate::policy::error::WeightsError;
use crate::policy::features::MAX_FEATURES;
use crate::policy::mlp::{LANES, MAX_WIDTH, OUTPUTS};

/// Neurons summed side by side: as many as a core of 13 registers holds the sums and weights of.
const ABREAST: usize = 4;
/// Largest magnitude of an activation; what is beyond is limited to it.
pub const MAX_ACTIVATION: i32 = i16::MAX as i32;
/// Most fractional bits of a sum.
const MAX_BITS: u32 = 30;
/// Words of [`Bits`].
const BITS: usize = 8;

/// A network of integers that borrows its weights from where they lie: no copy, no allocation.
///
/// An activation is an integer that counts units of 2⁻ᵇ. Each neuron is summed as bias + Σ w·a, exactly; a hidden one's sum is
/// then shifted right and limited to 0 … [`MAX_ACTIVATION`]. [`FixedMlp::new`] makes sure that no sum of a product can
/// exceed 32 bits. After the inputs' conversion there is no rounding but the shift's, so every target gives the same bits.
#[derive(Clone, Copy, Debug)]
pub struct FixedMlp<'a> {
    layers: [FixedDense<'a>; 4],
    bits: Bits,
    shifts: [u32; 3],
}

/// A dense layer of integers. Its words: for every four neurons their biases, then for each two inputs a word
/// for each neuron, the first input's weight in the low half.
#[derive(Clone, Copy, Debug)]
pub struct FixedDense<'a> {
    rows: &'a [[u32; ABREAST]],
    inputs: usize,
    neurons: usize,
}

/// The scales of a network of integers: a weight, and an activation, counts units of 2⁻ᵇ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bits {
    /// Fractional bits of the inputs and of each hidden layer's activations.
    pub activations: [u32; 4],
    /// Fractional bits of each layer's weights.
    pub weights: [u32; 4],
}

impl Bits {
    /// Fractional bits of a layer's sums, of four.
    #[must_use]
    pub const fn sum(&self, layer: usize) -> u32 {
        self.weights[layer % 4].saturating_add(self.activations[layer % 4])
    }

    /// How far the sums of each hidden layer are shifted to the right. A bias holds half of what is cut off, so
    /// that the shift rounds to the nearest.
    #[must_use]
    pub fn shifts(&self) -> [u32; 3] {
        core::array::from_fn(|layer| self.sum(layer).saturating_sub(self.activations[layer + 1]))
    }

    /// Whether every sum is shifted by at least one place, and no number has more than 30 fractional bits.
    pub(crate) fn valid(&self) -> bool {
        (0..4).all(|layer| self.sum(layer) <= MAX_BITS)
            && self.shifts().iter().all(|&shift| shift > 0)
    }

    /// The scales as words, at the end of a network's.
    pub(crate) fn words(self) -> impl Iterator<Item = u32> {
        self.activations.into_iter().chain(self.weights)
    }

    fn parse(words: &[u32]) -> Option<Self> {
        let &[a, b, c, d, ref weights @ ..] = words else {
            return None;
        };
        let bits = Self {
            activations: [a, b, c, d],
            weights: weights.try_into().ok()?,
        };
        bits.valid().then_some(bits)
    }
}

impl<'a> FixedMlp<'a> {
    /// Number of words that a network of this shape takes.
    ///
    /// Cost: constant. Overflows, as `usize` does, for sizes beyond [`MAX_WIDTH`] by far.
    #[must_use]
    pub const fn words(inputs: usize, width: usize) -> usize {
        layer_words(inputs, width)
            + 2 * layer_words(width, width)
            + layer_words(width, OUTPUTS)
            + BITS
    }

    /// A network over `words`.
    ///
    /// Cost: O(words).
    ///
    /// # Errors
    /// [`WeightsError::Shape`] if their number does not fit the shape, if `width` is not a multiple of [`LANES`] up to
    /// [`MAX_WIDTH`], or if there are no inputs or more than [`MAX_FEATURES`]; [`WeightsError::OutOfRange`] if a sum has
    /// more than 30 fractional bits, or not more than the activation that it becomes; [`WeightsError::Overflow`] if a sum could exceed 32 bits.
    pub fn new(words: &'a [u32], inputs: usize, width: usize) -> Result<Self, WeightsError> {
        let shape_fits = (LANES..=MAX_WIDTH).contains(&width)
            && width.is_multiple_of(LANES)
            && (1..=MAX_FEATURES).contains(&inputs);
        if !shape_fits || words.len() != Self::words(inputs, width) {
            return Err(WeightsError::Shape);
        }
        let split = |words| FixedDense::split(words, width, width).ok_or(WeightsError::Shape);
        let (first, rest) = FixedDense::split(words, inputs, width).ok_or(WeightsError::Shape)?;
        let (second, rest) = split(rest)?;
        let (third, rest) = split(rest)?;
        let (output, rest) = FixedDense::split(rest, width, OUTPUTS).ok_or(WeightsError::Shape)?;
        let bits = Bits::parse(rest).ok_or(WeightsError::OutOfRange)?;
        let layers = [first, second, third, output];
        if layers.iter().all(FixedDense::cannot_overflow) {
            Ok(Self {
                layers,
                bits,
                shifts: bits.shifts(),
            })
        } else {
            Err(WeightsError::Overflow)
        }
    }

    /// Width of the hidden layers.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.layers[0].neurons
    }

    /// The four layers, from the inputs to the outputs.
    #[must_use]
    pub const fn layers(&self) -> [FixedDense<'a>; 4] {
        self.layers
    }

    /// The scales.
    #[must_use]
    pub const fn bits(&self) -> Bits {
        self.bits
    }

    /// The outputs for `inputs`; inputs that are missing or no numbers count as zero, surplus ones are ignored.
    ///
    /// Cost: a multiplication and an addition for each weight. Finite for any inputs whatsoever.
    #[must_use]
    pub fn forward(&self, inputs: &[f32]) -> [f32; OUTPUTS] {
        // The stack of a small network is half that of a wide one.
        if self.width() <= MAX_WIDTH / 2 {
            self.pass::<{ MAX_WIDTH / 4 }>(inputs)
        } else {
            self.pass::<{ MAX_WIDTH / 2 }>(inputs)
        }
    }

    /// The pass through a network whose layers are at most twice `P` wide: activations lie in pairs.
    #[inline(never)]
    fn pass<const P: usize>(&self, inputs: &[f32]) -> [f32; OUTPUTS] {
        let (mut a, mut b) = ([0; P], [0; P]);
        let unit = power_of_two(self.bits.activations[0]);
        let (pairs, last) = inputs.as_chunks::<2>();
        let last = last.first().map(|&x| [x, 0.0]);
        for (place, &[x, y]) in a.iter_mut().zip(pairs.iter().chain(&last)) {
            *place = pair(fixed(x, unit), fixed(y, unit));
        }
        let [first, second, third, output] = &self.layers;
        let [s, t, u] = self.shifts;
        first.relu(&a, s, &mut b);
        second.relu(&b, t, &mut a);
        third.relu(&a, u, &mut b);
        let unit = 1.0 / power_of_two(self.bits.sum(3));
        output.sums(output.rows, &b).map(|sum| sum as f32 * unit)
    }
}

impl<'a> FixedDense<'a> {
    /// Number of neurons.
    #[must_use]
    pub const fn neurons(&self) -> usize {
        self.neurons
    }

    /// Number of inputs.
    #[must_use]
    pub const fn inputs(&self) -> usize {
        self.inputs
    }

    /// The bias of a neuron, in units of its sum; 0 if there is no such neuron.
    #[must_use]
    pub fn bias(&self, neuron: usize) -> i32 {
        self.word(neuron, 0).cast_signed()
    }

    /// The weight of an input of a neuron; 0 if there is no such weight.
    #[must_use]
    pub fn weight(&self, neuron: usize, input: usize) -> i16 {
        let word = self.word(neuron, 1 + input / 2);
        let half = if input.is_multiple_of(2) {
            low(word)
        } else {
            high(word)
        };
        half as i16
    }

    fn word(&self, neuron: usize, row: usize) -> u32 {
        let row = neuron / ABREAST * rows(self.inputs) + row;
        self.rows.get(row).map_or(0, |row| row[neuron % ABREAST])
    }

    /// Takes a layer from the front of `words`.
    fn split(words: &'a [u32], inputs: usize, neurons: usize) -> Option<(Self, &'a [u32])> {
        let (words, rest) = words.split_at_checked(layer_words(inputs, neurons))?;
        let layer = Self {
            rows: words.as_chunks().0,
            inputs,
            neurons,
        };
        Some((layer, rest))
    }

    /// Whether every sum fits 32 bits for every activation, in whichever order it is added up.
    fn cannot_overflow(&self) -> bool {
        self.rows.chunks_exact(rows(self.inputs)).all(|group| {
            let (biases, weights) = (group[0], &group[1..]);
            let fits = |neuron: usize| {
                let pairs = weights.iter().map(|row| row[neuron]);
                let weights = pairs.flat_map(|word| [low(word), high(word)]);
                sum_fits(biases[neuron].cast_signed(), weights)
            };
            (0..ABREAST).all(fits)
        })
    }

    /// `y` becomes the activations, in pairs, after the sums over `x` are shifted.
    fn relu(&self, x: &[u32], shift: u32, y: &mut [u32]) {
        let groups = self.rows.chunks_exact(rows(self.inputs));
        for (group, y) in groups.zip(y.as_chunks_mut::<2>().0) {
            let [a, b, c, d] = self
                .sums(group, x)
                .map(|sum| (sum >> shift).clamp(0, MAX_ACTIVATION));
            *y = [pair(a, b), pair(c, d)];
        }
    }

    /// bias + W·x of four neurons.
    #[inline(always)]
    fn sums(&self, group: &[[u32; ABREAST]], x: &[u32]) -> [i32; ABREAST] {
        let Some((biases, rows)) = group.split_first() else {
            return [0; ABREAST];
        };
        let mut sums = biases.map(u32::cast_signed);
        for (row, &x) in rows.iter().zip(x) {
            for (sum, &w) in sums.iter_mut().zip(row) {
                // Never wraps: see `cannot_overflow`.
                *sum = sum
                    .wrapping_add(low(w) * low(x))
                    .wrapping_add(high(w) * high(x));
            }
        }
        sums
    }
}

/// Whether bias + Σ w·a fits 32 bits for all activations within ± [`MAX_ACTIVATION`], and each partial sum too.
pub(crate) fn sum_fits(bias: i32, weights: impl Iterator<Item = i32>) -> bool {
    let total: u32 = weights.map(i32::unsigned_abs).sum();
    let room = i32::MAX.unsigned_abs().saturating_sub(bias.unsigned_abs());
    total <= room / MAX_ACTIVATION.unsigned_abs()
}

/// Rows of four neurons: biases, and weights of pairs of inputs.
pub(crate) const fn rows(inputs: usize) -> usize {
    1 + inputs.div_ceil(2)
}

/// Words of a layer.
pub(crate) const fn layer_words(inputs: usize, neurons: usize) -> usize {
    rows(inputs) * neurons
}

/// 2ⁿ for n up to 30.
pub(crate) const fn power_of_two(n: u32) -> f32 {
    (1_u32 << (n % u32::BITS)) as f32
}

/// `x` in units of 1/`per_unit`, to the nearest, limited to ± [`MAX_ACTIVATION`]; 0 for what is no number.
fn fixed(x: f32, per_unit: f32) -> i32 {
    let scaled = x * per_unit;
    let half = if scaled < 0.0 { -0.5 } else { 0.5 };
    ((scaled + half) as i32).clamp(-MAX_ACTIVATION, MAX_ACTIVATION)
}

/// Two numbers of 16 bits in a word, the first in the low half.
pub(crate) const fn pair(first: i32, second: i32) -> u32 {
    first.cast_unsigned() & 0xffff | second.cast_unsigned() << 16
}

const fn low(word: u32) -> i32 {
    word as i16 as i32
}

const fn high(word: u32) -> i32 {
    word.cast_signed() >> 16
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::policy::features::FeatureSet;
    use crate::policy::weights::testing::{draft, noise};
    use crate::policy::weights::{Perspective, Weights};
    use proptest::prelude::*;
    use std::vec;
    use std::vec::Vec;

    const INPUTS: usize = 19;

    fn file(width: usize) -> Vec<u32> {
        draft(FeatureSet::Scene, Perspective::Ego, width, |draft| {
            let mut words = vec![0; draft.words_i16()];
            draft.encode_i16([12; 4], &mut words).unwrap();
            words
        })
    }

    fn network(file: &[u32]) -> FixedMlp<'_> {
        *Weights::parse(file).unwrap().network().as_i16().unwrap()
    }

    /// The documented sums, one weight at a time, in 64 bits.
    fn reference(network: &FixedMlp<'_>, x: &[f32]) -> [f32; OUTPUTS] {
        let bits = network.bits();
        let (inputs, shifts, outputs) = (bits.activations[0], bits.shifts(), bits.sum(3));
        let round = |x: f32| (f64::from(x) * f64::from(1 << inputs)).round() as i64;
        let limited = |x: i64| x.clamp(-i64::from(MAX_ACTIVATION), MAX_ACTIVATION.into());
        let mut a: Vec<i64> = x.iter().map(|&x| limited(round(x))).collect();
        for (index, layer) in network.layers().iter().enumerate() {
            let sum = |neuron| {
                let weights = (0..layer.inputs()).map(|i| i64::from(layer.weight(neuron, i)));
                let products = weights.zip(&a).map(|(w, a)| w * a);
                i64::from(layer.bias(neuron)) + products.sum::<i64>()
            };
            a = (0..layer.neurons()).map(sum).collect();
            assert!(a.iter().all(|&sum| i32::try_from(sum).is_ok()));
            if let Some(shift) = shifts.get(index) {
                a.iter_mut()
                    .for_each(|sum| *sum = limited((*sum >> shift).max(0)));
            }
        }
        core::array::from_fn(|i| a[i] as f32 / (1_u32 << outputs) as f32)
    }

    #[test]
    fn every_width_gives_the_bits_of_the_documented_sums() {
        for width in (LANES..=MAX_WIDTH).step_by(LANES) {
            let file = file(width);
            let network = network(&file);
            let x: Vec<f32> = noise(5).map(|x| 8.0 * x).take(INPUTS).collect();
            let outputs = network.forward(&x);
            assert!(outputs.iter().any(|&o| o != 0.0));
            assert_eq!(outputs, reference(&network, &x), "{width} wide");
        }
    }

    #[test]
    fn it_is_close_to_the_network_that_it_was_made_of() {
        let file = file(48);
        let floats = crate::policy::weights::testing::file(FeatureSet::Scene, Perspective::Ego, 48);
        let floats = Weights::parse(&floats).unwrap();
        let mut numbers = noise(9);
        for _ in 0..1000 {
            let x: Vec<f32> = numbers.by_ref().take(INPUTS).collect();
            let (fixed, float) = (network(&file).forward(&x), floats.network().forward(&x));
            for (fixed, float) in fixed.into_iter().zip(float) {
                assert!((fixed - float).abs() < 0.01, "{fixed} instead of {float}");
            }
        }
    }

    #[test]
    fn what_is_no_number_counts_as_zero_and_what_is_large_is_limited() {
        assert_eq!(fixed(f32::NAN, 4096.0), 0);
        assert_eq!(fixed(f32::INFINITY, 4096.0), MAX_ACTIVATION);
        assert_eq!(fixed(-9.0, 4096.0), -MAX_ACTIVATION);
        assert_eq!(
            [0.5, -0.5, 1.4, -1.6].map(|x| fixed(x, 1.0)),
            [1, -1, 1, -2]
        );
    }

    /// A network without weights.
    fn blank() -> Vec<u32> {
        let mut words = vec![0; FixedMlp::words(INPUTS, 16)];
        words[FixedMlp::words(INPUTS, 16) - BITS..].copy_from_slice(&[12; BITS]);
        words
    }

    #[test]
    fn sums_that_could_exceed_32_bits_are_refused() {
        let fits = |bias, weight: i32, count| sum_fits(bias, (0..count).map(|_| weight));
        assert!(fits(0, 1024, 64));
        assert!(fits(i32::MAX - 65_535 * MAX_ACTIVATION, 65_535, 1));
        assert!(!fits(i32::MAX - 65_535 * MAX_ACTIVATION + 1, 65_535, 1));
        assert!(!fits(0, -1025, 64));
        assert!(!fits(i32::MIN, 1, 1));

        let mut words = blank();
        assert!(FixedMlp::new(&words, INPUTS, 16).is_ok());
        // The weights of the first neuron: ten words of two weights each, then those of the next neuron.
        for row in 1..=10 {
            words[row * ABREAST] = pair(4000, -4000);
        }
        let error = FixedMlp::new(&words, INPUTS, 16).unwrap_err();
        assert_eq!(error, WeightsError::Overflow);
    }

    #[test]
    fn scales_and_shapes_are_checked() {
        let words = blank();
        for (inputs, width) in [(INPUTS + 2, 16), (0, 16), (INPUTS, 15), (INPUTS, 32)] {
            let error = FixedMlp::new(&words, inputs, width).unwrap_err();
            assert_eq!(error, WeightsError::Shape);
        }
        // Of the last layer's weights; then of the third layer's, whose sums would be shifted by nothing.
        for (place, bits) in [(1, MAX_BITS), (1, u32::MAX), (2, 0), (8, u32::MAX)] {
            let mut words = words.clone();
            let place = words.len() - place;
            words[place] = bits;
            let error = FixedMlp::new(&words, INPUTS, 16).unwrap_err();
            assert_eq!(error, WeightsError::OutOfRange);
        }
    }

    #[test]
    fn weights_too_large_for_the_bits_are_refused() {
        draft(FeatureSet::Scene, Perspective::Ego, 16, |draft| {
            let mut words = vec![0; draft.words_i16()];
            let error = draft.encode_i16([12, 30, 12, 12], &mut words).unwrap_err();
            assert_eq!(error, WeightsError::Overflow);
            let short = &mut words[..100];
            assert_eq!(
                draft.encode_i16([12; 4], short).unwrap_err(),
                WeightsError::NoRoom
            );
        });
    }

    proptest! {
        #[test]
        fn whatever_the_bits_of_the_inputs_the_outputs_are_those_of_the_documented_sums(
            bits in any::<[u32; INPUTS]>(), width in 1_usize..=3,
        ) {
            let file = file(16 * width);
            let network = network(&file);
            let x = bits.map(f32::from_bits);
            let numbers = x.map(|x| if x.is_nan() { 0.0 } else { x.clamp(-9.0, 9.0) });
            prop_assert_eq!(network.forward(&x), reference(&network, &numbers));
        }
    }
}
