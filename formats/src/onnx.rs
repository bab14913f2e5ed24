//! Policies as ONNX graphs.
//!
//! ```text
//! features ─ Sub centre ─ Mul scale ─ Clip ±8 ─ (Gemm ─ Relu) × 3 ─ Gemm ─ Tanh ─ Mul 3 ─ acceleration
//! ```
//!
//! The graph takes raw features, `[batch, inputs]` in the order and units of
//! [`FeatureSet`](cede_controller::FeatureSet), and gives accelerations (m/s²), `[batch, 2]`: of the ego and
//! of the other as the policy expects it, or of the left-turner and of the other for a joint policy. So
//! normalisation and squashing travel inside. Metadata name the feature set, the features, the perspective and
//! the provenance. [`write()`] makes such a graph, [`read`] takes it, or another of its kind, back.

#[cfg(feature = "policy")]
mod chain;
#[cfg(feature = "policy")]
mod export;
#[cfg(feature = "policy")]
mod import;
pub mod proto;
mod tensor;

#[cfg(feature = "policy")]
pub use chain::GraphError;
#[cfg(feature = "policy")]
pub use export::write;
#[cfg(feature = "policy")]
pub use import::{ImportError, Told, read};
pub use tensor::{TensorError, Values};

#[cfg(all(test, feature = "policy"))]
mod tests;
