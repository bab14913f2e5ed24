//! The same update of soft actor-critic in Cede and in the libraries that users would otherwise write it in.

pub mod burn;
pub mod candle;
pub mod cede;

use cede_train::driving::replay::Batch;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Whatever goes wrong in a peer.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Makes one update: labels from twin targets, both critics, the policy through the smaller critic, the
/// temperature, Adam, soft targets. Gives the mean of the two critics' losses.
pub type Update = Box<dyn FnMut() -> Result<f32, Failure>>;

/// Samples of a batch.
pub const BATCH: usize = 512;
/// Features of an observation.
pub const FEATURES: usize = 8;
/// Numbers of an action.
pub const ACTIONS: usize = 2;

/// Half the range of log σ, (−5, 2), and its middle.
const LOG_SIGMA: [f64; 2] = [3.5, -1.5];
/// ln √(2π) + 2·ln 2: what the log-density of a squashed action loses whatever the action.
const DENSITY: f64 = 0.918_938_533_204_672_7 + 2.0 * std::f64::consts::LN_2;

/// A dense layer.
struct Layer {
    /// Its inputs and outputs.
    shape: [usize; 2],
    /// Input by input the weights to each output.
    weights: Vec<f32>,
    /// One for each output.
    biases: Vec<f32>,
}

/// Three hidden layers of `width`, with weights at random.
fn layers(inputs: usize, width: usize, outputs: usize, random: &mut Pcg64) -> Vec<Layer> {
    let sizes = [inputs, width, width, width, outputs];
    sizes
        .windows(2)
        .map(|pair| {
            let bound = 1.0 / (pair[0] as f32).sqrt();
            let mut draw = |n| draw(n, bound, random);
            Layer {
                shape: [pair[0], pair[1]],
                weights: draw(pair[0] * pair[1]),
                biases: draw(pair[1]),
            }
        })
        .collect()
}

/// The batch that every learner is given.
#[must_use]
pub fn batch() -> Batch {
    let random = &mut Pcg64::seed_from_u64(1);
    Batch {
        observations: draw(BATCH * FEATURES, 1.0, random),
        actions: draw(BATCH * ACTIONS, 1.0, random),
        rewards: draw(BATCH, 1.0, random),
        next: draw(BATCH * FEATURES, 1.0, random),
        continues: vec![1.0; BATCH],
    }
}

/// `n` numbers in (−`bound`, `bound`).
fn draw(n: usize, bound: f32, random: &mut Pcg64) -> Vec<f32> {
    (0..n).map(|_| random.random_range(-bound..bound)).collect()
}
