//! A network becomes a weights file.

use super::draft::Draft;
use super::quantise;
use super::{HEADER, MAGIC, Number, VERSION, Weights, WeightsError, crc32, size};
use crate::policy::features::FeatureSet;
use crate::policy::fixed::FixedMlp;
use crate::policy::mlp::{MAX_WIDTH, Mlp, OUTPUTS};

impl Draft<'_> {
    /// Number of words of the file, which [`Draft::encode`] writes.
    #[must_use]
    pub const fn words(&self) -> usize {
        self.words_around(Mlp::words(self.features.count(), self.width))
    }

    /// Number of words of the file of integers, which [`Draft::encode_i16`] writes.
    #[must_use]
    pub const fn words_i16(&self) -> usize {
        self.words_around(FixedMlp::words(self.features.count(), self.width))
    }

    const fn words_around(&self, network: usize) -> usize {
        HEADER + 2 * self.features.count() + network + 1
    }

    /// Writes the file to the first [`Draft::words`] places of `out` and reads it back.
    ///
    /// # Errors
    /// [`WeightsError::NoRoom`] if `out` is too short, [`WeightsError::Shape`] and
    /// [`WeightsError::OutOfRange`] if the draft is not a valid network.
    pub fn encode<'o>(&self, out: &'o mut [u32]) -> Result<Weights<'o>, WeightsError> {
        let (inputs, width) = (self.features.count(), self.width);
        self.file(Number::F32, out, |words| {
            for (place, value) in Mlp::places(inputs, width).zip(self.parameters) {
                words[place] = value.to_bits();
            }
            Ok(())
        })
    }

    /// Writes the file of integers to the first [`Draft::words_i16`] places of `out` and reads it back. The activations, of
    /// the inputs first, have `bits` fractional bits each; the weights of a layer have as many as their sums leave room for.
    ///
    /// # Errors
    /// As [`Draft::encode`], and [`WeightsError::Overflow`] if weights or biases are so large, or the bits so many, that
    /// a layer cannot be summed in 32 bits.
    pub fn encode_i16<'o>(
        &self,
        bits: [u32; 4],
        out: &'o mut [u32],
    ) -> Result<Weights<'o>, WeightsError> {
        self.file(Number::I16, out, |words| {
            quantise::network(self, bits, words).ok_or(WeightsError::Overflow)
        })
    }

    /// Writes a file, with the network's words by `network`.
    fn file<'o>(
        &self,
        number: Number,
        out: &'o mut [u32],
        network: impl FnOnce(&mut [u32]) -> Result<(), WeightsError>,
    ) -> Result<Weights<'o>, WeightsError> {
        let inputs = self.features.count();
        let features = FeatureSet::ALL.iter().position(|&f| f == self.features);
        let (Some(features), true) = (features, self.width <= MAX_WIDTH) else {
            return Err(WeightsError::Shape);
        };
        let sizes = (self.parameters.len(), self.centres.len(), self.scales.len());
        if sizes != (Mlp::words(inputs, self.width), inputs, inputs) {
            return Err(WeightsError::Shape);
        }
        let words = number.words(inputs, self.width);
        let out = out.get_mut(..self.words_around(words));
        let out = out.ok_or(WeightsError::NoRoom)?;
        let head = [
            MAGIC,
            VERSION,
            size(features),
            self.perspective as u32,
            size(inputs),
            size(self.width),
            size(OUTPUTS),
        ];
        let provenance = super::words(&self.provenance);
        let header = head.into_iter().chain(provenance).chain([number as u32]);
        for (place, word) in out.iter_mut().zip(header) {
            *place = word;
        }
        network(&mut out[HEADER..HEADER + words])?;
        let normalisation = self.centres.iter().chain(self.scales);
        for (place, value) in out[HEADER + words..].iter_mut().zip(normalisation) {
            *place = value.to_bits();
        }
        if let Some((last, content)) = out.split_last_mut() {
            *last = crc32(content);
        }
        Weights::parse(out)
    }
}
