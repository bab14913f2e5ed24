//! Words become weights: everything is checked before anything is used.

use super::{
    HEADER, MAGIC, MAX_NORMALISATION, MAX_WEIGHT, Perspective, VERSION, Weights, WeightsError,
    crc32, size,
};
use crate::policy::features::FeatureSet;
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

fn feature_set(code: u32) -> Option<FeatureSet> {
    FeatureSet::ALL.get(usize::try_from(code).ok()?).copied()
}

fn perspective_of(code: u32) -> Option<Perspective> {
    [Perspective::Joint, Perspective::Ego]
        .into_iter()
        .find(|&p| p as u32 == code)
}
