//! What a policy's file says about it besides its numbers.

use cede_controller::{FeatureSet, Perspective, Weights};
use std::fmt::Write;

/// Key of the feature set's name.
pub(crate) const FEATURES: &str = "cede.features";
/// Key of the perspective's name.
pub(crate) const PERSPECTIVE: &str = "cede.perspective";

/// Name of a perspective in files and on the command line.
#[must_use]
pub const fn perspective_name(perspective: Perspective) -> &'static str {
    match perspective {
        Perspective::Joint => "joint",
        Perspective::Ego => "ego",
    }
}

/// The perspective of this name.
#[must_use]
pub fn perspective_named(name: &str) -> Option<Perspective> {
    [Perspective::Joint, Perspective::Ego]
        .into_iter()
        .find(|&p| perspective_name(p) == name)
}

/// The feature set of this name.
#[must_use]
pub fn features_named(name: &str) -> Option<FeatureSet> {
    FeatureSet::ALL.into_iter().find(|set| set.name() == name)
}

/// Keys and values of a policy's metadata, in a fixed order.
pub(crate) fn of(weights: &Weights<'_>) -> [(&'static str, String); 4] {
    let labels: Vec<_> = weights.features().labels().collect();
    let provenance = weights
        .provenance()
        .iter()
        .fold(String::new(), |mut text, byte| {
            // Writing to a string does not fail.
            let _ = write!(text, "{byte:02x}");
            text
        });
    [
        (FEATURES, weights.features().name().to_owned()),
        ("cede.feature_names", labels.join(",")),
        (
            PERSPECTIVE,
            perspective_name(weights.perspective()).to_owned(),
        ),
        ("cede.provenance_sha256", provenance),
    ]
}
