//! Which library and which interface this is, and how much room its objects need.

use crate::approach::cede_approach;
use crate::drive::cede_drive;
use crate::junction::cede_junction;
use crate::policy::cede_policy;
use core::ffi::{CStr, c_char};

/// The version of this interface. A program compares it with cede_abi_version() once, at its start: it grows with every
/// change of a structure, a size, a number or the meaning of a function.
pub const CEDE_ABI_VERSION: u32 = 5;

/// Alignment of all objects in bytes.
pub const CEDE_ALIGNMENT: u32 = 8;

/// The library's CEDE_ABI_VERSION.
#[unsafe(no_mangle)]
pub extern "C" fn cede_abi_version() -> u32 {
    crate::planted::fault();
    CEDE_ABI_VERSION
}

const VERSION: &CStr =
    match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(version) => version,
        Err(_) => c"",
    };

/// The library's version in words, as in "0.2.0".
#[unsafe(no_mangle)]
pub extern "C" fn cede_version() -> *const c_char {
    VERSION.as_ptr()
}

/// Alignment of all objects in bytes, CEDE_ALIGNMENT.
#[unsafe(no_mangle)]
pub extern "C" fn cede_alignment() -> u32 {
    CEDE_ALIGNMENT
}

/// Bytes of a cede_policy.
#[unsafe(no_mangle)]
pub extern "C" fn cede_policy_size() -> u32 {
    size_of::<cede_policy>() as u32
}

/// Bytes of a cede_drive.
#[unsafe(no_mangle)]
pub extern "C" fn cede_drive_size() -> u32 {
    size_of::<cede_drive>() as u32
}

/// Bytes of a cede_junction.
#[unsafe(no_mangle)]
pub extern "C" fn cede_junction_size() -> u32 {
    size_of::<cede_junction>() as u32
}

/// Bytes of a cede_approach.
#[unsafe(no_mangle)]
pub extern "C" fn cede_approach_size() -> u32 {
    size_of::<cede_approach>() as u32
}
