//! ONNX files.
//!
//! [`graph`] reads any feed-forward graph, for whoever makes something of it; [`proto`] is the
//! format itself.
//!
//! With the feature `policy`, `export` writes a policy as a graph and `import` takes it, or
//! another of its kind, back:
//!
//! ```text
//! features ─ Sub centre ─ Mul scale ─ Clip ±8 ─ (Gemm ─ Relu) × 3 ─ Gemm ─ Tanh ─ Mul 3 ─ acceleration
//! ```
//!
//! The graph takes raw features, `[batch, inputs]` in the order and units of the controller's
//! `FeatureSet`, and gives accelerations (m/s²), `[batch, 2]`: of the ego and of the other as the
//! policy expects it, or of the left-turner and of the other for a joint policy. So normalisation
//! and squashing travel inside. Metadata name the feature set, the features, the perspective and
//! the provenance.

#[cfg(feature = "policy")]
mod chain;
#[cfg(feature = "policy")]
mod export;
pub mod graph;
#[cfg(feature = "policy")]
mod import;
pub mod proto;
mod shape;
mod tensor;

#[cfg(feature = "policy")]
pub use export::export;
#[cfg(feature = "policy")]
pub use import::{ImportError, Told, import};
pub use shape::{MOST_ELEMENTS, MOST_WEIGHTS, Shape};
pub use tensor::{TensorError, Values};

#[cfg(all(test, feature = "policy"))]
mod tests;
