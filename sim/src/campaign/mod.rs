//! Adversarial campaigns: others that try to make a shielded vehicle collide, within the contract.
//!
//! One vehicle (or every one) is driven by a careless proposer behind a [`Shield`];
//! the others do their worst: random, bang-bang, or aimed at it. Commands come late, sensors err and
//! black out, all within the contract. An overlap, as rapier2d sees it, is then the shield's fault.

mod adversary;
pub mod beyond;
mod scenario;

pub use scenario::{Scenario, Setup};

use crate::judge::Judge;
use crate::meeting::{instant, path};
use crate::stepper;
use adversary::Adversary;
use cede_controller::dangerous::{Rules, Sound};
use cede_controller::kinematics::{STEP, State};
use cede_controller::{
    Cause, Decision, Fault, Footprint, Observation, RouteConflict, Shield, Track, Vehicle,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// Most other vehicles of a scenario.
pub const OTHERS: usize = cede_controller::MAX_OTHERS;

/// A vehicle that is so near (m) to the end of its path is taken away.
const AWAY: f32 = 1.0;

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
    World::<R>::new(&scenario, rng).map_or_else(Tally::default, |world| world.run(shielded, judge))
}

/// What drives one vehicle.
enum Mind<'s, R: Rules> {
    Shielded {
        shield: Box<Shield<'s, OTHERS, R>>,
        careless: Careless,
        sight: Sight,
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

/// What a shielded vehicle fails to see, for as many steps.
#[derive(Default)]
struct Sight {
    /// Itself.
    blind: u32,
    /// Each vehicle.
    missing: [u32; OTHERS + 1],
}

impl Sight {
    /// One more step, with failures of the given probability; that of a single track is a quarter of it.
    fn fail(&mut self, probability: f64, rng: &mut Pcg64) {
        let mut fail = |left: &mut u32, probability| {
            if *left > 0 {
                *left -= 1;
            } else if rng.random_bool(probability) {
                *left = rng.random_range(1..40);
            }
        };
        fail(&mut self.blind, probability);
        for left in &mut self.missing {
            fail(left, 0.25 * probability);
        }
    }
}

struct World<'s, R: Rules> {
    scenario: &'s Scenario,
    rng: Pcg64,
    states: Vec<State>,
    /// Who has come to the end of its path, and is taken away.
    gone: Vec<bool>,
    minds: Vec<Mind<'s, R>>,
    /// The acceleration in effect, and the command that may come late.
    in_effect: Vec<f32>,
    commands: Vec<f32>,
}

impl<'s, R: Rules> World<'s, R> {
    /// `None` if a shield cannot enter.
    fn new(scenario: &'s Scenario, mut rng: Pcg64) -> Option<Self> {
        let count = scenario.vehicles.len();
        let contract = scenario.setup.contract;
        let mut mind = |i: usize| {
            if i > 0 && !scenario.setup.everyone {
                return Some(Mind::Adversary(Adversary::random(&mut rng)));
            }
            let shield = Shield::with_rules(contract, &scenario.junction, path(i)).ok()?;
            Some(Mind::Shielded {
                shield: Box::new(shield),
                careless: Careless {
                    acceleration: 0.0,
                    left: 0,
                },
                sight: Sight::default(),
            })
        };
        Some(Self {
            minds: (0..count).map(&mut mind).collect::<Option<_>>()?,
            states: scenario.vehicles.iter().map(|v| v.start).collect(),
            gone: vec![false; count],
            in_effect: vec![0.0; count],
            commands: vec![0.0; count],
            scenario,
            rng,
        })
    }

    fn run(mut self, shielded: bool, judge: &mut Judge) -> Tally {
        let mut tally = Tally::default();
        for step in 0..self.scenario.setup.steps {
            for i in 0..self.minds.len() {
                if self.gone[i] {
                    continue;
                }
                let decision = self.decide(i, step, shielded);
                if let Some(decision) = decision {
                    let unverified = decision.cause == Cause::Fallback(Fault::NoPlan);
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
        let (command, decision) = match &mut self.minds[i] {
            Mind::Adversary(adversary) => {
                let command = adversary.accelerate(self.scenario, &self.states, i, &mut self.rng);
                (command, None)
            }
            Mind::Shielded {
                careless, sight, ..
            } => {
                let proposal = careless.propose(&mut self.rng);
                if step > 0 {
                    sight.fail(self.scenario.setup.blackouts, &mut self.rng);
                }
                let decision = self.filter(i, step, proposal);
                let passed = shielded.then_some(decision).flatten();
                (passed.map_or(proposal, |d| d.acceleration), decision)
            }
        };
        self.commands[i] = command;
        decision
    }

    /// What the shield of vehicle `i` makes of a proposal.
    fn filter(&mut self, i: usize, step: u32, proposal: f32) -> Option<Decision> {
        let others: Vec<usize> = (0..self.states.len()).filter(|&j| j != i).collect();
        let mut ego = self.sense(i);
        let mut tracks = Vec::new();
        for &j in &others {
            let number = self.scenario.vehicles[j].number;
            let track = Track::on(number, path(j), self.sense(j));
            let place = self.rng.random_range(0..=tracks.len());
            tracks.insert(place, track);
        }
        let Mind::Shielded { shield, sight, .. } = &mut self.minds[i] else {
            return None;
        };
        for j in others {
            let number = self.scenario.vehicles[j].number;
            if self.gone[j] {
                shield.forget(number);
            }
            if self.gone[j] || sight.missing[j] > 0 {
                tracks.retain(|track| track.number != number);
            }
        }
        if sight.blind > 0 {
            ego.s = f32::NAN;
        }
        let observation = Observation {
            ego,
            tracks: &tracks,
        };
        Some(shield.filter(instant(step), &observation, proposal))
    }

    /// Vehicle `i`, with the errors of sensing.
    fn sense(&mut self, i: usize) -> Vehicle {
        let contract = &self.scenario.setup.contract;
        let mut error = |size: f32| size * self.rng.random_range(-1.0..=1.0_f32);
        let state = self.states[i];
        let speed = state.v + error(contract.speed_error());
        Vehicle {
            s: state.s + error(contract.position_error()),
            speed: if speed > 0.0 { speed } else { 0.0 },
            pose: self.scenario.vehicles[i].route.pose(state.s),
        }
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
        for ((gone, state), vehicle) in self
            .gone
            .iter_mut()
            .zip(&self.states)
            .zip(&self.scenario.vehicles)
        {
            *gone |= state.s > vehicle.route.length() - AWAY;
        }
    }

    /// Whether a shielded vehicle touches any other.
    fn collision(&self, judge: &mut Judge) -> bool {
        let mut poses = [None; OTHERS + 1];
        let vehicles = self.scenario.vehicles.iter().zip(&self.states);
        for ((pose, (vehicle, state)), gone) in poses.iter_mut().zip(vehicles).zip(&self.gone) {
            *pose = (!gone).then(|| vehicle.route.pose(state.s));
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
        let passed = |i: usize| {
            let others = (0..self.states.len()).filter(|&j| j != i);
            let conflicts =
                others.filter_map(|j| self.scenario.junction.conflict(path(i), path(j)));
            let mut zones = conflicts
                .flat_map(RouteConflict::zones)
                .filter(|z| !z.is_lane());
            zones.all(|zone| self.states[i].s >= zone.ego.to)
        };
        let minds = self.minds.iter().enumerate();
        minds
            .filter(|(_, mind)| matches!(mind, Mind::Shielded { .. }))
            .all(|(i, _)| passed(i))
    }
}
