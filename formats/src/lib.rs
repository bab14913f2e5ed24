//! Files of neural networks, and of Cede's policies.
//!
//! [`onnx`] reads networks that were trained elsewhere. With the feature `policy`, which is on by
//! default, it also writes a policy as a graph that any runtime executes and makes a policy of a
//! graph; [`cede`] loads weights files, [`quantise`] makes integers of one, [`safetensors`] writes the bare
//! numbers, [`description`] is what these files say about a policy, and [`property`] is what is to be proved of one.
#![forbid(unsafe_code)]

#[cfg(feature = "policy")]
pub mod cede;
#[cfg(feature = "policy")]
pub mod description;
#[cfg(feature = "policy")]
mod layers;
pub mod onnx;
#[cfg(feature = "policy")]
pub mod property;
#[cfg(feature = "policy")]
pub mod quantise;
#[cfg(feature = "policy")]
pub mod safetensors;

#[cfg(feature = "policy")]
pub use layers::NotF32;
