//! How commands become acceleration: at any time within the latency, and in any way in between.

use crate::motion::TICK;
use crate::numbers::Drivetrain;
use crate::rng::Rng;
use std::collections::VecDeque;

/// How a command takes over from the one before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takeover {
    /// At once.
    Prompt,
    /// As late as allowed.
    Late,
    /// Prompt and late in turns.
    Alternating,
    /// At a random time, another one for each command.
    Random,
    /// Steadily over the whole latency.
    Ramp,
    /// At any acceleration in between until it is due.
    Wander,
}

impl Takeover {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Prompt,
        Self::Late,
        Self::Alternating,
        Self::Random,
        Self::Ramp,
        Self::Wander,
    ];
}

/// What the vehicle does worse than its contract says; nothing, within the contract.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weakness {
    /// Share of the commanded braking that is achieved.
    pub brakes: f64,
    /// Time constant in s with which the acceleration follows.
    pub lag: f64,
}

impl Weakness {
    /// None.
    pub const NONE: Self = Self {
        brakes: 1.0,
        lag: 0.0,
    };
}

/// Which way the acceleration differs from the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Up,
    Down,
    /// More than what is commanded, either way: harder acceleration, harder braking.
    More,
    /// Less than what is commanded.
    Less,
    /// Up and down in turns, with the commands.
    Turns,
    /// Anything in between, at any time.
    Wander,
}

/// What the vehicle does with what its contract leaves open.
#[derive(Clone, Copy, Debug)]
struct Whim {
    drivetrain: Drivetrain,
    /// Its time constant in s.
    lag: f64,
    way: Way,
}

impl Whim {
    fn random(drivetrain: Drivetrain, rng: &mut Rng) -> Self {
        let ways = [
            Way::Up,
            Way::Down,
            Way::More,
            Way::Less,
            Way::Turns,
            Way::Wander,
        ];
        let any = rng.unit();
        Self {
            drivetrain,
            lag: drivetrain.lag * rng.pick(&[0.0, 1.0, 1.0, any]),
            way: rng.pick(&ways),
        }
    }

    fn off(&self, command: f64, turn: bool, rng: &mut Rng) -> f64 {
        let share = match self.way {
            Way::Up => 1.0,
            Way::Down => -1.0,
            Way::More => command.signum(),
            Way::Less => -command.signum(),
            Way::Turns if turn => 1.0,
            Way::Turns => -1.0,
            Way::Wander => rng.within(-1.0, 1.0),
        };
        share * self.drivetrain.off(command)
    }
}

/// A command on its way to the wheels.
#[derive(Clone, Copy, Debug)]
struct Pending {
    since: u64,
    due: u64,
    acceleration: f64,
}

/// The drivetrain and brakes of one vehicle.
#[derive(Clone, Debug)]
pub struct Actuator {
    takeover: Takeover,
    /// Ticks until a command is in effect at the latest.
    latency: u64,
    weakness: Weakness,
    /// None, if it does just what is commanded.
    whim: Option<Whim>,
    /// A command is in effect; before, it is what the vehicle did.
    commanded: bool,
    in_effect: f64,
    pending: VecDeque<Pending>,
    turn: bool,
    felt: f64,
    rng: Rng,
}

impl Actuator {
    /// One that carries out `acceleration` now, with a latency of so many ticks.
    #[must_use]
    pub fn new(
        takeover: Takeover,
        latency: u64,
        weakness: Weakness,
        drivetrain: Drivetrain,
        acceleration: f64,
        mut rng: Rng,
    ) -> Self {
        let inexact = !drivetrain.is_exact();
        Self {
            commanded: false,
            whim: inexact.then(|| Whim::random(drivetrain, &mut rng)),
            takeover,
            latency,
            weakness,
            in_effect: acceleration,
            pending: VecDeque::new(),
            turn: false,
            felt: acceleration,
            rng,
        }
    }

    /// A command is given at `tick`.
    pub fn command(&mut self, tick: u64, acceleration: f64) {
        self.turn = !self.turn;
        let delay = match self.takeover {
            Takeover::Prompt => 0,
            Takeover::Alternating if self.turn => 0,
            Takeover::Random => self.rng.below(self.latency as usize + 1) as u64,
            _ => self.latency,
        };
        self.pending.push_back(Pending {
            since: tick,
            due: tick + delay,
            acceleration,
        });
    }

    /// The acceleration during the tick that begins.
    pub fn acceleration(&mut self, tick: u64) -> f64 {
        while let Some(next) = self.pending.front().filter(|next| next.due <= tick) {
            self.in_effect = next.acceleration;
            self.commanded = true;
            self.pending.pop_front();
        }
        let wanted = match self.pending.front() {
            Some(next) => self.in_between(*next, tick),
            None => self.in_effect,
        };
        self.follow(wanted)
    }

    fn in_between(&mut self, next: Pending, tick: u64) -> f64 {
        let share = match self.takeover {
            // The end of the tick: by then the share may be that large.
            Takeover::Ramp => (tick - next.since) as f64 / (next.due - next.since) as f64,
            Takeover::Wander => self.rng.unit(),
            _ => 0.0,
        };
        self.in_effect + share * (next.acceleration - self.in_effect)
    }

    fn follow(&mut self, wanted: f64) -> f64 {
        let wanted = if wanted < 0.0 {
            wanted * self.weakness.brakes
        } else {
            wanted
        };
        let whim = self.whim;
        let commanded = whim.filter(|_| self.commanded);
        let off = commanded.map_or(0.0, |whim| whim.off(wanted, self.turn, &mut self.rng));
        let wanted = wanted + off;
        let lag = self.weakness.lag + whim.map_or(0.0, |whim| whim.lag);
        if lag > 0.0 {
            self.felt += (wanted - self.felt) * (1.0 - (-TICK / lag).exp());
        } else {
            self.felt = wanted;
        }
        self.felt
    }

    /// The command that is in effect, without those on their way.
    #[must_use]
    pub fn in_effect(&self) -> f64 {
        self.in_effect
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXACT: Drivetrain = Drivetrain {
        lag: 0.0,
        gain: 0.0,
        disturbance: 0.0,
    };

    #[test]
    fn every_takeover_stays_between_the_commands_and_ends_in_time() {
        for takeover in Takeover::ALL {
            let mut actuator =
                Actuator::new(takeover, 20, Weakness::NONE, EXACT, -1.0, Rng::new(4));
            for round in 0..5 {
                let (old, new) = if round % 2 == 0 {
                    (-1.0, 2.0)
                } else {
                    (2.0, -1.0)
                };
                actuator.command(round * 20, new);
                for tick in 0..20 {
                    let now = actuator.acceleration(round * 20 + tick);
                    assert!((now - old) * (now - new) <= 1e-12, "{takeover:?}");
                }
                assert_eq!(actuator.clone().acceleration((round + 1) * 20), new);
            }
        }
    }

    #[test]
    fn a_lag_delays_and_weak_brakes_brake_less() {
        let weak = Weakness {
            brakes: 0.5,
            lag: 0.1,
        };
        let mut actuator = Actuator::new(Takeover::Prompt, 0, weak, EXACT, 0.0, Rng::new(1));
        actuator.command(0, -4.0);
        let after: Vec<f64> = (0..200).map(|tick| actuator.acceleration(tick)).collect();
        assert!((after[19] + 2.0 * (1.0 - (-1.0_f64).exp())).abs() < 1e-9);
        assert!((after[199] + 2.0).abs() < 1e-3);
    }
}
