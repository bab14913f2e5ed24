//! The differentiable closed loop: two vehicles driven by one network for some steps, and the way back.

use crate::algorithm::apg::cost::{ByStates, Cost};
use crate::driving::inputs::Inputs;
use crate::driving::slopes::slopes;
use crate::driving::states;
use crate::nn::network::{Delta, Network, Tape};
use cede_controller::Pair;
use cede_controller::kinematics::{STEP, State};
use cede_controller::policy::{acceleration, acceleration_slope};
use cede_sim::ObservationModel;
use cede_sim::stepper::advance;
use serde::{Deserialize, Serialize};

/// Where one place of a batch begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Which encounter.
    pub encounter: usize,
    /// Steps since its start.
    pub step: usize,
    /// The two vehicles' states.
    #[serde(with = "states")]
    pub states: [State; 2],
}

/// What places are to be driven like.
#[derive(Clone, Copy, Debug)]
pub struct Aim<'a> {
    /// What it costs to drive unlike the humans.
    pub cost: &'a Cost,
    /// Encounters of a lower number are driven like the humans, all others like the former network.
    pub own: usize,
    /// The former network, if there is one.
    pub former: Option<Former<'a>>,
}

/// A network that another one is not to depart from.
#[derive(Clone, Copy, Debug)]
pub struct Former<'a> {
    /// It sees what the other one sees.
    pub network: &'a Network,
    /// Weight of the squared departure from each of its accelerations, in s⁴/m².
    pub weight: f32,
}

/// One roll-out of a batch and its way back.
#[derive(Clone, Debug, Default)]
pub struct ClosedLoop {
    steps: Vec<Step>,
    last: Vec<[State; 2]>,
    inputs: Vec<f32>,
    delta: Delta,
    /// What the former network makes of a step.
    former: Tape,
}

/// One step of a batch.
#[derive(Clone, Debug, Default)]
struct Step {
    /// States before the step.
    states: Vec<[State; 2]>,
    /// What each vehicle saw.
    pairs: Vec<[Pair; 2]>,
    tape: Tape,
    /// For each vehicle its own acceleration and the one that it expects of the other.
    commands: Vec<[[f32; 2]; 2]>,
}

