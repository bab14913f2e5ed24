//! Who goes first where two vehicles wait for each other.
//!
//! Who arrived first; and if that one does not take its turn, the other, and so on, as long as both rest.
//! `docs/theorem.md` shows why never both have precedence.

use super::contract::{Contract, Precedence};
use super::rules::Rules;
use super::waiting::{Arrived, Presence, dip, sets_off};
use crate::instant::micros;
use crate::junction::zone::Zone;
use crate::junction::{Path, PathId, Priority, RightOfWay, RouteConflict, Way};
use core::cmp::Ordering;

/// The zones in which the ego has precedence, one bit each.
pub(crate) type ZoneSet = u8;

/// Every zone that the ego shares with another.
pub(crate) const ALL: ZoneSet = ZoneSet::MAX;

/// Whether zone number `zone` is in the set.
pub(crate) fn has(set: ZoneSet, zone: u8) -> bool {
    set.checked_shr(zone.into()).unwrap_or(0) & 1 == 1
}

/// How many times longer two wait for each other until they take turns where signs say who goes first.
const SIGNED: u16 = 4;

/// Which of the ego and one other goes first where they meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Right {
    /// Who has the right of way.
    pub of_way: RightOfWay,
    /// When it counts.
    pub priority: Priority,
    /// Who comes first while they take turns. Of any number of vehicles one comes before all others, which the right of
    /// way does not promise.
    pub in_turns: RightOfWay,
}

impl Right {
    /// On the ego's path and path `other`, which meet like `conflict`.
    pub(crate) fn of(conflict: &RouteConflict, way: Way<'_>, other: PathId) -> Self {
        let RouteConflict {
            right_of_way,
            priority,
            ..
        } = *conflict;
        let order = |path| way.path(path).map_or(0, Path::order);
        let by_order = match order(way.ego()).cmp(&order(other)) {
            Ordering::Less => RightOfWay::Ego,
            Ordering::Greater => RightOfWay::Other,
            Ordering::Equal => RightOfWay::Unsettled,
        };
        Self {
            of_way: right_of_way,
            priority,
            in_turns: match priority {
                Priority::FirstCome | Priority::Unsigned => by_order,
                Priority::Signed => right_of_way,
            },
        }
    }

    /// Periods for which both rest before the first turn. Whoever has to give way to signs waits longer before it takes
    /// the other for one that does not go.
    const fn patience(self, rule: Precedence) -> u16 {
        match self.priority {
            Priority::FirstCome | Priority::Unsigned => rule.patience,
            Priority::Signed => rule.patience.saturating_mul(SIGNED),
        }
    }
}

/// What the ego remembers of itself and one other who wait for each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct PairMemory {
    /// How the other came to its line.
    pub other: Presence,
    turn: Turn,
}

/// Whose turn it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
enum Turn {
    /// No period of the two has been counted yet: nobody's.
    #[default]
    New,
    /// Whoever goes first by arrival and right of way.
    First,
    /// Not the ego's.
    Past,
    /// The ego's.
    Ego,
    /// Not the ego's, but it stands in these zones: the other has to wait until it has left them.
    Inside(ZoneSet),
}

impl PairMemory {
    /// The zones in which the ego has precedence over the other.
    #[must_use]
    pub fn claims(
        &self,
        contract: &Contract,
        rule: Precedence,
        right: Right,
        ego: &Presence,
    ) -> u8 {
        match self.turn {
            Turn::First | Turn::Ego if self.ends_soon(contract, right.patience(rule), ego) => 0,
            Turn::First => {
                let first = match right.priority {
                    Priority::FirstCome => self.came_first(contract, rule, right.of_way, ego),
                    Priority::Unsigned | Priority::Signed => right.of_way == RightOfWay::Ego,
                };
                if first { ALL } else { 0 }
            }
            Turn::New | Turn::Past => 0,
            Turn::Ego => ALL,
            Turn::Inside(zones) => zones,
        }
    }

    /// Whether the ego still rests so shortly before what it has ends that it would be called back: not everybody would
    /// have seen it move by then.
    fn ends_soon(&self, contract: &Contract, patience: u16, ego: &Presence) -> bool {
        let perhaps = ego.standstill.perhaps.min(self.other.standstill.perhaps);
        let ends = match perhaps.checked_div(patience) {
            None => return false, // There are no turns.
            Some(0) => patience,
            Some(patiences) => patience.saturating_mul(2 << patiences.ilog2()),
        };
        // Where others are slow to see it, most of the first turn is left to set off in.
        let late = sets_off(contract).min(patience / 4);
        ego.standstill.surely > 0 && perhaps.saturating_add(late) >= ends
    }

