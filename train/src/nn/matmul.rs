//! Products of small dense matrices: safe views over the `gemm-f32` kernels.
//!
//! The kernels choose AVX-512, AVX2 or scalar code at run time. Machines with the
//! same instruction set give the same bits; others differ in the last place.
#![allow(unsafe_code)]

use gemm_common::Parallelism;

/// A read-only view of a row-major matrix, or of its transpose.
#[derive(Clone, Copy, Debug)]
pub struct Matrix<'a> {
    data: &'a [f32],
    rows: usize,
    columns: usize,
    transposed: bool,
}

impl<'a> Matrix<'a> {
    /// A view of `rows × columns` values stored row by row.
    ///
    /// # Panics
    /// If `data` does not hold exactly that many values.
    #[must_use]
    pub fn new(data: &'a [f32], rows: usize, columns: usize) -> Self {
        assert_eq!(data.len(), rows * columns, "a matrix of {rows} × {columns}");
        Self {
            data,
            rows,
            columns,
            transposed: false,
        }
    }

    /// The transpose, without copying.
    #[must_use]
    pub fn transpose(self) -> Self {
        Self {
            rows: self.columns,
            columns: self.rows,
            transposed: !self.transposed,
            ..self
        }
    }

    /// Strides in elements: (from row to row, from column to column).
    fn strides(&self) -> (isize, isize) {
        if self.transposed {
            (1, self.rows as isize)
        } else {
            (self.columns as isize, 1)
        }
    }
}

/// What a product does with the values in its destination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Into {
    /// Overwrites them.
    Replace,
    /// Adds to them.
    Add,
}

/// Writes `left · right` to the row-major `destination`, on the calling thread.
///
/// # Panics
/// If the three shapes do not fit together.
pub fn multiply(destination: &mut [f32], left: Matrix<'_>, right: Matrix<'_>, into: Into) {
    let (m, n, k) = (left.rows, right.columns, left.columns);
    assert_eq!(k, right.rows, "inner dimensions");
    assert_eq!(destination.len(), m * n, "a product of {m} × {n}");
    // The kernels write along columns, and element by element where a column is not contiguous. They
    // therefore compute the transposed product, rightᵀ · leftᵀ, whose columns are the destination's
    // rows: the same sums in the same order, up to fifteen times as fast. Rows too short for a vector
    // do not gain from it.
    if n < SHORT {
        product(destination, (1, n as isize), left, right, into);
    } else {
        let (left, right) = (left.transpose(), right.transpose());
        product(destination, (n as isize, 1), right, left, into);
    }
}

/// Rows of the destination shorter than this are multiplied without the transposition.
const SHORT: usize = 8;

/// `left · right`, to a destination with these strides from (column to column, row to row).
fn product(
    destination: &mut [f32],
    (column, row): (isize, isize),
    left: Matrix<'_>,
    right: Matrix<'_>,
    into: Into,
) {
    let (left_row, left_column) = left.strides();
    let (right_row, right_column) = right.strides();
    let (read, alpha) = match into {
        Into::Replace => (false, 0.0),
        Into::Add => (true, 1.0),
    };
    // SAFETY: the assertions of `multiply`, `Matrix::new` and strides that are a permutation of the
    // destination's own make every index that the kernel forms from these shapes and strides lie
    // inside the three slices; `destination` is borrowed mutably, so it overlaps neither operand.
    unsafe {
        gemm_f32::gemm::f32::get_gemm_fn()(
            left.rows,
            right.columns,
            left.columns,
            destination.as_mut_ptr(),
            column,
            row,
            read,
            left.data.as_ptr(),
            left_column,
            left_row,
            right.data.as_ptr(),
            right_column,
            right_row,
            alpha,
            1.0,
            false,
            false,
            false,
            Parallelism::None,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn naive(left: Matrix<'_>, right: Matrix<'_>) -> Vec<f32> {
        let at = |m: Matrix<'_>, i: usize, j: usize| {
            let (row, column) = m.strides();
            m.data[i * row as usize + j * column as usize]
        };
        let mut product = Vec::new();
        for i in 0..left.rows {
            for j in 0..right.columns {
                product.push(
                    (0..left.columns)
                        .map(|k| at(left, i, k) * at(right, k, j))
                        .sum(),
                );
            }
        }
        product
    }

    #[test]
    fn products_of_every_orientation_agree_with_the_definition() {
        let values = |n: usize| {
            (0..n)
                .map(|i| ((i * 7 % 11) as f32) - 5.0)
                .collect::<Vec<_>>()
        };
        for (m, n, k) in [(1, 1, 1), (3, 1, 5), (17, 9, 4), (64, 7, 33), (33, 64, 12)] {
            let (a, b) = (values(m * k), values(k * n));
            for (left, right) in [
                (Matrix::new(&a, m, k), Matrix::new(&b, k, n)),
                (Matrix::new(&a, k, m).transpose(), Matrix::new(&b, k, n)),
                (Matrix::new(&a, m, k), Matrix::new(&b, n, k).transpose()),
            ] {
                let expected = naive(left, right);
                let mut product = vec![f32::NAN; m * n];
                multiply(&mut product, left, right, Into::Replace);
                assert_eq!(product, expected);
                multiply(&mut product, left, right, Into::Add);
                assert!(product.iter().zip(&expected).all(|(p, e)| *p == 2.0 * e));
            }
        }
    }
}
