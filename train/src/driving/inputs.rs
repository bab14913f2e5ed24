//! A network's inputs: the controller's features, normalised with constants that the weights file stores.

#[cfg(doc)]
use cede_controller::policy::features::LIMIT;
use cede_controller::policy::features::normalised;
use cede_controller::{FeatureSet, Pair};
use serde::{Deserialize, Serialize};

/// A feature set with the centre and the scale of each feature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inputs {
    features: FeatureSet,
    /// Centre of each feature.
    pub centres: Vec<f32>,
    /// Scale of each feature: the network sees (feature − centre) · scale, within ± [`LIMIT`].
    pub scales: Vec<f32>,
}

/// A feature whose standard deviation is below this counts as constant and is not scaled.
const CONSTANT: f64 = 1e-3;

impl Inputs {
    /// Normalisation to mean 0 and standard deviation 1 over `pairs`.
    #[must_use]
    pub fn fit<'p>(features: FeatureSet, pairs: impl IntoIterator<Item = &'p Pair>) -> Self {
        let count = features.count();
        let (mut n, mut sums, mut squares) = (0.0, vec![0.0; count], vec![0.0; count]);
        for pair in pairs {
            n += 1.0;
            for (i, x) in features.of(pair)[..count].iter().enumerate() {
                sums[i] += f64::from(*x);
                squares[i] += f64::from(*x) * f64::from(*x);
            }
        }
        let n: f64 = if n > 0.0 { n } else { 1.0 };
        let means: Vec<f64> = sums.iter().map(|s| s / n).collect();
        let scale = |(square, mean): (&f64, &f64)| {
            let deviation = (square / n - mean * mean).max(0.0).sqrt();
            if deviation > CONSTANT {
                (1.0 / deviation) as f32
            } else {
                1.0
            }
        };
        Self {
            features,
            scales: squares.iter().zip(&means).map(scale).collect(),
            centres: means.iter().map(|m| *m as f32).collect(),
        }
    }

    /// The feature set.
    #[must_use]
    pub fn features(&self) -> FeatureSet {
        self.features
    }

    /// Appends the network's inputs for `pair` to `rows`.
    pub fn append(&self, pair: &Pair, rows: &mut Vec<f32>) {
        let features = self.features.of(pair);
        let constants = self.centres.iter().zip(&self.scales);
        let inputs = features.iter().zip(constants);
        rows.extend(inputs.map(|(&feature, (&centre, &scale))| normalised(feature, centre, scale)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Settings {
        features: FeatureSet,
    }

    #[test]
    fn a_feature_set_is_serialised_as_its_name() {
        for features in FeatureSet::ALL {
            let text = toml::to_string(&Settings { features }).unwrap();
            assert_eq!(text, format!("features = \"{}\"\n", features.name()));
            assert_eq!(toml::from_str(&text), Ok(Settings { features }));
        }
        let error = toml::from_str::<Settings>("features = \"rwa\"").unwrap_err();
        assert!(error.to_string().contains("rwa"), "{error}");
    }
}
