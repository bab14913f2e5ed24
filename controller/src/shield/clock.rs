//! Calls and the grid of periods.

use super::contract::Contract;
use crate::instant::{Instant, micros};
use core::cmp::Ordering;

/// When the shield was called.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Clock {
    calls: Option<Calls>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Calls {
    first: Instant,
    last: Instant,
    /// Periods from the first call to the last one, rounded.
    periods: u64,
}

/// What a call is to the one before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tick {
    /// There is none before it.
    First,
    /// The same moment again.
    Repeated,
    /// An earlier moment.
    Backwards,
    /// A later moment.
    Next {
        /// Microseconds since the last call.
        elapsed: u64,
        /// Periods of the grid since the last call.
        periods: u16,
        /// Whether one period has passed, within the jitter.
        on_time: bool,
        /// Microseconds that are left of the jitter, and those that can be left at most.
        left: [i64; 2],
    },
}

impl Clock {
    /// Notes a call at `now`, unless it is repeated or earlier than the last one.
    pub(crate) fn tick(&mut self, contract: &Contract, now: Instant) -> Tick {
        let Some(calls) = &mut self.calls else {
            self.calls = Some(Calls {
                first: now,
                last: now,
                periods: 0,
            });
            return Tick::First;
        };
        match now.cmp(&calls.last) {
            Ordering::Equal => return Tick::Repeated,
            Ordering::Less => return Tick::Backwards,
            Ordering::Greater => {}
        }
        // A period of a contract is above 0; the smallest ones round to 1 µs.
        let period = micros(contract.period).max(1);
        let elapsed = now.since(calls.last);
        let half = period / 2;
        let periods = now.since(calls.first).saturating_add(half) / period;
        let gone = periods.saturating_sub(calls.periods);
        let spare = 2 * micros(contract.jitter) + 1;
        let left = signed(spare).saturating_sub(signed(elapsed.abs_diff(period)));
        calls.last = now;
        calls.periods = periods;
        Tick::Next {
            elapsed,
            periods: u16::try_from(gone).unwrap_or(u16::MAX),
            on_time: left >= 0,
            left: [left, signed(spare)],
        }
    }

    pub(crate) fn last(&self) -> Option<Instant> {
        self.calls.map(|calls| calls.last)
    }
}

fn signed(micros: u64) -> i64 {
    i64::try_from(micros).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_are_on_time_late_early_repeated_and_backwards() {
        let contract = Contract::WORST_CASE;
        let mut clock = Clock::default();
        let mut at = |millis| clock.tick(&contract, Instant::from_millis(millis));
        let next = |elapsed: u64, periods, on_time| Tick::Next {
            elapsed,
            periods,
            on_time,
            left: [1 - signed(elapsed.abs_diff(100_000)), 1],
        };
        assert_eq!(at(5000), Tick::First);
        assert_eq!(at(5100), next(100_000, 1, true));
        assert_eq!(at(5100), Tick::Repeated);
        assert_eq!(at(5000), Tick::Backwards);
        assert_eq!(at(5400), next(300_000, 3, false));
        assert_eq!(at(5430), next(30_000, 0, false));
        assert_eq!(at(5500), next(70_000, 1, false));
        // The grid is rounded to.
        assert_eq!(at(5560), next(60_000, 1, false));
        assert_eq!(at(5640), next(80_000, 0, false));
    }

    #[test]
    fn jitter_is_on_time() {
        let contract = Contract::builder().latency(0.03).jitter(0.01).build();
        let contract = contract.unwrap();
        let mut clock = Clock::default();
        for (millis, on_time) in [(0, true), (110, true), (190, true), (311, false)] {
            let tick = clock.tick(&contract, Instant::from_millis(millis));
            let is = !matches!(tick, Tick::Next { on_time: false, .. });
            assert_eq!(is, on_time, "{millis}");
        }
    }
}
