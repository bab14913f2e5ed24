//! The weights file (`.cede`): a network with all that is needed to run it, checked before it drives.
//!
//! The file is a row of little-endian 32-bit words:
//!
//! | words | what |
//! |---|---|
//! | 1 | the letters `CEDE` |
//! | 1 | version of the format, 2 |
//! | 1 | [`FeatureSet`]: 0 raw, 1 route, 2 traffic, 3 scene |
//! | 1 | [`Perspective`]: 0 joint, 1 ego |
//! | 3 | sizes: inputs I, width H of the hidden layers, outputs, 4 |
//! | 8 | provenance: a SHA-256 of what the network was made from |
//! | 1 | reserved, 0 |
//! | … | the four layers, `f32`: for each tile of 96 neurons, and for what is left, a row of biases, then for each input a row of weights |
//! | I, I | centre and scale of each feature, `f32`: the network sees (feature − centre) · scale, within ± [`LIMIT`](crate::policy::features::LIMIT) |
//! | 1 | CRC-32 (ISO-HDLC) of all the bytes before |
//!
//! What lies next to each other is wanted one after the other ([`Mlp`]): a wide layer is read once, from its first
//! word to its last. Version 1 knew no tiles; its files are refused.
//!
//! It is kept as words, not as bytes, because they are aligned: a processor loads a weight straight
//! from flash as a float. [`include_weights!`](crate::include_weights) puts a file there, on a
//! boundary of 64 bytes; as every layer's weights then lie on such boundaries too, no vector of weights
//! straddles two cache lines (it costs a third of the time where it does, and no bit of the result).

use crate::policy::features::FeatureSet;
use crate::policy::mlp::{MAX_WIDTH, Mlp, OUTPUTS};
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

/// A weights file, parsed in place.
#[derive(Clone, Copy, Debug)]
pub struct Weights<'a> {
    /// What the network is told.
    pub features: FeatureSet,
    /// Whose commands it gives.
    pub perspective: Perspective,
    /// The network.
    pub network: Mlp<'a>,
    provenance: &'a [u32; 8],
    centres: &'a [u32],
    scales: &'a [u32],
}

/// Why words are not a weights file, or a draft cannot become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WeightsError {
    /// It does not begin with the letters `CEDE`.
    Magic,
    /// The checksum does not fit: a bit has changed.
    Checksum,
    /// A version, feature set or perspective that this program does not know.
    Unknown,
    /// The number of words does not fit the layers' sizes, or the sizes are out of range.
    Shape,
    /// A number is not finite or too large.
    OutOfRange,
    /// The buffer that it is to be written to is too short.
    NoRoom,
}

impl core::fmt::Display for WeightsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Magic => "not a weights file: it does not begin with CEDE",
            Self::Checksum => "the checksum does not fit: the file is damaged",
            Self::Unknown => {
                "a version, feature set or perspective that this program does not know; if the file is older, train or import it again"
            }
            Self::Shape => "the layers' sizes do not fit the file's length or the limits",
            Self::OutOfRange => "a weight is not finite or too large",
            Self::NoRoom => "the buffer is too short for the weights",
        })
    }
}

impl core::error::Error for WeightsError {}

impl<'a> Weights<'a> {
    /// Checks `words` and borrows from them.
    ///
    /// Cost: O(words), most of it the checksum.
    ///
    /// # Errors
    /// See [`WeightsError`]; a single flipped bit anywhere is always found.
    pub fn parse(words: &'a [u32]) -> Result<Self, WeightsError> {
        if words.first() != Some(&MAGIC) {
            return Err(WeightsError::Magic);
        }
        let (&checksum, content) = words.split_last().ok_or(WeightsError::Shape)?;
        if crc32(content) != checksum {
            return Err(WeightsError::Checksum);
        }
        let (header, rest) = content.split_first_chunk().ok_or(WeightsError::Shape)?;
        let header = Header::parse(header)?;
        let shape = body(rest, header.features.count(), header.width);
        let (parameters, centres, scales) = shape.ok_or(WeightsError::Shape)?;
        let network = Mlp::new(parameters, header.features.count(), header.width)
            .ok_or(WeightsError::Shape)?;
        if !(in_range(parameters, MAX_WEIGHT)
            && in_range(centres, MAX_NORMALISATION)
            && in_range(scales, MAX_NORMALISATION))
        {
            return Err(WeightsError::OutOfRange);
        }
        Ok(Self {
            features: header.features,
            perspective: header.perspective,
            provenance: header.provenance,
            network,
            centres,
            scales,
        })
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

/// What a weights file is made from.
#[derive(Clone, Copy, Debug)]
pub struct Draft<'a> {
    /// What the network is told; it says how many inputs there are.
    pub features: FeatureSet,
    /// Whose commands it gives.
    pub perspective: Perspective,
    /// Width of the hidden layers: a multiple of 16 up to 128.
    pub width: usize,
    /// SHA-256 of what the network was made from.
    pub provenance: [u8; 32],
    /// Centre of each feature.
    pub centres: &'a [f32],
    /// Scale of each feature.
    pub scales: &'a [f32],
    /// Layer by layer the biases, then the weights of input 0 for each neuron, then those of input 1, …
    pub parameters: &'a [f32],
}

impl Draft<'_> {
    /// Number of words of the file, which [`Draft::encode`] writes.
    #[must_use]
    pub const fn words(&self) -> usize {
        let inputs = self.features.count();
        HEADER + 2 * inputs + Mlp::words(inputs, self.width) + 1
    }

