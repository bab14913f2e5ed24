//! One claim in one setting: where the network is evaluated for it, and by how much it is violated.

use crate::algorithm::apg::settings::ClaimSettings;
use crate::driving::inputs::Inputs;
use crate::driving::slopes::slopes;
use crate::nn::network::Delta;
use cede_controller::policy::{MAX_ACCELERATION, acceleration, acceleration_slope};
use cede_formats::property::{Claim, Place, Setting, StateProperty};
use rand::RngExt;
use rand_pcg::Pcg64;

/// Half the width (m or m/s) of a difference quotient.
const HALF_STEP: f64 = 0.05;
/// Probability that a coordinate of a random state is at the lower end of its range; the same for the upper.
const ON_A_SIDE: f32 = 0.25;
/// Longest step of gradient ascent, as a share of the region's width in each coordinate.
const CLIMB: f64 = 0.1;

/// One claim in one setting.
#[derive(Clone, Debug)]
pub(super) struct Question {
    claim: Claim,
    pub(super) region: [[f64; 2]; 4],
    pub(super) setting: Setting,
}

/// The evaluations of the network that decide a claim at one state. The claim's violation is
/// `sign`·(Σ share·a − limit); the claim is violated where this is positive.
pub(super) struct Probe {
    /// Index of the question.
    pub(super) question: usize,
    pub(super) place: Place,
    /// Index of its first row in the batch.
    pub(super) row: usize,
    /// The states at which the network is evaluated, each with its share of the sum.
    pub(super) runs: Vec<(Place, f32)>,
    /// Whether the sum is over accelerations, or over means before the squashing.
    pub(super) squashed: bool,
    pub(super) margin: f32,
}

/// The term of the sum for a network's mean, and its derivative with respect to the mean: the
/// acceleration (m/s²) if `squashed`, otherwise the scaled mean, which bounds the acceleration's slope.
pub(super) fn term(mean: f32, squashed: bool) -> (f32, f32) {
    if squashed {
        let a = acceleration(mean);
        (a, acceleration_slope(a))
    } else {
        (MAX_ACCELERATION * mean, MAX_ACCELERATION)
    }
}

impl Question {
    /// The claims of `property` in all its settings. Claims that no policy can violate are left out.
    pub(super) fn all(property: &StateProperty) -> Vec<Self> {
        let limit = f64::from(MAX_ACCELERATION);
        let falsifiable = match property.claim {
            Claim::AccelerationAtMost(most) => most < limit,
            Claim::AccelerationAtLeast(least) => least > -limit,
            Claim::RisesAtLeast { .. } | Claim::ChangesAtMost { .. } => true,
        };
        let settings = property.settings().into_iter().filter(|_| falsifiable);
        settings
            .map(|setting| Self {
                claim: property.claim,
                region: property.region(),
                setting,
            })
            .collect()
    }

    /// A random state of the region.
    pub(super) fn random_state(&self, random: &mut Pcg64) -> Place {
        self.region.map(|[least, most]| {
            let side: f32 = random.random();
            if side < ON_A_SIDE {
                least
            } else if side < 2.0 * ON_A_SIDE {
                most
            } else {
                least + (most - least) * random.random::<f64>()
            }
        })
    }

    /// The evaluations for `place`; `question` is the index of this question, `row` that of the first
    /// evaluation in the batch.
    pub(super) fn probe(
        &self,
        question: usize,
        place: Place,
        row: usize,
        settings: &ClaimSettings,
    ) -> Probe {
        let (runs, squashed, margin) = match self.claim {
            Claim::AccelerationAtMost(_) | Claim::AccelerationAtLeast(_) => {
                (vec![(place, 1.0)], true, settings.margin)
            }
            Claim::RisesAtLeast { with, .. } | Claim::ChangesAtMost { with, .. } => {
                let [least, most] = self.region[with.index()];
                let at = |x: f64| {
                    let mut moved = place;
                    moved[with.index()] = x.clamp(least, most);
                    moved
                };
                let x = place[with.index()];
                let (low, high) = (at(x - HALF_STEP), at(x + HALF_STEP));
                let step = (high[with.index()] - low[with.index()]).max(1e-3) as f32;
                (
                    vec![(low, -1.0 / step), (high, 1.0 / step)],
                    false,
                    settings.slope_margin,
                )
            }
        };
        Probe {
            question,
            place,
            row,
            runs,
            squashed,
            margin,
        }
    }

    /// A step from `place` in the direction `up`, within the region.
    pub(super) fn climbed(&self, place: Place, up: [f32; 4], random: &mut Pcg64) -> Place {
        let length = CLIMB * random.random::<f64>();
        std::array::from_fn(|i| {
            let [least, most] = self.region[i];
            let step = if up[i] == 0.0 {
                0.0
            } else {
                length * (most - least) * f64::from(up[i].signum())
            };
            (place[i] + step).clamp(least, most)
        })
    }
}

impl Probe {
    /// The violation of the claim, and the sign of its dependence on the sum. `terms` has the term of
    /// every row in the batch.
    pub(super) fn violation(&self, question: &Question, terms: &[(f32, f32)]) -> (f32, f32) {
        let runs = self.runs.iter().zip(&terms[self.row..]);
        let value: f32 = runs.map(|((_, share), (a, _))| share * a).sum();
        match question.claim {
            Claim::AccelerationAtMost(most) => (value - most as f32, 1.0),
            Claim::AccelerationAtLeast(least) => (least as f32 - value, -1.0),
            Claim::RisesAtLeast { slope, .. } => (slope as f32 - value, -1.0),
            Claim::ChangesAtMost { slope, .. } => (value.abs() - slope as f32, value.signum()),
        }
    }

    /// The derivatives of the violation with respect to the state; `delta` has those with respect to
    /// the network's inputs.
    pub(super) fn uphill(&self, question: &Question, inputs: &Inputs, delta: &Delta) -> [f32; 4] {
        let count = inputs.scales.len();
        let mut up = [0.0; 4];
        for (i, (place, _)) in self.runs.iter().enumerate() {
            let start = (self.row + i) * count;
            let by_inputs = delta.values[start..start + count].iter();
            let pair = question.setting.pair(*place);
            let scaled = by_inputs.zip(&inputs.scales);
            for ((d, scale), slope) in scaled.zip(slopes(inputs.features(), &pair)) {
                for (up, slope) in up.iter_mut().zip(slope) {
                    *up += d * scale * slope;
                }
            }
        }
        up
    }
}
