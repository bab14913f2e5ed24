//! Properties in the loss: the violation of the claims that `cede verify policy` checks, as a cost.
//!
//! Every update evaluates each claim at random states of its region, with faces and corners
//! over-represented, and at adversarial states, which climb towards the largest violation by
//! gradient ascent. Training thus meets the counterexamples that the verifier would find. A claim
//! about a slope is evaluated as a difference quotient of the mean before the squashing, because the
//! verifier bounds that slope: it has the sign of the acceleration's slope, and three times it is at
//! least as steep.

mod question;

use crate::algorithm::apg::claims::question::{Probe, Question, term};
use crate::algorithm::apg::settings::ClaimSettings;
use crate::driving::inputs::Inputs;
use crate::nn::network::{Delta, Network, Tape};
use cede_formats::property::{Place, StateProperty};
use rand::RngExt;
use rand_pcg::Pcg64;

/// Probability that an adversarial state is replaced by a random one after an update.
const RESTART: f32 = 0.05;

/// The adversarial states of each claim; part of a run's progress.
pub type AdversarialStates = Vec<Vec<Place>>;

/// The claims of all properties, with the buffers for their evaluation.
#[derive(Clone, Debug, Default)]
pub struct Claims {
    questions: Vec<Question>,
    tape: Tape,
    delta: Delta,
}

impl Claims {
    /// The claims of `properties` that a policy can violate.
    #[must_use]
    pub fn new(properties: &[StateProperty]) -> Self {
        Self {
            questions: properties.iter().flat_map(Question::all).collect(),
            ..Self::default()
        }
    }

    /// Returns the cost of violating the claims: for each claim and setting the mean violation
    /// including the margin. Adds its derivatives with respect to the parameters to `gradient`, and
    /// moves the adversarial states.
    ///
    /// Takes one forward and two backward passes for each state.
    pub fn learn(
        &mut self,
        settings: &ClaimSettings,
        network: &Network,
        inputs: &Inputs,
        adversarial: &mut AdversarialStates,
        random: &mut Pcg64,
        gradient: &mut [f32],
    ) -> f32 {
        if self.questions.is_empty() {
            return 0.0;
        }
        adversarial.resize_with(self.questions.len(), Vec::new);
        let (probes, rows) = self.probes(settings, inputs, adversarial, random);
        let output = network.forward(&rows, &mut self.tape);
        let runs: usize = probes.iter().map(|probe| probe.runs.len()).sum();
        let width = output.len() / runs.max(1);
        let terms: Vec<(f32, f32)> = probes
            .iter()
            .flat_map(|probe| probe.runs.iter().map(|_| probe.squashed))
            .zip(output.chunks_exact(width.max(1)))
            .map(|(squashed, row)| term(row[0], squashed))
            .collect();
        let violations: Vec<(f32, f32)> = probes
            .iter()
            .map(|probe| probe.violation(&self.questions[probe.question], &terms))
            .collect();

        let share = settings.weight / (settings.hard + settings.fresh).max(1) as f32;
        let mut cost = 0.0;
        for (probe, (violation, _)) in probes.iter().zip(&violations) {
            cost += share * (violation + probe.margin).max(0.0);
        }
        // The derivatives of Σ weight(k)·sum(k) over all probes k with respect to the outputs.
        let fill = |delta: &mut Delta, weight: &dyn Fn(usize) -> f32| {
            delta.values.clear();
            delta.values.resize(runs * width, 0.0);
            for (k, probe) in probes.iter().enumerate() {
                for (i, (_, part)) in probe.runs.iter().enumerate() {
                    let row = probe.row + i;
                    delta.values[row * width] = weight(k) * part * terms[row].1;
                }
            }
        };
        fill(&mut self.delta, &|k| {
            let (violation, sign) = violations[k];
            if violation + probes[k].margin > 0.0 {
                share * sign
            } else {
                0.0
            }
        });
        network.backward(&self.tape, &mut self.delta, Some(gradient));

        fill(&mut self.delta, &|k| violations[k].1);
        network.backward(&self.tape, &mut self.delta, None);
        self.climb(settings, inputs, &probes, &violations, adversarial, random);
        cost
    }

