//! Bounds of the derivatives of the network's mean by the state.

use super::enclosure::{Interval, STATE};
use cede_nnv_check::{Activation, Network};

/// The range of the (generalised) gradient of output 0 by the state, from the bounds of all
/// neurons with an activation and the ranges of the features' derivatives.
pub(super) fn gradient(
    network: &Network,
    bounds: &[(f64, f64)],
    features: &[[Interval; STATE]],
) -> [Interval; STATE] {
    let mut row = vec![Interval::point(1.0)];
    let mut end = bounds.len();
    for layer in network.layers().iter().rev() {
        if layer.activation == Activation::Relu {
            let own = &bounds[end - layer.outputs()..end];
            end -= layer.outputs();
            for (slope, &(l, u)) in row.iter_mut().zip(own) {
                *slope = match (l >= 0.0, u <= 0.0) {
                    (true, _) => *slope,
                    (_, true) => Interval::ZERO,
                    _ => slope.hull(Interval::ZERO),
                };
            }
        }
        row = through(&row, |i| layer.weights.row(i), layer.inputs());
    }
    std::array::from_fn(|k| {
        let terms = row
            .iter()
            .zip(features)
            .filter(|(r, f)| r.magnitude() > 0.0 && f[k].magnitude() > 0.0);
        terms.fold(Interval::ZERO, |sum, (r, f)| sum.add(r.mul(f[k])))
    })
}

/// The row of intervals times a matrix: middles and radii, with what rounding may cost added to
/// the radii.
pub(super) fn through<'a>(
    row: &[Interval],
    weights: impl Fn(usize) -> &'a [f64],
    inputs: usize,
) -> Vec<Interval> {
    let (mut middles, mut radii) = (vec![0.0; inputs], vec![0.0; inputs]);
    let rounding = (2 * row.len() + 8) as f64 * f64::EPSILON;
    for (i, slope) in row.iter().enumerate() {
        let (middle, radius) = (
            slope.middle(),
            slope.radius() + rounding * slope.magnitude(),
        );
        if slope.magnitude() == 0.0 {
            continue;
        }
        for ((m, r), w) in middles.iter_mut().zip(&mut radii).zip(weights(i)) {
            *m += middle * w;
            *r += radius * w.abs();
        }
    }
    let around = |(m, r): (f64, f64)| Interval {
        lo: (m - r * (1.0 + 1e-9)).next_down(),
        hi: (m + r * (1.0 + 1e-9)).next_up(),
    };
    middles.into_iter().zip(radii).map(around).collect()
}
