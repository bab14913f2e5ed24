//! An attacker of the safety shield that shares nothing with the simulator.
//!
//! It has kinematics, geometry, error models, adversaries and random numbers of its own, in f64. Every scenario keeps the
//! contract, so that an overlap, a breach or a fault that is reported, or a decision without a plan after the first
//! verified one is the shield's fault.
//!
//! # What it takes from the controller
//!
//! Nothing but its public interface:
//!
//! - the numbers of a contract, which are the assumptions;
//! - what a junction states: the zones and the lines. Adversaries aim at zones; where C7 holds, they stay out of them and
//!   count arrivals at lines, as the rule says; scenarios end where zones do; a newcomer (U3) is shown before a plan
//!   needs its zone;
//! - decisions and plans, which adversaries look at.
//!
//! Who touches whom, who is ahead in a lane, and by which gap, is measured on the attacker's own polylines and rectangles
//! ([`shared`]). What a follower owes (C6) is measured there, too, and beside that in what the junction publishes as lanes:
//! they begin somewhat sooner, and the contract speaks of them.
//!
//! | | |
//! |---|---|
//! | [`plane`], [`polyline`], [`motion`] | rectangles, ways, pieces of constant acceleration |
//! | [`actuator`], [`error`], [`sight`], [`sway`] | what the contract allows: latency, errors, gaps, offsets |
//! | [`shared`] | lanes that are one, and who is in front there |
//! | [`human`] | adversaries, and what they owe |
//! | [`sketch`], [`site`], [`audit`] | random ways, the junctions that they make, whether zones cover them |
//! | [`scenario`], [`world`], [`judge`] | families of scenarios, one scenario, who touches whom |
//! | [`campaign`], [`search`] | scenarios by the million, and by cross entropy |
//! | [`mutants`] | shields with one broken rule, which are caught |
//! | [`outside`], [`plain`] | just outside of the contract, beside a plain rule |
//!
//! # What no test can show
//!
//! Some findings do not compile any more. A shield cannot be kept for the next intersection, because it borrows its junction:
//!
//! ```compile_fail,E0505
//! use cede_controller::{Contract, Junction, PathId, Shield};
//!
//! fn keep(first: Junction<2, 16>, path: PathId) {
//!     let shield = Shield::<8>::enter(Contract::WORST_CASE, &first, path);
//!     drop(first);
//!     let _ = shield;
//! }
//! ```
//!
//! Weights cannot be changed after they have been validated, because their fields are private:
//!
//! ```compile_fail,E0616
//! use cede_controller::{FeatureSet, Weights, WeightsError};
//!
//! fn changed<'a>(words: &'a [u32]) -> Result<Weights<'a>, WeightsError> {
//!     let mut weights = Weights::parse(words)?;
//!     weights.features = FeatureSet::Raw;
//!     Ok(weights)
//! }
//! ```

pub mod actuator;
pub mod audit;
pub mod body;
pub mod campaign;
pub mod corner;
pub mod error;
pub mod hidden;
pub mod human;
pub mod judge;
pub mod lane;
pub mod look;
pub mod motion;
pub mod mutants;
pub mod numbers;
pub mod outcome;
pub mod outside;
pub mod pilot;
pub mod plain;
pub mod plane;
pub mod polyline;
pub mod proposer;
pub mod report;
pub mod rng;
pub mod scenario;
pub mod search;
pub mod setup;
pub mod shared;
pub mod sight;
pub mod site;
pub mod sketch;
pub mod sway;
pub mod tally;
pub mod world;
