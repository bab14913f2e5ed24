//! Claims in the loss: what `cede verify policy` will ask of a policy, as a cost of breaking it.
//!
//! Every update asks each claim at fresh states of its region (faces and corners more often than
//! chance would) and at hard ones, which climb to where the claim is broken the most: so training
//! meets the counterexamples that the verifier would find. A claim about slopes is asked by a
//! difference quotient of what the verifier bounds: the mean before the squashing, whose slope has
//! the sign of the acceleration's and three times of which is never less steep.

use crate::driving::inputs::Inputs;
use crate::driving::slopes::slopes;
use crate::nn::network::{Delta, Network, Tape};
use cede_controller::policy::MAX_ACCELERATION;
use cede_formats::property::{Claim, Place, Setting, StateProperty};
use rand::RngExt;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// How claims are learned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Weight of the claims' cost beside that of driving unlike the humans.
    pub weight: f32,
    /// What is asked beyond a claimed acceleration (m/s²), so that there is something left to prove.
    pub margin: f32,
    /// The same beyond a claimed slope (m/s² per metre or per m/s).
    pub slope_margin: f32,
    /// Fresh states of each claim in an update.
    pub fresh: usize,
    /// Hard states of each claim, kept from update to update.
    pub hard: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            weight: 3.0,
            margin: 0.2,
            slope_margin: 0.1,
            fresh: 16,
            hard: 16,
        }
    }
}

/// Half the step (m or m/s) of a difference quotient.
const HALF_STEP: f64 = 0.05;
/// Probability that a fresh state lies on a given side of its region.
const ON_A_SIDE: f32 = 0.25;
/// A hard state climbs by at most this share of the region's widths in an update.
const CLIMB: f64 = 0.1;
/// Probability that a hard state begins anew after an update.
const BEGINS_ANEW: f32 = 0.05;

/// The hard states of each claim: part of a run's progress.
pub type Hard = Vec<Vec<Place>>;

/// Claims that can be broken, each in one setting, ready to be asked.
#[derive(Clone, Debug, Default)]
pub struct Claims {
    questions: Vec<Question>,
    tape: Tape,
    delta: Delta,
}

/// One claim in one setting.
#[derive(Clone, Debug)]
struct Question {
    claim: Claim,
    region: [[f64; 2]; 4],
    setting: Setting,
}

/// The runs of the network that answer a question at a place: the claim's excess is
/// `sign`·(Σ share·a − limit), and it is broken where that is positive.
struct Answer {
    question: usize,
    place: Place,
    /// First of its rows.
    row: usize,
    /// Where the network is run, and the share of that acceleration.
    runs: Vec<(Place, f32)>,
    /// Whether the mean is squashed to an acceleration.
    squashed: bool,
    margin: f32,
}

impl Claims {
    /// The claims of `properties` that any policy could break at all.
    #[must_use]
    pub fn new(properties: &[StateProperty]) -> Self {
        let limit = f64::from(MAX_ACCELERATION);
        let open = properties.iter().filter(|property| match property.claim {
            Claim::AccelerationAtMost(most) => most < limit,
            Claim::AccelerationAtLeast(least) => least > -limit,
            Claim::RisesAtLeast { .. } | Claim::ChangesAtMost { .. } => true,
        });
        let questions = open.flat_map(|property| {
            property.settings().into_iter().map(|setting| Question {
                claim: property.claim,
                region: property.region(),
                setting,
            })
        });
        Self {
            questions: questions.collect(),
            ..Self::default()
        }
    }

