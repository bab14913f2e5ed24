//! Cede's policies in the formats of other programs.
//!
//! [`onnx`] writes a policy as a graph that any runtime executes, and makes a policy of a graph that
//! was trained elsewhere; [`safetensors`] writes the bare numbers. What either file says about
//! the policy is in [`description`].
#![forbid(unsafe_code)]

pub mod description;
mod layers;
pub mod onnx;
pub mod safetensors;
