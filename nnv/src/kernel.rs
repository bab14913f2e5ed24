//! The inner loops of bound propagation. They run on whatever vector unit the machine has;
//! no fused operations, so that every machine computes the same bits.

/// Neurons that are bounded side by side.
pub(super) const LANES: usize = 16;

/// One number for each lane.
pub(super) type Lane = [f64; LANES];

/// Width of a register tile of [`compose`].
const TILE: usize = 8;

/// Rounds a number of neurons up to whole tiles.
pub(super) fn padded(count: usize) -> usize {
    count.next_multiple_of(TILE)
}

/// z[c][i] = Σₐ rows[c][a]·weights[a][i] for every column c: the rows of a layer from the rows
/// of the active neurons before it. `weights` and `z` have [`padded`] neurons to a row.
#[inline(always)]
pub(super) fn compose(rows: &[f64], weights: &[f64], active: usize, neurons: usize, z: &mut [f64]) {
    let columns = z.len() / neurons;
    let mut c = 0;
    while c + 4 <= columns {
        tiles::<4>(
            &rows[c * active..(c + 4) * active],
            weights,
            active,
            neurons,
            &mut z[c * neurons..],
        );
        c += 4;
    }
    while c < columns {
        tiles::<1>(
            &rows[c * active..(c + 1) * active],
            weights,
            active,
            neurons,
            &mut z[c * neurons..],
        );
        c += 1;
    }
}

/// `N` columns of [`compose`], held in registers while the active neurons pass by.
#[inline(always)]
fn tiles<const N: usize>(
    rows: &[f64],
    weights: &[f64],
    active: usize,
    neurons: usize,
    z: &mut [f64],
) {
    let row: [&[f64]; N] = std::array::from_fn(|k| &rows[k * active..(k + 1) * active]);
    for first in (0..neurons).step_by(TILE) {
        let mut sums = [[0.0; TILE]; N];
        for a in 0..active {
            let Some(w) = weights[a * neurons + first..].first_chunk::<TILE>() else {
                return;
            };
            for k in 0..N {
                let x = row[k][a];
                for i in 0..TILE {
                    sums[k][i] += x * w[i];
                }
            }
        }
        for k in 0..N {
            z[k * neurons + first..k * neurons + first + TILE].copy_from_slice(&sums[k]);
        }
    }
}

/// block[c] += factor·row[c] for every column of the row. Rows of sparse networks are mostly zeros.
#[inline(always)]
pub(super) fn add_row(block: &mut [Lane], row: &[f64], factor: &Lane) {
    for (sums, &x) in block.iter_mut().zip(row).filter(|(_, x)| **x != 0.0) {
        for (sum, f) in sums.iter_mut().zip(factor) {
            *sum += f * x;
        }
    }
}

/// sums += factor·row.
#[inline(always)]
pub(super) fn add_scaled(sums: &mut [f64], row: &[f64], factor: f64) {
    for (sum, x) in sums.iter_mut().zip(row) {
        *sum += factor * x;
    }
}

/// sums += Σ factor·row, for four of them at a time.
#[inline(always)]
pub(super) fn add_scaled_4(sums: &mut [f64], terms: [(f64, &[f64]); 4]) {
    let [(a, p), (b, q), (c, r), (d, s)] = terms;
    for ((((sum, p), q), r), s) in sums.iter_mut().zip(p).zip(q).zip(r).zip(s) {
        *sum += (a * p + b * q) + (c * r + d * s);
    }
}

/// Σ aᵢbᵢ, summed in eight interleaved parts.
#[inline(always)]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (heads_a, tail_a) = a.as_chunks::<8>();
    let (heads_b, tail_b) = b.as_chunks::<8>();
    let mut parts = [0.0; 8];
    for (x, y) in heads_a.iter().zip(heads_b) {
        for i in 0..8 {
            parts[i] += x[i] * y[i];
        }
    }
    let tail: f64 = tail_a.iter().zip(tail_b).map(|(x, y)| x * y).sum();
    parts.iter().sum::<f64>() + tail
}
