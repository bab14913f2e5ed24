//! Adversarial campaigns: others that try to make a shielded vehicle collide, within the contract.
//!
//! One vehicle (or every one) is driven by a careless proposer behind a [`Shield`];
//! the others do their worst: random, bang-bang, or aimed at it. Commands come late, sensors err and
//! black out, all within the contract. An overlap, as rapier2d sees it, is then the shield's fault.

mod adversary;
mod scenario;

pub use scenario::{Scenario, Setup};

use crate::judge::Judge;
use crate::stepper;
use adversary::Adversary;
use cede_controller::dangerous::{Rules, Sound};
use cede_controller::kinematics::{STEP, State};
use cede_controller::{Cause, Decision, Fault, Footprint, Observation, Shield, Vehicle};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// Most other vehicles of a scenario.
pub const OTHERS: usize = cede_controller::MAX_OTHERS;

/// What a campaign saw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Scenarios that were run: those that begin with a verified plan.
    pub scenarios: u64,
    /// Steps of shielded vehicles.
    pub steps: u64,
    /// Scenarios in which a shielded vehicle overlapped with another.
    pub overlaps: u64,
    /// Steps without a verified plan although every motion is within the contract.
    pub unverified: u64,
    /// Steps at which somebody was said to have broken the contract, although nobody did.
    pub false_breaches: u64,
    /// Steps at which the shield intervened.
    pub interventions: u64,
    /// Scenarios in which every shielded vehicle had passed all its zones at the end.
    pub cleared: u64,
}

impl Tally {
    /// Both together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            scenarios: self.scenarios + other.scenarios,
            steps: self.steps + other.steps,
            overlaps: self.overlaps + other.overlaps,
            unverified: self.unverified + other.unverified,
            false_breaches: self.false_breaches + other.false_breaches,
            interventions: self.interventions + other.interventions,
            cleared: self.cleared + other.cleared,
        }
    }
}

/// Runs `scenarios` scenarios of `setup` with shields of rules `R`; scenario number i has seed `seed` + i.
///
/// rapier2d judges every step ([`Judge`]). The same seed gives the same tally on any number of threads.
#[must_use]
pub fn campaign<R: Rules>(setup: Setup, scenarios: u64, seed: u64) -> Tally {
    run_all::<R>(setup, scenarios, seed, true)
}

/// [`campaign`] with the shield switched off: the proposals pass as they are.
#[must_use]
pub fn unshielded(setup: Setup, scenarios: u64, seed: u64) -> Tally {
    run_all::<Sound>(setup, scenarios, seed, false)
}

fn run_all<R: Rules>(setup: Setup, scenarios: u64, seed: u64, shielded: bool) -> Tally {
    let judge = || Judge::new(&[Footprint::PAPER; OTHERS + 1]);
    (seed..seed.saturating_add(scenarios))
        .into_par_iter()
        .map_init(judge, |judge, seed| run::<R>(setup, seed, shielded, judge))
        .reduce(Tally::default, Tally::plus)
}

fn run<R: Rules>(setup: Setup, seed: u64, shielded: bool, judge: &mut Judge) -> Tally {
    let mut rng = Pcg64::seed_from_u64(seed);
    let Some(scenario) = Scenario::random(setup, &mut rng) else {
        return Tally::default();
    };
    World::<R>::new(scenario, rng).run(shielded, judge)
}

/// What drives one vehicle.
enum Mind<R: Rules> {
    Shielded {
        shield: Box<Shield<OTHERS, R>>,
        careless: Careless,
        /// Periods for which the sensors are still blind.
        blind: u32,
    },
    Adversary(Adversary),
}

/// A proposer that knows nothing: it holds an acceleration for a while.
struct Careless {
    acceleration: f32,
    left: u32,
}

impl Careless {
    fn propose(&mut self, rng: &mut Pcg64) -> f32 {
        if self.left == 0 {
            self.left = rng.random_range(1..20);
            self.acceleration = match rng.random_range(0..4) {
                0 => rng.random_range(-3.0..3.0),
                1 => 0.0,
                _ => 3.0,
            };
        }
        self.left -= 1;
        self.acceleration
    }
}

struct World<R: Rules> {
    scenario: Scenario,
    rng: Pcg64,
    states: Vec<State>,
    minds: Vec<Mind<R>>,
    /// The acceleration in effect, and the command that may come late.
    in_effect: Vec<f32>,
    commands: Vec<f32>,
}

impl<R: Rules> World<R> {
    fn new(scenario: Scenario, mut rng: Pcg64) -> Self {
        let count = scenario.vehicles.len();
        let minds = (0..count)
            .map(|i| {
                if i > 0 && !scenario.setup.everyone {
                    return Mind::Adversary(Adversary::random(&mut rng));
                }
                Mind::Shielded {
                    shield: Box::new(Shield::with_rules(scenario.setup.contract)),
                    careless: Careless {
                        acceleration: 0.0,
                        left: 0,
                    },
                    blind: 0,
                }
            })
            .collect();
        Self {
            states: scenario.vehicles.iter().map(|v| v.start).collect(),
            in_effect: vec![0.0; count],
            commands: vec![0.0; count],
            minds,
            scenario,
            rng,
        }
    }

