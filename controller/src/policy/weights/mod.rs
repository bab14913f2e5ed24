//! The weights file (`.cede`): a network with all that is needed to run it, checked before it drives.
//!
//! The file is a row of little-endian 32-bit words:
//!
//! | words | what |
//! |---|---|
//! | 1 | the letters `CEDE` |
//! | 1 | version of the format, 2 |
//! | 1 | [`FeatureSet`]: 0 raw, 1 route, 2 traffic, 3 scene, 4 rights |
//! | 1 | [`Perspective`]: 0 joint, 1 ego |
//! | 3 | sizes: inputs I, width H of the hidden layers, outputs, 4 |
//! | 8 | provenance: a SHA-256 of what the network was made from |
//! | 1 | the network's numbers: 0 `f32`, 1 `i16` |
//! | … | the network |
//! | I, I | centre and scale of each feature, `f32`: the network sees (feature − centre) · scale, within ± [`LIMIT`](crate::policy::features::LIMIT) |
//! | 1 | CRC-32 (ISO-HDLC) of all the bytes before |
//!
//! A network of `f32` is its four layers: for each tile of 96 neurons, and for what is left, a row of biases, then for
//! each input a row of weights. One of `i16` is its four layers: for every four neurons a row of biases (`i32`), then for each two
//! inputs a row of words, each with two weights (`i16`, the first input's in the low half; a last input without a second one
//! has a zero); then eight words, the scales ([`Bits`](crate::policy::fixed::Bits)): fractional bits of the inputs and of the
//! three hidden layers' activations, and of the four layers' weights.
//!
//! What lies next to each other is wanted one after the other ([`Mlp`]): a wide layer is read once, from its first
//! word to its last. Version 1 knew no tiles; its files are refused.
//!
//! It is kept as words, not as bytes, because they are aligned: a processor loads a weight straight
//! from flash as a float. [`include_weights!`](crate::include_weights) puts a file there, on a
//! boundary of 64 bytes; as every layer's weights then lie on such boundaries too, no vector of weights
//! straddles two cache lines (it costs a third of the time where it does, and no bit of the result).

mod draft;
mod embed;
mod encode;
mod parse;
mod quantise;

pub use crate::policy::error::WeightsError;
pub use draft::Draft;
pub use embed::{Aligned, words};

use crate::policy::features::FeatureSet;
use crate::policy::fixed::FixedMlp;
use crate::policy::mlp::{Mlp, OUTPUTS};
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

const MAGIC: u32 = u32::from_le_bytes(*b"CEDE");
const VERSION: u32 = 2;
const HEADER: usize = 16;
/// Without a table: a kilobyte of flash is worth more than the milliseconds once, when the weights are parsed.
static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Largest magnitude of a weight or bias. With inputs within ± 8 and widths up to 128
/// no sum can exceed 10²¹, so nothing overflows.
pub const MAX_WEIGHT: f32 = 1e3;
/// Largest magnitude of a centre or scale.
pub const MAX_NORMALISATION: f32 = 1e6;

/// Whose commands a network gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Perspective {
    /// The paper's: it is told the left-turner first and commands both, the left-turner's output first.
    Joint,
    /// It is told the ego first, whatever its part, commands it and predicts the other.
    Ego,
}

/// What a network computes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    F32,
    I16,
}

impl Number {
    /// Words of a network of this shape.
    const fn words(self, inputs: usize, width: usize) -> usize {
        match self {
            Self::F32 => Mlp::words(inputs, width),
            Self::I16 => FixedMlp::words(inputs, width),
        }
    }
}

/// The network of a weights file.
#[derive(Clone, Copy, Debug)]
pub enum Network<'a> {
    /// In `f32`.
    F32(Mlp<'a>),
    /// In integers.
    I16(FixedMlp<'a>),
}

impl<'a> Network<'a> {
    /// The outputs for `inputs`: see [`Mlp::forward`] and [`FixedMlp::forward`].
    #[must_use]
    pub fn forward(&self, inputs: &[f32]) -> [f32; OUTPUTS] {
        match self {
            Self::F32(network) => network.forward(inputs),
            Self::I16(network) => network.forward(inputs),
        }
    }

    /// Width of the hidden layers.
    #[must_use]
    pub const fn width(&self) -> usize {
        match self {
            Self::F32(network) => network.width(),
            Self::I16(network) => network.width(),
        }
    }

    /// The network, if it is one of `f32`.
    #[must_use]
    pub const fn as_f32(&self) -> Option<&Mlp<'a>> {
        match self {
            Self::F32(network) => Some(network),
            Self::I16(_) => None,
        }
    }

    /// The network, if it is one of integers.
    #[must_use]
    pub const fn as_i16(&self) -> Option<&FixedMlp<'a>> {
        match self {
            Self::F32(_) => None,
            Self::I16(network) => Some(network),
        }
    }
}

