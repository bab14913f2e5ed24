//! Over whom the ego has precedence, as its shield counts it from call to call.

use super::Shield;
use super::clock::Tick;
use super::own::Own;
use super::precedence::{self, Right};
use super::rules::Rules;
use super::waiting::{Arrived, Presence, Sighting};
use crate::instant::Instant;
use crate::junction::RightOfWay;
use crate::junction::zone::FAR;

/// Periods since the last call above which nothing is known any more of who rested.
const LOST: u16 = 16;

impl<const N: usize, R: Rules> Shield<'_, N, R> {
    /// Notes who has arrived and who rests, and over whom the ego has precedence.
    pub(super) fn wait(&mut self, (now, tick): (Instant, Tick), ego: Option<&Own>) {
        let contract = &self.contract;
        let Some(rule) = contract.precedence else {
            return;
        };
        let periods = match tick {
            Tick::First => 1,
            Tick::Next { periods, .. } => periods,
            Tick::Repeated | Tick::Backwards => 0,
        };
        // A call that is not on time says nothing of how long somebody has moved or rested.
        let on_time = !matches!(tick, Tick::Next { on_time: false, .. });
        // Of the periods in which there was no call, nothing is known.
        let counted = periods.min(LOST);
        let seen = u16::from(on_time && counted > 0);
        let missed = counted - seen;
        let way = self.way;
        let arrive = |presence: &mut Presence, path, seen: Sighting| {
            if periods == 0 {
                presence.note_again(seen.rest);
                return Arrived::Perhaps;
            }
            let line = way.path(path).map_or(FAR, |path| path.line());
            presence.arrive((contract, rule), line, seen.s, now)
        };
        if periods > LOST {
            self.presence.forget();
            self.tracks.iter_mut().for_each(|other| other.pair.forget());
        }
        let mine = Sighting::of_ego(contract, ego);
        let here = arrive(&mut self.presence, way.ego(), mine);
        let before = self.presence;
        self.presence.miss(here, missed);
        if seen > 0 {
            self.presence.stay(contract, mine.rest, here);
        }
        for other in self.tracks.iter_mut() {
            let Some(conflict) = way.conflict(other.path) else {
                continue;
            };
            let right = Right::of(conflict, way, other.path);
            let mut turns = right;
            if ego.is_none() {
                turns.in_turns = RightOfWay::Unsettled;
            }
            let its = other.sighting(contract);
            let there = arrive(&mut other.pair.other, other.path, its);
            other
                .pair
                .miss::<R>(rule, turns, (&before, here), there, missed);
            if seen > 0 {
                other.pair.other.stay(contract, its.rest, there);
                other.pair.pass::<R>(contract, rule, turns, &self.presence);
            }
            other.claims = other.pair.claims(contract, rule, right, &self.presence);
            if let Some(ego) = ego.filter(|_| other.claims != precedence::ALL) {
                other
                    .pair
                    .hold::<R>(contract, &self.presence, conflict.zones(), ego.s);
                other.claims = other.pair.claims(contract, rule, right, &self.presence);
            }
        }
    }
}
