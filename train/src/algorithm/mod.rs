//! The learning algorithms, one file each; their parts are in the folders of the same names.

pub mod apg;
pub mod bc;
pub mod sac;
