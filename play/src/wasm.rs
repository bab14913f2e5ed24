//! What the module exports: a place for words, and a call. All `unsafe` of the crate is here.
#![allow(unsafe_code)]

use crate::desk::{Desk, Place};
use crate::words::{Input, Output, WORDS};
use core::cell::{OnceCell, RefCell};
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

#[cfg(target_feature = "atomics")]
compile_error!("with threads, the desk would need a lock");

/// Something that only one thread can see.
struct Single<T>(T);

// SAFETY: without the target feature `atomics` a module has one thread.
unsafe impl<T> Sync for Single<T> {}

// Atomic only so that the page can write to them between two calls.
static WORDS_OF_CALL: [AtomicU32; WORDS] = [const { AtomicU32::new(0) }; WORDS];
static PLACE: Single<Place> = Single(OnceCell::new());
static DESK: Single<OnceCell<RefCell<Desk<'static>>>> = Single(OnceCell::new());

/// Where a call's words are written before it, and its answer's are read after it.
// SAFETY: no other function has this name.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn words() -> *const AtomicU32 {
    WORDS_OF_CALL.as_ptr()
}

/// Answers call number `call`, which has `count` words: the number of words of the answer, or -1 if it is refused.
// SAFETY: no other function has this name.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn call(call: u32, count: u32) -> i32 {
    let desk = DESK.0.get_or_init(|| RefCell::new(Desk::new(&PLACE.0)));
    let mut question = [0; WORDS];
    let count = (count as usize).min(WORDS);
    for (to, from) in question.iter_mut().zip(&WORDS_OF_CALL).take(count) {
        *to = from.load(Relaxed);
    }
    let mut out = Output::new();
    let accepted = match desk.try_borrow_mut() {
        Ok(mut desk) => desk.call(call, Input(question.get(..count).unwrap_or(&[])), &mut out),
        Err(_) => false,
    };
    for (to, &from) in WORDS_OF_CALL.iter().zip(out.words()) {
        to.store(from, Relaxed);
    }
    match i32::try_from(out.words().len()) {
        Ok(count) if accepted => count,
        _ => -1,
    }
}

/// Nothing here panics on purpose; a trap ends the call, and the page says so.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
