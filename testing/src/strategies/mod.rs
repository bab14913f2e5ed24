//! Proptest strategies for everything that the controller is told.
//!
//! Values shrink towards a case that a person can read: few vehicles, straight roads, round numbers, exact sensors. Each
//! displays in words.
//!
//! ```
//! use cede_controller::Contract;
//! use cede_testing::strategies;
//! use proptest::prelude::*;
//!
//! proptest!(ProptestConfig::with_cases(8), |(case in strategies::case(&Contract::WORST_CASE))| {
//!     let junction = case.place.junction(cede_controller::Footprint::PAPER).unwrap();
//!     prop_assert_eq!(junction.paths().len(), 6);
//! });
//! ```

mod case;
mod contract;
mod motion;
mod observation;
mod place;

pub(crate) use case::case_of_two;
pub use case::{case, noise};
pub use contract::{Refused, contract, refused_contract};
pub use motion::{script, script_outside};
pub use observation::{AnyCall, AnyCalls, AnyObservation, calls, observation};
pub use place::{arm, place};
