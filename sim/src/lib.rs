//! Drives vehicles through encounters and judges how: drivers, episodes, metrics, adversarial campaigns.
#![forbid(unsafe_code)]

pub mod batch;
pub mod campaign;
pub mod criticality;
pub mod driver;
pub mod episode;
pub mod evaluate;
#[cfg(test)]
mod fixture;
pub mod judge;
pub mod meeting;
pub mod metrics;
pub mod observation_model;
pub mod orientations;
pub mod reward;
pub mod statistics;
pub mod stepper;
pub mod traffic;
pub mod transparency;

pub use driver::{Driver, DriverFactory, View};
pub use judge::Judge;
pub use meeting::{Meeting, NoJunction};
pub use observation_model::{Bystanders, ObservationModel};
