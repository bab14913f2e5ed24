//! The accelerations among which the shield chooses.

use super::contract::{Contract, Ego};
use crate::real::Real;

/// Accelerations of the grid, from full braking to full acceleration.
pub const GRID: u8 = 13;

/// Number `i` < [`GRID`] of the grid's accelerations, in m/s².
#[must_use]
pub fn grid<R: Real>(ego: &Ego, i: u8) -> R {
    let share = f32::from(i) / f32::from(GRID - 1);
    R::of(share) * R::of(ego.acceleration) - R::of(1.0 - share) * R::of(ego.braking)
}

/// The hardest acceleration (m/s²) that may be commanded at `speed` (m/s, as sensed) while one of at most `in_effect`
/// (m/s²) still acts: the ego does not become faster than `ego.max_speed`, and if it is already, no faster than it is.
#[inline(never)] // Once in flash.
pub fn most<R: Real>(contract: &Contract, speed: R, in_effect: R) -> R {
    let ego = contract.ego();
    let (period, late) = (R::of(contract.period()), R::of(contract.response()));
    let zero = R::of(0.0);
    let room = R::of(ego.max_speed) - speed - R::of(contract.speed_error());
    let after = (room - zero.max(in_effect) * late) / period;
    let throughout = room / (period + late);
    let room = after.min(throughout);
    if contract.is_exact() {
        // In this order, what is not a number becomes 0.
        return zero.max(room).min(R::of(ego.acceleration));
    }
    let (gain, disturbance) = (R::of(ego.gain), R::of(ego.disturbance));
    let (in_part, in_excess) = (R::of(1.0) - gain, R::of(1.0) + gain);
    let left = room - disturbance;
    // Braking may be achieved in part, and acceleration in excess.
    let commanded = (left / in_part).min(left / in_excess);
    let hold = -(disturbance / in_part);
    hold.max(commanded).min(R::of(ego.acceleration))
}

/// What may be commanded of `acceleration` (m/s²) if `most` (m/s²) is the hardest; braking, if it is not a number.
#[must_use]
pub fn allowed(ego: &Ego, most: f32, acceleration: f32) -> f32 {
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
    most: f32,
    wanted: f32,
    check: impl Fn(f32) -> Option<V>,
) -> Option<(f32, V)> {
    let mut found: Option<(f32, V)> = None;
    for i in 0..GRID {
        let candidate = allowed(ego, most, grid(ego, i));
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
