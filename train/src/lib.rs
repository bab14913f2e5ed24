//! Trains the policies that `cede-controller` runs.
//!
//! | | |
//! |---|---|
//! | [`nn`] | networks, their gradients and the optimiser |
//! | [`driving`] | a network as a driver: its inputs, its episodes, its score |
//! | [`algorithm`] | one file per algorithm: behaviour cloning, soft actor-critic (SAC, SACER-V, SACER-SVO), analytic policy gradient |
//! | [`run`] | a training run: settings, learning curve, checkpoints, logs, provenance |
//!
//! Each module depends only on those above it in this table.
#![deny(unsafe_code)]

pub mod algorithm;
pub mod driving;
pub mod nn;
pub mod run;
