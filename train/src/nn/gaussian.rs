//! Gaussians squashed by tanh: SAC's distribution over actions, with the exact log-density.
//!
//! a = tanh(u), u = μ + σ·ε, ε ~ N(0, 1), so that
//! log π(a) = log N(u; μ, σ) − log(1 − tanh² u), where the correction is
//! computed as 2·(ln 2 − u − softplus(−2u)), which stays exact where 1 − tanh² u
//! underflows (Haarnoja et al., 2018, appendix C).

use core::f32::consts::LN_2;

/// Range of log σ. Outside it the distribution is nearly a point or nearly flat, and its gradients vanish.
pub const LOG_DEVIATION: (f32, f32) = (-5.0, 2.0);

const HALF_LN_2_PI: f32 = 0.918_938_5;

/// One sampled action and the values that its gradient needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The action, in (−1, 1).
    pub action: f32,
    /// log π(action) of this component.
    pub log_density: f32,
    deviation: f32,
    noise: f32,
    /// d log σ / d raw output: the raw value is squashed smoothly into [`LOG_DEVIATION`].
    slope: f32,
}

/// Maps the network's raw output to log σ, smoothly, and gives the slope there.
fn log_deviation(raw: f32) -> (f32, f32) {
    let (low, high) = LOG_DEVIATION;
    let t = libm::tanhf(raw);
    let half = 0.5 * (high - low);
    (low + half * (t + 1.0), half * (1.0 - t * t))
}

impl Sample {
    /// The action for `noise` (a standard normal deviate) under the distribution with the network's
    /// outputs `mean` and `raw_deviation`.
    #[must_use]
    pub fn new(mean: f32, raw_deviation: f32, noise: f32) -> Self {
        let (log_sigma, slope) = log_deviation(raw_deviation);
        let deviation = libm::expf(log_sigma);
        let u = mean + deviation * noise;
        let softplus = {
            let x = -2.0 * u;
            if x > 0.0 {
                x + libm::log1pf(libm::expf(-x))
            } else {
                libm::log1pf(libm::expf(x))
            }
        };
        let correction = 2.0 * (LN_2 - u - softplus);
        Self {
            action: libm::tanhf(u),
            log_density: -0.5 * noise * noise - log_sigma - HALF_LN_2_PI - correction,
            deviation,
            noise,
            slope,
        }
    }

    /// Derivatives of a loss with respect to (mean, raw deviation), from its derivatives with
    /// respect to the action and to the log-density. The noise is constant (reparameterisation).
    #[must_use]
    pub fn backward(&self, by_action: f32, by_log_density: f32) -> (f32, f32) {
        let by_u =
            by_action * (1.0 - self.action * self.action) + by_log_density * 2.0 * self.action;
        let by_log_sigma = by_u * self.deviation * self.noise - by_log_density;
        (by_u, by_log_sigma * self.slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nn::finite_differences::differences;

    /// The definition, in `f64`.
    fn reference(mean: f64, raw: f64, noise: f64) -> (f64, f64) {
        let (low, high) = (f64::from(LOG_DEVIATION.0), f64::from(LOG_DEVIATION.1));
        let log_sigma = low + 0.5 * (high - low) * (raw.tanh() + 1.0);
        let u = mean + log_sigma.exp() * noise;
        let normal = -0.5 * noise * noise - log_sigma - 0.5 * (2.0 * std::f64::consts::PI).ln();
        // 1 − tanh² = 1 / cosh².
        (u.tanh(), normal + 2.0 * u.cosh().ln())
    }

    fn cases() -> impl Iterator<Item = (f32, f32, f32)> {
        let means = [-4.0, -0.7, 0.0, 1.3, 6.0];
        means.into_iter().flat_map(|m| {
            [-1.5, -0.2, 0.4, 1.1]
                .into_iter()
                .flat_map(move |d| [-2.1, 0.0, 0.6].map(move |e| (m, d, e)))
        })
    }

    #[test]
    fn action_and_log_density_follow_the_definition() {
        for (m, d, e) in cases() {
            let got = Sample::new(m, d, e);
            let (action, log_density) = reference(m.into(), d.into(), e.into());
            assert!((f64::from(got.action) - action).abs() < 1e-6);
            let error = (f64::from(got.log_density) - log_density).abs();
            assert!(
                error < 1e-5 * (1.0 + log_density.abs()),
                "{m} {d} {e}: {error}"
            );
        }
    }

    #[test]
    fn gradients_agree_with_finite_differences() {
        for (m, d, e) in cases() {
            for (by_action, by_density) in [(1.0, 0.0), (0.0, 1.0), (-0.7, 0.3)] {
                let loss = |x: &[f64]| {
                    let (a, l) = reference(x[0], x[1], e.into());
                    f64::from(by_action) * a + f64::from(by_density) * l
                };
                let expected = differences(&[m.into(), d.into()], loss);
                let got = Sample::new(m, d, e).backward(by_action, by_density);
                for (g, e) in [got.0, got.1].into_iter().zip(expected) {
                    let error = (f64::from(g) - e).abs();
                    assert!(error < 2e-4 * (1.0 + e.abs()), "{m} {d}: {g} against {e}");
                }
            }
        }
    }

    #[test]
    fn the_density_integrates_to_one() {
        // Uniform grid over ε with its normal weight gives the mean of 1/π over actions: 2, the
        // length of (−1, 1), for a distribution that covers it.
        let n = 200_000;
        let width = 16.0 / n as f32;
        let total: f64 = (0..n)
            .map(|i| {
                let e = -8.0 + width * (i as f32 + 0.5);
                let s = Sample::new(0.2, 0.457, e);
                let normal = (-0.5 * f64::from(e * e)).exp() / (2.0 * std::f64::consts::PI).sqrt();
                normal * f64::from(width) / f64::from(s.log_density).exp()
            })
            .sum();
        assert!((total - 2.0).abs() < 1e-3, "{total}");
    }
}
