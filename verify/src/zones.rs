//! Whether the zones of a junction cover every overlap: a check of what `cede_controller::junction` publishes.
//!
//! [`check`] reads paths, footprints, tolerance and zones ([`Site`]), and no code that makes zones. It shows, for all
//! places of two vehicles on their paths that no zone holds, that the footprints are apart, in every heading of
//! definition D2 of `docs/theorem.md`: by branch and bound, in intervals with outward rounding.

mod body;
mod cell;
pub mod example;
mod search;
mod site;
#[cfg(test)]
mod tests;

pub use search::{Checked, Failing, Verdict, check};
pub use site::{Pair, Path, Site, SiteError, Zone};

/// The zones hold footprints that are larger than the tolerance makes them by this (m) on every side: what is left to the
/// rounding of places in `f32`.
pub const RESERVE: f64 = 0.01;
