//! A Cortex-M under QEMU: semihosting, and SysTick for a clock.

use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hio};

#[entry]
fn start() -> ! {
    crate::main()
}

/// Writes to the host's standard output. An image without a console still has its exit status.
pub(crate) fn write(text: &[u8]) {
    if let Ok(mut out) = hio::hstdout() {
        let _ = out.write_all(text);
    }
}

pub(crate) fn exit(success: bool) -> ! {
    debug::exit(if success {
        debug::EXIT_SUCCESS
    } else {
        debug::EXIT_FAILURE
    });
    loop {
        cortex_m::asm::wfi();
    }
}

pub(crate) fn stack_pointer() -> *mut u32 {
    cortex_m::register::msp::read() as *mut u32
}

/// The boards' clock of 25 MHz, of 24 bits, which may wrap once.
pub(crate) struct Clock(SYST);

/// Ticks until the clock wraps.
const ROUND: u32 = 1 << 24;

impl Clock {
    /// Nanoseconds of an instruction, under QEMU's `-icount shift=10`, or 6 where there is no FPU and more to count.
    pub(crate) const INSTRUCTION: u32 = if cfg!(target_abi = "eabihf") {
        1024
    } else {
        64
    };
    /// Nanoseconds of a tick.
    pub(crate) const TICK: u32 = 40;

    /// The board's one clock; `None` when it is taken already.
    pub(crate) fn take() -> Option<Self> {
        let mut clock = Peripherals::take()?.SYST;
        clock.set_clock_source(SystClkSource::Core);
        clock.set_reload(ROUND - 1);
        clock.clear_current();
        clock.enable_counter();
        Some(Self(clock))
    }

    /// The ticks that `work` takes.
    #[inline(never)]
    pub(crate) fn ticks<T>(&mut self, work: impl FnOnce() -> T) -> (T, u32) {
        self.0.clear_current();
        let before = SYST::get_current();
        let result = core::hint::black_box(work());
        let after = SYST::get_current();
        let rounds = if self.0.has_wrapped() && after < before {
            ROUND
        } else {
            0
        };
        (result, (before.wrapping_sub(after) & (ROUND - 1)) + rounds)
    }
}
