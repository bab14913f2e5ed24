//! Shapes and constant tensors.

use super::{OnnxError, proto};

/// The most elements of a tensor or entries of a layer's matrix.
pub(super) const MOST_ELEMENTS: usize = 1 << 22;

/// The shape of a tensor; its size is at most [`MOST_ELEMENTS`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Shape(Vec<usize>);

impl Shape {
    /// A shape, unless a dimension is negative or the size too large.
    pub(super) fn new(dims: &[i64]) -> Option<Self> {
        let dims: Vec<usize> = dims
            .iter()
            .map(|&d| usize::try_from(d).ok())
            .collect::<Option<_>>()?;
        Self::from_dims(dims)
    }

    /// A shape, unless its size is too large.
    pub(super) fn from_dims(dims: Vec<usize>) -> Option<Self> {
        let size = dims
            .iter()
            .try_fold(1_usize, |size, &d| size.checked_mul(d))?;
        (size <= MOST_ELEMENTS).then_some(Self(dims))
    }

    pub(super) fn dims(&self) -> &[usize] {
        &self.0
    }

    pub(super) fn size(&self) -> usize {
        self.0.iter().product()
    }

    /// The shape of `self` broadcast against `other` (numpy's rule), if they fit.
    pub(super) fn broadcast(&self, other: &Self) -> Option<Self> {
        let rank = self.0.len().max(other.0.len());
        let dim = |shape: &Self, axis: usize| {
            axis.checked_sub(rank - shape.0.len())
                .map_or(1, |axis| shape.0[axis])
        };
        let dims = (0..rank).map(|axis| match (dim(self, axis), dim(other, axis)) {
            (a, b) if a == b => Some(a),
            (1, n) | (n, 1) => Some(n),
            _ => None,
        });
        Self::from_dims(dims.collect::<Option<_>>()?)
    }

    /// Which element of `self` stands at a flat index of `whole`, a broadcast of `self`.
    pub(super) fn index_in(&self, whole: &Self, mut flat: usize) -> usize {
        let (mut index, mut stride) = (0, 1);
        for axis in (0..whole.0.len()).rev() {
            let at = flat % whole.0[axis];
            flat /= whole.0[axis];
            if let Some(own) = (axis + self.0.len()).checked_sub(whole.0.len()) {
                index += if self.0[own] == 1 { 0 } else { at * stride };
                stride *= self.0[own];
            }
        }
        index
    }
}

/// A constant tensor; integers (shapes, axes) are held apart from reals.
#[derive(Clone, Debug)]
pub(super) struct Constant {
    pub(super) shape: Shape,
    pub(super) data: Data,
}

#[derive(Clone, Debug)]
pub(super) enum Data {
    Real(Vec<f64>),
    Integer(Vec<i64>),
}

const FLOAT: i32 = 1;
const INT64: i32 = 7;
const DOUBLE: i32 = 11;

/// A tensor's shape and values.
pub(super) fn read(tensor: &proto::Tensor) -> Result<Constant, OnnxError> {
    let fault = |what: String| OnnxError::Tensor {
        name: tensor.name.clone(),
        what,
    };
    if tensor.data_location != 0 {
        return Err(fault("its data lie outside the file".to_owned()));
    }
    let shape =
        Shape::new(&tensor.dims).ok_or_else(|| fault(format!("shape {:?}", tensor.dims)))?;
    let raw = !tensor.raw_data.is_empty();
    let data = match tensor.data_type {
        FLOAT if raw => Data::Real(words(&tensor.raw_data, |b| {
            f64::from(f32::from_le_bytes(b))
        })),
        FLOAT => Data::Real(tensor.float_data.iter().copied().map(f64::from).collect()),
        DOUBLE if raw => Data::Real(words(&tensor.raw_data, f64::from_le_bytes)),
        DOUBLE => Data::Real(tensor.double_data.clone()),
        INT64 if raw => Data::Integer(words(&tensor.raw_data, i64::from_le_bytes)),
        INT64 => Data::Integer(tensor.int64_data.clone()),
        other => {
            return Err(fault(format!(
                "element type {other}; supported are float, double and int64"
            )));
        }
    };
    let (count, finite) = match &data {
        Data::Real(values) => (values.len(), values.iter().all(|v| v.is_finite())),
        Data::Integer(values) => (values.len(), true),
    };
    if count != shape.size() {
        return Err(fault(format!(
            "{count} values for shape {:?}",
            shape.dims()
        )));
    }
    if !finite {
        return Err(fault("holds a number that is not finite".to_owned()));
    }
    Ok(Constant { shape, data })
}

fn words<const N: usize, T>(bytes: &[u8], read: impl Fn([u8; N]) -> T) -> Vec<T> {
    bytes
        .as_chunks::<N>()
        .0
        .iter()
        .map(|chunk| read(*chunk))
        .collect()
}
