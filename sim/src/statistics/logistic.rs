//! Logistic regression by Newton's method.

/// Penalty on the squared standardised weights: keeps separable data from infinite weights.
const RIDGE: f64 = 0.1;
/// Newton's method converges quadratically; what is left after this many steps is rounding.
const ITERATIONS: usize = 25;

/// P(true | x) = 1 / (1 + exp(−(w·x + b))), with `D` inputs.
///
/// Fitted by iteratively reweighted least squares (Hastie, Tibshirani, Friedman, "The
/// Elements of Statistical Learning", section 4.4.1) on standardised inputs with a small
/// ridge penalty. Deterministic; the same bits on every machine.
#[derive(Clone, Debug, PartialEq)]
pub struct LogisticRegression<const D: usize> {
    mean: [f64; D],
    scale: [f64; D],
    weights: [f64; D],
    bias: f64,
}

impl<const D: usize> LogisticRegression<D> {
    /// Fits the model to `samples`; `None` if there are none.
    ///
    /// Cost: O(n D² + D³) an iteration, at most 25 iterations.
    #[must_use]
    pub fn fit(samples: &[([f64; D], bool)]) -> Option<Self> {
        if samples.is_empty() {
            return None;
        }
        let n = samples.len() as f64;
        let mean = std::array::from_fn(|i| samples.iter().map(|(x, _)| x[i]).sum::<f64>() / n);
        let scale = std::array::from_fn(|i| {
            let squares: f64 = samples.iter().map(|(x, _)| (x[i] - mean[i]).powi(2)).sum();
            let deviation = (squares / n).sqrt();
            if deviation > 0.0 { deviation } else { 1.0 }
        });
        let mut model = Self {
            mean,
            scale,
            weights: [0.0; D],
            bias: 0.0,
        };
        for _ in 0..ITERATIONS {
            if model.newton_step(samples) < 1e-12 {
                break;
            }
        }
        Some(model)
    }

    /// One step of Newton's method; gives the largest change of a weight.
    fn newton_step(&mut self, samples: &[([f64; D], bool)]) -> f64 {
        // The bias is the last unknown; it is not penalised, but for what keeps one-sided samples finite.
        let unknowns = D + 1;
        let mut gradient = vec![0.0; unknowns];
        let mut hessian = vec![vec![0.0; unknowns]; unknowns];
        for i in 0..unknowns {
            let (weight, penalty) = if i < D {
                (self.weights[i], RIDGE)
            } else {
                (self.bias, 1e-3)
            };
            gradient[i] -= penalty * weight;
            hessian[i][i] += penalty;
        }
        for (x, outcome) in samples {
            let p = self.probability(x);
            let residual = f64::from(u8::from(*outcome)) - p;
            let z = self.standardised(x);
            let input = |i: usize| if i < D { z[i] } else { 1.0 };
            for i in 0..unknowns {
                gradient[i] += residual * input(i);
                for (j, entry) in hessian[i].iter_mut().enumerate() {
                    *entry += p * (1.0 - p) * input(i) * input(j);
                }
            }
        }
        let step = solve(hessian, gradient);
        for (weight, change) in self.weights.iter_mut().zip(&step) {
            *weight += change;
        }
        self.bias += step[D];
        step.iter().fold(0.0, |largest, x| x.abs().max(largest))
    }

    fn standardised(&self, x: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|i| (x[i] - self.mean[i]) / self.scale[i])
    }

    /// P(true | x), in [0, 1].
    #[must_use]
    pub fn probability(&self, x: &[f64; D]) -> f64 {
        let z = self.standardised(x);
        let score = z.iter().zip(&self.weights).map(|(z, w)| z * w).sum::<f64>() + self.bias;
        1.0 / (1.0 + libm::exp(-score))
    }
}

/// Solves the symmetric positive definite system `a` x = `b` by elimination without pivoting.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let (above, below) = a.split_at_mut(k + 1);
        let pivot = &above[k];
        for (row, i) in below.iter_mut().zip(k + 1..) {
            let factor = row[k] / pivot[k];
            for (entry, of_pivot) in row.iter_mut().zip(pivot).skip(k) {
                *entry -= factor * of_pivot;
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k][k];
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_binary_input_gives_the_empirical_shares() {
        // 30 of 40 at x = 1, 10 of 40 at x = 0: the odds are 3 and 1/3, but for the small penalty.
        let samples: Vec<_> = (0..80)
            .map(|i| {
                let x = i % 2;
                ([f64::from(x)], i / 2 % 4 < 1 + 2 * x)
            })
            .collect();
        let model = LogisticRegression::fit(&samples).unwrap();
        assert!((model.probability(&[1.0]) - 0.75).abs() < 5e-3);
        assert!((model.probability(&[0.0]) - 0.25).abs() < 5e-3);
    }

    #[test]
    fn separable_constant_and_one_sided_samples_stay_finite() {
        for samples in [
            vec![([0.0, 5.0], false), ([1.0, 5.0], true)],
            vec![([2.0, 5.0], true); 3],
        ] {
            let model = LogisticRegression::fit(&samples).unwrap();
            for (x, outcome) in samples {
                let p = model.probability(&x);
                assert!(p.is_finite() && (p > 0.5) == outcome, "{p}");
            }
        }
        assert_eq!(LogisticRegression::<2>::fit(&[]), None);
    }

    #[test]
    fn at_the_optimum_the_gradient_vanishes() {
        let samples: Vec<_> = (0..50)
            .map(|i| {
                let x = f64::from(i);
                ([x, (x * 0.7).sin()], i * 7 % 50 < i)
            })
            .collect();
        let mut model = LogisticRegression::fit(&samples).unwrap();
        assert!(model.newton_step(&samples) < 1e-9);
    }
}