/// A weights file, parsed in place.
///
/// What was validated stays as it is; there is no other way to make one than [`Weights::parse`].
///
/// ```compile_fail,E0616
/// use cede_controller::{FeatureSet, Weights, WeightsError};
///
/// fn other_features<'a>(words: &'a [u32]) -> Result<Weights<'a>, WeightsError> {
///     let mut weights = Weights::parse(words)?;
///     weights.features = FeatureSet::Raw;
///     Ok(weights)
/// }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Weights<'a> {
    features: FeatureSet,
    perspective: Perspective,
    network: Network<'a>,
    provenance: &'a [u32; 8],
    centres: &'a [u32],
    scales: &'a [u32],
}

impl<'a> Weights<'a> {
    /// What the network is told.
    #[must_use]
    pub const fn features(&self) -> FeatureSet {
        self.features
    }

    /// Whose commands it gives.
    #[must_use]
    pub const fn perspective(&self) -> Perspective {
        self.perspective
    }

    /// The network.
    #[must_use]
    pub const fn network(&self) -> &Network<'a> {
        &self.network
    }

    /// SHA-256 of what the network was made from.
    #[must_use]
    pub fn provenance(&self) -> [u8; 32] {
        let mut bytes = [0; 32];
        for (place, word) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(self.provenance) {
            *place = word.to_le_bytes();
        }
        bytes
    }

    /// Centre and scale of each feature: the network sees (feature − centre) · scale.
    ///
    /// Cost: O(features) to go through.
    pub fn normalisation(&self) -> impl Iterator<Item = (f32, f32)> + use<'a> {
        let float = |&word: &u32| f32::from_bits(word);
        self.centres
            .iter()
            .map(float)
            .zip(self.scales.iter().map(float))
    }
}

fn crc32(words: &[u32]) -> u32 {
    let mut digest = CRC.digest();
    for byte in words.iter().flat_map(|word| word.to_le_bytes()) {
        digest.update(&[byte]);
    }
    digest.finalize()
}

