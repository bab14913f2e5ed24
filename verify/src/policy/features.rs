//! The policy's features as linear functions of the state, up to a radius, on a box of states.
//!
//! The mean value theorem gives f(x) ∈ f(c) + Σ [∂ᵢf]·(xᵢ − cᵢ) for x in a box with centre c; with
//! the middle of each interval of derivatives as the slope, what is left is a radius that shrinks
//! with the square of the box. The radius also covers the `f32` rounding of the controller's own
//! computation: every feature is computed with a handful of operations (assumed below 16 half
//! units in the last place of the largest operand; the tests hold the enclosure against the
//! controller's code).

use super::interval::{Dual, Interval, STATE};
use cede_controller::policy::features::{CREEP, HORIZON, LIMIT};
use cede_controller::policy::svo::MIN_DISTANCE;
use cede_controller::{ConflictKind, FeatureSet, RightOfWay};
use cede_formats::property::Setting;
use cede_nnv_check::{AffineEnclosure, InputBox};

/// Relative allowance for the `f32` rounding of a feature.
const SINGLE: f64 = 16.0 * (f32::EPSILON as f64) * 0.5;

/// The features over (ego distance, ego speed, other distance, other speed) with what the `f32`
/// computation may add, before normalisation. Nobody around the pair.
fn features(set: FeatureSet, state: [Dual; STATE], setting: &Setting) -> Option<Vec<(Dual, f64)>> {
    let [d, v, other_d, other_v] = state;
    let exact = |dual: Dual| (dual, 0.0);
    let arrival = |d: Dual, v: Dual| {
        let horizon = f64::from(HORIZON);
        let time = d.div(v.clamp(f64::from(CREEP), f64::INFINITY));
        let rounding = SINGLE * time.value.magnitude().min(horizon);
        (time.clamp(-horizon, horizon), rounding)
    };
    let spare = |d: Dual, v: Dual| {
        // The controller's factor is an f32 constant, the nearest to 1/6.
        let braking = v.mul(v).scale(f64::from(0.5_f32 / 3.0_f32));
        (
            d.sub(braking),
            SINGLE * (d.value.magnitude() + braking.value.magnitude()),
        )
    };
    let floor = |d: Dual| d.clamp(f64::from(MIN_DISTANCE), f64::INFINITY);
    let moving = |v: Dual| v.clamp(0.0, f64::INFINITY);
    let svo = moving(other_v)
        .mul(floor(d))
        .atan2(moving(v).mul(floor(other_d)));
    let flag = |on: bool| exact(Dual::constant(f64::from(u8::from(on))));
    let right = match setting.right_of_way {
        RightOfWay::Ego => 1.0,
        RightOfWay::Other => -1.0,
        RightOfWay::Unsettled => 0.0,
    };
    let mut all = vec![
        exact(d),
        exact(v),
        exact(other_d),
        exact(other_v),
        arrival(d, v),
        arrival(other_d, other_v),
        (svo, 4.0 * SINGLE),
        spare(d, v),
        spare(other_d, other_v),
        flag(setting.kind == ConflictKind::Crossing),
        flag(setting.kind == ConflictKind::Merging),
        exact(Dual::constant(right)),
        exact(Dual::constant(f64::from(setting.turns[0]))),
        exact(Dual::constant(f64::from(setting.turns[1]))),
    ];
    match set {
        FeatureSet::Route => {}
        FeatureSet::Traffic => {
            for own in [v, other_v] {
                all.extend([exact(Dual::constant(f64::from(HORIZON))), exact(own)]);
            }
        }
        FeatureSet::Scene => {
            let far = f64::from(HORIZON);
            all.extend([exact(Dual::constant(far)), exact(v)]);
            all.extend([far, far, 0.0].map(|nobody| exact(Dual::constant(nobody))));
        }
        _ => return None,
    }
    Some(all)
}

/// A normalised feature on a box of states.
pub(super) struct Enclosed {
    /// A linear function and a radius; the radius covers the `f32` computation.
    pub(super) feature: AffineEnclosure,
    /// The ranges of its derivatives.
    pub(super) slopes: [Interval; STATE],
    /// How far the `f32` computation can be from the exact one.
    pub(super) rounding: f64,
}

/// The normalised features on a box of states. `None` for a feature set that is not a function of
/// the state.
pub(super) fn enclose(
    set: FeatureSet,
    normalisation: &[(f64, f64)],
    region: &InputBox,
    setting: &Setting,
) -> Option<Vec<Enclosed>> {
    let sides: [Interval; STATE] = std::array::from_fn(|i| Interval {
        lo: region.lower[i],
        hi: region.upper[i],
    });
    let centre = sides.map(Interval::middle);
    let on = |at: [Interval; STATE]| {
        features(
            set,
            std::array::from_fn(|i| Dual::variable(at[i], i)),
            setting,
        )
    };
    let (whole, middle) = (on(sides)?, on(centre.map(Interval::point))?);
    let limit = f64::from(LIMIT);
    let normal = |dual: Dual, &(c, s): &(f64, f64)| {
        dual.sub(Dual::constant(c)).scale(s).clamp(-limit, limit)
    };
    let each =
        whole
            .into_iter()
            .zip(middle)
            .zip(normalisation)
            .map(|(((all, rounding), (at, _)), n)| {
                let rounding =
                    (rounding + SINGLE * (all.value.magnitude() + n.0.abs())) * n.1.abs();
                let (all, at) = (normal(all, n), normal(at, n));
                let steepest = all.slopes.iter().map(|s| s.magnitude()).fold(0.0, f64::max);
                if !steepest.is_finite() {
                    let flat = AffineEnclosure {
                        constant: all.value.middle(),
                        slopes: vec![0.0; STATE],
                        radius: all.value.radius() + rounding,
                    };
                    return Enclosed {
                        feature: flat,
                        slopes: all.slopes,
                        rounding,
                    };
                }
                let slopes = all.slopes.map(Interval::middle);
                let mut constant = at.value;
                let mut radius = rounding;
                for i in 0..STATE {
                    constant =
                        constant.sub(Interval::point(slopes[i]).mul(Interval::point(centre[i])));
                    let reach = sides[i].radius();
                    radius += all.slopes[i].radius() * reach * (1.0 + 1e-12);
                }
                radius += constant.radius() + 1e-15;
                let feature = AffineEnclosure {
                    constant: constant.middle(),
                    slopes: slopes.to_vec(),
                    radius: radius * (1.0 + 1e-12),
                };
                Enclosed {
                    feature,
                    slopes: all.slopes,
                    rounding,
                }
            });
    Some(each.collect())
}
