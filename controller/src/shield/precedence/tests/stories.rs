//! Two vehicles that come to a crossing, rest, creep and go, as two shields see them.
//!
//! Time goes in tenths of a period. The shields are called once a period each, at phases of their own, early or late by
//! the jitter; they err, miss frames and calls, and one of them may be switched on late.

use super::super::super::contract::{Contract, Precedence};
use super::super::super::rules::Rules;
use super::super::{Priority, RightOfWay, has};
use super::watcher::{LINE, State, Watcher, contract};
use crate::instant::Instant;
use proptest::prelude::*;
use std::vec::Vec;

/// Steps a period.
const GRAIN: usize = 10;

/// Seconds a step.
const STEP: f32 = 0.01;

/// What is wrong, so that it must be caught.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    None,
    /// Sensed places err more than the contract says.
    Places,
    /// Sensed speeds err more than the contract says.
    Speeds,
    /// A shield that is switched on takes everybody for one that has just moved.
    Late,
    /// Periods without a call are not counted.
    Missed,
    /// Two calls above the speed of rest are taken for motion throughout.
    Motion,
}

/// What a vehicle does for how many steps, at which acceleration.
type Manner = (usize, f32);

#[derive(Clone, Debug)]
pub(super) struct Story {
    contract: Contract,
    rights: [RightOfWay; 2],
    priority: Priority,
    motions: [Vec<State>; 2],
    /// Steps by which the second one's calls are later.
    phase: usize,
    /// Steps by which a call may be early or late.
    jitter: usize,
    /// Period in which the first one's shield is switched on.
    starts: usize,
    /// Whether frames and calls are missed now and then.
    misses: bool,
    seed: u64,
}

fn manners() -> impl Strategy<Value = Vec<Manner>> {
    let rests = (1_usize..60).prop_map(|periods| std::vec![(GRAIN * periods, -3.0)]);
    let drives = (5_usize..40, -3.0_f32..3.0).prop_map(|manner| std::vec![manner]);
    // To and fro within a period.
    let rocks = (1_usize..4, 0.5_f32..3.0)
        .prop_map(|(times, a)| (0..times).flat_map(|_| [(5, a), (5, -a)]).collect());
    let all = prop_oneof![3 => rests, 2 => drives, 2 => rocks];
    prop::collection::vec(all, 1..25).prop_map(|all| all.concat())
}

/// States after each step, the first of them on the way to the line.
fn motion(start: f32, manners: &[Manner]) -> Vec<State> {
    let (mut s, mut v) = (LINE - 30.0 + start, 8.0_f32);
    let mut states = Vec::new();
    let far = LINE - 0.5 + 0.1 * start;
    while s + 0.5 * v * v / 3.0 < far {
        s += STEP * v;
        states.push([s, v]);
    }
    let stops = (300, -3.0);
    for (steps, a) in [stops].iter().chain(manners).copied() {
        for _ in 0..steps {
            let next = (v + STEP * a).max(0.0);
            s += 0.5 * STEP * (v + next);
            v = next;
            states.push([s, v]);
        }
    }
    states
}

prop_compose! {
    pub(super) fn story()(
        (patience, tie) in (5_u16..20, 0_u16..4),
        errors in [prop_oneof![Just(0.0_f32), 0.0_f32..0.3], prop_oneof![Just(0.0_f32), 0.0_f32..0.3]],
        right in 0_usize..3, starts in [-12.0_f32..3.0, -12.0_f32..3.0],
        manners in [manners(), manners()], seed in any::<u64>(),
        phase in 0..GRAIN, jitter in prop_oneof![2 => Just(0), 1 => Just(1)],
        late in prop_oneof![2 => Just(0), 1 => 0_usize..120], misses in any::<bool>(),
        priority in prop_oneof![
            2 => Just(Priority::FirstCome), 2 => Just(Priority::Unsigned), 1 => Just(Priority::Signed)
        ],
    ) -> Story {
        use RightOfWay::{Ego, Other, Unsettled};
        Story {
            contract: Contract {
                position_error: errors[0],
                speed_error: errors[1],
                jitter: STEP * jitter as f32,
                ..contract(patience, tie)
            },
            rights: [[Ego, Other], [Other, Ego], [Unsettled; 2]][right],
            priority,
            motions: [0, 1].map(|i| motion(starts[i], &manners[i])),
            phase,
            jitter,
            starts: late,
            misses,
            seed,
        }
    }
}

/// Numbers from 0 to 1.
struct Random(u64);

