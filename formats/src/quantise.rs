//! A policy as one of integers: `i16` weights and activations, for cores without an FPU and for half the flash.
//!
//! The weights of a layer have as many fractional bits as their sums leave room for in 32 bits, which their sizes alone
//! decide. How many the activations have is chosen on states of the region that properties speak of, without recorded
//! data: those with which the largest departure of an acceleration, plus the most that the rounding of activations could
//! add, is smallest. An activation beyond its range is limited.

use crate::layers::{self, Layer, NotF32};
use crate::property::StateProperty;
use cede_controller::policy::acceleration_slope;
use cede_controller::policy::features::HORIZON;
use cede_controller::policy::weights::Draft;
use cede_controller::{Crosser, Leader, Pair, Policy, Weights, WeightsError};

/// Fractional bits of the inputs: ± 8 fill 16 bits.
const INPUT_BITS: u32 = 12;
/// Fractional bits of activations that are tried: ranges from 2 to 256.
const TRIED: std::ops::RangeInclusive<u32> = 7..=14;
/// Those to begin with.
const FIRST: u32 = 11;
/// How often each layer's bits are chosen anew.
const ROUNDS: usize = 2;
/// States of each setting of a property.
const STATES: u32 = 64;

/// A policy of integers.
#[derive(Clone, Debug)]
pub struct Quantised {
    /// The words of its weights file.
    pub words: Vec<u32>,
    /// Fractional bits of the inputs and of the three hidden layers' activations.
    pub bits: [u32; 4],
    /// The largest departure (m/s²) of an acceleration from the policy in `f32`, over the sampled states.
    pub departure: f32,
    /// How many states were sampled.
    pub states: usize,
}

