//! Encounters at unsignalized intersections, and the drivers that are judged on them.
#![forbid(unsafe_code)]

pub mod driver;
pub mod encounter;

pub use driver::{Driver, DriverFactory, State, View};
pub use encounter::{Encounter, EncounterId, Manoeuvre, Participant, Role, Sample, SimRoute};
