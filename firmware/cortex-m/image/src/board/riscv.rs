//! A RISC-V core of QEMU's `virt` machine: its serial port, its test device, and the counter of retired instructions.

use core::arch::{asm, global_asm};

// FPU on, where there is one; the stack painted as `cortex-m-rt` does it.
global_asm!(
    ".section .init, \"ax\"",
    ".global _start",
    "_start:",
    "la sp, _stack_start",
    "li t0, 0x2000",
    "csrs mstatus, t0",
    "la t0, _stack_end",
    "la t1, _stack_start",
    "li t2, {paint}",
    "1: sw t2, 0(t0)",
    "addi t0, t0, 4",
    "blt t0, t1, 1b",
    "j cede_start",
    paint = const super::PAINT,
);

/// Where the serial port takes a character, and the test device a verdict.
const SERIAL: *mut u8 = 0x1000_0000 as *mut u8;
const TEST: *mut u32 = 0x0010_0000 as *mut u32;
const PASSED: u32 = 0x5555;
const FAILED: u32 = 0x0001_3333;

#[unsafe(no_mangle)]
extern "C" fn cede_start() -> ! {
    crate::main()
}

pub(crate) fn write(text: &[u8]) {
    for &byte in text {
        // SAFETY: QEMU's serial port is there and always takes a character.
        unsafe { SERIAL.write_volatile(byte) };
    }
}

pub(crate) fn exit(success: bool) -> ! {
    let verdict = if success { PASSED } else { FAILED };
    // SAFETY: QEMU's test device is there; it ends the machine.
    unsafe { TEST.write_volatile(verdict) };
    loop {}
}

pub(crate) fn stack_pointer() -> *mut u32 {
    let pointer;
    // SAFETY: it reads a register.
    unsafe { asm!("mv {}, sp", out(reg) pointer, options(nomem, nostack)) };
    pointer
}

/// The counter of retired instructions.
pub(crate) struct Clock;

impl Clock {
    /// A tick is an instruction.
    pub(crate) const INSTRUCTION: u32 = 1;
    pub(crate) const TICK: u32 = 1;

    pub(crate) fn take() -> Option<Self> {
        Some(Self)
    }

    /// The instructions that `work` takes.
    #[inline(never)]
    pub(crate) fn ticks<T>(&mut self, work: impl FnOnce() -> T) -> (T, u32) {
        let before = retired();
        let result = core::hint::black_box(work());
        (result, retired().wrapping_sub(before))
    }
}

fn retired() -> u32 {
    let count;
    // SAFETY: it reads a counter.
    unsafe { asm!("csrr {}, minstret", out(reg) count) };
    count
}
