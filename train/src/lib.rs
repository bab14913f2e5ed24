//! Trains the policies that `cede-controller` runs.

pub mod adam;
pub mod gaussian;
pub mod learner;
pub mod matmul;
pub mod network;
pub mod replay;
