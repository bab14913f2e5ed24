//! Words become weights: everything is checked before anything is used.

use super::{
    HEADER, MAGIC, MAX_NORMALISATION, MAX_WEIGHT, Network, Number, Perspective, VERSION, Weights,
    WeightsError, crc32, size,
};
use crate::policy::features::FeatureSet;
use crate::policy::fixed::FixedMlp;
use crate::policy::mlp::{MAX_WIDTH, Mlp, OUTPUTS};

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
        let shape = header.body(rest).ok_or(WeightsError::Shape)?;
        let (parameters, centres, scales) = shape;
        let network = header.network(parameters)?;
        if !(in_range(centres, MAX_NORMALISATION) && in_range(scales, MAX_NORMALISATION)) {
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
}

struct Header<'a> {
    features: FeatureSet,
    perspective: Perspective,
    width: usize,
    provenance: &'a [u32; 8],
    number: Number,
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
            number,
        ] = words;
        let width = usize::try_from(*width).unwrap_or(usize::MAX);
        if *version != VERSION {
            return Err(WeightsError::Unknown);
        }
        let header = Self {
            features: feature_set(*features).ok_or(WeightsError::Unknown)?,
            perspective: perspective_of(*perspective).ok_or(WeightsError::Unknown)?,
            width,
            provenance,
            number: number_of(*number).ok_or(WeightsError::Unknown)?,
        };
        let known = size(header.features.count()) == *inputs && size(OUTPUTS) == *outputs;
        if known && width <= MAX_WIDTH {
            Ok(header)
        } else {
            Err(WeightsError::Shape)
        }
    }

    /// What follows the header: the network, centres, scales.
    fn body(&self, words: &'a [u32]) -> Option<(&'a [u32], &'a [u32], &'a [u32])> {
        let inputs = self.features.count();
        let (network, rest) = words.split_at_checked(self.number.words(inputs, self.width))?;
        let (centres, scales) = rest.split_at_checked(inputs)?;
        (scales.len() == inputs).then_some((network, centres, scales))
    }

    fn network(&self, words: &'a [u32]) -> Result<Network<'a>, WeightsError> {
        let inputs = self.features.count();
        match self.number {
            Number::F32 => {
                let network = Mlp::new(words, inputs, self.width).ok_or(WeightsError::Shape)?;
                if in_range(words, MAX_WEIGHT) {
                    Ok(Network::F32(network))
                } else {
                    Err(WeightsError::OutOfRange)
                }
            }
            Number::I16 => FixedMlp::new(words, inputs, self.width).map(Network::I16),
        }
    }
}

fn in_range(words: &[u32], limit: f32) -> bool {
    words
        .iter()
        .all(|&word| f32::from_bits(word).abs() <= limit)
}

fn feature_set(code: u32) -> Option<FeatureSet> {
    FeatureSet::ALL.get(usize::try_from(code).ok()?).copied()
}

fn perspective_of(code: u32) -> Option<Perspective> {
    [Perspective::Joint, Perspective::Ego]
        .into_iter()
        .find(|&p| p as u32 == code)
}

fn number_of(code: u32) -> Option<Number> {
    [Number::F32, Number::I16]
        .into_iter()
        .find(|&n| n as u32 == code)
}
