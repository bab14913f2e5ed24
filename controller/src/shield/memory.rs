//! What the shield remembers from one decision to the next.

use super::contract::Contract;
use super::margin;
use super::plan::Plan;
use super::reach::Reach;
use crate::decision::Breach;
use crate::observation::{Observation, Vehicle};

/// The plan that was verified last, the commands given, and what was seen.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Memory<const N: usize> {
    /// What is left of the last verified plan. Void if there is none, or if the contract was broken since.
    pub(crate) plan: Option<Plan>,
    /// The last command in m/s², and the one before it.
    commands: [Option<f32>; 2],
    last: Option<Observation<N>>,
    /// Periods since `last`.
    age: u16,
}

impl<const N: usize> Memory<N> {
    pub(crate) const fn new() -> Self {
        Self {
            plan: None,
            commands: [None; 2],
            last: None,
            age: 0,
        }
    }

    /// The ego's acceleration until the next command takes effect: least and most.
    pub(crate) fn in_effect(&self, contract: &Contract) -> [f32; 2] {
        let [command, _] = self.commands;
        command.map_or(
            [-contract.ego.braking, contract.ego.acceleration],
            |command| [command; 2],
        )
    }

    pub(crate) fn tick(&mut self) {
        self.age = self.age.saturating_add(1);
    }

    pub(crate) fn command(&mut self, acceleration: f32) {
        self.commands = [Some(acceleration), self.commands[0]];
    }

    /// Notes what is seen now, and whether it can have come from what was seen last.
    ///
    /// If it cannot, the remembered plan is void: it was verified against a world that is not this
    /// one. So it is if somebody has appeared whom it did not consider.
    pub(crate) fn note(&mut self, contract: &Contract, seen: &Observation<N>) -> Option<Breach> {
        let mut breach = None;
        let mut newcomer = false;
        if let Some(last) = &self.last {
            let time = f32::from(self.age) * contract.period;
            let others = last.others.iter().zip(seen.others.iter());
            for (number, pair) in (0_u8..).zip(others) {
                match pair {
                    (Some(last), Some(now)) if !other_can(contract, last, now, time) => {
                        breach = breach.or(Some(Breach::Other(number)));
                    }
                    (None, Some(_)) => newcomer = true,
                    _ => {}
                }
            }
            if !self.ego_can(contract, &last.ego, &seen.ego, time) {
                breach = Some(Breach::Ego);
            }
        }
        if breach.is_some() || newcomer {
            self.plan = None;
        }
        self.last = Some(*seen);
        self.age = 0;
        breach
    }

    fn ego_can(&self, contract: &Contract, last: &Vehicle, now: &Vehicle, time: f32) -> bool {
        let [command, before] = self.commands;
        let (least, most) = match (command, before) {
            (Some(a), Some(b)) if self.age == 1 => {
                if a < b {
                    (a, b)
                } else {
                    (b, a)
                }
            }
            _ => (-contract.ego.braking, contract.ego.acceleration),
        };
        let error = contract.speed_error;
        let least =
            Reach::start(last.speed - error).at_least(least, margin::unlimited(contract), time);
        let most = Reach::start(last.speed + error).at_most(most, time);
        moved(contract, last, now, least, most)
    }
}

/// Whether an other seen as `last` can be as it is seen `now`, `time` (s) later.
fn other_can(contract: &Contract, last: &Vehicle, now: &Vehicle, time: f32) -> bool {
    let error = contract.speed_error;
    let least = Reach::start(last.speed - error).at_least(-contract.other.braking, 0.0, time);
    let most = margin::rush(contract, last.speed + error, time);
    moved(contract, last, now, least, most)
}

/// Whether the way from `last` to `now` is between `least` and `most`, but for sensing errors.
fn moved(
    contract: &Contract,
    last: &Vehicle,
    now: &Vehicle,
    least: Reach<f32>,
    most: Reach<f32>,
) -> bool {
    let distance = 2.0 * contract.position_error + contract.slack;
    let speed = contract.speed_error + contract.slack;
    let way = now.s - last.s;
    (least.distance - distance..=most.distance + distance).contains(&way)
        && (least.speed - speed..=most.speed + speed).contains(&now.speed)
}
