//! Encounters at unsignalized intersections, and the drivers that are judged on them.
#![forbid(unsafe_code)]

pub mod batch;
pub mod campaign;
pub mod data;
pub mod driver;
pub mod encounter;
pub mod episode;
pub mod evaluate;
#[cfg(test)]
mod fixture;
pub mod judge;
pub mod kinematics;
pub mod metrics;
pub mod output;
pub mod overlap;
pub mod reward;
pub mod sight;
pub mod statistics;
pub mod synthetic;
pub mod transparency;

pub use data::Dataset;
pub use driver::{Driver, DriverFactory, State, View};
pub use encounter::{Encounter, EncounterId, Manoeuvre, Participant, Role, Sample, SimRoute};
pub use judge::Judge;
pub use kinematics::{advance, clamp_acceleration};
pub use overlap::OrientedBox;
pub use sight::{Bystanders, Sight};
