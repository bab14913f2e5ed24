//! What a command does to the ego: it takes effect late, the drivetrain and the brakes follow it late, and not exactly.
//!
//! A command takes effect within the latency; several may be in flight. From then on the acceleration follows what is in
//! effect as a first-order lag does, whose time constant is anything up to [`super::Ego::lag`]. What is followed differs
//! from the command by a share ([`super::Ego::gain`]) and by what nobody commands ([`super::Ego::disturbance`]).
//!
//! Such a lag is a mixture of delays. So a speed is at most what it would be if every rise of the acceleration acted at once
//! and every fall late by the time constant, and at least what it would be the other way round: for bounds, the time constant
//! is added to the latency. `docs/theorem.md` has the proof.

use super::contract::Contract;
use crate::instant::{Instant, micros};
use crate::real::Real;
use heapless::Vec;

/// Commands in flight at most: so many periods may the latency last.
pub const FLIGHTS: usize = 10;

/// What acts of it: the acceleration itself, every command in flight, the last one, and one part more where a period ends.
const PARTS: usize = FLIGHTS + 3;

/// Accelerations that may act on the ego until a command that is given now is certainly followed: what is inherited from
/// before.
#[derive(Clone, Debug, PartialEq)]
pub struct Inherited<R> {
    parts: Vec<Part<R>, PARTS>,
    /// When the last part ends, in s from now.
    end: f32,
}

/// Accelerations that may act for some time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part<R> {
    /// For how long, in s, after the part before it.
    pub time: f32,
    /// The least and the largest of them, in m/s².
    pub bounds: [R; 2],
    /// The next period has begun: its command may act, too.
    pub later: bool,
}

impl<R: Real> Inherited<R> {
    /// Accelerations between `bounds` (m/s²) throughout the response.
    #[must_use]
    pub fn all(contract: &Contract, bounds: [R; 2]) -> Self {
        let mut all = Self::new();
        all.until(contract, contract.response(), bounds);
        all
    }

    pub(super) const fn new() -> Self {
        let parts = Vec::new();
        Self { parts, end: 0.0 }
    }

    /// From the end of the last part until `end` (s from now), accelerations between `bounds` (m/s²). A part that the end of
    /// the first period divides becomes two.
    pub(super) fn until(&mut self, contract: &Contract, end: f32, bounds: [R; 2]) {
        let period = contract.shortest_period();
        if self.end < period && period < end {
            self.push(period, bounds, false);
        }
        self.push(end, bounds, self.end >= period);
    }

    fn push(&mut self, end: f32, bounds: [R; 2], later: bool) {
        let time = if self.end == 0.0 { end } else { end - self.end };
        // `PARTS` are enough for every command in flight.
        let _ = self.parts.push(Part {
            time,
            bounds,
            later,
        });
        self.end = end;
    }

    /// The parts, one after the other.
    pub fn parts(&self) -> impl Iterator<Item = &Part<R>> {
        self.parts.iter()
    }

    /// The least and the largest acceleration (m/s²) of all parts.
    #[must_use]
    pub fn bounds(&self) -> [R; 2] {
        let mut parts = self.parts.iter().map(|part| part.bounds);
        let first = parts.next().unwrap_or([R::of(0.0); 2]);
        parts.fold(first, hull)
    }
}

/// The least bounds that hold both.
fn hull<R: Real>([a, b]: [R; 2], [c, d]: [R; 2]) -> [R; 2] {
    [a.min(c), b.max(d)]
}

/// The largest acceleration (m/s²) that `command` may lead to, or the hardest braking, if both count as positive.
pub fn strongest<R: Real>(contract: &Contract, command: R) -> R {
    if contract.is_exact() {
        return command;
    }
    command + uncertain(contract, command)
}

/// The least acceleration (m/s²) that `command` may lead to, or the weakest braking, if both count as positive.
pub fn weakest<R: Real>(contract: &Contract, command: R) -> R {
    if contract.is_exact() {
        return command;
    }
    command - uncertain(contract, command)
}

/// By how much (m/s²) the acceleration may differ from `command`.
fn uncertain<R: Real>(contract: &Contract, command: R) -> R {
    let size = command.max(-command);
    R::of(contract.ego.gain) * size + R::of(contract.ego.disturbance)
}

/// How far below 0 (m/s) a bound on the ego's speed from below may count down while accelerations of at least `least`
/// (m/s²) act, so that, counted up from there at a plan's `go`, it stays one.
///
/// An ego that stands while its brakes let go starts later than its lag, by the time in which the acceleration comes up
/// to 0: ln(1 + b/go) time constants at most, and ln(1 + x) ≤ x/√(1 + x).
pub fn hold<R: Real>(contract: &Contract, least: R) -> R {
    let zero = R::of(0.0);
    if contract.ego.lag == 0.0 {
        return zero;
    }
    let braked = zero.max(-least);
    let share = braked / weakest(contract, R::of(contract.ego.go));
    -(R::of(contract.ego.lag) * braked / (R::of(1.0) + share).sqrt())
}

/// The commands given, as far as they may still act.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Commands {
    /// In the order in which they were given; the last one is the one before the next.
    flights: Vec<Flight, FLIGHTS>,
    /// The accelerations that the ego may have had when the last one was given, its least and its largest (m/s²).
    had: [f32; 2],
}

