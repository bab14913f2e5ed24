//! The policy's features as linear functions of the state, up to a radius, on a box of states.
//!
//! The features are the controller's own, computed on [`Enclosure`]s. The mean value theorem gives
//! f(x) ∈ f(c) + Σ [∂ᵢf]·(xᵢ − cᵢ) for x in a box with centre c; with the middle of each interval of
//! derivatives as the slope, what is left is a radius that shrinks with the square of the box. The
//! radius also covers the `f32` rounding of the controller's computation.

use super::enclosure::{Enclosure, Interval, STATE};
use cede_controller::policy::features::normalised;
use cede_controller::{FeatureSet, Real};
use cede_formats::property::Setting;
use cede_nnv_check::{AffineEnclosure, InputBox};

/// A normalised feature on a box of states.
pub(super) struct Enclosed {
    /// A linear function and a radius; the radius covers the `f32` computation.
    pub(super) feature: AffineEnclosure,
    /// The ranges of its derivatives.
    pub(super) slopes: [Interval; STATE],
    /// How far the `f32` computation can be from the exact one.
    pub(super) rounding: f64,
}

/// The normalised features on a box of states; `normalisation` has a centre and a scale for each. `None`
/// for a feature set that is not a function of the state.
pub(super) fn enclose(
    set: FeatureSet,
    normalisation: &[(f32, f32)],
    region: &InputBox,
    setting: &Setting,
) -> Option<Vec<Enclosed>> {
    if set == FeatureSet::Raw {
        return None;
    }
    let sides: [Interval; STATE] = std::array::from_fn(|i| Interval {
        lo: region.lower[i],
        hi: region.upper[i],
    });
    let on = |at: [Interval; STATE]| {
        let state = std::array::from_fn(|i| Enclosure::variable(at[i], i));
        let features = set.of(&setting.pair_of(state)).into_iter();
        features
            .zip(normalisation)
            .map(|(feature, &(centre, scale))| {
                normalised(feature, Enclosure::of(centre), Enclosure::of(scale))
            })
    };
    let centre = sides.map(Interval::middle);
    let each = on(sides).zip(on(centre.map(Interval::point)));
    Some(
        each.map(|(whole, middle)| linear(&whole, middle.value, &sides, &centre))
            .collect(),
    )
}

/// The linear function through `middle` at `centre`, and how far the feature can be from it.
fn linear(
    whole: &Enclosure,
    middle: Interval,
    sides: &[Interval; STATE],
    centre: &[f64; STATE],
) -> Enclosed {
    let rounding = whole.rounding;
    let steepest = whole.slopes.iter().map(|s| s.magnitude());
    if !steepest.fold(0.0, f64::max).is_finite() {
        return Enclosed {
            feature: AffineEnclosure {
                constant: whole.value.middle(),
                slopes: vec![0.0; STATE],
                radius: whole.value.radius() + rounding,
            },
            slopes: whole.slopes,
            rounding,
        };
    }
    let slopes = whole.slopes.map(Interval::middle);
    let mut constant = middle;
    let mut radius = rounding;
    for i in 0..STATE {
        constant = constant.sub(Interval::point(slopes[i]).mul(Interval::point(centre[i])));
        radius += whole.slopes[i].radius() * sides[i].radius() * (1.0 + 1e-12);
    }
    radius += constant.radius() + 1e-15;
    Enclosed {
        feature: AffineEnclosure {
            constant: constant.middle(),
            slopes: slopes.to_vec(),
            radius: radius * (1.0 + 1e-12),
        },
        slopes: whole.slopes,
        rounding,
    }
}
