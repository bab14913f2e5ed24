//! What the shield remembers of the ego from one decision to the next: its plan, its commands, where it was.

use super::actuation::{Commands, Inherited, anything};
use super::bounds::Bounds;
use super::contract::Contract;
use super::margin;
use super::own::Own;
use super::reach::Reach;
use crate::headroom::Room;
use crate::instant::{Instant, micros};
use crate::junction::zone::{FAR, Span};
use crate::observation::Vehicle;
use crate::plan::Plan;

/// What is left of the plan that was verified last.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Remembered {
    plan: Plan,
    /// When it was verified.
    at: Instant,
    /// Calls since then.
    calls: u32,
}

/// The plan that was verified last, the commands given, and where the ego was.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    remembered: Option<Remembered>,
    commands: Commands,
    /// Where the ego was seen last: what every observation says, carried on by what its commands lead to; and when.
    last: Option<(Bounds, Instant)>,
    /// Arc length (m), at least, of the ego when it was seen last.
    least: f32,
    /// Calls since `last`.
    blind: u16,
}

impl Memory {
    pub(crate) const fn new() -> Self {
        Self {
            remembered: None,
            commands: Commands::unknown(),
            last: None,
            least: -FAR,
            blind: 0,
        }
    }

    /// What is left of the last verified plan. None if there is none, or if it is void.
    pub(crate) fn plan(&self) -> Option<Plan> {
        self.remembered.map(|remembered| remembered.plan)
    }

    /// A plan is verified at `now` against everybody.
    pub(crate) fn verified(&mut self, plan: Plan, now: Instant) {
        self.remembered = Some(Remembered {
            plan,
            at: now,
            calls: 0,
        });
    }

    /// What is left of the plan holds from `now` on, whenever it was verified.
    pub(crate) fn confirmed(&mut self, now: Instant) {
        if let Some(remembered) = &mut self.remembered {
            remembered.at = now;
            remembered.calls = 0;
        }
    }

    pub(crate) fn void(&mut self) {
        self.remembered = None;
    }

    /// One command of the plan was carried out.
    pub(crate) fn shorten(&mut self, tail: impl Fn(Plan) -> Plan) {
        if let Some(remembered) = &mut self.remembered {
            remembered.plan = tail(remembered.plan);
        }
    }

    /// Another call at `now`. Whether the plan's commands have been given at the times that it counts on.
    pub(crate) fn call(&mut self, contract: &Contract, now: Instant) -> bool {
        self.blind = self.blind.saturating_add(1);
        let Some(remembered) = &mut self.remembered else {
            return true;
        };
        remembered.calls = remembered.calls.saturating_add(1);
        let due = u64::from(remembered.calls).saturating_mul(micros(contract.period));
        let away = now.since(remembered.at).abs_diff(due);
        // Half a microsecond a period, from rounding the period.
        // The call that verified it was itself up to one jitter off the grid, and so is this one.
        away <= (2 * micros(contract.jitter)).saturating_add(1 + u64::from(remembered.calls))
    }

    /// What acts on the ego until the command to be given at `now` is followed.
    pub(crate) fn inherited(&self, contract: &Contract, now: Instant) -> Inherited<f32> {
        self.commands.inherited(contract, now)
    }

    pub(crate) fn command(&mut self, contract: &Contract, acceleration: f32, now: Instant) {
        self.commands.give(contract, acceleration, now);
    }

    /// Nothing is known any more of what the commands lead to.
    pub(crate) fn forget_commands(&mut self) {
        self.commands = Commands::unknown();
    }

    /// What was known of the ego says nothing about the next observation.
    pub(crate) fn forget_ego(&mut self) {
        self.last = None;
    }

    /// Notes where the ego is at `now`; and what is left until its commands cannot have brought it there, of its place and
    /// of its speed.
    pub(crate) fn note(
        &mut self,
        contract: &Contract,
        ego: &Vehicle,
        now: Instant,
    ) -> (Own, Option<[Room; 2]>) {
        let seen = Bounds::sensed(contract, ego.s, ego.speed);
        let expected = self.expected(contract, now);
        let common = expected.map(|expected| both(contract, expected, seen));
        let possible = common.filter(|&(_, rooms)| Room::hold(rooms));
        let unknown = common.is_none() || possible.is_some();
        let own = Own::new(contract, ego, if unknown { self.least } else { -FAR });
        self.last = Some((possible.map_or(seen, |(bounds, _)| bounds), now));
        self.least = own.least;
        self.blind = 0;
        (own, common.map(|(_, rooms)| rooms))
    }

    /// Where the ego may be at `now`, and how fast, by when it was seen before.
    #[inline(never)] // Once in flash.
    fn expected(&self, contract: &Contract, now: Instant) -> Option<Bounds> {
        let (last, at) = self.last?;
        let time = now.seconds_since(at);
        let [least, most] = self.accelerations(contract);
        let cap = margin::unlimited(contract);
        let slow = Reach::start(last.speed.from).fading(cap, margin::fade::<f32>(contract) * time);
        let least = slow.at_least(least, cap, time);
        let most = Reach::start(last.speed.to).at_most(most, time);
        Some(Bounds {
            s: Span {
                from: last.s.from + least.distance,
                to: last.s.to + most.distance,
            },
            speed: Span {
                from: least.speed,
                to: most.speed,
            },
        })
    }

    /// The ego's speed (m/s), at least, if it is not seen at `now`.
    pub(crate) fn least_speed(&self, contract: &Contract, now: Instant) -> f32 {
        self.expected(contract, now)
            .map_or(0.0, |expected| expected.speed.from)
    }

    /// The ego's acceleration since it was seen last: least and most.
    fn accelerations(&self, contract: &Contract) -> [f32; 2] {
        if self.blind <= 1 {
            self.commands.since_last(contract)
        } else {
            anything(contract)
        }
    }
}

/// What is in both, and what is left of place and speed until that is empty by more than rounding.
fn both(contract: &Contract, expected: Bounds, seen: Bounds) -> (Bounds, [Room; 2]) {
    let common = |a: Span, b: Span| {
        let from = if a.from > b.from { a.from } else { b.from };
        let to = if a.to < b.to { a.to } else { b.to };
        let rounded = Span {
            from: if from < to { from } else { to },
            to: if from < to { to } else { from },
        };
        let (a, b) = (a.to - a.from, b.to - b.from);
        let most = if a < b { a } else { b } + contract.slack;
        (rounded, Room::of(to + contract.slack - from, most))
    };
    let (s, place) = common(expected.s, seen.s);
    let (speed, pace) = common(expected.speed, seen.speed);
    (Bounds { s, speed }, [place, pace])
}
