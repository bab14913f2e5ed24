//! Networks, their gradients and the optimiser.

pub mod adam;
pub mod gaussian;
pub mod matmul;
pub mod network;
