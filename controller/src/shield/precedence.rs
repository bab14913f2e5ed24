//! Who goes first where two vehicles wait for each other.
//!
//! Who arrived first; and if that one does not take its turn, the other, and so on, as long as both rest.
//! `docs/theorem.md` shows why never both have precedence.

use super::contract::{Contract, Precedence};
use super::rules::Rules;
use super::waiting::{RestState, Standstill};
use crate::junction::conflict::{RightOfWay, RouteConflict};
use crate::junction::scene::{MAX_OTHERS, Scene};
use crate::junction::zone::{Span, Zone};
use crate::observation::{Observation, Vehicle};

/// The zones in which the ego has precedence, one bit each.
type Zones = u8;

/// Every zone that the ego shares with another.
const ALL: Zones = Zones::MAX;

/// In which zones with which others the ego has precedence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Claims(pub(super) [Zones; MAX_OTHERS]);

impl Claims {
    pub(crate) fn has(self, other: u8, zone: u8) -> bool {
        let zones = self.0.get(usize::from(other)).copied().unwrap_or(0);
        zones.checked_shr(zone.into()).unwrap_or(0) & 1 == 1
    }
}

/// What the ego remembers of how it and each other came to the zones that they share.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Precedences<const N: usize>([PairMemory; N]);

/// The ego and one other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct PairMemory {
    ego: Arrival,
    other: Arrival,
    turn: Turn,
}

/// One of the two.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Arrival {
    /// Periods since it arrived, the first included, as long as the two have not both arrived; 0 before.
    arrived: u16,
    standstill: Standstill,
}

/// Whose turn it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Turn {
    /// Whoever goes first by arrival and right of way.
    #[default]
    First,
    /// Not the ego's.
    Past,
    /// The ego's.
    Ego,
    /// Not the ego's, but it stands in these zones: the other has to wait until it has left them.
    Inside(Zones),
}

impl<const N: usize> Precedences<N> {
    pub(crate) fn new() -> Self {
        Self([PairMemory::default(); N])
    }

    /// One period later: notes who has arrived and who rests, and says over whom the ego has precedence.
    pub(crate) fn note<R: Rules>(
        &mut self,
        contract: &Contract,
        rule: Precedence,
        scene: &Scene<N>,
        seen: &Observation<N>,
    ) -> Claims {
        let mut claims = Claims::default();
        let others = scene.conflicts().iter().zip(seen.others.iter());
        let pairs = claims.0.iter_mut().zip(self.0.iter_mut());
        for ((conflict, other), (claims, pair)) in others.zip(pairs) {
            let Some(other) = other else {
                pair.lose();
                continue;
            };
            pair.tick();
            pair.ego
                .note(contract, rule, entry(conflict, |z| z.ego), &seen.ego);
            pair.other
                .note(contract, rule, entry(conflict, |z| z.other), other);
            pair.pass::<R>(contract, rule, conflict.right_of_way);
            *claims = pair.claims(rule, conflict.right_of_way);
            if *claims != ALL {
                pair.hold::<R>(contract, conflict, &seen.ego);
                *claims = pair.claims(rule, conflict.right_of_way);
            }
        }
        claims
    }

    /// One period later, in which nothing was seen: whoever had arrived may have rested.
    pub(crate) fn blind<R: Rules>(&mut self, contract: &Contract, rule: Precedence) {
        for pair in &mut self.0 {
            pair.tick();
            for arrival in [&mut pair.ego, &mut pair.other] {
                if arrival.arrived > 0 {
                    arrival.standstill.note(RestState::Perhaps);
                }
            }
            pair.pass::<R>(contract, rule, RightOfWay::Unsettled);
        }
    }
}

impl Arrival {
    fn note(
        &mut self,
        contract: &Contract,
        rule: Precedence,
        entry: Option<f32>,
        vehicle: &Vehicle,
    ) {
        let within = |limit: f32| entry.is_some_and(|entry| entry - vehicle.s <= limit);
        if self.arrived == 0 && within(rule.distance) {
            self.arrived = 1;
        }
        self.standstill
            .note(match RestState::of(contract, vehicle) {
                _ if self.arrived == 0 => RestState::No,
                // It has to have arrived for the other's shield as well.
                RestState::Surely if !within(rule.distance - 2.0 * contract.position_error) => {
                    RestState::Perhaps
                }
                rest => rest,
            });
    }
}

impl PairMemory {
    /// One period has passed.
    fn tick(&mut self) {
        let (ego, other) = (&mut self.ego.arrived, &mut self.other.arrived);
        match (*ego, *other) {
            (1.., 0) => *ego = ego.saturating_add(1),
            (0, 1..) => *other = other.saturating_add(1),
            _ => {}
        }
    }

