//! Who is ahead in a lane that the ego shares with another, and by how much.

use super::contract::Contract;
use super::error::EnterError;
use super::other::{News, Other};
use super::own::Own;
use super::precedence::has;
use super::rules::Rules;
use crate::junction::zone::Zone;
use crate::junction::{Class, PathId, Way};
use crate::real::Real;

/// Whether the ego is certainly in the lane, and ahead of the other in it.
///
/// Two vehicles in a lane do not overlap, and the middle of the band is where they would: sensing errors are too small
/// to take one side for the other ([`EnterError::PositionError`]). One that coasts counts where it may be farthest.
pub(super) fn is_ahead<R: Rules>(
    contract: &Contract,
    zone: &Zone,
    ego: &Own,
    other: &Other,
) -> bool {
    let lead = ego.s - (other.bounds.s.to - contract.position_error);
    ego.least >= zone.ego.from && R::is_ahead(zone, lead)
}

/// The gap (m), at least, from the other to the ego ahead of it once that has entered the lane.
pub(super) fn gap_ahead(zone: &Zone, ego: &Own, other: &Other) -> f32 {
    let place = Real::max(zone.ego.from, ego.least);
    place - other.bounds.s.to - zone.lead.to
}

/// How far (m) the ego may go and still be at rest behind an other that is ahead and brakes as hard as it can.
pub(super) fn behind<R: Rules>(contract: &Contract, zone: &Zone, ego: &Own, other: &Other) -> f32 {
    let gap = zone.lead.from - (ego.s + contract.position_error - other.bounds.s.from);
    if gap < 0.0 {
        // Not behind it at all.
        return gap;
    }
    gap + R::earliest_rest(contract, other.bounds.speed.from)
}

/// [`Rules::safe_gap`] outside of the search for a plan.
#[inline(never)] // Once in flash.
pub(super) fn safe_gap<R: Rules>(contract: &Contract, speed: f32, ego_speed: f32) -> f32 {
    R::safe_gap(contract, speed, ego_speed)
}

/// Notes for each lane that the ego shares with `other` whether it is ahead there, and the other keeps its distance
/// from now on: the plan in force counted on it, or the gap is enough, or it was so when the other appeared.
pub(super) fn settle<'z, R: Rules>(
    contract: &Contract,
    zones: impl Iterator<Item = &'z Zone>,
    ego: &Own,
    other: &mut Other,
) {
    let appeared = other.news == News::Appeared;
    for (index, zone) in (0_u8..).zip(zones) {
        if !zone.is_lane() || !is_ahead::<R>(contract, zone, ego, other) {
            continue;
        }
        let slowest = Real::max(ego.speed - contract.speed_error, 0.0);
        let needs = safe_gap::<R>(contract, other.bounds.speed.to, slowest);
        let enough = gap_ahead(zone, ego, other) >= needs;
        if appeared || has(other.counted, index) || enough {
            other.settled |= 1 << index;
        }
    }
}

/// Whether in every lane that the ego shares, sensed positions tell who is ahead.
pub(super) fn tells_apart(contract: &Contract, way: Way<'_>) -> Result<(), EnterError> {
    let length = |path| way.path(path).map_or(0.0, |path| path.footprint().length);
    let driven = |&(path, _): &(PathId, _)| {
        let path = way.path(path);
        path.is_some_and(|path| path.class() != Class::Pedestrian)
    };
    for (path, conflict) in way.conflicts().filter(driven) {
        let touching = length(way.ego()) + length(path);
        for zone in conflict.zones().filter(|zone| zone.is_lane()) {
            let band = zone.lead.to - zone.lead.from;
            let below = 0.25 * Real::min(touching, band);
            let value = contract.position_error;
            if value >= below {
                return Err(EnterError::PositionError { path, value, below });
            }
        }
    }
    Ok(())
}
