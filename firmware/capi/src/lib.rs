//! Cede's controller as a C library. `include/cede.h` is generated from this crate; `docs/integration.md` is its manual.
//!
//! Every function checks its pointers and its objects, copies its arguments, calls the controller, and writes the results.
//! The controller itself has no `unsafe`; all of it is here, in `memory`, `object` and one block of each function.
//!
//! # Panics
//!
//! With the feature `std` the standard library has the panic handler. Without it this crate has one that calls a function
//! which does not exist: what links cannot panic. It needs a release build, because a debug build keeps checks that may panic.
#![cfg_attr(not(feature = "std"), no_std)]
// The names are C's, so that there is one name for each thing.
#![allow(non_camel_case_types)]
// What a pointer must point to is said once, at the top of the header, for all functions.
#![allow(clippy::missing_safety_doc)]

mod approach;
mod contract;
mod decision;
mod detail;
mod drive;
mod field;
mod inspect;
mod junction;
mod known_answer;
mod memory;
mod object;
mod observation;
mod planted;
mod policy;
mod self_test;
mod status;
mod text;
mod version;

#[cfg(not(feature = "std"))]
mod bare;

pub use approach::*;
pub use contract::*;
pub use decision::*;
pub use detail::*;
pub use drive::*;
pub use field::*;
pub use inspect::*;
pub use junction::*;
pub use known_answer::*;
pub use observation::*;
pub use policy::*;
pub use self_test::*;
pub use status::*;
pub use text::*;
pub use version::*;