/// Why a policy does not become one of integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QuantiseError {
    /// It is one already.
    #[error(transparent)]
    NotF32(#[from] NotF32),
    /// Its weights do not fit.
    #[error("the network does not fit 16-bit weights: {0}")]
    Weights(#[from] WeightsError),
}

/// Makes integers of a policy; its activations' bits are chosen on the regions of `properties`.
///
/// # Errors
/// If it is one of integers already, or weights are so large that a layer cannot be summed in 32 bits.
pub fn quantise(
    weights: &Weights<'_>,
    properties: &[StateProperty],
) -> Result<Quantised, QuantiseError> {
    let layers = layers::of(weights)?;
    let parameters = layers
        .iter()
        .flat_map(|layer| layer.biases.iter().chain(&layer.weights));
    let parameters: Vec<f32> = parameters.copied().collect();
    let (centres, scales): (Vec<f32>, Vec<f32>) = weights.normalisation().unzip();
    let draft = Draft {
        features: weights.features(),
        perspective: weights.perspective(),
        width: weights.network().width(),
        provenance: weights.provenance(),
        centres: &centres,
        scales: &scales,
        parameters: &parameters,
    };
    let original = Policy::from(*weights);
    let pairs = properties.iter().flat_map(sample);
    let sampled: Vec<_> = pairs
        .map(|pair| Sampled::new(&original, &layers, pair))
        .collect();
    let tried = |bits| {
        let mut words = vec![0; draft.words_i16()];
        let policy = Policy::from(draft.encode_i16(bits, &mut words)?);
        let most = |of: &dyn Fn(&Sampled) -> f32| sampled.iter().map(of).fold(0.0, f32::max);
        let departure = most(&|sampled| sampled.departure(&policy));
        let could_be = departure + most(&|sampled| sampled.rounding(bits));
        let states = sampled.len();
        let quantised = Quantised {
            words,
            bits,
            departure,
            states,
        };
        Ok::<_, WeightsError>((could_be, quantised))
    };
    let mut best = tried([INPUT_BITS, FIRST, FIRST, FIRST])?;
    for layer in (1..=3).cycle().take(3 * ROUNDS) {
        for bits in TRIED {
            let mut all = best.1.bits;
            all[layer] = bits;
            // Bits for which the weights do not fit are not an error: others are there.
            best = match tried(all) {
                Ok(other) if other.0 < best.0 => other,
                _ => best,
            };
        }
    }
    Ok(best.1)
}

/// A state, what the policy in `f32` proposes there, and how the ego's acceleration answers if the inputs and each
/// layer's activations all change by 1, each in the direction that matters most.
struct Sampled {
    pair: Pair,
    proposal: [f32; 2],
    gains: [f32; 4],
}

impl Sampled {
    fn new(policy: &Policy<'_>, layers: &[Layer; 4], pair: Pair) -> Self {
        let proposal = policy.act(&pair);
        let inputs = policy.inputs(&pair);
        let slope = acceleration_slope(proposal[0]);
        let gains = gains(layers, &inputs[..layers[0].inputs()]).map(|gain| slope * gain);
        Self {
            pair,
            proposal,
            gains,
        }
    }

    fn departure(&self, policy: &Policy<'_>) -> f32 {
        let [a, b] = self.proposal;
        let [c, d] = policy.act(&self.pair);
        (a - c).abs().max((b - d).abs())
    }

    /// What activations with so many fractional bits could add if all are rounded the worst way.
    fn rounding(&self, bits: [u32; 4]) -> f32 {
        let each = self.gains.iter().zip(bits);
        each.map(|(gain, bits)| 0.5 * gain / (1_u32 << bits) as f32)
            .sum()
    }
}

/// Sums of the magnitudes of the first output's derivatives by the inputs and by each hidden layer's activations.
fn gains(layers: &[Layer; 4], inputs: &[f32]) -> [f32; 4] {
    let mut activations = vec![inputs.to_vec()];
    for layer in &layers[..3] {
        let mut sums = layer.biases.clone();
        let rows = layer.weights.chunks_exact(layer.outputs());
        for (row, x) in rows.zip(&activations[activations.len() - 1]) {
            sums.iter_mut().zip(row).for_each(|(sum, w)| *sum += w * x);
        }
        activations.push(sums.into_iter().map(|sum| sum.max(0.0)).collect());
    }
    let mut gains = [0.0; 4];
    let mut row = vec![1.0];
    for (index, layer) in layers.iter().enumerate().rev() {
        let rows = layer.weights.chunks_exact(layer.outputs());
        let before = rows.map(|weights| weights.iter().zip(&row).map(|(w, r)| w * r).sum::<f32>());
        let active = activations[index]
            .iter()
            .map(|&a| if index == 0 || a > 0.0 { 1.0 } else { 0.0 });
        row = before.zip(active).map(|(r, active)| r * active).collect();
        gains[index] = row.iter().map(|r| r.abs()).sum();
    }
    gains
}

/// States that fill a property's regions evenly; in every other one there is traffic around the ego.
fn sample(property: &StateProperty) -> Vec<Pair> {
    let mut numbers = (1..).map(|number| {
        // Kronecker's sequence: seven independent irrationals, here the square roots of primes.
        [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0]
            .map(|prime| (f64::from(number) * prime.sqrt()).fract())
    });
    let region = property.region();
    let mut pairs = Vec::new();
    for setting in property.settings() {
        for (number, shares) in (0..STATES).zip(&mut numbers) {
            let at = |i: usize| region[i][0] + shares[i] * (region[i][1] - region[i][0]);
            let mut pair = setting.pair(std::array::from_fn(at));
            let [.., gap, distance, speed] = shares.map(|share| share as f32);
            if number % 2 == 1 {
                pair.ego.leader = Some(Leader {
                    gap: gap * HORIZON,
                    speed: speed * pair.ego.speed,
                });
                pair.ego.crosser = Some(Crosser {
                    distance: distance * HORIZON,
                    its_distance: gap * HORIZON,
                    its_speed: speed * pair.other.speed,
                });
            }
            pairs.push(pair);
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::property::Properties;

    fn properties() -> Vec<StateProperty> {
        let text = include_str!("../../docs/safety/policy.toml");
        Properties::read(text).unwrap().property
    }

    #[test]
    fn the_embedded_policy_of_integers_is_the_embedded_policy_quantised() {
        let weights = Weights::parse(cede_controller::policy::embedded::words()).unwrap();
        let quantised = quantise(&weights, &properties()).unwrap();
        assert!(quantised.departure < 0.01, "{}", quantised.departure);
        assert!(
            quantised.words == cede_controller::policy::embedded::words_i16(),
            "write it anew: cede export --quantise i16 --out controller/assets/embedded-i16.cede"
        );
        let again = Weights::parse(&quantised.words).unwrap();
        assert_eq!(again.provenance(), weights.provenance());
        assert_eq!(
            quantise(&again, &properties()).unwrap_err(),
            QuantiseError::NotF32(NotF32)
        );
    }
}