    /// The other is not to be seen.
    fn lose(&mut self) {
        self.other = Arrival::default();
        if matches!(self.turn, Turn::Ego | Turn::Inside(_)) {
            self.turn = Turn::Past;
        }
    }

    /// The zones in which the ego has precedence.
    fn claims(&self, rule: Precedence, right_of_way: RightOfWay) -> Zones {
        let first = || precedes(self.ego.arrived, self.other.arrived, rule.tie, right_of_way);
        match self.turn {
            Turn::First if first() => ALL,
            Turn::First | Turn::Past => 0,
            Turn::Ego => ALL,
            Turn::Inside(zones) => zones,
        }
    }

    /// Whoever stands in a zone while both rest has precedence there until it has left: whoever has the turn, the other
    /// sees it stand there, and has no plan left that counts on the zone.
    fn hold<R: Rules>(&mut self, contract: &Contract, conflict: &RouteConflict, ego: &Vehicle) {
        let periods = R::grace(contract);
        if self.ego.standstill.surely.min(self.other.standstill.surely) < periods {
            return;
        }
        // It has been there for all these periods, however it crept.
        let slow = contract.rest_speed() + 2.0 * contract.speed_error;
        let crept = f32::from(periods) * contract.period * slow + contract.position_error;
        let inside = |zone: &Zone| ego.s - crept > zone.ego.from && ego.s < zone.ego.to;
        let zones = (0_u32..).zip(conflict.zones());
        let zones = zones.fold(0, |zones, (number, zone)| {
            zones | Zones::from(inside(zone) && !zone.is_lane()) << number
        });
        if zones != 0 {
            self.turn = Turn::Inside(zones);
        }
    }

    /// Passes the turn on. While both rest, a turn begins after `patience` periods, twice, four times, … as many, and its
    /// first few periods are nobody's; as soon as one of them moves, the turn stays whose it is.
    fn pass<R: Rules>(&mut self, contract: &Contract, rule: Precedence, right_of_way: RightOfWay) {
        let (ego, other) = (self.ego.standstill, self.other.standstill);
        let perhaps = ego.perhaps.min(other.perhaps);
        let surely = ego.surely.min(other.surely);
        let patiences = perhaps.checked_div(rule.patience).unwrap_or(0);
        let Some(turn) = patiences.checked_ilog2() else {
            return;
        };
        let begins = rule.patience.saturating_mul(1 << turn);
        if R::ends(perhaps, surely, begins, rule.patience) {
            self.turn = Turn::Past;
        }
        // A saturated counter no longer tells whose turn it is: nobody's.
        let counted = ego.perhaps < u16::MAX && other.perhaps < u16::MAX;
        // The first turn is the one's who gives way, the second the other's, and so on.
        let mine = self.first(right_of_way) == Some(turn % 2 == 1);
        if surely == begins.saturating_add(R::grace(contract)) && counted && mine {
            self.turn = Turn::Ego;
        }
    }

    /// Whether the ego comes before the other while both rest, so that the other knows it, too: by the right of
    /// way; without one, by how much earlier it arrived and came to rest, both together.
    fn first(&self, right_of_way: RightOfWay) -> Option<bool> {
        let earlier = |one: Arrival, two: Arrival| {
            let [a, b] = [one, two].map(|arrival| i32::from(arrival.arrived));
            a - b + i32::from(one.standstill.surely) - i32::from(two.standstill.perhaps) > 1
        };
        match right_of_way {
            RightOfWay::Ego => Some(true),
            RightOfWay::Other => Some(false),
            RightOfWay::Unsettled => {
                let first = earlier(self.ego, self.other);
                (first || earlier(self.other, self.ego)).then_some(first)
            }
        }
    }
}

/// Where a vehicle comes to the first zone that it shares with the other.
fn entry(conflict: &RouteConflict, side: fn(&Zone) -> Span) -> Option<f32> {
    conflict
        .zones()
        .map(|zone| side(zone).from)
        .fold(None, |first, from| match first {
            Some(first) if first <= from => Some(first),
            _ => Some(from),
        })
}

/// Whether the ego goes first, which came, as the other, so many periods ago, or not yet (0). Of two vehicles
/// that see the same, at most one does.
fn precedes(ego: u16, other: u16, tie: u16, right_of_way: RightOfWay) -> bool {
    if ego == 0 {
        return false;
    }
    // An other that has not arrived yet arrives now at the earliest.
    let ahead = i32::from(ego) - i32::from(other.max(1));
    let tie = i32::from(tie);
    match right_of_way {
        RightOfWay::Ego => ahead >= -tie,
        // The other, if it has the right of way, may count one period less between the two arrivals.
        _ => ahead > tie + 1,
    }
}

#[cfg(test)]
mod tests;
