//! Counts instructions under QEMU's `-icount shift=10`, where each takes 1,024 ns of the board's time.
//!
//! They are instructions, not cycles: QEMU models no pipeline, no wait states and no cache.

use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// Nanoseconds of an instruction and of a tick of the boards' 25 MHz clock.
const INSTRUCTION: u32 = 1024;
const TICK: u32 = 40;

/// Counts up to 655,000 instructions at a time.
pub(crate) struct Counter {
    clock: SYST,
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
        let mut clock = Peripherals::take()?.SYST;
        clock.set_clock_source(SystClkSource::Core);
        clock.set_reload(0x00ff_ffff);
        clock.clear_current();
        clock.enable_counter();
        let mut counter = Self { clock, overhead: 0 };
        counter.overhead = counter.ticks(|| ()).1;
        Some(counter)
    }

    /// What `work` gives, and the instructions that it took.
    pub(crate) fn count<T>(&mut self, work: impl FnOnce() -> T) -> (T, u32) {
        let (result, ticks) = self.ticks(work);
        let ticks = ticks.saturating_sub(self.overhead);
        (result, (ticks * TICK + INSTRUCTION / 2) / INSTRUCTION)
    }

    #[inline(never)]
    fn ticks<T>(&mut self, work: impl FnOnce() -> T) -> (T, u32) {
        self.clock.clear_current();
        let before = SYST::get_current();
        let result = core::hint::black_box(work());
        let after = SYST::get_current();
        (result, before.wrapping_sub(after) & 0x00ff_ffff)
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
