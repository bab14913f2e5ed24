//! Objects in the caller's storage: made, lent, changed, each time checked.
//!
//! A sealed object starts with the number of its kind, mixed with its address, and a checksum of its bytes. What was never
//! made, is of another kind or was moved has another number; what was overwritten has another checksum. Nothing of the
//! value is looked at before both fit.

use crate::memory::checked;
use crate::status::cede_status;
use core::mem::MaybeUninit;
use core::sync::atomic::{Ordering, compiler_fence};

/// A type of the header that is storage for an object.
pub(crate) trait Storage: Sized {
    /// What is kept in it.
    type Value;
    /// Number of the kind.
    const KIND: u32;
    /// Holds if the object fits; checked when it is compiled.
    const FITS: () = assert!(
        size_of::<Object<Self::Value>>() <= size_of::<Self>()
            && align_of::<Object<Self::Value>>() <= align_of::<Self>()
            && size_of::<Object<Self::Value>>().is_multiple_of(WORD)
    );
}

/// What is at the start of the storage.
#[repr(C)]
pub(crate) struct Object<T> {
    kind: u32,
    seal: u32,
    value: T,
}

const WORD: usize = size_of::<u32>();

/// The kind of an object that is being worked on, or that never was one.
const NONE: u32 = 0;

/// Makes an object, whatever was there: `begin` fills its place.
///
/// # Safety
/// `begin` writes a value to the place. A pointer that is neither null nor misaligned points to storage that nobody else uses during the call.
pub(crate) unsafe fn make<S: Storage>(
    storage: *mut S,
    begin: impl FnOnce(&mut MaybeUninit<S::Value>),
) -> Result<(), cede_status> {
    let () = S::FITS;
    checked(storage)?;
    let object = storage.cast::<Object<S::Value>>();
    // SAFETY: the storage is there by the caller's contract, and large enough.
    unsafe {
        unseal(object);
        begin(&mut *(&raw mut (*object).value).cast());
        seal::<S>(object);
    }
    Ok(())
}

/// Makes an object of a value that is small enough to be copied.
///
/// # Safety
/// As [`make`].
pub(crate) unsafe fn store<S: Storage>(
    storage: *mut S,
    value: S::Value,
) -> Result<(), cede_status> {
    // SAFETY: by the caller's contract, and the place is written to.
    unsafe {
        make(storage, |place| {
            place.write(value);
        })
    }
}

/// The value of an object.
///
/// # Safety
/// As [`make`]; besides, nobody makes or changes the object as long as `'a`.
pub(crate) unsafe fn lend<'a, S: Storage>(storage: *const S) -> Result<&'a S::Value, cede_status> {
    // SAFETY: by the caller's contract.
    let object = unsafe { verified(storage) }?;
    // SAFETY: its bytes are those of a value that was written here.
    Ok(unsafe { &(*object).value })
}

/// What `work` gives on the value of an object.
///
/// # Safety
/// As [`make`].
pub(crate) unsafe fn change<S: Storage, R>(
    storage: *mut S,
    work: impl FnOnce(&mut S::Value) -> R,
) -> Result<R, cede_status> {
    // SAFETY: by the caller's contract.
    unsafe { verified(storage) }?;
    let object = storage.cast::<Object<S::Value>>();
    // SAFETY: its bytes are those of a value that was written here, and it is nobody else's during the call.
    unsafe {
        unseal(object);
        let result = work(&mut (*object).value);
        seal::<S>(object);
        Ok(result)
    }
}

/// The checksum of an object whose value has not changed since it was last lent, if it is still that object.
///
/// # Safety
/// As [`make`].
pub(crate) unsafe fn seal_of<S: Storage>(storage: *const S) -> Result<u32, cede_status> {
    checked(storage)?;
    let object = storage.cast::<Object<S::Value>>();
    // SAFETY: two words of the storage, which is there.
    let (kind, seal) = unsafe {
        (
            (&raw const (*object).kind).read_volatile(),
            (&raw const (*object).seal).read_volatile(),
        )
    };
    if kind == kind_at::<S>(storage) {
        Ok(seal)
    } else {
        Err(cede_status::NotInitialised)
    }
}

/// The object in the storage, if it is one and nothing has changed it.
unsafe fn verified<S: Storage>(storage: *const S) -> Result<*const Object<S::Value>, cede_status> {
    let () = S::FITS;
    // SAFETY: by the caller's contract.
    let seal = unsafe { seal_of(storage) }?;
    let object = storage.cast::<Object<S::Value>>();
    // SAFETY: the storage is there.
    if unsafe { checksum::<S>(object) } == seal || cfg!(feature = "planted-unsealed") {
        Ok(object)
    } else {
        Err(cede_status::Corrupt)
    }
}

/// Marks the object as being worked on: who interrupts the work and asks for it finds none.
unsafe fn unseal<T>(object: *mut Object<T>) {
    // SAFETY: a word of the storage, which is there.
    unsafe { (&raw mut (*object).kind).write_volatile(NONE) };
    compiler_fence(Ordering::SeqCst);
}

unsafe fn seal<S: Storage>(object: *mut Object<S::Value>) {
    compiler_fence(Ordering::SeqCst);
    // SAFETY: the storage is there.
    unsafe {
        let seal = checksum::<S>(object);
        (&raw mut (*object).seal).write_volatile(seal);
        (&raw mut (*object).kind).write_volatile(kind_at::<S>(object.cast_const().cast()));
    }
}

/// An object that is moved is none.
fn kind_at<S: Storage>(storage: *const S) -> u32 {
    S::KIND ^ storage.addr() as u32
}

/// Finds every change within one 32-bit word, and of any other all but one in 2³².
unsafe fn checksum<S: Storage>(object: *const Object<S::Value>) -> u32 {
    let words = size_of::<Object<S::Value>>() / WORD;
    let word = object.cast::<u32>();
    let mut sum = S::KIND;
    // The first two words are the kind and the checksum.
    for i in 2..words {
        // SAFETY: inside the object. Where a type has padding, Rust knows no value of it; the memory has one,
        // which a volatile read gives, and which stays because nobody writes between two calls.
        let value = unsafe { word.wrapping_add(i).read_volatile() };
        sum = checksum_step(sum, value);
    }
    sum
}

/// A bijection of the sum and of the word.
pub(crate) const fn checksum_step(sum: u32, word: u32) -> u32 {
    const ODD: u32 = 0x9e37_79b1;
    (sum.rotate_left(5) ^ word).wrapping_mul(ODD)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes that an object needs, and those that it has: what is left is room for versions to come.
    fn room<S: Storage>() -> (usize, usize) {
        (size_of::<Object<S::Value>>(), size_of::<S>())
    }

    #[test]
    fn the_storage_is_larger_than_it_must_be_but_not_much() {
        let rooms = [
            room::<crate::cede_policy>(),
            room::<crate::cede_drive>(),
            room::<crate::cede_junction>(),
            room::<crate::cede_approach>(),
        ];
        for (needs, has) in rooms {
            assert!(needs <= has && has <= needs + needs / 3 + 32, "{rooms:?}");
        }
    }
}
