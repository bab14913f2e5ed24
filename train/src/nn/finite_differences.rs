//! What the tests check analytic gradients against: a reference network in `f64` and central differences.

use crate::nn::network::Network;

/// The outputs of `network` with other `parameters` for one row of inputs, in `f64`, by definition.
pub(crate) fn reference(network: &Network, parameters: &[f64], input: &[f64]) -> Vec<f64> {
    let mut values = input.to_vec();
    let mut start = 0;
    let last = network.sizes().len() - 2;
    for (i, size) in network.sizes().windows(2).enumerate() {
        let (inputs, outputs) = (size[0], size[1]);
        let (weights, biases) = parameters[start..].split_at(inputs * outputs);
        values = (0..outputs)
            .map(|o| {
                let sum: f64 = (0..inputs)
                    .map(|j| values[j] * weights[j * outputs + o])
                    .sum();
                let y = sum + biases[o];
                if i < last { y.max(0.0) } else { y }
            })
            .collect();
        start += (inputs + 1) * outputs;
    }
    values
}

/// Central differences of `f` at `x`.
pub(crate) fn differences(x: &[f64], f: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let mut x = x.to_vec();
    (0..x.len())
        .map(|i| {
            let (old, h) = (x[i], 1e-5);
            x[i] = old + h;
            let up = f(&x);
            x[i] = old - h;
            let down = f(&x);
            x[i] = old;
            (up - down) / (2.0 * h)
        })
        .collect()
}

pub(crate) fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|&x| f64::from(x)).collect()
}

/// Fails unless the two gradients agree to 1e-4 of the larger one's largest component.
pub(crate) fn assert_gradient(got: &[f32], expected: &[f64]) {
    assert_eq!(got.len(), expected.len());
    let scale = expected.iter().fold(1e-3, |m: f64, e| m.max(e.abs()));
    for (i, (g, e)) in got.iter().zip(expected).enumerate() {
        let error = (f64::from(*g) - e).abs() / scale;
        assert!(error < 1e-4, "component {i}: {g} against {e}");
    }
}
