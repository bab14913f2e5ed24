//! One other vehicle on one of its paths, as far as it is known.

use super::bounds::Bounds;
use super::contract::Contract;
use super::findings::Findings;
use super::precedence::{PairMemory, ZoneSet, has};
use super::rules::Rules;
use super::unwatched::{Entry, Place};
use super::waiting::{RestState, Sighting};
use crate::headroom::Room;
use crate::instant::Instant;
use crate::junction::zone::{FAR, Span, Zone};
use crate::junction::{PathId, Way};
use crate::observation::Vehicle;
use crate::real::Real;

/// A tracked vehicle on one of its candidate paths, which has a zone ahead with the ego's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Other {
    pub(crate) number: u16,
    pub(crate) path: PathId,
    /// The speed (m/s) at which it was sensed last.
    speed: f32,
    /// Where it was at `at`: when it was sensed last, or when the contract was replaced.
    pub(super) base: Bounds,
    pub(super) at: Instant,
    /// Where it is now.
    pub(crate) bounds: Bounds,
    /// It is in the present observation.
    pub(crate) seen: bool,
    /// What is new of it.
    pub(crate) news: News,
    /// It was not watched before this observation.
    pub(super) fresh: bool,
    /// It has no zone ahead any more: it is known only so that it does not count as a newcomer.
    pub(super) gone: bool,
    /// Lanes that the plan in force enters ahead of it, with the gap that it needs.
    pub(crate) counted: ZoneSet,
    /// Lanes in which the ego is ahead of it, and it has had the gap to keep its distance.
    pub(crate) settled: ZoneSet,
    /// Who goes first.
    pub(crate) pair: PairMemory,
    /// The zones in which the ego has precedence over it.
    pub(crate) claims: ZoneSet,
}

/// What is new of another in the present observation. The remembered plan has not been verified against one that appeared, is
/// watched from now on or broke the contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum News {
    None,
    /// It was not there before.
    Appeared,
    /// It was out of sight, where the remembered plan counted on it.
    Emerged,
    /// It was there, and nobody watched it.
    Watched,
    /// It moved beyond the contract's bounds.
    Broke,
}

impl Other {
    pub(super) fn new(
        contract: &Contract,
        number: u16,
        path: PathId,
        vehicle: &Vehicle,
        now: Instant,
    ) -> Self {
        let speed = vehicle.speed;
        let bounds = Bounds::sensed(contract, vehicle.s, speed);
        Self::at(number, path, speed, bounds, now)
    }

    /// One that appears, sensed at `speed` (m/s).
    pub(super) fn at(number: u16, path: PathId, speed: f32, bounds: Bounds, now: Instant) -> Self {
        Self {
            number,
            path,
            speed,
            base: bounds,
            at: now,
            bounds,
            seen: true,
            news: News::Appeared,
            fresh: true,
            gone: false,
            counted: 0,
            settled: 0,
            pair: PairMemory::default(),
            claims: 0,
        }
    }

    /// What is remembered of it without watching it.
    pub(super) const fn place(&self) -> Place {
        Place::Known {
            base: self.base,
            at: self.at,
            settled: self.settled,
        }
    }

    /// Notes that it comes from where nobody could see it, from `source`; and whether the plan in force is safe from whoever
    /// was there.
    pub(super) fn emerge(&mut self, source: Bounds, holds: bool) {
        let lower = |span: &mut Span, most: f32| {
            if span.from <= most {
                span.to = Real::min(span.to, most);
            }
        };
        lower(&mut self.bounds.s, source.s.to);
        lower(&mut self.bounds.speed, source.speed.to);
        self.base = self.bounds;
        if holds {
            self.news = News::Emerged;
            // It enters no lane ahead of it without the gap.
            self.counted = ZoneSet::MAX;
        }
    }