    /// The evaluations of every claim, first at its adversarial, then at new random states, and the
    /// network's inputs for them.
    fn probes(
        &self,
        settings: &ClaimSettings,
        inputs: &Inputs,
        adversarial: &mut AdversarialStates,
        random: &mut Pcg64,
    ) -> (Vec<Probe>, Vec<f32>) {
        let (mut probes, mut rows, mut runs) = (Vec::new(), Vec::new(), 0);
        for (index, (question, adversarial)) in self.questions.iter().zip(adversarial).enumerate() {
            adversarial.resize_with(settings.hard, || question.random_state(random));
            let fresh = (0..settings.fresh).map(|_| question.random_state(random));
            for place in adversarial.iter().copied().chain(fresh) {
                let probe = question.probe(index, place, runs, settings);
                for (place, _) in &probe.runs {
                    inputs.append(&question.setting.pair(*place), &mut rows);
                }
                runs += probe.runs.len();
                probes.push(probe);
            }
        }
        (probes, rows)
    }

    /// Moves every adversarial state a step of gradient ascent, or replaces it by a random state. A
    /// random state of this update with a larger violation replaces the weakest adversarial one.
    fn climb(
        &self,
        settings: &ClaimSettings,
        inputs: &Inputs,
        probes: &[Probe],
        violations: &[(f32, f32)],
        adversarial: &mut AdversarialStates,
        random: &mut Pcg64,
    ) {
        let mut probes = probes.iter().zip(violations);
        for (question, adversarial) in self.questions.iter().zip(adversarial) {
            let mut weakest = (f32::INFINITY, 0);
            for (slot, (probe, (violation, _))) in probes.by_ref().take(settings.hard).enumerate() {
                if *violation < weakest.0 {
                    weakest = (*violation, slot);
                }
                let up = probe.uphill(question, inputs, &self.delta);
                adversarial[slot] = if random.random::<f32>() < RESTART {
                    question.random_state(random)
                } else {
                    question.climbed(probe.place, up, random)
                };
            }
            let mut strongest = f32::NEG_INFINITY;
            for (probe, (violation, _)) in probes.by_ref().take(settings.fresh) {
                if *violation > strongest.max(weakest.0) && settings.hard > 0 {
                    strongest = *violation;
                    adversarial[weakest.1] = probe.place;
                }
            }
        }
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
        let settings = ClaimSettings {
            fresh: 20,
            ..ClaimSettings::default()
        };
        let (mut network, inputs) = (network(1), inputs());
        let mut claims = Claims::new(&properties());
        assert_eq!(claims.questions.len(), 4, "3 m/s² cannot be exceeded");
        let mut learn = |network: &Network, gradient: &mut [f32]| {
            let (mut adversarial, mut random) = (AdversarialStates::new(), Pcg64::seed_from_u64(5));
            claims.learn(
                &settings,
                network,
                &inputs,
                &mut adversarial,
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
    fn a_network_learns_the_claims_and_adversarial_states_stay_in_their_regions() {
        let (mut network, inputs) = (network(2), inputs());
        let (mut claims, settings) = (Claims::new(&properties()), ClaimSettings::default());
        let (mut adversarial, mut random) = (AdversarialStates::new(), Pcg64::seed_from_u64(6));
        let mut adam = Adam::new(network.parameters().len());
        let mut costs = Vec::new();
        for _ in 0..400 {
            let mut gradient = vec![0.0; network.parameters().len()];
            let cost = claims.learn(
                &settings,
                &network,
                &inputs,
                &mut adversarial,
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
        for (question, states) in claims.questions.iter().zip(&adversarial) {
            let within = |place: &Place| {
                let sides = place.iter().zip(question.region);
                sides.into_iter().all(|(x, [lo, hi])| (lo..=hi).contains(x))
            };
            assert!(states.len() == settings.hard && states.iter().all(within));
        }
    }
}
