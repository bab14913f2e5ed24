//! What differs between the boards: start, console, exit, stack and clock.

#[cfg(not(target_arch = "riscv32"))]
mod cortex_m;
#[cfg(target_arch = "riscv32")]
mod riscv;

#[cfg(not(target_arch = "riscv32"))]
pub(crate) use cortex_m::{Clock, exit, stack_pointer, write};
#[cfg(target_arch = "riscv32")]
pub(crate) use riscv::{Clock, exit, stack_pointer, write};

/// What the start-up code paints the stack with, as `cortex-m-rt` does.
pub(crate) const PAINT: u32 = 0xcccc_cccc;
