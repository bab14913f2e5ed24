//! Vehicles without a shield: they try to be hit, and keep the contract.

mod aim;
mod courtesy;
mod walker;

pub use courtesy::{Duty, Meeting};
pub use walker::{Gait, Walker};

use crate::motion::State;
use crate::numbers::{Means, Numbers};
use crate::rng::Rng;
use crate::site::Area;

/// How an adversary chooses its acceleration.
#[derive(Clone, Debug, PartialEq)]
pub enum Manner {
    /// Anything the contract allows, held for a while.
    Random,
    /// Full acceleration or full braking, in turns.
    Bang,
    /// Always full acceleration.
    Rush,
    /// Arrives in the zone while the ego is in it.
    Aim,
    /// Waits at the edge of the zone until the ego is committed, then goes.
    Lurk,
    /// Drives into the zone and stops there for a while.
    Block,
    /// Accelerates away from an ego behind it, and brakes as hard as it can when that comes near.
    BrakeCheck,
    /// Hardly moves.
    Creep,
    /// Keeps its speed.
    Coast,
    /// Stays where it is.
    Stand,
    /// Full acceleration and full braking to a stand, each for seconds, as in a queue.
    StopAndGo,
    /// Stays where it is for so many choices, then aims at the ego.
    Leaves(u32),
    /// These accelerations, each for half a second.
    Profile(Vec<f64>),
}

impl Manner {
    /// One of those that an adversary has.
    #[must_use]
    pub fn random(rng: &mut Rng) -> Self {
        rng.pick(&[
            &Self::Random,
            &Self::Bang,
            &Self::Rush,
            &Self::Aim,
            &Self::Aim,
            &Self::Aim,
            &Self::Lurk,
            &Self::Lurk,
            &Self::Block,
            &Self::BrakeCheck,
            &Self::BrakeCheck,
            &Self::Creep,
            &Self::Coast,
        ])
        .clone()
    }

    /// One that stands in a queue, or is about to spoil it.
    #[must_use]
    pub fn queueing(rng: &mut Rng) -> Self {
        match rng.below(4) {
            0 | 1 => Self::StopAndGo,
            2 => Self::BrakeCheck,
            _ => Self::random(rng),
        }
    }

    /// One that stands in the way, and leaves after up to 15 s.
    #[must_use]
    pub fn leaving(rng: &mut Rng) -> Self {
        match rng.below(5) {
            0 => Self::StopAndGo,
            1 => Self::Stand,
            _ => Self::Leaves(rng.below(150) as u32),
        }
    }

    /// One that does not aim at anybody.
    #[must_use]
    pub fn gentle(rng: &mut Rng) -> Self {
        rng.pick(&[&Self::Coast, &Self::Random, &Self::Creep])
            .clone()
    }
}

/// What an adversary knows of the ego that it is after.
#[derive(Clone, Copy, Debug)]
pub struct Prey<'a> {
    /// Its motion.
    pub state: State,
    /// The acceleration that it was commanded last.
    pub command: f64,
    /// Periods for which its plan still goes.
    pub go: u16,
    /// The zones that both have ahead or are in.
    pub areas: &'a [Area],
}

/// A vehicle without a shield.
#[derive(Clone, Debug)]
pub struct Human {
    manner: Manner,
    /// What it can do.
    pub means: Means,
    /// The acceleration that it chose last.
    chosen: f64,
    /// Choices for which it is held.
    held: u32,
    choices: u32,
    rng: Rng,
}

/// A human chooses again after this (s).
pub const CHOICE: f64 = 0.1;

impl Human {
    /// One of this manner.
    #[must_use]
    pub fn new(manner: Manner, means: Means, rng: Rng) -> Self {
        Self {
            manner,
            means,
            chosen: 0.0,
            held: 0,
            choices: 0,
            rng,
        }
    }

    /// The acceleration that it wants.
    #[must_use]
    pub fn wanted(&self) -> f64 {
        self.chosen
    }

