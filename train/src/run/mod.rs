//! A training run of any algorithm, as the command line starts it.
//!
//! | | |
//! |---|---|
//! | [`Algorithm`], [`TrainSettings`] | what to train with; settings as TOML, checked against their ranges |
//! | [`Lessons`] | what a run learns from |
//! | [`Run`], [`Progress`], [`Report`] | the run, its state, and what a slice of its work did |
//! | [`curve`], [`log`] | the learning curve, and its files for plots |
//! | [`checkpoint`] | a run's state in a file |
//! | [`provenance`] | what a policy was trained from |

mod algorithm;
pub mod checkpoint;
pub mod curve;
mod lessons;
pub mod log;
pub mod provenance;
mod ranges;
mod runner;
mod settings;

pub use algorithm::Algorithm;
pub use lessons::Lessons;
pub use ranges::OutOfRange;
pub use runner::{Progress, Report, Run};
pub use settings::TrainSettings;
