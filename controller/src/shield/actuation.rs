//! What a command does to the ego: it takes effect late, the drivetrain and the brakes follow it late, and not exactly.
//!
//! A command takes effect within the latency; several may be in flight. From then on the acceleration follows what is in
//! effect as a first-order lag does, whose time constant is anything up to [`super::Ego::lag`]. What is followed differs
//! from the command by a share ([`super::Ego::gain`]) and by what nobody commands ([`super::Ego::disturbance`]).
//!
//! Such a lag is a mixture of delays. So a speed is at most what it would be if every rise of the acceleration acted at once
//! and every fall late by the time constant, and at least what it would be the other way round: for bounds, the time constant
//! is added to the latency. `docs/theorem.md` has the proof.

use super::contract::{Contract, FLIGHTS};
use crate::instant::{Instant, micros};
use crate::real::Real;
use heapless::{Deque, Vec};

/// What acts: every command in flight, the one before them, and the acceleration itself.
const PARTS: usize = FLIGHTS + 2;

/// Accelerations that may act on the ego until a command that is given now is certainly followed: what is inherited from
/// before.
#[derive(Clone, Debug, PartialEq)]
pub struct Inherited<R> {
    /// The last one first: bounds that hold until a time, in s from now.
    parts: Vec<(f32, [R; 2]), PARTS>,
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
        let mut all = Self { parts: Vec::new() };
        all.prepend(contract.response(), bounds);
        all
    }

    /// Until `end` (s from now), before all parts that are known, accelerations between `bounds` (m/s²).
    fn prepend(&mut self, end: f32, bounds: [R; 2]) {
        if end > 0.0 || end.is_nan() {
            // `PARTS` are enough.
            let _ = self.parts.push((end, bounds));
        }
    }

    /// The parts, one after the other. What the end of the first period divides is two.
    pub fn parts(&self, contract: &Contract) -> impl Iterator<Item = Part<R>> {
        let period = contract.shortest_period();
        let (mut rest, mut from) = (self.parts.iter().rev().peekable(), 0.0);
        core::iter::from_fn(move || {
            let &&(end, bounds) = rest.peek()?;
            let divided = from < period && period < end;
            let to = if divided { period } else { end };
            let part = Part {
                time: if from == 0.0 { to } else { to - from },
                bounds,
                later: from >= period,
            };
            if !divided {
                rest.next();
            }
            from = to;
            Some(part)
        })
    }

    /// The least and the largest acceleration (m/s²) of all parts: those that act at first.
    #[must_use]
    pub fn bounds(&self) -> [R; 2] {
        let first = self.parts.last();
        first.map_or([R::of(0.0); 2], |(_, bounds)| *bounds)
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
/// (m/s²) act, so that, counted up from there at `most` or less, it stays one.
///
/// An ego that stands while its brakes let go starts later than its lag, by the time in which the acceleration comes up
/// to 0: ln(1 + b/`most`) time constants at most, and ln(1 + x) ≤ x/√(1 + x). The speed that it lacks grows with `most`.
pub fn hold<R: Real>(contract: &Contract, least: R, most: R) -> R {
    let zero = R::of(0.0);
    if contract.ego.lag == 0.0 {
        return zero;
    }
    let braked = zero.max(-least);
    let share = braked / most;
    -(R::of(contract.ego.lag) * braked / (R::of(1.0) + share).sqrt())
}

/// The commands given, as far as they may still act.
#[derive(Clone, Debug)]
pub(super) struct Commands {
    /// In the order in which they were given. The first one stands for all before it.
    flights: Deque<Flight, { FLIGHTS + 1 }>,
    /// The accelerations that the ego may have had when the last one was given, its least and its largest (m/s²).
    had: [f32; 2],
    /// What may have been commanded under former contracts may lead to this (m/s²).
    former: [f32; 2],
}

/// A command on its way.
#[derive(Clone, Copy, Debug)]
struct Flight {
    /// In m/s²; not a number, if it may be any.
    command: f32,
    /// When it was given, in microseconds, without those above 32 bits.
    given: u32,
}

impl Flight {
    /// What it may lead to: the least and the largest acceleration, in m/s².
    #[inline(never)] // Once in flash.
    fn bounds(self, contract: &Contract, former: [f32; 2]) -> [f32; 2] {
        if self.command.is_nan() {
            hull(former, anything(contract))
        } else {
            [
                weakest(contract, self.command),
                strongest(contract, self.command),
            ]
        }
    }

    /// Microseconds from when it was given to `now`.
    const fn age(self, now: u32) -> u32 {
        now.wrapping_sub(self.given)
    }
}

/// Microseconds, without those above 32 bits.
const fn short(now: Instant) -> u32 {
    now.micros() as u32
}

impl Commands {
    /// Nothing is known of what was commanded before.
    pub(super) const fn unknown() -> Self {
        Self {
            flights: Deque::new(),
            had: [0.0; 2],
            former: [0.0; 2],
        }
    }

    /// From now on another contract says what commands lead to; until now `contract` did.
    pub(super) fn forget(&mut self, contract: &Contract) {
        *self = Self {
            former: self.unknown_bounds(contract),
            ..Self::unknown()
        };
    }

    /// What a command that is not known may lead to, in m/s².
    pub(super) fn unknown_bounds(&self, contract: &Contract) -> [f32; 2] {
        hull(self.former, anything(contract))
    }

    /// `command` (m/s²) is given at `now`.
    pub(super) fn give(&mut self, contract: &Contract, command: f32, now: Instant) {
        self.had = self.has(contract, now);
        let given = short(now);
        if self.flights.is_empty() {
            // Whatever was commanded before may act for as long as any command.
            let _ = self.flights.push_back(Flight {
                command: f32::NAN,
                given,
            });
        }
        if self.flights.is_full() {
            self.flights.pop_front();
            // It stands for the one before it, too.
            if let Some(oldest) = self.flights.front_mut() {
                oldest.command = f32::NAN;
            }
        }
        let _ = self.flights.push_back(Flight { command, given });
    }

    /// Of the commands given, from the last one back, until when (s from `now`) each may be in effect.
    fn acting(&self, contract: &Contract, now: u32, mut each: impl FnMut(f32, [f32; 2])) {
        let latency = u32::try_from(micros(contract.latency)).unwrap_or(u32::MAX);
        let mut end = contract.switching();
        for flight in self.flights.iter().rev() {
            each(end, flight.bounds(contract, self.former));
            let left = latency.saturating_sub(flight.age(now));
            // The one before it acts until it is in effect. A microsecond is how exact a latency is.
            if left <= 1 {
                return;
            }
            end = left as f32 * 1.0e-6;
        }
    }

    /// Everything that may have been in effect since the last command was given, in m/s².
    fn in_effect(&self, contract: &Contract) -> [f32; 2] {
        let Some(last) = self.flights.back() else {
            return self.unknown_bounds(contract);
        };
        let mut bounds = last.bounds(contract, self.former);
        self.acting(contract, last.given, |_, of| bounds = hull(bounds, of));
        bounds
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
        let Some(last) = self.flights.back() else {
            return self.unknown_bounds(contract);
        };
        let elapsed = last.age(short(now)) as f32 * 1.0e-6;
        follow(contract, self.had, self.in_effect(contract), elapsed)
    }

    /// What acts until a command that is given at `now` is certainly followed.
    pub(super) fn inherited(&self, contract: &Contract, now: Instant) -> Inherited<f32> {
        let Some(last) = self.flights.back() else {
            return Inherited::all(contract, self.unknown_bounds(contract));
        };
        let (lag, mut bounds) = (contract.ego.lag, last.bounds(contract, self.former));
        let mut inherited = Inherited { parts: Vec::new() };
        self.acting(contract, short(now), |end, of| {
            bounds = hull(bounds, of);
            inherited.prepend(end + lag, bounds);
        });
        inherited.prepend(lag, hull(bounds, self.has(contract, now)));
        inherited
    }
}

/// Everything that can be commanded may lead to this (m/s²): the least and the most.
#[inline(never)] // Once in flash.
pub(super) fn anything(contract: &Contract) -> [f32; 2] {
    let ego = contract.ego;
    [
        weakest(contract, -ego.emergency),
        strongest(contract, ego.acceleration),
    ]
}

/// Bounds on the acceleration (m/s²) of a drivetrain that had one in `acting` `elapsed` seconds ago, and has followed
/// others in `followed` since.
fn follow(
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shield::contract::tests::INEXACT;

    const WORST: Contract = Contract::WORST_CASE;

    #[track_caller]
    fn near(a: [f32; 2], b: [f32; 2]) {
        let near = |i: usize| (a[i] - b[i]).abs() < 1e-4;
        assert!(near(0) && near(1), "{a:?}, {b:?}");
    }

    #[track_caller]
    fn acts(contract: &Contract, inherited: &Inherited<f32>, expected: &[(f32, [f32; 2], bool)]) {
        let parts: std::vec::Vec<_> = inherited.parts(contract).collect();
        assert_eq!(parts.len(), expected.len(), "{parts:?}");
        for (part, &(time, bounds, later)) in parts.iter().zip(expected) {
            near([part.time, 0.0], [time, 0.0]);
            near(part.bounds, bounds);
            assert_eq!(part.later, later, "{parts:?}");
        }
    }

    #[test]
    fn a_command_is_off_by_a_share_and_by_what_nobody_commands() {
        let both = |contract: &Contract, command: f32| {
            [weakest(contract, command), strongest(contract, command)]
        };
        near(both(&INEXACT, 2.0), [1.0, 3.0]);
        near(both(&INEXACT, -2.0), [-3.0, -1.0]);
        assert_eq!(both(&WORST, -2.0), [-2.0; 2]);
        near(anything(&INEXACT), [-8.0, 3.0]);
        near(anything(&WORST), [-3.0, 3.0]);
    }

    #[test]
    fn an_ego_that_stands_braked_starts_later_by_what_its_lag_keeps() {
        let held = |least, most| hold(&INEXACT, least, most);
        // 0.2 s of 4 m/s², by the root of 1 + 4/2.
        near([held(-4.0, 2.0), held(1.0, 2.0)], [-0.461_88, 0.0]);
        assert_eq!(hold(&WORST, -4.0, 2.0), 0.0);
    }

    #[test]
    fn what_is_left_of_an_acceleration_falls_with_time() {
        let follows = |had, followed| follow(&INEXACT, had, followed, 0.3);
        // 0.2 s of 0.5 s are left.
        near(follows([-2.0, 1.0], [0.0, 3.0]), [-0.8, 3.0]);
        near(follows([-1.0, 4.0], [0.0, 1.0]), [-0.4, 2.2]);
        near(follows([1.0, 2.0], [0.0, 3.0]), [0.0, 3.0]);
        near(follow(&WORST, [-2.0, 4.0], [0.0, 1.0], 0.0), [0.0, 1.0]);
    }

    #[test]
    fn what_acts_is_divided_where_the_first_period_ends() {
        let mut inherited = Inherited { parts: Vec::new() };
        inherited.prepend(0.3, [-1.0, 1.0]);
        inherited.prepend(0.05, [-2.0, 2.0]);
        inherited.prepend(0.0, [-3.0, 3.0]);
        // A period is 0.08 s at least.
        let (one, two) = ([-1.0, 1.0], [-2.0, 2.0]);
        acts(
            &INEXACT,
            &inherited,
            &[(0.05, two, false), (0.03, one, false), (0.22, one, true)],
        );
        assert_eq!(inherited.bounds(), two);
        let all = Inherited::all(&WORST, one);
        acts(&WORST, &all, &[(0.1, one, false)]);
    }

    #[test]
    fn commands_in_flight_act_until_the_next_one_is_in_effect() {
        let contract = WORST.to_builder().latency(0.25).build().unwrap();
        let at = Instant::from_millis;
        let mut commands = Commands::unknown();
        let any = [-3.0, 3.0];
        acts(
            &contract,
            &commands.inherited(&contract, at(0)),
            &[(0.1, any, false), (0.15, any, true)],
        );
        commands.give(&contract, 1.0, at(0));
        commands.give(&contract, 2.0, at(100));
        let (last, both) = ([2.0; 2], [1.0, 2.0]);
        acts(
            &contract,
            &commands.inherited(&contract, at(200)),
            &[
                (0.05, any, false),
                (0.05, both, false),
                (0.05, both, true),
                (0.1, last, true),
            ],
        );
        // When the last one was given, anything before the first one was.
        assert_eq!(commands.in_effect(&contract), any);
        assert_eq!(commands.since_last(&contract), any);
        commands.give(&contract, 0.5, at(200));
        commands.give(&contract, 0.5, at(300));
        assert_eq!(commands.in_effect(&contract), [0.5, 2.0]);
        // Without a lag, what was in effect before that is over.
        assert_eq!(commands.since_last(&contract), [0.5, 2.0]);
    }

    /// Just before the next call: ten commands in flight, the one before them, and the acceleration itself.
    #[test]
    fn there_is_room_for_all_that_may_act_and_for_no_more() {
        let contract = WORST
            .to_builder()
            .latency(1.0)
            .ego_lag(0.2)
            .build()
            .unwrap();
        let mut commands = Commands::unknown();
        for i in 0..20 {
            commands.give(&contract, 1.0, Instant::from_millis(100 * i));
        }
        let inherited = commands.inherited(&contract, Instant::from_millis(1950));
        assert_eq!(
            (inherited.parts.len(), inherited.parts.capacity()),
            (12, 12)
        );
        assert_eq!(commands.flights.capacity(), 11);
    }

    #[test]
    fn with_a_lag_what_the_ego_had_counts_as_well() {
        let mut contract = INEXACT;
        (contract.ego.gain, contract.ego.disturbance) = (0.0, 0.0);
        (contract.jitter, contract.latency) = (0.0, 0.05);
        let at = Instant::from_millis;
        let mut commands = Commands::unknown();
        for (command, millis) in [(-6.0, 0), (-6.0, 100), (1.0, 200), (1.0, 300)] {
            commands.give(&contract, command, at(millis));
        }
        // When the last one was given only it and the one before acted; the drivetrain had more.
        assert_eq!(commands.in_effect(&contract), [1.0; 2]);
        let [least, most] = commands.since_last(&contract);
        assert!(
            (-6.0..-3.0).contains(&least) && (1.0..2.0).contains(&most),
            "{least}, {most}"
        );
        let inherited = commands.inherited(&contract, at(400));
        let parts: std::vec::Vec<_> = inherited.parts(&contract).collect();
        // What it has until a lag is over; then one command for the latency and a lag.
        let times: std::vec::Vec<_> = parts.iter().map(|part| part.time).collect();
        near([times[0] + times[1], times.iter().sum()], [0.2, 0.25]);
        assert!(parts[0].bounds[0] < 0.0 && parts[0].bounds[0] > 0.7 * least);
        assert_eq!(parts.last().unwrap().bounds, [1.0; 2]);
    }

    #[test]
    fn when_more_commands_are_in_flight_than_there_is_room_for_the_oldest_may_be_anything() {
        let contract = WORST.to_builder().latency(0.9).build().unwrap();
        let mut commands = Commands::unknown();
        for i in 0..30 {
            commands.give(&contract, 1.0, Instant::from_millis(100 * i));
        }
        assert_eq!(commands.in_effect(&contract), [1.0; 2]);
        // Given too fast, those of the last 0.5 s are all that is known.
        for i in 0..30 {
            commands.give(&contract, 1.0, Instant::from_millis(3000 + 50 * i));
        }
        assert_eq!(commands.in_effect(&contract), [-3.0, 3.0]);
    }
}
