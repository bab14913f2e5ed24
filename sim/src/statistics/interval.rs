//! Shares and means with their 95 % confidence intervals.

use serde::Serialize;

/// The 97.5 % quantile of the standard normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// `count` successes among `n` trials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Share {
    /// Successes.
    pub count: usize,
    /// Trials.
    pub n: usize,
}

impl Share {
    /// Counts what is `true`.
    #[must_use]
    pub fn of(trials: impl IntoIterator<Item = bool>) -> Self {
        trials
            .into_iter()
            .fold(Self::default(), |share, success| Self {
                count: share.count + usize::from(success),
                n: share.n + 1,
            })
    }

    /// The fraction in [0, 1]; `None` without trials.
    #[must_use]
    pub fn fraction(self) -> Option<f64> {
        (self.n > 0).then(|| self.count as f64 / self.n as f64)
    }

    /// Wilson's 95 % score interval of the fraction; `None` for fewer than two trials.
    ///
    /// Source: E. B. Wilson, "Probable inference, the law of succession, and statistical
    /// inference", Journal of the American Statistical Association 22 (1927).
    #[must_use]
    pub fn interval(self) -> Option<[f64; 2]> {
        let p = self.fraction().filter(|_| self.n > 1)?;
        let n = self.n as f64;
        let (z2, scale) = (Z * Z, 1.0 + Z * Z / n);
        let centre = (p + z2 / (2.0 * n)) / scale;
        let half = Z / scale * (p * (1.0 - p) / n + z2 / (4.0 * n * n)).sqrt();
        Some([(centre - half).max(0.0), (centre + half).min(1.0)])
    }
}

/// Mean of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mean {
    /// Size of the sample, at least 1.
    pub n: usize,
    /// The mean.
    pub mean: f64,
    /// Standard deviation of the sample (n − 1); 0 for a single value.
    pub deviation: f64,
}

impl Mean {
    /// The mean of `values`, summed in their order; `None` without values.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.into_iter().collect();
        let n = values.len();
        if n == 0 {
            return None;
        }
        let mean = values.iter().sum::<f64>() / n as f64;
        let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
        let deviation = (squares / (n.max(2) - 1) as f64).sqrt();
        Some(Self { n, mean, deviation })
    }

    /// The 95 % interval of the mean by the normal approximation; `None` for a single value.
    #[must_use]
    pub fn interval(self) -> Option<[f64; 2]> {
        let half = Z * self.deviation / (self.n as f64).sqrt();
        (self.n > 1).then_some([self.mean - half, self.mean + half])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 5e-5
    }

    #[test]
    fn wilson_intervals_equal_published_ones() {
        // Newcombe, "Two-sided confidence intervals for the single proportion",
        // Statistics in Medicine 17 (1998), Table I, method 3.
        for (count, n, low, high) in [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0, 0.1611),
            (1, 29, 0.0061, 0.1718),
        ] {
            let [a, b] = Share { count, n }.interval().unwrap();
            assert!(close(a, low) && close(b, high), "{count}/{n}: {a} {b}");
        }
    }

    #[test]
    fn nothing_has_no_share_and_no_mean() {
        assert_eq!(Share::of([]).fraction(), None);
        assert_eq!(Share::of([]).interval(), None);
        assert_eq!(Share::of([true]).interval(), None);
        assert_eq!(Mean::of([]), None);
    }

    #[test]
    fn a_mean_with_its_interval() {
        let mean = Mean::of([1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!((mean.n, mean.mean), (4, 2.5));
        assert!(close(mean.deviation, (5.0_f64 / 3.0).sqrt()));
        let [low, high] = mean.interval().unwrap();
        assert!(close(high - 2.5, 1.26517) && close(low + high, 5.0));
        assert_eq!(Mean::of([7.0]).unwrap().interval(), None);
    }
}
