//! Networks, their gradients and the optimiser.

pub mod adam;
mod ensemble;
#[cfg(test)]
pub(crate) mod finite_differences;
pub mod gaussian;
pub mod matmul;
pub mod network;