    /// Whoever stands in a zone while both rest has precedence there until it has left: whoever has the turn, the other
    /// sees it stand there, and has no plan left that counts on the zone. `s` is where the ego is sensed (m).
    pub fn hold<'z, R: Rules>(
        &mut self,
        contract: &Contract,
        ego: &Presence,
        zones: impl Iterator<Item = &'z Zone>,
        s: f32,
    ) {
        // One period more than between turns: the other may have counted on the zone until the ego was in it.
        let periods = R::grace(contract).saturating_add(1);
        if ego.standstill.surely.min(self.other.standstill.surely) < periods {
            return;
        }
        // It has been there for all these periods, however it crept.
        let slow = contract.rest_speed() + 2.0 * contract.speed_error + 0.5 * dip(contract);
        let crept = f32::from(periods) * contract.period * slow + contract.position_error;
        let inside = |zone: &Zone| s - crept > zone.ego.from && s < zone.ego.to;
        let mut held = 0;
        for (number, zone) in (0_u8..).zip(zones) {
            if inside(zone) && !zone.is_lane() {
                held |= 1 << number;
            }
        }
        if held != 0 {
            self.turn = Turn::Inside(held);
        }
    }

    /// Passes the turn on. While both rest, a turn begins after `patience` periods, twice, four times, … as many, and its
    /// first few periods are nobody's; as soon as one of them moves, the turn stays whose it is. To be called after
    /// both were noted, a period after the last time.
    pub fn pass<R: Rules>(
        &mut self,
        contract: &Contract,
        rule: Precedence,
        right: Right,
        ego: &Presence,
    ) {
        if self.turn == Turn::New {
            self.turn = Turn::First;
        }
        let patience = right.patience(rule);
        let (mine, theirs) = (ego.standstill, self.other.standstill);
        let perhaps = mine.perhaps.min(theirs.perhaps);
        let surely = mine.surely.min(theirs.surely);
        let Some((turn, begins)) = turn(perhaps, patience) else {
            return;
        };
        if R::ends(perhaps, surely, begins, patience) {
            self.turn = Turn::Past;
        }
        // No turn begins for two that have not surely rested.
        if surely < begins {
            return;
        }
        // An unknown rest is `u16::MAX`, so that the smaller one is the known one. One known rest is enough if there is an
        // order in turns. Without an order, who comes first is told from both.
        let counted = perhaps < u16::MAX
            && (right.in_turns != RightOfWay::Unsettled
                || mine.perhaps < u16::MAX && theirs.perhaps < u16::MAX);
        // The first two turns are the one's who comes second, the next two the other's, and so on.
        let owner = self.first(contract, right.in_turns, ego) == Some((turn / 2) % 2 == 1);
        if surely == begins.saturating_add(R::grace(contract)) && counted && owner {
            self.turn = Turn::Ego;
        }
    }

    /// Notes so many periods without a call, and passes the turn on after each: nobody has surely rested in them, so that a
    /// turn may end and none begins. The ego was like `ego` before, and has arrived `here`, the other `there`.
    pub(super) fn miss<R: Rules>(
        &mut self,
        rule: Precedence,
        right: Right,
        (ego, here): (&Presence, Arrived),
        there: Arrived,
        periods: u16,
    ) {
        if periods == 0 {
            return;
        }
        if self.turn == Turn::New {
            self.turn = Turn::First;
        }
        let patience = right.patience(rule);
        let (mine, theirs) = (ego.standstill, self.other.standstill);
        let before = mine.perhaps.min(theirs.perhaps);
        let ends = |more: u16| {
            let perhaps = before.saturating_add(more);
            turn(perhaps, patience).is_some_and(|(_, begins)| R::ends(perhaps, 0, begins, patience))
        };
        let wait = here != Arrived::Not && there != Arrived::Not;
        if wait && (1..=periods).any(ends) {
            self.turn = Turn::Past;
        }
        self.other.miss(there, periods);
    }

    /// Nothing is known any more of who rested how long: nobody's turn is left.
    pub fn forget(&mut self) {
        self.other.forget();
        self.turn = Turn::Past;
    }

    /// Whether the ego certainly arrived before the other; in a tie, whether it has the right of way.
    fn came_first(
        &self,
        contract: &Contract,
        rule: Precedence,
        right_of_way: RightOfWay,
        ego: &Presence,
    ) -> bool {
        let tie = (u64::from(rule.tie) + 1) * micros(contract.period);
        let mine = right_of_way == RightOfWay::Ego;
        ego.arrival.goes_first(self.other.arrival, tie, mine)
    }

    /// Whether the ego comes before the other while both rest, so that the other knows it, too: by the right of
    /// way; without one, by how much earlier it arrived and came to rest.
    fn first(&self, contract: &Contract, in_turns: RightOfWay, ego: &Presence) -> Option<bool> {
        match in_turns {
            RightOfWay::Ego => Some(true),
            RightOfWay::Other => Some(false),
            RightOfWay::Unsettled => {
                let period = micros(contract.period);
                let first = ego.first(self.other, period);
                (first || self.other.first(*ego, period)).then_some(first)
            }
        }
    }
}

/// Number of the turn, from 0, of two who have perhaps rested for so many periods, and after how many it begins; none before
/// the first.
fn turn(perhaps: u16, patience: u16) -> Option<(u32, u16)> {
    let turn = perhaps.checked_div(patience)?.checked_ilog2()?;
    Some((turn, patience.saturating_mul(1 << turn)))
}

#[cfg(test)]
mod tests;
