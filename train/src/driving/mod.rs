//! A network in the driver's seat.
//!
//! `cede_sim::ObservationModel` says what a vehicle of an encounter observes; [`inputs`] makes it a
//! network's inputs and [`slopes`] carries derivatives back; [`policy_view`] turns outputs into
//! accelerations; [`episodes`] and [`judge`] drive whole encounters.

pub mod dual;
pub mod episodes;
pub mod inputs;
pub mod judge;
pub mod policy_view;
pub mod replay;
pub mod slopes;
pub(crate) mod states;