    /// Chooses anew, `me` being its motion; without a prey nobody is ahead whom it could meet.
    pub fn choose(&mut self, numbers: &Numbers, me: State, prey: Option<Prey<'_>>) {
        self.choices += 1;
        let Means {
            acceleration,
            braking,
            ..
        } = self.means;
        let area = prey.and_then(|prey| nearest(me, prey).map(|area| (prey, area)));
        let wanted = match (&self.manner, area) {
            (Manner::Stand, _) => -braking,
            (Manner::Coast, _) => 0.0,
            (Manner::Random, _) => self.random(),
            (Manner::Bang, _) => self.bang(15),
            (Manner::StopAndGo, _) => self.bang(40),
            (&Manner::Leaves(choices), _) if self.choices <= choices => -braking,
            (Manner::Profile(profile), _) => {
                let at = (self.choices as usize - 1) / 5;
                profile[at.min(profile.len() - 1)]
            }
            (Manner::Creep, _) if me.v > 0.6 => -0.5 * braking,
            (Manner::Creep, _) => 0.5 * acceleration,
            (Manner::Rush, _) | (_, None) => acceleration,
            (Manner::Aim | Manner::Leaves(_), Some((prey, area))) => {
                aim::aim(numbers, &self.means, me, prey, area)
            }
            (Manner::Lurk, Some((prey, area))) => aim::lurk(numbers, &self.means, me, prey, area),
            (Manner::Block, Some((_, area))) => self.block(me, area),
            (Manner::BrakeCheck, Some((prey, _))) => self.brake_check(me, prey),
        };
        let noise = if self.rng.chance(0.03) {
            self.rng.within(-braking, acceleration)
        } else {
            wanted
        };
        self.chosen = noise.clamp(-braking, acceleration);
    }

    fn hold(&mut self, next: impl FnOnce(&mut Rng, f64) -> f64, longest: usize) -> f64 {
        if self.held == 0 {
            self.held = 1 + self.rng.below(longest) as u32;
            self.chosen = next(&mut self.rng, self.chosen);
        }
        self.held -= 1;
        self.chosen
    }

    fn random(&mut self) -> f64 {
        let (down, up) = (-self.means.braking, self.means.acceleration);
        self.hold(
            |rng, _| match rng.below(4) {
                0 => up,
                1 => down,
                2 => 0.0,
                _ => rng.within(down, up),
            },
            25,
        )
    }

    fn bang(&mut self, longest: usize) -> f64 {
        let (down, up) = (-self.means.braking, self.means.acceleration);
        self.hold(|_, last| if last > 0.0 { down } else { up }, longest)
    }

    fn block(&mut self, me: State, area: Area) -> f64 {
        let (down, up) = (-self.means.braking, self.means.acceleration);
        let inside = me.s > area.other[0];
        self.hold(
            |rng, _| {
                if inside && rng.chance(0.7) { down } else { up }
            },
            if inside { 30 } else { 4 },
        )
    }

    fn brake_check(&mut self, me: State, prey: Prey<'_>) -> f64 {
        let behind = me.s - prey.state.s;
        let near = prey.state.v * prey.state.v / 6.0 + 0.5 * prey.state.v;
        let (down, up) = (-self.means.braking, self.means.acceleration);
        let closes = behind > 0.0 && behind < near + 8.0 && prey.state.v > me.v - 1.0;
        self.hold(
            |rng, _| {
                if closes && rng.chance(0.6) { down } else { up }
            },
            8,
        )
    }
}

/// The zone that comes first for `me` of those that neither has left.
fn nearest(me: State, prey: Prey<'_>) -> Option<Area> {
    let ahead = |area: &&Area| me.s < area.other[1] && prey.state.s < area.ego[1];
    let areas = prey.areas.iter().filter(ahead);
    areas
        .min_by(|a, b| a.other[0].total_cmp(&b.other[0]))
        .copied()
}
