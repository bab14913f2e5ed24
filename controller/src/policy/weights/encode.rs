//! A network becomes a weights file.

use super::{HEADER, MAGIC, Perspective, VERSION, Weights, WeightsError, crc32, size, words};
use crate::policy::features::FeatureSet;
use crate::policy::mlp::{MAX_WIDTH, Mlp, OUTPUTS};

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
