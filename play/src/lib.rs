//! Cede's controller for a page: one vehicle at one junction, asked by numbers.
//!
//! A [`Desk`] answers [`Call`]s whose arguments and results are 32-bit words, so that a page, and a program on the
//! host that repeats what a page asked, get the same words. A desk serves one junction; the next one needs a new desk
//! (in a browser, a new instance of the module).
#![no_std]

mod call;
mod contract;
mod desk;
mod refusal;
#[cfg(target_arch = "wasm32")]
mod wasm;
mod words;

pub use call::Call;
pub use desk::{Desk, Junction, Place};
pub use refusal::Refusal;
pub use words::{Input, Output, WORDS};
