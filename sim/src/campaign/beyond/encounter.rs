//! One encounter, in steps of 10 ms.

use super::super::adversary::Adversary;
use super::super::scenario::Scenario;
use super::super::{Careless, OTHERS};
use super::deviation::Deviation;
use super::plain;
use super::{Count, Guard, Temper};
use crate::judge::Judge;
use crate::meeting::path;
use cede_controller::kinematics::State;
use cede_controller::shield::reach::Reach;
use cede_controller::{Cause, Fault, Instant, Observation, Pose, Shield, Track, Vehicle};
use rand::RngExt;
use rand_pcg::Pcg64;
use std::collections::VecDeque;

/// Time step in s.
const DT: f32 = 0.01;

/// Length of an encounter in time steps.
const STEPS: u32 = 2000;

/// A hostile vehicle, and the duty of a gentle one, choose anew after so many time steps.
const CHOICE: u32 = 10;

/// How fast (m/s) a driver that is not careless wants to go.
const DESIRED: f32 = 10.0;

/// One encounter under way; vehicle 0 is the ego.
struct Encounter<'s> {
    scenario: &'s Scenario,
    deviation: Deviation,
    temper: Temper,
    rng: Pcg64,
    states: Vec<State>,
    other: Adversary,
    /// Acceleration of the other.
    its: f32,
    shield: Shield<'s, OTHERS>,
    /// Who proposes; a vehicle that keeps to a speed, if none.
    careless: Option<Careless>,
    /// Commands that are not in effect yet, with the step at which they will be.
    sent: VecDeque<(u32, f32)>,
    in_effect: f32,
    /// The ego's acceleration, which follows the command in effect.
    acceleration: f32,
    /// Which way the ego's acceleration differs from that: more of it or less, and up or down, −1 to 1 each.
    whim: [f32; 2],
    /// The sensed states of this and earlier calls, the ego's first.
    seen: Vec<Option<State>>,
    flagged: bool,
}

/// `None` if the encounter does not begin with a verified plan.
pub(super) fn run(
    scenario: &Scenario,
    deviation: Deviation,
    (guard, temper): (Guard, Temper),
    mut rng: Pcg64,
    judge: &mut Judge,
) -> Option<Count> {
    let contract = scenario.setup.contract;
    let shield = Shield::enter(contract, &scenario.junction, path(0)).ok()?;
    let careless = rng.random_bool(0.5).then_some(Careless {
        acceleration: 0.0,
        left: 0,
    });
    let ego = contract.ego();
    // Contracts of an exact drivetrain keep their encounters.
    let whim = if ego.gain > 0.0 || ego.disturbance > 0.0 {
        [rng.random_range(-1.0..=1.0), rng.random_range(-1.0..=1.0)]
    } else {
        [0.0; 2]
    };
    let encounter = Encounter {
        scenario,
        deviation,
        temper,
        other: Adversary::random(&mut rng),
        its: 0.0,
        states: scenario.vehicles.iter().map(|it| it.start).collect(),
        shield,
        careless,
        sent: VecDeque::new(),
        in_effect: 0.0,
        acceleration: 0.0,
        whim,
        seen: Vec::new(),
        flagged: false,
        rng,
    };
    if !encounter.begins_with_a_plan() {
        return None;
    }
    Some(encounter.drive(guard, judge))
}

