//! The bridge from the reals to `f32`: how far rounding can move the shield's margins.
//!
//! The theorem of `docs/theorem.md` is about real numbers; the vehicle computes in `f32`. [`bound`] shows, for all
//! inputs of an operating domain, that the two margins differ by at most so many metres wherever that could
//! turn a no into a yes; a contract's slack above it makes the shield's yes a yes in the reals.

mod periods;
mod predicate;
mod rounded;
mod search;
#[cfg(test)]
mod tests;

pub use periods::shortfall;
pub use predicate::{Input, Predicate, Region};
pub use search::{Bound, bound};
