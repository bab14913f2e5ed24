//! Trains the policies that `cede-controller` runs.
//!
//! One file an algorithm: [`bc`] (behaviour cloning), [`sac`] (SAC, SACER-V, SACER-SVO) and [`apg`]
//! (analytic policy gradient, our own). What they share: [`network`] with its gradients,
//! [`adam`], [`gaussian`], [`replay`] and [`learner`]; `cede_sim::Sight` says what a vehicle of an
//! encounter sees, [`inputs`] and [`slopes`] make it a network's inputs and carry derivatives back.
#![deny(unsafe_code)]

pub mod adam;
pub mod apg;
pub mod bc;
pub mod checkpoint;
pub mod claims;
pub mod closed_loop;
pub mod cost;
pub mod curve;
pub mod episodes;
pub mod gaussian;
pub mod inputs;
pub mod judge;
pub mod learner;
pub mod log;
pub mod matmul;
pub mod network;
pub mod pilot;
pub mod provenance;
pub mod ranges;
pub mod replay;
pub mod run;
pub mod sac;
pub mod slopes;