fn size(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

#[cfg(test)]
pub(crate) mod testing {
    extern crate std;
    use super::*;
    use std::vec;
    use std::vec::Vec;

    /// Numbers between ± 1 that look random.
    pub(crate) fn noise(seed: u32) -> impl Iterator<Item = f32> {
        core::iter::successors(Some(seed), |&x| {
            Some(x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453))
        })
        .map(|x| ((x >> 16) as u16 as i16) as f32 / 32768.0)
    }

    /// What `with` makes of a draft with random weights.
    pub(crate) fn draft<T>(
        features: FeatureSet,
        perspective: Perspective,
        width: usize,
        with: impl FnOnce(&Draft<'_>) -> T,
    ) -> T {
        let inputs = features.count();
        let count = Mlp::words(inputs, width);
        let parameters: Vec<f32> = noise(7).map(|w| 0.4 * w).take(count).collect();
        with(&Draft {
            features,
            perspective,
            width,
            provenance: core::array::from_fn(|i| i as u8),
            centres: &vec![1.0; inputs],
            scales: &vec![0.1; inputs],
            parameters: &parameters,
        })
    }

    /// A weights file with random weights.
    pub(crate) fn file(features: FeatureSet, perspective: Perspective, width: usize) -> Vec<u32> {
        draft(features, perspective, width, |draft| {
            let mut words = vec![0; draft.words()];
            draft.encode(&mut words).unwrap();
            words
        })
    }

    /// The same in integers.
    pub(crate) fn file_i16(
        features: FeatureSet,
        perspective: Perspective,
        width: usize,
    ) -> Vec<u32> {
        draft(features, perspective, width, |draft| {
            let mut words = vec![0; draft.words_i16()];
            draft.encode_i16([12, 11, 11, 11], &mut words).unwrap();
            words
        })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::testing::{file, file_i16, noise};
    use super::*;
    use crate::policy::mlp::MAX_WIDTH;
    use std::vec::Vec;

    #[test]
    fn what_is_written_is_read_back() {
        for features in FeatureSet::ALL {
            for perspective in [Perspective::Joint, Perspective::Ego] {
                for file in [
                    file(features, perspective, 32),
                    file_i16(features, perspective, 32),
                ] {
                    let weights = Weights::parse(&file).unwrap();
                    assert_eq!(weights.features(), features);
                    assert_eq!(weights.perspective(), perspective);
                    assert_eq!(weights.network().width(), 32);
                    assert_eq!(weights.provenance()[31], 31);
                    assert!(weights.normalisation().all(|n| n == (1.0, 0.1)));
                    assert_eq!(weights.normalisation().count(), features.count());
                }
            }
        }
    }

    #[test]
    fn every_parameter_is_read_back_in_order() {
        for width in (16..=MAX_WIDTH).step_by(16) {
            let file = file(FeatureSet::Raw, Perspective::Ego, width);
            let weights = Weights::parse(&file).unwrap();
            let layers = weights.network().as_f32().unwrap().layers();
            let read = layers.iter().flat_map(|l| l.biases().chain(l.weights()));
            let written = noise(7).map(|w| 0.4 * w).take(Mlp::words(8, width));
            assert!(read.eq(written), "{width} wide");
        }
    }

    #[test]
    fn every_flipped_bit_is_found() {
        for file in [file, file_i16] {
            let mut file = file(FeatureSet::Raw, Perspective::Joint, 16);
            assert!(Weights::parse(&file).is_ok());
            for bit in 0..32 * file.len() {
                file[bit / 32] ^= 1 << (bit % 32);
                assert!(Weights::parse(&file).is_err(), "bit {bit}");
                file[bit / 32] ^= 1 << (bit % 32);
            }
        }
    }

    #[test]
    fn files_that_are_cut_short_or_continued_are_refused() {
        for file in [file, file_i16] {
            let mut file = file(FeatureSet::Raw, Perspective::Ego, 16);
            for length in 0..file.len() {
                assert!(Weights::parse(&file[..length]).is_err(), "{length} words");
            }
            file.push(0);
            assert!(Weights::parse(&file).is_err());
        }
    }

    /// `file` with one word changed and the checksum made good.
    fn forged(place: usize, word: u32) -> WeightsError {
        let mut file = file(FeatureSet::Raw, Perspective::Ego, 16);
        file[place] = word;
        let (last, content) = file.split_last_mut().unwrap();
        *last = crc32(content);
        Weights::parse(&file).unwrap_err()
    }

    #[test]
    fn each_field_is_checked() {
        assert_eq!(forged(0, 1), WeightsError::Magic);
        assert_eq!(forged(1, 1), WeightsError::Unknown);
        assert_eq!(forged(1, 3), WeightsError::Unknown);
        assert_eq!(forged(2, 5), WeightsError::Unknown);
        assert_eq!(forged(3, 2), WeightsError::Unknown);
        for width in [0, 15, 17, 32, 144, u32::MAX] {
            assert_eq!(forged(5, width), WeightsError::Shape);
        }
        assert_eq!(forged(4, 14), WeightsError::Shape);
        assert_eq!(forged(6, 2), WeightsError::Shape);
        assert_eq!(forged(15, 1), WeightsError::Shape);
        assert_eq!(forged(15, 2), WeightsError::Unknown);
        let centre = HEADER + Mlp::words(8, 16);
        for (place, limit) in [(HEADER, MAX_WEIGHT), (centre, MAX_NORMALISATION)] {
            for bad in [f32::NAN, f32::INFINITY, limit * 1.1, -limit * 1.1] {
                assert_eq!(forged(place, bad.to_bits()), WeightsError::OutOfRange);
            }
        }
    }

    #[test]
    fn bytes_become_words_and_an_odd_length_shows() {
        assert_eq!(words(b"CEDE\x01\0\0\0").collect::<Vec<_>>(), [MAGIC, 1]);
        assert_eq!(Aligned::<2>::new(b"CEDE\x01\0\0\0").0, [MAGIC, 1]);
        assert_eq!(words(b"CEDE\x01").count(), 2);
    }

    #[test]
    fn a_draft_that_is_no_network_is_refused() {
        let draft = Draft {
            features: FeatureSet::Raw,
            perspective: Perspective::Ego,
            width: 16,
            provenance: [0; 32],
            centres: &[0.0; 8],
            scales: &[1.0; 8],
            parameters: &[f32::NAN; Mlp::words(8, 16)],
        };
        let mut out = [0; 1000];
        assert_eq!(
            draft.encode(&mut out).unwrap_err(),
            WeightsError::OutOfRange
        );
        let short = Draft {
            scales: &[],
            ..draft
        };
        assert_eq!(short.encode(&mut out).unwrap_err(), WeightsError::Shape);
        assert_eq!(
            draft.encode(&mut out[..50]).unwrap_err(),
            WeightsError::NoRoom
        );
        let wide = Draft {
            width: usize::MAX,
            ..draft
        };
        assert_eq!(wide.encode(&mut out).unwrap_err(), WeightsError::Shape);
    }
}
