//! Who touches whom, looked for after every tick in which it is possible.

use crate::lane::Lane;
use crate::motion::{State, TICK};
use crate::plane::{Place, separation};
use crate::sway::Sway;

/// Corners of a vehicle that turns are faster than its centre, by this factor at most.
const CORNERS: f64 = 1.7;

/// Two vehicles together do not become faster than this (m/s) within [`LONGEST`].
const FASTER: f64 = 2.5;

/// The longest time between two looks, in ticks.
const LONGEST: f64 = 50.0;

/// Ticks in which two vehicles that are `gap` m apart cannot touch.
fn free_ticks(gap: f64, seen: [Seen<'_>; 2]) -> u64 {
    // A kink moves corners within a short way.
    let [a, b] = seen.map(|seen| seen.lane.jump);
    let closing = CORNERS * (seen[0].state.v + seen[1].state.v + FASTER);
    let ticks = (gap - a - b) / (closing * TICK);
    ticks.clamp(0.0, LONGEST) as u64
}

/// A vehicle as the judge sees it.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'s> {
    /// Its lane.
    pub lane: &'s Lane,
    /// Where it is beside it.
    pub sway: Sway,
    /// Its motion.
    pub state: State,
}

impl Seen<'_> {
    /// Where it is.
    #[must_use]
    pub fn place(&self) -> Place {
        self.sway.place(&self.lane.line, self.state.s)
    }
}

/// Watches pairs, and knows for each when it has to look again.
#[derive(Clone, Debug)]
pub struct Judge {
    count: usize,
    /// The tick at which the pair can touch at the earliest.
    next: Vec<u64>,
    /// The least separation so far of a pair that was looked at.
    pub closest: f64,
}

impl Judge {
    /// For so many vehicles.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self {
            count,
            next: vec![0; count * count],
            closest: f64::INFINITY,
        }
    }

    /// Whether vehicles `a` and `b`, which are `seen` at the end of `tick`, touch.
    pub fn touch(&mut self, tick: u64, (a, b): (usize, usize), seen: [Seen<'_>; 2]) -> bool {
        let next = &mut self.next[a * self.count + b];
        if tick < *next {
            return false;
        }
        let [one, two] = seen;
        let (sa, sb) = (one.lane.size, two.lane.size);
        let (pa, pb) = (one.place(), two.place());
        let gap = separation(pa, sa, pb, sb);
        *next = tick + 1 + free_ticks(gap, [one, two]);
        self.closest = self.closest.min(gap);
        gap < 0.0
    }
}
