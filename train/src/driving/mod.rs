//! A network as a driver.
//!
//! `cede_sim::ObservationModel` computes what a vehicle of an encounter observes. [`inputs`] turns
//! this into a network's inputs, [`slopes`] differentiates them, [`policy_view`] turns outputs into
//! accelerations, and [`episodes`] and [`judge`] drive whole encounters.

pub mod dual;
pub mod episodes;
pub mod inputs;
pub mod judge;
pub mod policy_view;
pub mod replay;
pub mod slopes;
pub(crate) mod states;