    /// Writes the file to the first [`Draft::words`] places of `out` and reads it back.
    ///
    ///
    /// # Errors
    /// [`WeightsError::NoRoom`] if `out` is too short, [`WeightsError::Shape`] and
    /// [`WeightsError::OutOfRange`] if the draft is not a valid network.
    pub fn encode<'o>(&self, out: &'o mut [u32]) -> Result<Weights<'o>, WeightsError> {
        if self.width > MAX_WIDTH {
            return Err(WeightsError::Shape);
        }
        let out = out.get_mut(..self.words()).ok_or(WeightsError::NoRoom)?;
        let floats = [self.parameters, self.centres, self.scales];
        let length = HEADER + floats.iter().map(|f| f.len()).sum::<usize>() + 1;
        let features = FeatureSet::ALL.iter().position(|&f| f == self.features);
        let (Some(features), true) = (features, length == out.len()) else {
            return Err(WeightsError::Shape);
        };
        let head = [
            MAGIC,
            VERSION,
            size(features),
            self.perspective as u32,
            size(self.features.count()),
            size(self.width),
            size(OUTPUTS),
        ];
        let header = head.into_iter().chain(words(&self.provenance)).chain([0]);
        for (place, word) in out.iter_mut().zip(header) {
            *place = word;
        }
        let inputs = self.features.count();
        let places = Mlp::places(inputs, self.width).chain(Mlp::words(inputs, self.width)..);
        for (place, value) in places.zip(floats.into_iter().flatten()) {
            out[HEADER + place] = value.to_bits();
        }
        if let Some((last, content)) = out.split_last_mut() {
            *last = crc32(content);
        }
        Weights::parse(out)
    }
}

/// The words of a file read as bytes. A length that is no multiple of four gives one word more than
/// it should, so that [`Weights::parse`] refuses it.
pub fn words(bytes: &[u8]) -> impl Iterator<Item = u32> + '_ {
    bytes.chunks(4).map(|chunk| {
        let mut word = [0; 4];
        for (place, &byte) in word.iter_mut().zip(chunk) {
            *place = byte;
        }
        u32::from_le_bytes(word)
    })
}

/// Words on a boundary of 64 bytes, a cache line: where a network runs fastest.
#[repr(C, align(64))]
pub struct Aligned<const N: usize>(pub [u32; N]);

impl<const N: usize> Aligned<N> {
    /// The words of a file at compile time; see [`include_weights!`](crate::include_weights).
    ///
    /// # Panics
    /// If `bytes` is not `4 · N` long: at compile time, when it makes a constant or a static.
    #[must_use]
    pub const fn new(bytes: &[u8]) -> Self {
        let (chunks, rest) = bytes.as_chunks::<4>();
        assert!(
            chunks.len() == N && rest.is_empty(),
            "not a whole number of words"
        );
        let mut words = [0; N];
        let mut i = 0;
        while i < N {
            words[i] = u32::from_le_bytes(chunks[i]);
            i += 1;
        }
        Self(words)
    }
}

/// A weights file as a `&'static [u32]` in read-only memory, for [`Weights::parse`].
///
/// The path is relative to the source file, as in `include_bytes!`.
#[macro_export]
macro_rules! include_weights {
    ($path:expr) => {{
        const BYTES: &[u8] = include_bytes!($path);
        static WORDS: $crate::policy::weights::Aligned<{ BYTES.len() / 4 }> =
            $crate::policy::weights::Aligned::new(BYTES);
        &WORDS.0 as &'static [u32]
    }};
}

struct Header<'a> {
    features: FeatureSet,
    perspective: Perspective,
    width: usize,
    provenance: &'a [u32; 8],
}