    /// Notes what was known of it while nobody watched it.
    pub(super) fn follow<R: Rules>(
        &mut self,
        contract: &Contract,
        vehicle: &Vehicle,
        entry: &mut Entry,
        findings: &mut Findings,
    ) {
        let Place::Known { base, at, settled } = entry.place else {
            return;
        };
        let bounds = R::coast(contract, base, self.at.seconds_since(at));
        let rooms = bounds.rooms(contract, vehicle.s, vehicle.speed);
        let possible = Room::hold(rooms);
        // Else it is another one, by the number of one that has left.
        if possible || entry.from < FAR {
            self.news = News::Watched;
            findings.moved(self.number, rooms);
        }
        if possible {
            self.settled = settled;
            // A plan in force that is safe from it enters no lane ahead of it without the gap.
            self.counted = if entry.holds { ZoneSet::MAX } else { 0 };
        } else {
            entry.holds = false;
        }
    }

    /// Notes that it is seen again, and whether it can have come there.
    pub(super) fn meet(
        &mut self,
        contract: &Contract,
        vehicle: &Vehicle,
        now: Instant,
        findings: &mut Findings,
    ) {
        let (s, speed) = (vehicle.s, vehicle.speed);
        let seen = Bounds::sensed(contract, s, speed);
        let least = self.bounds.s.from;
        let rooms = self.bounds.rooms(contract, s, speed);
        let possible = Room::hold(rooms);
        if possible || !self.gone {
            findings.moved(self.number, rooms);
        }
        (self.speed, self.base, self.at) = (speed, seen, now);
        self.bounds = seen;
        self.seen = true;
        if possible {
            // It never moves backwards, whatever the sensors say: what it has left, it has left for ever.
            if least <= seen.s.to {
                self.bounds.s.from = Real::max(seen.s.from, least);
            }
        } else if self.gone {
            // Another one, by the number of one that has left.
            *self = Self {
                fresh: false,
                ..Self::new(contract, self.number, self.path, vehicle, now)
            };
        } else {
            self.news = News::Broke;
            (self.counted, self.settled) = (0, 0);
            // Perhaps it is another one: nothing is known of who came first.
            self.pair = PairMemory::default();
            self.pair.forget();
        }
    }

    pub(super) fn coasting<R: Rules>(&self, contract: &Contract, now: Instant) -> Bounds {
        R::coast(contract, self.base, now.seconds_since(self.at))
    }

    /// What a shield's memory of precedence notes of it.
    pub(crate) fn sighting(&self, contract: &Contract) -> Sighting {
        Sighting {
            s: Some(self.bounds.s),
            rest: if self.seen {
                RestState::of(contract, self.speed)
            } else {
                RestState::Perhaps
            },
        }
    }

    /// Where (m) the ego, which is at `ego` (m) at least, enters the first zone that neither has left by more than
    /// `spare` (m).
    pub(super) fn entry<R: Rules>(&self, way: Way<'_>, ego: f32, spare: f32) -> Option<f32> {
        let least = self.bounds.s.from - spare;
        let ahead = |zone: &&Zone| ego - spare < zone.ego.to && !R::left(zone, least);
        let zones = way.conflict(self.path)?.zones().filter(ahead);
        zones.map(|zone| zone.ego.from).reduce(f32::min)
    }

    /// [`Other::entry`] of the zones in which the other does not just keep its distance.
    pub(super) fn unsettled<R: Rules>(&self, way: Way<'_>, ego: f32, spare: f32) -> Option<f32> {
        let least = self.bounds.s.from - spare;
        let ahead = |zone: &Zone| ego - spare < zone.ego.to && !R::left(zone, least);
        let zones = (0_u8..).zip(way.conflict(self.path)?.zones());
        let open = zones.filter(|&(index, zone)| ahead(zone) && !self.is_settled(index));
        open.map(|(_, zone)| zone.ego.from).reduce(f32::min)
    }

    /// Whether the ego is ahead of it in lane number `index`, and it keeps its distance.
    pub(crate) fn is_settled(&self, index: u8) -> bool {
        has(self.settled, index)
    }
}
