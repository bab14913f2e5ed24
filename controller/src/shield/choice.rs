//! The accelerations among which the shield chooses.

use super::contract::{Contract, Ego};
use crate::plan::Plan;
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

/// The next command (m/s²) of a plan.
pub(super) const fn next(contract: &Contract, plan: Plan) -> f32 {
    if plan.go > 0 {
        contract.ego.go
    } else {
        -contract.ego.braking
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shield::contract::tests::INEXACT;

    fn near(a: f32, b: f32) {
        assert!((a - b).abs() < 1e-4, "{a}, {b}");
    }

    #[test]
    fn the_grid_goes_from_full_braking_to_full_acceleration() {
        let mut ego = Contract::WORST_CASE.ego;
        (ego.acceleration, ego.braking) = (2.0, 4.0);
        for (i, acceleration) in [(0, -4.0), (3, -2.5), (6, -1.0), (8, 0.0), (12, 2.0)] {
            near(grid(&ego, i), acceleration);
        }
    }

    #[test]
    fn what_may_be_commanded_reaches_the_limit_and_not_more() {
        let contract = Contract::builder().speed_error(0.2).build().unwrap();
        // 0.8 m/s are left, and 0.4: what is in effect takes 0.3 of them if it accelerates.
        near(most(&contract, 14.0, 3.0), 3.0);
        near(most(&contract, 14.4, 3.0), 1.0);
        near(most(&contract, 14.4, -1.0), 2.0);
        near(most(&contract, 15.2, -1.0), 0.0);
        near(most(&contract, 5.0, 0.0), 3.0);
    }

    #[test]
    fn an_inexact_ego_is_held_below_the_limit_whatever_becomes_of_its_command() {
        let mut contract = INEXACT;
        (contract.jitter, contract.latency, contract.speed_error) = (0.0, 0.1, 0.0);
        contract.ego.lag = 0.0;
        // 1.5 m/s² are left, 0.4, none: of them 0.5 are nobody's, and a quarter may be in excess, or not achieved.
        near(most(&contract, 14.7, 0.0), 0.8);
        near(most(&contract, 14.92, 0.0), -0.1 / 0.75);
        near(most(&contract, 14.98, 0.0), -0.4 / 0.75);
        near(most(&contract, 15.0, 0.0), -0.5 / 0.75);
        near(most(&contract, 16.0, 0.0), -0.5 / 0.75);
        near(most(&contract, 5.0, 0.0), 2.0);
    }

    #[test]
    fn what_is_allowed_is_between_full_braking_and_the_most() {
        let ego = Contract::WORST_CASE.ego;
        let of = |acceleration| allowed(&ego, 1.0, acceleration);
        assert_eq!(
            [2.0, 1.0, 0.5, -3.0, -3.5].map(of),
            [1.0, 1.0, 0.5, -3.0, -3.0]
        );
        assert_eq!(of(f32::NAN), -3.0);
    }

    #[test]
    fn the_nearest_of_the_grid_is_found_and_of_two_the_lower() {
        let ego = Contract::WORST_CASE.ego;
        let found = |most, wanted, but: f32| {
            let check = |candidate: f32| (candidate != but).then_some(());
            nearest(&ego, most, wanted, check).map(|(found, ())| found)
        };
        assert_eq!(found(3.0, 0.1, 9.0), Some(0.0));
        assert_eq!(found(3.0, 0.2, 0.0), Some(0.5));
        assert_eq!(found(0.7, 3.0, 9.0), Some(0.7));
        let ends = |candidate: f32| (candidate.abs() == 3.0).then_some(());
        assert_eq!(nearest(&ego, 3.0, 0.0, ends), Some((-3.0, ())));
        assert_eq!(nearest::<()>(&ego, 3.0, 0.0, |_| None), None);
    }
}