impl<'a> Header<'a> {
    fn parse(words: &'a [u32; HEADER]) -> Result<Self, WeightsError> {
        let [
            _,
            version,
            features,
            perspective,
            inputs,
            width,
            outputs,
            provenance @ ..,
            reserved,
        ] = words;
        let width = usize::try_from(*width).unwrap_or(usize::MAX);
        if *version != VERSION || *reserved != 0 {
            return Err(WeightsError::Unknown);
        }
        let header = Self {
            features: feature_set(*features).ok_or(WeightsError::Unknown)?,
            perspective: perspective_of(*perspective).ok_or(WeightsError::Unknown)?,
            width,
            provenance,
        };
        let known = size(header.features.count()) == *inputs && size(OUTPUTS) == *outputs;
        if known && width <= MAX_WIDTH {
            Ok(header)
        } else {
            Err(WeightsError::Shape)
        }
    }
}

/// What follows the header: parameters, centres, scales.
fn body(words: &[u32], inputs: usize, width: usize) -> Option<(&[u32], &[u32], &[u32])> {
    let (parameters, rest) = words.split_at_checked(Mlp::words(inputs, width))?;
    let (centres, scales) = rest.split_at_checked(inputs)?;
    (scales.len() == inputs).then_some((parameters, centres, scales))
}

fn in_range(words: &[u32], limit: f32) -> bool {
    words
        .iter()
        .all(|&word| f32::from_bits(word).abs() <= limit)
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

fn feature_set(code: u32) -> Option<FeatureSet> {
    FeatureSet::ALL.get(usize::try_from(code).ok()?).copied()
}

fn perspective_of(code: u32) -> Option<Perspective> {
    [Perspective::Joint, Perspective::Ego]
        .into_iter()
        .find(|&p| p as u32 == code)
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

    /// A weights file with random weights.
    pub(crate) fn file(features: FeatureSet, perspective: Perspective, width: usize) -> Vec<u32> {
        let inputs = features.count();
        let count = Mlp::words(inputs, width);
        let parameters: Vec<f32> = noise(7).map(|w| 0.4 * w).take(count).collect();
        let draft = Draft {
            features,
            perspective,
            width,
            provenance: core::array::from_fn(|i| i as u8),
            centres: &vec![1.0; inputs],
            scales: &vec![0.1; inputs],
            parameters: &parameters,
        };
        let mut words = vec![0; draft.words()];
        draft.encode(&mut words).unwrap();
        words
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::testing::{file, noise};
    use super::*;
    use std::vec::Vec;

    #[test]
    fn what_is_written_is_read_back() {
        for features in FeatureSet::ALL {
            for perspective in [Perspective::Joint, Perspective::Ego] {
                let file = file(features, perspective, 32);
                let weights = Weights::parse(&file).unwrap();
                assert_eq!(weights.features, features);
                assert_eq!(weights.perspective, perspective);
                assert_eq!(weights.network.width(), 32);
                assert_eq!(weights.provenance()[31], 31);
                assert!(weights.normalisation().all(|n| n == (1.0, 0.1)));
                assert_eq!(weights.normalisation().count(), features.count());
            }
        }
    }

    #[test]
    fn every_parameter_is_read_back_in_order() {
        for width in (16..=MAX_WIDTH).step_by(16) {
            let file = file(FeatureSet::Raw, Perspective::Ego, width);
            let layers = Weights::parse(&file).unwrap().network.layers();
            let read = layers.iter().flat_map(|l| l.biases().chain(l.weights()));
            let written = noise(7).map(|w| 0.4 * w).take(Mlp::words(8, width));
            assert!(read.eq(written), "{width} wide");
        }
    }

    #[test]
    fn every_flipped_bit_is_found() {
        let mut file = file(FeatureSet::Raw, Perspective::Joint, 16);
        assert!(Weights::parse(&file).is_ok());
        for bit in 0..32 * file.len() {
            file[bit / 32] ^= 1 << (bit % 32);
            assert!(Weights::parse(&file).is_err(), "bit {bit}");
            file[bit / 32] ^= 1 << (bit % 32);
        }
    }

    #[test]
    fn files_that_are_cut_short_or_continued_are_refused() {
        let mut file = file(FeatureSet::Raw, Perspective::Ego, 16);
        for length in 0..file.len() {
            assert!(Weights::parse(&file[..length]).is_err(), "{length} words");
        }
        file.push(0);
        assert!(Weights::parse(&file).is_err());
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
        assert_eq!(forged(2, 4), WeightsError::Unknown);
        assert_eq!(forged(3, 2), WeightsError::Unknown);
        for width in [0, 15, 17, 32, 144, u32::MAX] {
            assert_eq!(forged(5, width), WeightsError::Shape);
        }
        assert_eq!(forged(4, 14), WeightsError::Shape);
        assert_eq!(forged(6, 2), WeightsError::Shape);
        assert_eq!(forged(15, 1), WeightsError::Unknown);
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