/// A command on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Flight {
    /// What it may lead to: the least and the largest acceleration, in m/s².
    bounds: [f32; 2],
    given: Instant,
}

impl Commands {
    /// Nothing is known of what was commanded before.
    pub(super) const fn unknown() -> Self {
        Self {
            flights: Vec::new(),
            had: [0.0; 2],
        }
    }

    /// `command` (m/s²) is given at `now`.
    pub(super) fn give(&mut self, contract: &Contract, command: f32, now: Instant) {
        self.had = self.has(contract, now);
        if self.flights.is_empty() {
            // Whatever was commanded before may act for as long as any command.
            let _ = self.flights.push(Flight {
                bounds: anything(contract),
                given: Instant::default(),
            });
        }
        let over = |next: &Flight| self.left(contract, next.given, now) == 0.0;
        let gone = self
            .flights
            .iter()
            .skip(1)
            .take_while(|next| over(next))
            .count();
        for _ in 0..gone {
            self.flights.remove(0);
        }
        if self.flights.is_full() {
            self.join();
        }
        let _ = self.flights.push(Flight {
            bounds: [weakest(contract, command), strongest(contract, command)],
            given: now,
        });
    }

    /// Without room, the two oldest commands count as one that may be either.
    fn join(&mut self) {
        let oldest = self.flights.remove(0);
        if let Some(next) = self.flights.first_mut() {
            next.bounds = hull(oldest.bounds, next.bounds);
        }
    }

    /// Seconds from `now` until a command `given` before is certainly in effect.
    fn left(&self, contract: &Contract, given: Instant, now: Instant) -> f32 {
        let left = given.plus(micros(contract.latency)).since(now);
        // A microsecond is how exact a latency is.
        if left <= 1 { 0.0 } else { left as f32 * 1.0e-6 }
    }

    /// Everything that may have been in effect since the last command was given, in m/s².
    fn in_effect(&self, contract: &Contract) -> [f32; 2] {
        let mut flights = self.flights.iter().map(|flight| flight.bounds);
        let first = flights.next().unwrap_or(anything(contract));
        flights.fold(first, hull)
    }

    /// The accelerations that the ego may have had since the last command was given, in m/s².
    pub(super) fn since_last(&self, contract: &Contract) -> [f32; 2] {
        let in_effect = self.in_effect(contract);
        if contract.ego.lag > 0.0 && !self.flights.is_empty() {
            hull(in_effect, self.had)
        } else {
            in_effect
        }
    }

    /// The accelerations that the ego may have at `now`, in m/s².
    fn has(&self, contract: &Contract, now: Instant) -> [f32; 2] {
        let Some(last) = self.flights.last() else {
            return anything(contract);
        };
        let elapsed = now.seconds_since(last.given);
        follow(contract, self.had, self.in_effect(contract), elapsed)
    }

    /// What acts until a command that is given at `now` is certainly followed.
    pub(super) fn inherited(&self, contract: &Contract, now: Instant) -> Inherited<f32> {
        if self.flights.is_empty() {
            return Inherited::all(contract, anything(contract));
        }
        let lag = contract.ego.lag;
        let mut inherited = Inherited::new();
        let mut add = |end: f32, bounds| {
            if end > inherited.end {
                inherited.until(contract, end, bounds);
            }
        };
        // Each command acts until the next one is certainly in effect, and the last one throughout.
        let ends = |next: Option<&Flight>| match next {
            Some(next) => self.left(contract, next.given, now),
            None => contract.switching(),
        };
        let later = |i: usize| {
            let on = self.flights.iter().enumerate().skip(i);
            let on = on.filter(|(i, _)| ends(self.flights.get(i + 1)) > 0.0);
            let mut on = on.map(|(_, flight)| flight.bounds);
            let first = on.next().unwrap_or(anything(contract));
            on.fold(first, hull)
        };
        add(lag, hull(self.has(contract, now), later(0)));
        for i in 0..self.flights.len() {
            let end = ends(self.flights.get(i + 1));
            if end > 0.0 {
                add(if lag == 0.0 { end } else { end + lag }, later(i));
            }
        }
        inherited
    }
}

/// Everything that can be commanded may lead to this (m/s²): the least and the most.
pub(super) fn anything(contract: &Contract) -> [f32; 2] {
    let ego = contract.ego;
    [
        weakest(contract, -ego.emergency),
        strongest(contract, ego.acceleration),
    ]
}

/// Bounds on the acceleration (m/s²) of a drivetrain that had one in `acting` `elapsed` seconds ago, and has followed
/// others in `followed` since.
pub(super) fn follow(
    contract: &Contract,
    [least, most]: [f32; 2],
    followed: [f32; 2],
    elapsed: f32,
) -> [f32; 2] {
    let lag = contract.ego.lag;
    // e^(−x) ≤ 1/(1 + x). Without a lag nothing is left, whatever the time.
    let left = if lag > 0.0 {
        lag / (lag + elapsed)
    } else {
        0.0
    };
    let below = Real::max(followed[0] - least, 0.0);
    let above = Real::max(most - followed[1], 0.0);
    [followed[0] - left * below, followed[1] + left * above]
}
