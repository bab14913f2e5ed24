//! The orientations that others have shown.

use super::Approach;
use crate::instant::Instant;
use crate::policy::pair::Pair;
use crate::policy::{Estimate, OrientationFilter};
use heapless::Vec;

/// What the tracks have shown that the policy was asked about last.
pub(super) type Filters = Vec<Filter, WATCHED>;

/// Tracks of which it is known what they have shown: the policy is asked about one, sometimes about two by turns.
const WATCHED: usize = 2;

/// What is known of the orientation of a track.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filter {
    number: u16,
    /// When it was looked at last.
    at: Instant,
    filter: OrientationFilter,
}

impl<const N: usize> Approach<'_, '_, N> {
    /// The orientation that track `number` has shown by `now`, if that is wanted.
    #[inline(never)]
    pub(super) fn look(&mut self, now: Instant, number: u16, pair: &Pair) -> Option<Estimate> {
        let period = self.shield.contract().period();
        let filters = self.filters.as_mut()?;
        let known = filters.iter().find(|known| known.number == number);
        let mut known = known.copied().unwrap_or(Filter {
            number,
            at: now,
            filter: OrientationFilter::default(),
        });
        filters.retain(|other| other.number != number);
        let elapsed = now.seconds_since(known.at);
        // Not looked at in between: what was expected then is of another time.
        if !(0.5 * period..1.5 * period).contains(&elapsed) {
            known.filter.skip();
        }
        known.at = now;
        let estimate = known.filter.look(&self.policy, pair, period);
        if filters.is_full() {
            let oldest = filters.iter().map(|other| other.at).min();
            filters.retain(|other| Some(other.at) != oldest);
        }
        // There is room.
        let _ = filters.push(known);
        Some(estimate)
    }
}
