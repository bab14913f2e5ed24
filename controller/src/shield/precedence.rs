//! Who goes first where two vehicles wait for each other.

use super::contract::Precedence;
use crate::observation::{Observation, Vehicle};
use crate::pair::RightOfWay;
use crate::scene::{Meeting, Scene};
use crate::zone::{Interval, Zone};

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

/// When the ego and each other arrived at the zones that they share.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arrivals<const N: usize> {
    /// Periods since the start.
    now: u32,
    /// The ego's arrival and the other's.
    pairs: [(Option<u32>, Option<u32>); N],
}

impl<const N: usize> Arrivals<N> {
    pub(crate) const fn new() -> Self {
        Self {
            now: 0,
            pairs: [(None, None); N],
        }
    }

    /// One period has passed.
    pub(crate) fn tick(&mut self) {
        self.now = self.now.saturating_add(1);
    }

    /// Notes who has arrived, and says over whom the ego has precedence.
    pub(crate) fn note(
        &mut self,
        rule: Precedence,
        scene: &Scene<N>,
        seen: &Observation<N>,
    ) -> Claims {
        let mut claims = Claims::default();
        let others = scene.meetings().iter().zip(seen.others.iter());
        for (number, ((meeting, other), pair)) in (0_u8..).zip(others.zip(self.pairs.iter_mut())) {
            let Some(other) = other else {
                pair.1 = None;
                continue;
            };
            let here = |entry: Option<f32>, vehicle: &Vehicle| {
                entry
                    .is_some_and(|entry| entry - vehicle.s <= rule.distance)
                    .then_some(self.now)
            };
            pair.0 = pair.0.or(here(entry(meeting, |z| z.ego), &seen.ego));
            pair.1 = pair.1.or(here(entry(meeting, |z| z.other), other));
            if precedes(*pair, self.now, rule.tie, meeting.right_of_way) {
                claims.claim(number);
            }
        }
        claims
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
