//! What the caller's pointers point to is copied: nothing of this library refers to it afterwards.

use crate::status::cede_status;

/// Whether `pointer` is neither null nor misaligned.
pub(crate) fn checked<T>(pointer: *const T) -> Result<(), cede_status> {
    if pointer.is_null() {
        Err(cede_status::NullPointer)
    } else if !pointer.is_aligned() {
        Err(cede_status::Misaligned)
    } else {
        Ok(())
    }
}

/// Plain data of the header: numbers and pointers, any bits of which are a value.
///
/// # Safety
/// No bits may be invalid: no `bool`, no enumeration, no reference.
pub(crate) unsafe trait Plain: Copy {}

// SAFETY: these are numbers.
unsafe impl Plain for u8 {}
// SAFETY: as above.
unsafe impl Plain for u32 {}

/// A copy of what `pointer` points to.
///
/// # Safety
/// A pointer that is neither null nor misaligned points to a `T` that nobody writes to during the call.
pub(crate) unsafe fn read<T: Plain>(pointer: *const T) -> Result<T, cede_status> {
    checked(pointer)?;
    // SAFETY: not null, aligned, and there by the caller's contract; any bits of it are a `T`.
    Ok(unsafe { pointer.read() })
}

/// Writes `value`, whatever was there.
///
/// # Safety
/// A pointer that is neither null nor misaligned points to room for a `T` that is the library's during the call.
pub(crate) unsafe fn write<T: Copy>(pointer: *mut T, value: T) -> Result<(), cede_status> {
    checked(pointer)?;
    // SAFETY: not null, aligned, and the caller's to be written to.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Writes `value` if the caller wants it: null says no.
///
/// # Safety
/// As [`write`].
pub(crate) unsafe fn offer<T: Copy>(pointer: *mut T, value: T) -> Result<(), cede_status> {
    if pointer.is_null() {
        return Ok(());
    }
    // SAFETY: the caller's contract is ours.
    unsafe { write(pointer, value) }
}

/// The `count` values that `pointer` points to; null if there are none.
///
/// # Safety
/// A pointer that is neither null nor misaligned points to `count` values that nobody writes to for as long as `'a`.
pub(crate) unsafe fn slice<'a, T: Plain>(
    pointer: *const T,
    count: u32,
) -> Result<&'a [T], cede_status> {
    if count == 0 {
        return Ok(&[]);
    }
    checked(pointer)?;
    let count = count as usize;
    if count > isize::MAX as usize / size_of::<T>() {
        return Err(cede_status::TooLarge);
    }
    // SAFETY: not null, aligned, no larger than memory, and there by the caller's contract.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}
