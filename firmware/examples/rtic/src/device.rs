//! What RTIC needs to know of a microcontroller: its interrupts. A vendor's crate has it for yours.

/// The two interrupts of the board that its software tasks are run by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
#[allow(clippy::upper_case_acronyms)]
pub(crate) enum Interrupt {
    /// Number 0.
    UARTRX0 = 0,
    /// Number 1.
    UARTTX0 = 1,
}

// SAFETY: the numbers are those of the vectors below.
unsafe impl cortex_m::interrupt::InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

/// The name by which RTIC asks for it.
pub(crate) use Interrupt as interrupt;

/// Bits of an interrupt's priority.
pub(crate) const NVIC_PRIO_BITS: u8 = 3;

unsafe extern "C" {
    fn UARTRX0();
    fn UARTTX0();
}

/// The vectors behind those of the core.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); 2] = [UARTRX0, UARTTX0];