impl Encounter<'_> {
    fn begins_with_a_plan(&self) -> bool {
        let tracks = self.tracks(&self.true_states());
        let ego = self.vehicle(0, self.states[0]);
        let observation = Observation {
            ego,
            tracks: &tracks,
        };
        self.shield.ready(Instant::default(), &observation).is_ok()
    }

    fn drive(mut self, guard: Guard, judge: &mut Judge) -> Count {
        let period = (self.scenario.setup.contract.period() / DT).round() as u32;
        let (mut due, mut called) = (0, 0);
        let freeze = self.rng.random_range(0..STEPS / 4);
        let freeze = freeze..freeze + (self.deviation.frozen / DT) as u32;
        for step in 0..STEPS {
            if step % CHOICE == 0 {
                self.its = self.choose();
            }
            if step == due {
                let late =
                    self.deviation.jitter * period as f32 * self.rng.random_range(-1.0..=1.0);
                called += period;
                due = (called as f32 + late).max(step as f32 + 1.0) as u32;
                self.call(step, guard, freeze.contains(&step));
            }
            self.advance(step);
            if let Some(speed) = self.collision(judge) {
                return Count {
                    encounters: 1,
                    collisions: 1,
                    flagged: u64::from(self.flagged),
                    noticed: u64::from(self.flagged),
                    impact: speed,
                };
            }
        }
        Count {
            encounters: 1,
            noticed: u64::from(self.flagged),
            ..Count::default()
        }
    }

    /// The other's acceleration for the next 100 ms.
    fn choose(&mut self) -> f32 {
        let (scenario, states) = (self.scenario, &self.states);
        match self.temper {
            Temper::Hostile => {
                let wanted = self.other.accelerate(scenario, states, 1, &mut self.rng);
                if wanted > 0.0 {
                    wanted * self.deviation.acceleration
                } else {
                    wanted
                }
            }
            Temper::Gentle if self.other.must_brake(scenario, states, 1) => {
                -scenario.setup.contract.follower().braking
            }
            Temper::Gentle => self.rng.random_range(-0.5..0.5),
        }
    }

    /// A call of the guard, unless it is missed.
    fn call(&mut self, step: u32, guard: Guard, frozen: bool) {
        let proposal = self.propose();
        if self.rng.random_bool(self.deviation.missed) {
            return;
        }
        self.sense(frozen);
        let command = match guard {
            Guard::None => proposal,
            Guard::Plain => plain::filter(self.scenario, &self.seen, proposal),
            Guard::Shield => self.filter(step, proposal),
        };
        let latency = self.scenario.setup.contract.latency() * self.deviation.latency;
        // Up to the whole of it: the worst that the contract allows.
        self.sent
            .push_back((step + (latency / DT).round() as u32, command));
    }

    fn propose(&mut self) -> f32 {
        match &mut self.careless {
            Some(careless) => careless.propose(&mut self.rng),
            None => (DESIRED - self.states[0].v).clamp(-2.0, 2.0),
        }
    }

    /// Notes what is sensed now, or nothing new while sensing is `frozen`.
    fn sense(&mut self, frozen: bool) {
        if frozen && !self.seen.is_empty() {
            return;
        }
        let contract = self.scenario.setup.contract;
        let bound = |error: f32| error * self.deviation.errors + self.deviation.error;
        let place = bound(contract.position_error());
        let speed = bound(contract.speed_error());
        let missing = self.deviation.dropout;
        let rng = &mut self.rng;
        let sensed = self.states.iter().enumerate().map(|(i, state)| {
            let state = State {
                s: state.s + place * rng.random_range(-1.0..=1.0_f32),
                v: (state.v + speed * rng.random_range(-1.0..=1.0_f32)).max(0.0),
            };
            (i == 0 || !rng.random_bool(missing)).then_some(state)
        });
        self.seen = sensed.collect();
    }

    fn filter(&mut self, step: u32, proposal: f32) -> f32 {
        let Some(Some(ego)) = self.seen.first().copied() else {
            return -self.scenario.setup.contract.ego().braking;
        };
        let tracks = self.tracks(&self.seen);
        let observation = Observation {
            ego: self.vehicle(0, ego),
            tracks: &tracks,
        };
        let now = Instant::from_millis(u64::from(step) * 10);
        let decision = self.shield.filter(now, &observation, proposal);
        self.flagged |= decision.breach.is_some()
            || decision.fault.is_some()
            || decision.cause == Cause::Fallback(Fault::NoPlan);
        decision.acceleration
    }

    fn true_states(&self) -> Vec<Option<State>> {
        self.states.iter().copied().map(Some).collect()
    }

    fn tracks(&self, seen: &[Option<State>]) -> Vec<Track> {
        let others = seen.iter().enumerate().skip(1);
        let track = |(i, state): (usize, &Option<State>)| {
            let number = self.scenario.vehicles[i].number;
            Some(Track::on(number, path(i), self.vehicle(i, (*state)?)))
        };
        others.filter_map(track).collect()
    }

    /// Vehicle `i` as it is sensed in `state`: its pose fits its arc length.
    fn vehicle(&self, i: usize, state: State) -> Vehicle {
        Vehicle {
            s: state.s,
            speed: state.v,
            pose: self.scenario.vehicles[i].route.pose(state.s),
        }
    }

    fn advance(&mut self, step: u32) {
        while let Some(&(due, command)) = self.sent.front()
            && due <= step
        {
            self.in_effect = command;
            self.sent.pop_front();
        }
        let (ego, deviation) = (self.scenario.setup.contract.ego(), self.deviation);
        let wanted = if self.in_effect < 0.0 {
            self.in_effect * deviation.braking
        } else {
            self.in_effect
        };
        let [more, up] = self.whim;
        let gain = 1.0 + more * ego.gain * deviation.gain;
        let wanted = wanted * gain + up * ego.disturbance * deviation.disturbance;
        let lag = ego.lag * deviation.slower + deviation.lag;
        let follows = if lag > 0.0 {
            1.0 - (-DT / lag).exp()
        } else {
            1.0
        };
        self.acceleration += follows * (wanted - self.acceleration);
        let limit = (self.scenario.limit - self.states[0].v).max(0.0) / DT;
        let accelerations = [self.acceleration.min(limit), self.its];
        for (state, acceleration) in self.states.iter_mut().zip(accelerations) {
            let moved = Reach::start(state.v).at_most(acceleration, DT);
            *state = State {
                s: state.s + moved.distance,
                v: moved.speed,
            };
        }
    }

    /// The speed (m/s) at which the two collide, one relative to the other, if they do.
    fn collision(&self, judge: &mut Judge) -> Option<f64> {
        let vehicles = self.scenario.vehicles.iter().zip(&self.states);
        let poses: Vec<_> = vehicles
            .map(|(vehicle, state)| {
                (state.s < vehicle.route.length()).then(|| vehicle.route.pose(state.s))
            })
            .collect();
        judge.touching(&poses).next()?;
        let [Some(ego), Some(other)] = poses[..] else {
            return None;
        };
        let speeds = [self.states[0].v, self.states[1].v];
        let moves = |pose: Pose, speed: f32| pose.direction.into_inner() * speed;
        let relative = moves(ego, speeds[0]) - moves(other, speeds[1]);
        Some(f64::from(relative.x.hypot(relative.y)))
    }
}