    /// Adds the derivatives of the claims' cost (for each claim and setting the mean shortfall from
    /// the claim with its margin) with respect to the parameters to `gradient`, moves the hard
    /// states on, and returns the cost. Costs a run of the network and two ways back for each state.
    pub fn learn(
        &mut self,
        settings: &Settings,
        network: &Network,
        inputs: &Inputs,
        hard: &mut Hard,
        random: &mut Pcg64,
        gradient: &mut [f32],
    ) -> f32 {
        if self.questions.is_empty() {
            return 0.0;
        }
        hard.resize_with(self.questions.len(), Vec::new);
        let (mut answers, mut rows, mut runs) = (Vec::new(), Vec::new(), 0);
        for (question, hard) in hard.iter_mut().enumerate() {
            let asked = &self.questions[question];
            hard.resize_with(settings.hard, || asked.fresh(random));
            let fresh = (0..settings.fresh).map(|_| asked.fresh(random));
            for place in hard.iter().copied().chain(fresh) {
                let answer = asked.ask(question, place, runs, settings);
                for (place, _) in &answer.runs {
                    inputs.append(&asked.setting.pair(*place), &mut rows);
                }
                runs += answer.runs.len();
                answers.push(answer);
            }
        }
        let output = network.forward(&rows, &mut self.tape);
        let width = output.len() / runs.max(1);
        // What each run counts, and its derivative by the mean.
        let counted: Vec<(f32, f32)> = answers
            .iter()
            .flat_map(|answer| answer.runs.iter().map(|_| answer.squashed))
            .zip(output.chunks_exact(width.max(1)))
            .map(|(squashed, row)| count(row[0], squashed))
            .collect();
        let excesses: Vec<(f32, f32)> = answers
            .iter()
            .map(|answer| answer.excess(&self.questions[answer.question].claim, &counted))
            .collect();

        let share = settings.weight / (settings.hard + settings.fresh).max(1) as f32;
        let mut cost = 0.0;
        let fill = |delta: &mut Delta, weight: &dyn Fn(usize) -> f32| {
            delta.values.clear();
            delta.values.resize(runs * width, 0.0);
            for (k, answer) in answers.iter().enumerate() {
                for (i, (_, part)) in answer.runs.iter().enumerate() {
                    let row = answer.row + i;
                    delta.values[row * width] = weight(k) * part * counted[row].1;
                }
            }
        };
        for (answer, (excess, _)) in answers.iter().zip(&excesses) {
            cost += share * (excess + answer.margin).max(0.0);
        }
        fill(&mut self.delta, &|k| {
            let (excess, sign) = excesses[k];
            if excess + answers[k].margin > 0.0 {
                share * sign
            } else {
                0.0
            }
        });
        network.backward(&self.tape, &mut self.delta, Some(gradient));

        fill(&mut self.delta, &|k| excesses[k].1);
        network.backward(&self.tape, &mut self.delta, None);
        let mut answers = answers.iter().zip(&excesses);
        for (question, hard) in self.questions.iter().zip(hard) {
            let mut hardest = f32::NEG_INFINITY;
            let mut easiest = (f32::INFINITY, 0);
            for (slot, (answer, (excess, _))) in answers.by_ref().take(settings.hard).enumerate() {
                if *excess < easiest.0 {
                    easiest = (*excess, slot);
                }
                let up = answer.uphill(question, inputs, &self.delta);
                hard[slot] = if random.random::<f32>() < BEGINS_ANEW {
                    question.fresh(random)
                } else {
                    question.climbed(answer.place, up, random)
                };
            }
            for (answer, (excess, _)) in answers.by_ref().take(settings.fresh) {
                if *excess > hardest.max(easiest.0) && settings.hard > 0 {
                    hardest = *excess;
                    hard[easiest.1] = answer.place;
                }
            }
        }
        cost
    }
}

/// The acceleration (m/s²) of a mean, or what bounds its slope, and the derivative by the mean.
fn count(mean: f32, squashed: bool) -> (f32, f32) {
    if squashed {
        let a = MAX_ACCELERATION * libm::tanhf(mean);
        (a, MAX_ACCELERATION - a * a / MAX_ACCELERATION)
    } else {
        (MAX_ACCELERATION * mean, MAX_ACCELERATION)
    }
}

