//! Over whom the ego has precedence, as its shield counts it from call to call.

use super::Shield;
use super::clock::Tick;
use super::own::Own;
use super::precedence::{self, Right};
use super::rules::Rules;
use super::waiting::{RestState, Sighting};
use crate::instant::Instant;
use crate::junction::zone::FAR;
use crate::junction::{PathId, RightOfWay, Way};

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
        let mine = Sighting::of_ego(contract, ego);
        let unseen = |sighting: Sighting| Sighting {
            rest: RestState::Perhaps,
            ..sighting
        };
        if periods > LOST {
            self.presence.forget();
            self.tracks.iter_mut().for_each(|other| other.pair.forget());
        }
        if periods == 0 {
            self.presence.note_again(mine.rest);
            for other in self.tracks.iter_mut() {
                other.pair.other.note_again(other.sighting(contract).rest);
            }
        }
        // A call that is not on time says nothing of how long somebody has moved or rested.
        let on_time = !matches!(tick, Tick::Next { on_time: false, .. });
        let line = |path: PathId| self.way.path(path).map_or(FAR, |path| path.line());
        // Of the periods in which there was no call, nothing is known.
        for missed in (0..periods.min(LOST)).rev() {
            let seen = |sighting: Sighting| {
                if missed == 0 && on_time {
                    sighting
                } else {
                    unseen(sighting)
                }
            };
            let own = line(self.way.ego());
            self.presence.note(contract, rule, own, seen(mine), now);
            for other in self.tracks.iter_mut() {
                let its = seen(other.sighting(contract));
                other
                    .pair
                    .other
                    .note(contract, rule, line(other.path), its, now);
                let Some(mut right) = right(self.way, other.path) else {
                    continue;
                };
                if ego.is_none() {
                    right.in_turns = RightOfWay::Unsettled;
                }
                other.pair.pass::<R>(contract, rule, right, &self.presence);
            }
        }
        for other in self.tracks.iter_mut() {
            let Some(conflict) = self.way.conflict(other.path) else {
                continue;
            };
            let right = Right::of(conflict, self.way, other.path);
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

/// Which of the ego and an other on `path` goes first; nothing, if they do not meet.
fn right(way: Way<'_>, path: PathId) -> Option<Right> {
    Some(Right::of(way.conflict(path)?, way, path))
}
