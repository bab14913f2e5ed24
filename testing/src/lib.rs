//! Checks of your own policy, contract and vehicle, behind the shield of [`cede_controller`].
//!
//! They are those that the policy gets that ships with the controller. In a test of your own:
//!
//! ```
//! use cede_controller::{Contract, Footprint, Policy};
//! use cede_testing::{Suite, Vehicle};
//!
//! // Or `cede_controller::include_weights!("own.cede")`.
//! let policy = Policy::new(cede_controller::policy::embedded::words())?;
//! let contract = Contract::builder().ego_braking(4.0).latency(0.08).build()?;
//! // What the vehicle achieves on the worst road, as it was measured.
//! let vehicle = Vehicle::new(Footprint { length: 4.6, width: 1.9 }).braking(4.2).latency(0.08);
//! let report = Suite::new(policy, contract).vehicle(vehicle).cases(4).seed(1).run();
//! report.assert_passed();
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`Report`] names for each check what it demands, and for each that fails the number to change and the simplest case
//! that was found, in words and as a picture. [`Report::to_junit`] and [`Report::to_json`] are for machines. The program
//! `cede-conformance` (feature `cli`) does the same with files.
//!
//! # What a passed suite is worth
//!
//! It is a test, not a proof: the shield's guarantee within the contract is proved elsewhere. What the suite adds is
//! yours: that the contract is no bolder than the vehicle, that the policy drives and does not leave it to the shield,
//! and that the build on your machine does what the proof is about. The others of its cases keep the contract; whether
//! those on your roads do is not checked.
//!
//! # Where things are
//!
//! | | |
//! |---|---|
//! | [`Suite`], [`Vehicle`] | what is checked |
//! | [`Report`], [`Outcome`], [`Failure`] | what came of it |
//! | [`strategies`] | proptest strategies, for tests of your own |
//! | [`Case`], [`Place`] | what they draw |
#![forbid(unsafe_code)]

mod case;
mod check;
mod hunt;
mod pilot;
mod place;
mod report;
mod run;
pub mod strategies;
mod subject;
mod suite;
mod trace;
mod vehicle;
mod world;

pub use case::{Case, Level, Noise, Other, Proposals, Push};
pub use place::{Place, Right, Road, Shape, TestJunction};
pub use report::{Failure, Outcome, Report, Verdict};
pub use suite::{Suite, checks};
pub use vehicle::{Bold, Vehicle, mend};
