//! The algorithms, one file each.

pub mod apg;
pub mod bc;
pub mod sac;
