//! Counts instructions under QEMU's `-icount`, where each takes the same time of the board.
//!
//! They are instructions, not cycles: QEMU models no pipeline, no wait states and no cache.

use crate::board::Clock;

/// Counts the instructions of some work.
pub(crate) struct Counter {
    clock: Clock,
    /// What counting itself takes, in ticks.
    overhead: u32,
}

/// Fewest and most instructions.
pub(crate) struct Range {
    pub(crate) least: u32,
    pub(crate) most: u32,
}

impl Counter {
    /// The board's one counter; `None` when it is taken already.
    pub(crate) fn take() -> Option<Self> {
        let mut clock = Clock::take()?;
        let overhead = clock.ticks(|| ()).1;
        Some(Self { clock, overhead })
    }

    /// What `work` gives, and the instructions that it took.
    pub(crate) fn count<T>(&mut self, work: impl FnOnce() -> T) -> (T, u32) {
        let (result, ticks) = self.clock.ticks(work);
        let ticks = ticks.saturating_sub(self.overhead);
        (
            result,
            (ticks * Clock::TICK + Clock::INSTRUCTION / 2) / Clock::INSTRUCTION,
        )
    }
}

impl Range {
    pub(crate) const EMPTY: Self = Self {
        least: u32::MAX,
        most: 0,
    };

    pub(crate) fn add(&mut self, count: u32) {
        self.least = self.least.min(count);
        self.most = self.most.max(count);
    }
}
