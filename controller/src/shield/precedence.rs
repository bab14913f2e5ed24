//! Who goes first where two vehicles wait for each other.

use super::contract::{Contract, Precedence};
use super::rules::Rules;
use super::waiting::{Rest, Turn, Waiting};
use crate::observation::{Observation, Vehicle};
use crate::pair::RightOfWay;
use crate::scene::{Meeting, Scene};
use crate::zone::{Interval, Zone};
use core::num::NonZeroU32;

/// The others over which the ego has precedence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Claims(u32);

impl Claims {
    pub(crate) fn has(self, other: u8) -> bool {
        self.0.checked_shr(other.into()).unwrap_or(0) & 1 == 1
    }

    pub(super) fn claim(&mut self, other: u8) {
        self.0 |= 1_u32.checked_shl(other.into()).unwrap_or(0);
    }
}

/// The period at which a vehicle arrived.
type Arrival = Option<NonZeroU32>;

/// What the ego remembers of itself and one other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Encounter {
    ego: Arrival,
    other: Arrival,
    waiting: Waiting,
}

/// When the ego and each other arrived at the zones that they share, and how long they have been waiting.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arrivals<const N: usize> {
    /// Periods since the start.
    now: u32,
    encounters: [Encounter; N],
}

impl<const N: usize> Arrivals<N> {
    pub(crate) fn new() -> Self {
        Self {
            now: 0,
            encounters: [Encounter::default(); N],
        }
    }

    /// One period has passed.
    pub(crate) fn tick(&mut self) {
        self.now = self.now.saturating_add(1);
    }

    /// Notes who has arrived and who waits, and says over whom the ego has precedence.
    pub(crate) fn note<R: Rules>(
        &mut self,
        contract: &Contract,
        rule: Precedence,
        scene: &Scene<N>,
        seen: &Observation<N>,
    ) -> Claims {
        let mut claims = Claims::default();
        let others = scene.meetings().iter().zip(seen.others.iter());
        let encounters = others.zip(self.encounters.iter_mut());
        for (number, ((meeting, other), encounter)) in (0_u8..).zip(encounters) {
            let Some(other) = other else {
                encounter.other = None;
                encounter.waiting.lose();
                continue;
            };
            let away = |entry: Option<f32>, vehicle: &Vehicle| entry.map(|entry| entry - vehicle.s);
            let ego = away(entry(meeting, |z| z.ego), &seen.ego);
            let far = away(entry(meeting, |z| z.other), other);
            let here = |away: Option<f32>| {
                let near = away.is_some_and(|metres| metres <= rule.distance);
                NonZeroU32::new(self.now).filter(|_| near)
            };
            encounter.ego = encounter.ego.or(here(ego));
            encounter.other = encounter.other.or(here(far));
            // So near that both have arrived for the other's shield as well.
            let near = |away: Option<f32>| {
                away.is_some_and(|metres| metres <= rule.distance - 2.0 * contract.position_error)
            };
            let rest = Rest::of(contract, &seen.ego).min(Rest::of(contract, other));
            let rest = match rest {
                _ if encounter.ego.is_none() || encounter.other.is_none() => Rest::No,
                Rest::Surely if !(near(ego) && near(far)) => Rest::Perhaps,
                rest => rest,
            };
            if encounter.note::<R>(contract, rule, rest, self.now, meeting.right_of_way) {
                claims.claim(number);
            }
        }
        claims
    }

    /// Nothing is seen: whoever has arrived may be at rest.
    pub(crate) fn blind(&mut self, rule: Precedence) {
        for Encounter {
            ego,
            other,
            waiting,
        } in &mut self.encounters
        {
            if ego.is_some() && other.is_some() {
                waiting.note(Rest::Perhaps, rule.patience, 0, |_| false);
            }
        }
    }
}

impl Encounter {
    /// Whether the ego has precedence now that the two have been seen at `rest` or not.
    fn note<R: Rules>(
        &mut self,
        contract: &Contract,
        rule: Precedence,
        rest: Rest,
        now: u32,
        right_of_way: RightOfWay,
    ) -> bool {
        let (ego, other) = (
            self.ego.map(NonZeroU32::get),
            self.other.map(NonZeroU32::get),
        );
        // Of three turns the first is the one's who should have given way.
        let mine = |turn: u16| settled(ego, other, right_of_way) == Some(turn % 3 != 1);
        self.waiting
            .note(rest, rule.patience, R::grace(contract), mine);
        match self.waiting.turn {
            Turn::First => precedes((ego, other), now, rule.tie, right_of_way),
            Turn::Past => false,
            Turn::Ego => true,
        }
    }
}

/// Where a vehicle comes to the first zone that it shares with the other.
fn entry(meeting: &Meeting, side: fn(&Zone) -> Interval) -> Option<f32> {
    meeting
        .zones()
        .map(|zone| side(zone).from)
        .fold(None, |first, from| match first {
            Some(first) if first <= from => Some(first),
            _ => Some(from),
        })
}

/// Whether the ego goes first. Of two vehicles that see the same, at most one does.
fn precedes(
    (ego, other): (Option<u32>, Option<u32>),
    now: u32,
    tie: u16,
    right_of_way: RightOfWay,
) -> bool {
    let Some(ego) = ego else { return false };
    // An other that has not arrived yet arrives now at the earliest.
    let other = other.unwrap_or(now);
    let tie = u32::from(tie);
    match right_of_way {
        RightOfWay::Ego => ego <= other.saturating_add(tie),
        // The other, if it has the right of way, may count one period less between the two arrivals.
        _ => other.saturating_sub(ego) > tie + 1,
    }
}

/// Whether the ego comes before the other, so that the other knows as well: by the right of way, however
/// long ago they arrived; without one, by their arrivals, however near, but for those a period apart.
fn settled(ego: Option<u32>, other: Option<u32>, right_of_way: RightOfWay) -> Option<bool> {
    match right_of_way {
        RightOfWay::Ego => Some(true),
        RightOfWay::Other => Some(false),
        RightOfWay::Unsettled => {
            let (ego, other) = (ego?, other?);
            (ego.abs_diff(other) > 1).then_some(ego < other)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_first_goes_first_and_a_tie_is_the_right_of_ways() {
        use RightOfWay::{Ego, Other, Unsettled};
        let first = |pair, right_of_way| precedes(pair, 100, 5, right_of_way);
        assert!(first((Some(10), Some(17)), Other));
        assert!(!first((Some(17), Some(10)), Ego));
        assert!(first((Some(12), Some(10)), Ego));
        assert!(!first((Some(10), Some(12)), Unsettled));
        assert!(first((Some(10), None), Unsettled));
        assert!(!first((None, None), Ego));
        // One period beyond a tie is the right of way's if it came first, and nobody's if it came second.
        assert!(first((Some(10), Some(16)), Ego) && !first((Some(16), Some(10)), Other));
        assert!(!first((Some(16), Some(10)), Ego) && !first((Some(10), Some(16)), Other));
    }

    proptest! {
        #[test]
        fn at_most_one_goes_first(
            a in prop::option::of(0_u32..40), b in prop::option::of(0_u32..40),
            skew in 0_u32..2, tie in 0_u16..10,
        ) {
            let now = 40;
            let one = precedes((a, b), now, tie, RightOfWay::Ego);
            // The other one may have counted one arrival a period later.
            let b = b.map(|b| b + skew);
            prop_assert!(!(one && precedes((b, a), now, tie, RightOfWay::Other)));
        }
    }
}