impl Question {
    /// A random state of the region.
    fn fresh(&self, random: &mut Pcg64) -> Place {
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

    fn ask(&self, question: usize, place: Place, row: usize, settings: &Settings) -> Answer {
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
        Answer {
            question,
            place,
            row,
            runs,
            squashed,
            margin,
        }
    }

    /// A step from `place` in the direction `up`, within the region.
    fn climbed(&self, place: Place, up: [f32; 4], random: &mut Pcg64) -> Place {
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

impl Answer {
    /// By how much the claim is broken, and the sign of its dependence on the weighted sum of
    /// what its runs count.
    fn excess(&self, claim: &Claim, counted: &[(f32, f32)]) -> (f32, f32) {
        let runs = self.runs.iter().zip(&counted[self.row..]);
        let value: f32 = runs.map(|((_, share), (a, _))| share * a).sum();
        match *claim {
            Claim::AccelerationAtMost(most) => (value - most as f32, 1.0),
            Claim::AccelerationAtLeast(least) => (least as f32 - value, -1.0),
            Claim::RisesAtLeast { slope, .. } => (slope as f32 - value, -1.0),
            Claim::ChangesAtMost { slope, .. } => (value.abs() - slope as f32, value.signum()),
        }
    }

    /// The derivatives of the excess with respect to the place, from those with respect to the
    /// network's inputs.
    fn uphill(&self, question: &Question, inputs: &Inputs, delta: &Delta) -> [f32; 4] {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nn::adam::Adam;
    use cede_controller::FeatureSet;
    use cede_formats::property::Properties;
    use rand::SeedableRng;

    fn properties() -> Vec<StateProperty> {
        let property = |id: &str, claim: &str| {
            format!(
                "[[property]]\nid = \"{id}\"\ntitle = \"\"\nego_distance = [10, 20]\nego_speed = [3, 7]\n\
                 other_distance = [2, 8]\nother_speed = [4, 8]\nconflicts = [\"crossing\"]\n\
                 right_of_way = [\"other\"]\nclaim = {claim}\n"
            )
        };
        let text = property("SR-1", "{ acceleration_at_most = -0.5 }")
            + &property("SR-2", "{ acceleration_at_least = -2 }")
            + &property(
                "SR-3",
                "{ rises_at_least = { with = \"other_distance\", slope = 0 } }",
            )
            + &property(
                "SR-4",
                "{ changes_at_most = { with = \"ego_speed\", slope = 0.2 } }",
            )
            + &property("SR-5", "{ acceleration_at_most = 3 }");
        Properties::read(&text).unwrap().property
    }

    fn inputs() -> Inputs {
        let settings = properties()[0].settings();
        let pairs: Vec<_> = (0..50)
            .map(|i| settings[0].pair([i.into(), 4.0, (60 - i).into(), f64::from(i % 9)]))
            .collect();
        Inputs::fit(FeatureSet::Scene, &pairs)
    }

    fn network(seed: u64) -> Network {
        let count = FeatureSet::Scene.count();
        Network::new(&[count, 16, 16, 16, 4], &mut Pcg64::seed_from_u64(seed))
    }

    #[test]
    fn the_gradient_agrees_with_finite_differences() {
        let settings = Settings {
            fresh: 20,
            ..Settings::default()
        };
        let (mut network, inputs) = (network(1), inputs());
        let mut claims = Claims::new(&properties());
        assert_eq!(claims.questions.len(), 4, "3 m/s² cannot be exceeded");
        let mut learn = |network: &Network, gradient: &mut [f32]| {
            let (mut hard, mut random) = (Hard::new(), Pcg64::seed_from_u64(5));
            claims.learn(
                &settings,
                network,
                &inputs,
                &mut hard,
                &mut random,
                gradient,
            )
        };
        let mut gradient = vec![0.0; network.parameters().len()];
        learn(&network, &mut gradient);
        let last = gradient.len() - 4;
        for parameter in [3, 500, 700, last - 64 * 4 / 4, last] {
            let (old, h) = (network.parameters()[parameter], 2e-3);
            let mut at = |x: f32| {
                network.parameters_mut()[parameter] = x;
                learn(&network, &mut vec![0.0; gradient.len()])
            };
            let expected = (at(old + h) - at(old - h)) / (2.0 * h);
            at(old);
            let error = (gradient[parameter] - expected).abs();
            assert!(
                error < 0.02 * (0.1 + expected.abs()),
                "{parameter}: {} against {expected}",
                gradient[parameter]
            );
        }
    }

    #[test]
    fn a_network_learns_what_is_claimed_and_hard_states_stay_in_their_regions() {
        let (mut network, inputs) = (network(2), inputs());
        let (mut claims, settings) = (Claims::new(&properties()), Settings::default());
        let (mut hard, mut random) = (Hard::new(), Pcg64::seed_from_u64(6));
        let mut adam = Adam::new(network.parameters().len());
        let mut costs = Vec::new();
        for _ in 0..400 {
            let mut gradient = vec![0.0; network.parameters().len()];
            let cost = claims.learn(
                &settings,
                &network,
                &inputs,
                &mut hard,
                &mut random,
                &mut gradient,
            );
            adam.step(network.parameters_mut(), &gradient, 2e-3);
            costs.push(cost);
        }
        assert!(
            costs[0] > 0.5 && costs[399] < 0.02,
            "{} {}",
            costs[0],
            costs[399]
        );
        for (question, hard) in claims.questions.iter().zip(&hard) {
            let within = |place: &Place| {
                let sides = place.iter().zip(question.region);
                sides.into_iter().all(|(x, [lo, hi])| (lo..=hi).contains(x))
            };
            assert!(hard.len() == settings.hard && hard.iter().all(within));
        }
    }
}