impl ClosedLoop {
    /// Drives every place for `horizon` steps with `network`, each vehicle from its own perspective.
    pub fn drive(
        &mut self,
        network: &Network,
        inputs: &Inputs,
        models: &[ObservationModel<'_>],
        places: &[Start],
        horizon: usize,
    ) {
        self.steps.resize_with(horizon, Step::default);
        self.last.clear();
        self.last.extend(places.iter().map(|place| place.states));
        let mut svo = vec![ObservationModel::FIRST_SVO; places.len()];
        for (t, step) in self.steps.iter_mut().enumerate() {
            step.states.clone_from(&self.last);
            step.pairs.clear();
            self.inputs.clear();
            for (place, (states, svo)) in places.iter().zip(step.states.iter().zip(&mut svo)) {
                let pairs = models[place.encounter].pairs(place.step + t, *states, *svo);
                *svo = pairs[0].svo();
                pairs
                    .iter()
                    .for_each(|pair| inputs.append(pair, &mut self.inputs));
                step.pairs.push(pairs);
            }
            let output = network.forward(&self.inputs, &mut step.tape);
            let command = |row: &[f32]| [row[0], row[1]].map(acceleration);
            let width = output.len() / (2 * places.len());
            step.commands.clear();
            let both = output.chunks_exact(2 * width);
            step.commands
                .extend(both.map(|row| [command(&row[..width]), command(&row[width..])]));
            for (states, commands) in self.last.iter_mut().zip(&step.commands) {
                advance(states, &commands.map(|[own, _]| own));
            }
        }
    }

    /// The states after the last step.
    #[must_use]
    pub fn last(&self) -> &[[State; 2]] {
        &self.last
    }

    /// Adds the derivatives of the places' total cost (each the mean over its steps) with respect to
    /// the network's parameters to `gradient`, and returns that cost. To follow [`ClosedLoop::drive`]
    /// with the same arguments.
    pub fn back(
        &mut self,
        network: &Network,
        inputs: &Inputs,
        models: &[ObservationModel<'_>],
        places: &[Start],
        aim: &Aim<'_>,
        gradient: &mut [f32],
    ) -> f32 {
        let horizon = self.steps.len();
        let share = 1.0 / horizon as f32;
        let width = network.sizes()[network.sizes().len() - 1];
        let mut total = 0.0;
        let mut by = vec![ByStates::default(); places.len()];
        for t in (0..horizon).rev() {
            let (step, after) = (&self.steps[t], self.steps.get(t + 1));
            let after = after.map_or(&self.last, |next| &next.states);
            let held = aim
                .former
                .filter(|_| places.iter().any(|place| place.encounter >= aim.own));
            if let Some(former) = held {
                former.network.forward(step.tape.input(), &mut self.former);
            }
            self.delta.values.clear();
            for (k, place) in places.iter().enumerate() {
                let by_commands = if place.encounter < aim.own {
                    let encounter = models[place.encounter].encounter;
                    let step_of = place.step + t + 1;
                    total += share * aim.cost.of(encounter, step_of, after[k], share, &mut by[k]);
                    step.by_commands(k, aim.cost.expectation * share, &mut by[k])
                } else if let Some(former) = held {
                    let rows = self.former.output()[2 * k * width..].chunks_exact(width);
                    let (cost, by) = step.departure(k, rows, former.weight * share);
                    total += cost;
                    by
                } else {
                    Default::default()
                };
                for (by, commands) in by_commands.iter().zip(&step.commands[k]) {
                    let both = by.iter().zip(commands);
                    self.delta
                        .values
                        .extend(both.map(|(by, a)| by * acceleration_slope(*a)));
                    self.delta.values.extend((2..width).map(|_| 0.0));
                }
            }
            network.backward(&step.tape, &mut self.delta, Some(gradient));
            self.delta.to_states(inputs, &step.pairs, &mut by);
        }
        total
    }
}

impl Step {
    /// Derivatives of the costs of place `k` with respect to what each vehicle commands and expects,
    /// and `by` taken from the states after the step to those before it.
    fn by_commands(&self, k: usize, expectation: f32, by: &mut ByStates) -> [[f32; 2]; 2] {
        let commands = self.commands[k];
        std::array::from_fn(|i| {
            let [own, expected] = commands[i];
            let (by_state, by_own) = through(self.states[k][i], own, by[i]);
            by[i] = by_state;
            let surprise = expected - commands[1 - i][0];
            [by_own, 2.0 * expectation * surprise]
        })
    }

    /// What it costs in place `k` to depart from the commands whose means are in `rows`, and the
    /// derivatives with respect to what each vehicle commands and expects.
    fn departure<'r>(
        &self,
        k: usize,
        rows: impl Iterator<Item = &'r [f32]>,
        weight: f32,
    ) -> (f32, [[f32; 2]; 2]) {
        let (mut cost, mut by) = (0.0, [[0.0; 2]; 2]);
        for ((commands, row), by) in self.commands[k].iter().zip(rows).zip(&mut by) {
            for ((command, mean), by) in commands.iter().zip(row).zip(by) {
                let apart = command - acceleration(*mean);
                cost += weight * apart * apart;
                *by = 2.0 * weight * apart;
            }
        }
        (cost, by)
    }
}

impl Delta {
    /// Takes derivatives with respect to a network's inputs on to the states that `pairs` show.
    fn to_states(&self, inputs: &Inputs, pairs: &[[Pair; 2]], by: &mut [ByStates]) {
        let count = inputs.scales.len();
        let mut rows = self.values.chunks_exact(count);
        for (pairs, by) in pairs.iter().zip(by) {
            for (i, pair) in pairs.iter().enumerate() {
                let slopes = slopes(inputs.features(), pair);
                let scaled = rows.next().unwrap_or(&[]).iter().zip(&inputs.scales);
                let mut sums = [0.0; 4];
                for ((d, scale), slope) in scaled.zip(slopes) {
                    for (sum, slope) in sums.iter_mut().zip(slope) {
                        *sum += d * scale * slope;
                    }
                }
                // A vehicle's distance to its conflict point shrinks as its arc length grows.
                by[i][0] -= sums[0];
                by[i][1] += sums[1];
                by[1 - i][0] -= sums[2];
                by[1 - i][1] += sums[3];
            }
        }
    }
}

/// Derivatives before a step of the kinematics, with respect to (s, v) and to the acceleration, from
/// those after it.
///
/// A vehicle that comes to rest within the step does not answer to a small change of its
/// acceleration; if the cost calls for more speed, the derivative passes all the same (a
/// straight-through estimate), or else no network would learn to leave a place where it stands.
fn through(state: State, acceleration: f32, by: [f32; 2]) -> ([f32; 2], f32) {
    let [by_s, by_v] = by;
    let by_acceleration = by_s * 0.5 * STEP * STEP + by_v * STEP;
    if state.v + acceleration * STEP >= 0.0 {
        return ([by_s, by_s * STEP + by_v], by_acceleration);
    }
    let wanted = if by_acceleration < 0.0 {
        by_acceleration
    } else {
        0.0
    };
    ([by_s, by_s * state.v / -acceleration], wanted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::FeatureSet;
    use cede_data::Dataset;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    /// The cost of driving a few places for some steps with a small network, and its gradient.
    fn cost(
        dataset: &Dataset,
        [network, former]: [&Network; 2],
        own: usize,
        steps: usize,
    ) -> (f32, Vec<f32>) {
        let models: Vec<ObservationModel<'_>> = dataset
            .encounters
            .iter()
            .map(ObservationModel::new)
            .collect();
        let pairs: Vec<Pair> = models.iter().flat_map(ObservationModel::recorded).collect();
        let inputs = Inputs::fit(FeatureSet::Route, &pairs);
        let places: Vec<Start> = (0..12)
            .map(|encounter| Start {
                encounter,
                step: 0,
                // Fast enough not to come to rest, where the derivative is an estimate.
                states: [0, 1].map(|i| State {
                    s: dataset.encounters[encounter].participants[i].record[0].s,
                    v: 6.0 + encounter as f32 / 8.0,
                }),
            })
            .collect();
        let cost = Cost {
            // What the other does is taken as given there.
            expectation: 0.0,
            ..Cost::default()
        };
        let former = Some(Former {
            network: former,
            weight: 2.0,
        });
        let aim = Aim {
            cost: &cost,
            own,
            former,
        };
        let (mut loops, mut gradient) =
            (ClosedLoop::default(), vec![0.0; network.parameters().len()]);
        loops.drive(network, &inputs, &models, &places, steps);
        let total = loops.back(network, &inputs, &models, &places, &aim, &mut gradient);
        (total, gradient)
    }

    fn network(seed: u64) -> Network {
        let count = FeatureSet::Route.count();
        Network::new(&[count, 16, 16, 16, 4], &mut Pcg64::seed_from_u64(seed))
    }

    fn assert_gradient(own: usize, steps: usize) {
        let dataset = Dataset::synthetic(12, 3);
        let (mut network, former) = (network(1), network(2));
        let (_, gradient) = cost(&dataset, [&network, &former], own, steps);
        let last = gradient.len() - 4;
        for parameter in [5, 100, 300, 600, last - 30, last - 60, last] {
            let (old, h) = (network.parameters()[parameter], 5e-3);
            let mut at = |x: f32| {
                network.parameters_mut()[parameter] = x;
                cost(&dataset, [&network, &former], own, steps).0
            };
            let expected = (at(old + h) - at(old - h)) / (2.0 * h);
            at(old);
            let error = (gradient[parameter] - expected).abs();
            assert!(
                error < 0.02 * (0.1 + expected.abs()),
                "parameter {parameter}: {} against {expected}",
                gradient[parameter]
            );
        }
    }

    #[test]
    fn the_gradient_of_driving_like_the_humans_agrees_with_finite_differences() {
        assert_gradient(usize::MAX, 4);
    }

    #[test]
    fn the_gradient_of_driving_like_the_former_network_agrees_with_finite_differences() {
        // One step: where it is held, the network does not answer for the states it gets into.
        assert_gradient(0, 1);
    }

    #[test]
    fn driving_as_before_costs_nothing() {
        let network = network(3);
        let dataset = Dataset::synthetic(12, 3);
        let (total, gradient) = cost(&dataset, [&network, &network], 0, 4);
        assert!(total == 0.0 && gradient.iter().all(|g| *g == 0.0));
    }
}