    fn run(mut self, shielded: bool, judge: &mut Judge) -> Tally {
        let mut tally = Tally::default();
        for step in 0..self.scenario.setup.steps {
            for i in 0..self.minds.len() {
                let decision = self.decide(i, step, shielded);
                if let Some(decision) = decision {
                    let unverified = decision.cause == Cause::Fallback(Fault::Unverified);
                    if step == 0 && unverified && shielded {
                        // Switched on in danger: nothing is promised.
                        return Tally::default();
                    }
                    tally.steps += 1;
                    tally.unverified += u64::from(unverified);
                    tally.false_breaches += u64::from(decision.breach.is_some());
                    tally.interventions += u64::from(matches!(decision.cause, Cause::Shielded(_)));
                }
            }
            self.advance();
            if self.collision(judge) {
                tally.overlaps = 1;
                break;
            }
        }
        tally.scenarios = 1;
        tally.cleared = u64::from(self.cleared());
        tally
    }

    /// Gives vehicle `i` its command; a shielded one's decision is returned.
    fn decide(&mut self, i: usize, step: u32, shielded: bool) -> Option<Decision> {
        let observation = self.observe(i);
        let (command, decision) = match &mut self.minds[i] {
            Mind::Adversary(adversary) => {
                let command = adversary.accelerate(&self.scenario, &self.states, i, &mut self.rng);
                (command, None)
            }
            Mind::Shielded {
                shield,
                careless,
                blind,
            } => {
                let proposal = careless.propose(&mut self.rng);
                let mut observation = observation;
                if *blind > 0 {
                    *blind -= 1;
                    observation.ego.s = f32::NAN;
                } else if step > 0 && self.rng.random_bool(self.scenario.setup.blackouts) {
                    *blind = self.rng.random_range(1..40);
                }
                let scene = &self.scenario.vehicles[i].scene;
                let decision = shield.filter(scene, &observation, proposal);
                let command = if shielded {
                    decision.acceleration
                } else {
                    proposal
                };
                (command, Some(decision))
            }
        };
        self.commands[i] = command;
        decision
    }

    /// What vehicle `i` senses.
    fn observe(&mut self, i: usize) -> Observation<OTHERS> {
        let contract = self.scenario.setup.contract;
        let rng = &mut self.rng;
        let mut sense = |j: usize| {
            let mut error = |size: f32| size * rng.random_range(-1.0..=1.0_f32);
            let state = self.states[j];
            let speed = state.v + error(contract.speed_error());
            Vehicle {
                s: state.s + error(contract.position_error()),
                speed: if speed > 0.0 { speed } else { 0.0 },
                pose: self.scenario.vehicles[j].route.pose(state.s),
            }
        };
        let mut observation = Observation {
            ego: sense(i),
            others: [None; OTHERS],
        };
        let others = (0..self.states.len()).filter(|&j| j != i);
        for (slot, j) in observation.others.iter_mut().zip(others) {
            *slot = Some(sense(j));
        }
        observation
    }

    /// One step of everybody.
    fn advance(&mut self) {
        let late = f64::from(self.scenario.setup.contract.latency() / STEP);
        let mut accelerations = [0.0; OTHERS + 1];
        for (i, effective) in accelerations.iter_mut().enumerate().take(self.states.len()) {
            let shielded = matches!(self.minds[i], Mind::Shielded { .. });
            // Late by a whole period or not at all: the extremes of what the contract allows.
            let held = shielded && late > 0.5 && self.rng.random_bool(0.5);
            let acceleration = if held {
                self.in_effect[i]
            } else {
                self.commands[i]
            };
            *effective = if shielded {
                acceleration.min((self.scenario.limit - self.states[i].v).max(0.0) / STEP)
            } else {
                acceleration
            };
            self.in_effect[i] = self.commands[i];
        }
        stepper::advance(&mut self.states, &accelerations);
    }

    /// Whether a shielded vehicle touches any other.
    fn collision(&self, judge: &mut Judge) -> bool {
        let mut poses = [None; OTHERS + 1];
        let vehicles = self.scenario.vehicles.iter().zip(&self.states);
        for (pose, (vehicle, state)) in poses.iter_mut().zip(vehicles) {
            *pose = Some(vehicle.route.pose(state.s));
        }
        let egos = if self.scenario.setup.everyone {
            poses.len()
        } else {
            1
        };
        judge.touching(&poses).any(|(i, _)| i < egos)
    }

    /// Whether every shielded vehicle has passed the zones in which routes cross.
    fn cleared(&self) -> bool {
        let vehicles = self.scenario.vehicles.iter().zip(&self.states);
        vehicles
            .zip(&self.minds)
            .filter(|(_, mind)| matches!(mind, Mind::Shielded { .. }))
            .all(|((vehicle, state), _)| {
                let zones = vehicle.scene.conflicts().iter().flat_map(|m| m.zones());
                zones.filter(|z| !z.is_lane()).all(|z| state.s >= z.ego.to)
            })
    }
}
