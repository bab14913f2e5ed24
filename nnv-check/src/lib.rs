//! What a verdict about a neural network rests on: the network, the property, the proof, and a
//! checker that shares no bound propagation with the prover.
//!
//! [`onnx`] and [`vnnlib`] read a [`Network`] and a [`Property`]; [`check`] goes over the
//! [`proof`] that a prover recorded, and [`Certificate`] is such a proof as a file.
#![forbid(unsafe_code)]

mod certificate;
pub mod check;
mod dyadic;
mod enclosure;
mod gzip;
mod interval;
mod model;
pub mod onnx;
pub mod proof;
mod property;
pub mod rounding;
pub mod vnnlib;

pub use certificate::{Certificate, CertificateError, Proved, Source};
pub use enclosure::AffineEnclosure;
pub use model::{Activation, Evaluation, Layer, Matrix, ModelError, Network};
pub use property::{Conjunction, Halfspace, InputBox, Limit, Property, Query};
