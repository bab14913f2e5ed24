//! The numbers of a constant tensor.

use super::proto::Tensor;

/// Element type `f32`.
pub(super) const FLOAT: i32 = 1;
const INT64: i32 = 7;
const DOUBLE: i32 = 11;

/// A tensor's elements, innermost dimension first; integers (shapes, axes) are held apart from reals.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Finite numbers, each with its exact value.
    Real(Vec<f64>),
    /// Integers.
    Integer(Vec<i64>),
}

/// Why a tensor's numbers cannot be had.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TensorError {
    /// They are in another file.
    #[error("its data lie outside the file (in PyTorch: export with external_data=False)")]
    Elsewhere,
    /// An element type that is not read.
    #[error("element type {0}; supported are float, double and int64")]
    Type(i32),
    /// The shape is negative somewhere, or is not that of the elements.
    #[error("{count} values for shape {dims:?}")]
    Shape {
        /// Number of elements.
        count: usize,
        /// The shape.
        dims: Vec<i64>,
    },
    /// An element is infinite or not a number.
    #[error("holds a number that is not finite")]
    NotFinite,
}

impl Tensor {
    /// The elements, `f32`, `f64` or `i64`, raw or typed.
    ///
    /// Never panics; memory is at most twice that of the tensor itself.
    ///
    /// # Errors
    /// See [`TensorError`].
    pub fn values(&self) -> Result<Values, TensorError> {
        if self.data_location != 0 {
            return Err(TensorError::Elsewhere);
        }
        let raw = !self.raw_data.is_empty();
        let values = match self.data_type {
            FLOAT if raw => Values::Real(words(&self.raw_data, |b| f32::from_le_bytes(b).into())),
            FLOAT => Values::Real(self.float_data.iter().copied().map(f64::from).collect()),
            DOUBLE if raw => Values::Real(words(&self.raw_data, f64::from_le_bytes)),
            DOUBLE => Values::Real(self.double_data.clone()),
            INT64 if raw => Values::Integer(words(&self.raw_data, i64::from_le_bytes)),
            INT64 => Values::Integer(self.int64_data.clone()),
            other => return Err(TensorError::Type(other)),
        };
        let (count, finite) = match &values {
            Values::Real(values) => (values.len(), values.iter().all(|v| v.is_finite())),
            Values::Integer(values) => (values.len(), true),
        };
        let size = self
            .dims
            .iter()
            .try_fold(1_usize, |n, &d| n.checked_mul(usize::try_from(d).ok()?));
        if size != Some(count) {
            let dims = self.dims.clone();
            return Err(TensorError::Shape { count, dims });
        }
        if finite {
            Ok(values)
        } else {
            Err(TensorError::NotFinite)
        }
    }
}

fn words<const N: usize, T>(bytes: &[u8], read: impl Fn([u8; N]) -> T) -> Vec<T> {
    let chunks = bytes.as_chunks::<N>().0.iter();
    chunks.map(|chunk| read(*chunk)).collect()
}
