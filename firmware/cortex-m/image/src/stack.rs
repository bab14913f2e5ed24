//! How much RAM was ever touched: the start-up code paints all of it.

/// What `cortex-m-rt` paints the stack with.
const PAINT: u32 = 0xcccc_cccc;

unsafe extern "C" {
    static _stack_end: u32;
    static _stack_start: u32;
    static __sdata: u32;
}

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
