//! How much RAM was touched since it was painted; the start-up code paints all of it first.

use crate::board::PAINT;

unsafe extern "C" {
    static _stack_end: u32;
    static _stack_start: u32;
    static __sdata: u32;
}

/// Paints what lies below the caller's stack frame anew.
#[inline(never)]
pub(crate) fn paint() {
    let end = (&raw const _stack_end).cast_mut();
    let mut word = crate::board::stack_pointer().wrapping_sub(MARGIN);
    // SAFETY: the words between the end of the stack and its pointer are nobody's, and the margin
    // keeps clear of what this function itself may have there.
    while word > end {
        word = word.wrapping_sub(1);
        unsafe { word.write_volatile(PAINT) };
    }
}

/// Words below the stack pointer that are not painted.
const MARGIN: usize = 8;

/// Bytes of RAM: statics, and the stack from its start down to the deepest word that is no longer paint.
pub(crate) fn touched() -> u32 {
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let mut deepest = end;
    // SAFETY: the linker script puts the stack, all of it RAM, between the two symbols.
    while deepest < start && unsafe { deepest.read_volatile() } == PAINT {
        deepest = deepest.wrapping_add(1);
    }
    let statics = (end as u32).wrapping_sub(&raw const __sdata as u32);
    (start as u32).wrapping_sub(deepest as u32) + statics
}
