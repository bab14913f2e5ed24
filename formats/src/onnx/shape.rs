//! Shapes of tensors.

/// The most elements of a tensor that depends on the inputs: 2²².
pub const MOST_ELEMENTS: usize = 1 << 22;
/// The most weights of a linear map, and elements of a constant: 2²⁶.
pub const MOST_WEIGHTS: usize = 1 << 26;

/// The shape of a tensor, outermost dimension first; its size is at most [`MOST_WEIGHTS`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shape(Vec<usize>);

impl Shape {
    /// A shape, unless its size is too large.
    #[must_use]
    pub fn new(dims: Vec<usize>) -> Option<Self> {
        let size = dims
            .iter()
            .try_fold(1_usize, |size, &d| size.checked_mul(d))?;
        (size <= MOST_WEIGHTS).then_some(Self(dims))
    }

    /// A shape as a file states it, unless a dimension is negative or the size too large.
    pub(super) fn stated(dims: &[i64]) -> Option<Self> {
        let dims = dims.iter().map(|&d| usize::try_from(d).ok());
        Self::new(dims.collect::<Option<_>>()?)
    }

    /// The dimensions.
    #[must_use]
    pub fn dims(&self) -> &[usize] {
        &self.0
    }

    /// The number of elements.
    #[must_use]
    pub fn size(&self) -> usize {
        self.0.iter().product()
    }

    /// The shape of `self` broadcast against `other` (numpy's rule), if they fit and its size is at
    /// most [`MOST_ELEMENTS`].
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
        let shape = Self::new(dims.collect::<Option<_>>()?)?;
        (shape.size() <= MOST_ELEMENTS).then_some(shape)
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