impl Random {
    fn draw(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1_u32 << 24) as f32
    }

    /// From -1 to 1, the ends more often than the rest.
    fn error(&mut self) -> f32 {
        (3.0 * (2.0 * self.draw() - 1.0)).clamp(-1.0, 1.0)
    }
}

impl Story {
    fn truth(&self, step: usize) -> Option<[State; 2]> {
        let [one, two] = &self.motions;
        Some([*one.get(step)?, *two.get(step)?])
    }

    /// The step of call number `k` of shield `i`.
    fn call(&self, i: usize, k: usize, random: &mut Random) -> usize {
        let shift = (random.error() * self.jitter as f32).round();
        (GRAIN * (k + 1) + i * self.phase).saturating_add_signed(shift as isize)
    }

    /// What shield `i` senses.
    fn sense(&self, i: usize, state: State, fault: Fault, random: &mut Random) -> State {
        let contract = &self.contract;
        let more = if fault == Fault::Places { 3.0 } else { 0.0 };
        // The second one takes whoever is slow for one at rest.
        let less = if fault == Fault::Speeds && i == 1 {
            0.8
        } else {
            0.0
        };
        let [s, v] = state;
        [
            s + (contract.position_error + more) * random.error(),
            (v - less + contract.speed_error * random.error()).max(0.0),
        ]
    }
}

/// A shield, when it is called next, and what it misses.
struct Caller {
    watcher: Watcher,
    calls: usize,
    next: usize,
    /// Calls that it misses.
    away: usize,
    /// Calls for which it does not see each of the two.
    dark: [usize; 2],
}

impl Caller {
    fn new(story: &Story, i: usize, fault: Fault) -> Self {
        let mut watcher = Watcher::under(story.contract, story.rights[i], story.priority);
        watcher.hasty = fault == Fault::Motion;
        let calls = if i == 0 { story.starts } else { 0 };
        if fault == Fault::Late && calls > 0 {
            watcher.assume_motion();
        }
        Self {
            watcher,
            calls,
            next: GRAIN * (calls + 1) + i * story.phase,
            away: 0,
            dark: [0; 2],
        }
    }

    fn step<R: Rules>(
        &mut self,
        (story, fault): (&Story, Fault),
        (i, step): (usize, usize),
        truth: [State; 2],
        random: &mut Random,
    ) {
        if step != self.next {
            return;
        }
        self.calls += 1;
        self.next = story.call(i, self.calls, random);
        let bad = |random: &mut Random| story.misses && random.draw() < 0.02;
        let burst = |random: &mut Random| 1 + (7.0 * random.draw()) as usize;
        self.away = self.away.saturating_sub(1);
        if bad(random) {
            self.away = burst(random);
        }
        if self.away > 0 {
            self.watcher.missed += u16::from(fault != Fault::Missed);
            // Without a call it decides nothing, and goes on with what it decided.
            self.watcher.claims = 0;
            return;
        }
        for dark in &mut self.dark {
            *dark = dark.saturating_sub(1);
            if bad(random) {
                *dark = burst(random);
            }
        }
        let sensed = [0, 1].map(|j| {
            let sensed = story.sense(i, truth[j], fault, random);
            (self.dark[j] == 0).then_some(sensed)
        });
        let now = Instant::from_millis(1000 + 10 * step as u64);
        self.watcher.call::<R>(sensed, i, now);
    }
}

/// Whether at some time both rely on precedence, or one does though the other did so within the last two
/// periods.
pub(super) fn both<R: Rules>(story: &Story, fault: Fault) -> bool {
    let mut random = Random(story.seed | 1);
    let mut callers = [0, 1].map(|i| Caller::new(story, i, fault));
    // Steps since each relied on it.
    let mut since = [2 * GRAIN; 2];
    for step in 0.. {
        let Some(truth) = story.truth(step) else {
            return false;
        };
        for (i, caller) in callers.iter_mut().enumerate() {
            caller.step::<R>((story, fault), (i, step), truth, &mut random);
        }
        let relies = [0, 1].map(|i| {
            let [s, v] = truth[1 - i];
            let braking = story
                .contract
                .precedence
                .map_or(1.0, |rule: Precedence| rule.braking);
            // The other can still stop: an exact sensor would show that.
            has(callers[i].watcher.claims, 0) && s + 0.5 * v * v / braking <= LINE
        });
        for i in [0, 1] {
            since[i] = if relies[i] { 0 } else { since[i] + 1 };
        }
        if (0..2).any(|i| relies[i] && since[1 - i] < 2 * GRAIN) {
            return true;
        }
    }
    false
}
