//! The elementary rules of which the shield is composed.

use super::actuation::Inherited;
use super::bounds::Bounds;
use super::contract::Contract;
use super::margin::{self, Departure};
use super::reach::Reach;
use super::waiting;
use crate::junction::zone::Zone;
use crate::plan::Plan;

/// The rules, one method each. [`Sound`] is the only implementation that drives.
///
/// The seam exists for tests: a shield in which a single rule is broken must be caught. It is found in
/// [`crate::dangerous`] alone.
pub trait Rules {
    /// Bounds on the ego until a plan's first command is in effect: [`margin::departure`].
    #[must_use]
    fn departure(
        contract: &Contract,
        speed: f32,
        inherited: &Inherited<f32>,
        command: f32,
    ) -> Departure<f32> {
        margin::departure(contract, speed, inherited, command)
    }

    /// Where the ego is at rest if it goes for `time` after `from` and then brakes: [`margin::rest`].
    #[inline(always)]
    #[must_use]
    fn rest(contract: &Contract, from: Reach<f32>, time: f32) -> f32 {
        margin::rest(contract, from, time)
    }

    /// Whether the ego stops in time: [`margin::stops_short`].
    #[must_use]
    fn stops_short(contract: &Contract, limit: f32, rest: f32) -> f32 {
        margin::stops_short(contract, limit, rest)
    }

    /// How far an other gets: [`margin::rush`].
    #[inline(always)]
    #[must_use]
    fn rush(contract: &Contract, speed: f32, time: f32) -> Reach<f32> {
        margin::rush(contract, speed, time)
    }

    /// The gap at which the ego may enter a lane: [`margin::safe_gap`].
    #[inline(always)]
    #[must_use]
    fn safe_gap(contract: &Contract, speed: f32, ego_speed: f32) -> f32 {
        margin::safe_gap(contract, speed, ego_speed)
    }

    /// Where an other ahead is at rest at the earliest: [`margin::earliest_rest`].
    #[must_use]
    fn earliest_rest(contract: &Contract, speed: f32) -> f32 {
        margin::earliest_rest(contract, speed)
    }

    /// Where an other is now that was within `bounds` `time` seconds ago: [`Bounds::after`].
    #[must_use]
    fn coast(contract: &Contract, bounds: Bounds, time: f32) -> Bounds {
        bounds.after(contract, time)
    }

    /// Whether an ego that leads by `lead` (m) in a lane, as sensed, is ahead of the other there.
    #[must_use]
    fn is_ahead(zone: &Zone, lead: f32) -> bool {
        lead >= zone.middle()
    }

    /// Whether a remembered plan with so many metres to spare keeps the guarantee against somebody new.
    #[must_use]
    fn keeps(margin: f32) -> bool {
        margin >= 0.0
    }

    /// The arc length at which the ego has cleared a zone in which routes cross.
    #[must_use]
    fn cleared_at(zone: &Zone) -> f32 {
        zone.ego.to
    }

    /// Whether an other that is at least at `other` has left the zone, for ever.
    #[must_use]
    fn left(zone: &Zone, other: f32) -> bool {
        other >= zone.other.to
    }

    /// Whether a hazard whose target is `a` metres ahead is cleared before one whose target is `b` metres ahead.
    #[must_use]
    fn sooner(a: f32, b: f32) -> bool {
        a < b
    }

    /// Whether nobody's turn is left from before, when both have rested for so many periods: a new one
    /// begins, or they may have moved since the last one began.
    #[must_use]
    fn ends(perhaps: u16, surely: u16, begins: u16, patience: u16) -> bool {
        let due = perhaps.checked_rem(patience) == Some(0);
        (due && (perhaps == begins || surely < begins)) || perhaps == u16::MAX
    }

    /// Periods from the end of one vehicle's turn to the beginning of the other's.
    #[must_use]
    fn grace(contract: &Contract) -> u16 {
        waiting::grace(contract)
    }

    /// What is left of a plan after its first command.
    #[must_use]
    fn tail(plan: Plan) -> Plan {
        plan.tail()
    }
}

/// The rules as they are proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sound;

impl Rules for Sound {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_ends_where_the_next_one_is_due() {
        let ends = |perhaps, surely| Sound::ends(perhaps, surely, 30, 15);
        assert!(ends(30, 30), "it begins");
        assert!(!ends(45, 30) && ends(45, 29), "or they moved since");
        assert!(!ends(44, 29) && !ends(31, 31));
        assert!(ends(u16::MAX, 30), "or nothing is known");
        assert!(!Sound::ends(30, 30, 30, 0));
    }
}
