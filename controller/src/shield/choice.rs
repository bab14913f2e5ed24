//! The accelerations among which the shield chooses.

use super::contract::Ego;
use crate::real::Real;

/// Accelerations of the grid, from full braking to full acceleration.
pub const GRID: u8 = 13;

/// Number `i` < [`GRID`] of the grid's accelerations, in m/s².
#[must_use]
pub fn grid<R: Real>(ego: &Ego, i: u8) -> R {
    let share = f32::from(i) / f32::from(GRID - 1);
    R::of(share) * R::of(ego.acceleration) - R::of(1.0 - share) * R::of(ego.braking)
}

/// What may be commanded of `acceleration` (m/s²) at `speed` (m/s); braking, if it is not a number.
#[must_use]
pub fn allowed(ego: &Ego, speed: f32, acceleration: f32) -> f32 {
    let most = if speed < ego.max_speed {
        ego.acceleration
    } else {
        0.0
    };
    if acceleration >= most {
        most
    } else if acceleration >= -ego.braking {
        acceleration
    } else {
        -ego.braking
    }
}

/// The acceleration of the grid that is nearest to `wanted` among those that `check` accepts, with what
/// `check` says of it; of two, the lower.
pub(super) fn nearest<V>(
    ego: &Ego,
    speed: f32,
    wanted: f32,
    check: impl Fn(f32) -> Option<V>,
) -> Option<(f32, V)> {
    let mut found: Option<(f32, V)> = None;
    for i in 0..GRID {
        let candidate = allowed(ego, speed, grid(ego, i));
        let distance = |acceleration: f32| (acceleration - wanted).abs();
        if found
            .as_ref()
            .is_none_or(|(best, _)| distance(candidate) < distance(*best))
            && let Some(verdict) = check(candidate)
        {
            found = Some((candidate, verdict));
        }
    }
    found
}
