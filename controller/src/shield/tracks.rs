//! The other vehicles that matter, from when they are first seen until they have certainly left.

use super::contract::Contract;
use super::door::{self, Admitted};
use super::findings::Findings;
use super::hazard::{self, Hazard};
use super::hidden::Hidden;
use super::lane;
use super::other::{News, Other};
use super::own::Own;
use super::rules::Rules;
use super::unwatched::{Closed, Entry, Place, Unwatched, take, unplaced};
use super::walkers::Walkers;
use crate::instant::Instant;
use crate::junction::zone::{FAR, MAX_ZONES};
use crate::junction::{Class, PathId, Way};
use crate::observation::{Candidate, Observation, Track};
use crate::real::Real;
use heapless::Vec;

/// The others that matter, at most `N`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tracks<const N: usize> {
    watched: Vec<Other, N>,
    unwatched: Unwatched,
    pub(crate) hidden: Hidden,
    pub(super) walkers: Walkers,
}

impl<const N: usize> Tracks<N> {
    pub(crate) const fn new() -> Self {
        Self {
            watched: Vec::new(),
            unwatched: Unwatched::new(),
            hidden: Hidden::new(),
            walkers: Walkers::new(),
        }
    }

    /// Everybody who is known, in fixed places; those who have left have no hazards.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Other> {
        self.watched.iter()
    }

    pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Other> {
        self.watched.iter_mut()
    }

    /// Number and path of everybody who is watched, or known without being watched.
    #[cfg(test)]
    pub(super) fn known(&self) -> impl Iterator<Item = (u16, PathId)> {
        let watched = self.watched.iter().map(|other| (other.number, other.path));
        watched.chain(
            self.unwatched
                .iter()
                .map(|entry| (entry.number, entry.path)),
        )
    }

    /// Nobody with this number is there any more.
    pub(crate) fn forget(&mut self, number: u16) {
        let known = |other: &Other| other.number == number && !other.gone;
        if self.watched.iter().any(known) || self.unwatched.knows(number) {
            self.hidden.lose();
        }
        self.watched.retain(|other| other.number != number);
        self.unwatched.forget(number);
        self.walkers.forget(number);
    }

    /// Until `now` everybody kept to `contract`, from now on to another one.
    pub(crate) fn rebase<R: Rules>(&mut self, contract: &Contract, now: Instant) {
        self.hidden.rebase::<R>(contract);
        self.walkers.rebase();
        for other in &mut self.watched {
            (other.base, other.at) = (other.bounds, now);
        }
        for entry in self.unwatched.iter_mut() {
            if let Place::Known { base, at, .. } = &mut entry.place {
                (*base, *at) = (R::coast(contract, *base, now.seconds_since(*at)), now);
            }
        }
    }

    /// Notes in which lanes the ego is ahead, and the others keep their distance.
    pub(super) fn settle<R: Rules>(&mut self, contract: &Contract, way: Way<'_>, ego: &Own) {
        for other in &mut self.watched {
            if let Some(conflict) = way.conflict(other.path) {
                lane::settle::<R>(contract, conflict.zones(), ego, other);
            }
        }
    }

    /// There is no plan, or not the motion, on which the lanes that the ego enters ahead of somebody counted.
    pub(crate) fn count_on_nothing(&mut self) {
        self.hidden.holds = false;
        self.watched.iter_mut().for_each(|other| other.counted = 0);
        self.unwatched
            .iter_mut()
            .for_each(|entry| entry.holds = false);
    }

    /// Where everybody may be at `now`, if nothing is seen.
    pub(crate) fn coast<R: Rules>(&mut self, contract: &Contract, now: Instant) {
        self.hidden.advance(now);
        self.walkers.advance(now);
        for other in &mut self.watched {
            other.seen = false;
            let least = other.bounds.s.from;
            other.bounds = other.coasting::<R>(contract, now);
            other.bounds.s.from = Real::max(other.bounds.s.from, least);
        }
    }

    /// Notes what is seen at `now`: whoever is missing coasts, whoever appears is added, whoever has left is dropped.
    ///
    /// Cost: O(tracks × N).
    pub(crate) fn note<R: Rules>(
        &mut self,
        contract: &Contract,
        way: Way<'_>,
        now: Instant,
        ego: &Own,
        seen: &Observation<'_>,
    ) -> Findings {
        let mut findings = Findings::default();
        for other in &mut self.watched {
            other.news = News::None;
            other.fresh = false;
        }
        self.unwatched.begin(way, ego.least, seen.tracks);
        self.hidden.begin();
        self.coast::<R>(contract, now);
        // Who is known comes first, so that a newcomer finds as much room as there is.
        for newcomers in [false, true] {
            for track in seen.tracks.iter().filter(|track| drives(track)) {
                self.note_track::<R>((contract, way), (now, ego), track, newcomers, &mut findings);
            }
        }
        for track in seen.tracks.iter().filter(|track| !drives(track)) {
            let others = (ego, &mut self.unwatched);
            (self.walkers).note((contract, way), others, track, &mut findings);
        }
        for other in &mut self.watched {
            let ahead = other.entry::<R>(way, ego.least, 0.0);
            other.gone |= ahead.is_none();
        }
        self.hidden.look::<R>(contract);
        if self.unwatched.beyond().is_some() {
            self.hidden.lose();
        }
        findings.closed = self.unwatched.end(way, ego.least);
        findings
    }

    /// Notes the candidates of a track that are known, or those that are not.
    fn note_track<R: Rules>(
        &mut self,
        context: (&Contract, Way<'_>),
        when: (Instant, &Own),
        track: &Track,
        newcomers: bool,
        findings: &mut Findings,
    ) {
        let number = track.number;
        if !newcomers
            && self
                .watched
                .iter()
                .any(|other| other.seen && other.number == number)
        {
            findings.fault = findings.fault.or(Some(door::twice(number)));
        }
        for candidate in track.candidates() {
            // One that has appeared in this observation is a newcomer to the next track with its number, too.
            let known = self.watched.iter().any(|other| {
                other.number == number && other.path == candidate.path && !other.fresh
            });
            if known != newcomers {
                self.note_candidate::<R>(context, when, (track, candidate), findings);
            }
        }
        // A candidate that is left out is excluded by what was seen, if anything was. As a rule there is none.
        let (contract, way) = context;
        let placed = |candidate| door::track(way, contract, track, candidate).is_ok();
        let stays =
            |other: &Other| other.number != number || other.seen || track.may_be_on(other.path);
        let remains =
            |entry: &Entry| entry.number != number || entry.seen || track.may_be_on(entry.path);
        if newcomers
            && !(self.watched.iter().all(stays) && self.unwatched.all(remains))
            && track.candidates().any(placed)
        {
            self.watched.retain(stays);
            self.unwatched.retain(remains);
        }
    }

    fn note_candidate<R: Rules>(
        &mut self,
        (contract, way): (&Contract, Way<'_>),
        (now, ego): (Instant, &Own),
        (track, candidate): (&Track, Candidate),
        findings: &mut Findings,
    ) {
        let (number, path) = (track.number, candidate.path);
        let known = |other: &&mut Other| other.number == number && other.path == path;
        let checked = door::track(way, contract, track, candidate);
        match checked {
            Ok(Admitted { pose, .. }) => findings.headroom.note_pose(Some(number), pose),
            Err(fault) => findings.headroom.note_fault(fault),
        }
        let checked = checked.map(|admitted| admitted.vehicle);
        match (self.watched.iter_mut().find(known), checked) {
            // Two vehicles of one number on one path: there is no place to watch the second one.
            (Some(other), _) if other.seen => {
                findings.fault = findings.fault.or(Some(door::twice(number)));
                self.close_unplaced(way, ego, (track, path));
            }
            (Some(other), Ok(vehicle)) => other.meet(contract, &vehicle, now, findings),
            // It coasts.
            (Some(_), Err(fault)) => findings.fault = findings.fault.or(Some(fault)),
            // Two of one number for whom there is no room.
            (None, _)
                if self
                    .unwatched
                    .placed(number, path)
                    .is_some_and(|it| it.seen) =>
            {
                findings.fault = findings.fault.or(Some(door::twice(number)));
                self.close_unplaced(way, ego, (track, path));
            }
            (None, Ok(vehicle)) => {
                let mut other = Other::new(contract, number, path, &vehicle, now);
                if let Some(entry) = self.unwatched.placed(number, path) {
                    other.follow::<R>(contract, &vehicle, entry, findings);
                } else if let Some(source) = self.hidden.source::<R>(contract, path, &vehicle) {
                    other.emerge(source, self.hidden.holds);
                }
                if let Some(conflict) = way.conflict(path) {
                    lane::settle::<R>(contract, conflict.zones(), ego, &mut other);
                }
                // One that seems to have left may seem not to have in the next observation: it is known from now on.
                let spare = 2.0 * contract.position_error;
                if other.entry::<R>(way, ego.least, spare).is_some() {
                    self.add::<R>((contract, way), ego, other);
                } else {
                    self.leave(way, other);
                }
            }
            // Nobody knows where it is: its zones may be occupied. One that was seen before is missing.
            (None, Err(fault)) => {
                findings.fault = findings.fault.or(Some(fault));
                if self.unwatched.placed(number, path).is_none() {
                    self.close_unplaced(way, ego, (track, path));
                }
            }
        }
    }

    /// Closes the zones of a track whose place is unknown.
    fn close_unplaced(&mut self, way: Way<'_>, ego: &Own, (track, path): (&Track, PathId)) {
        self.hidden.lose();
        if let Some(from) = unplaced(way, path, track.class, ego.least) {
            self.unwatched
                .close(track.number, path, Place::Unknown, from);
        }
    }

    /// One has left its zones. It is known, so that it is nobody new when it seems not to have, or its state is refused.
    fn leave(&mut self, way: Way<'_>, mut other: Other) {
        if way
            .conflict(other.path)
            .is_none_or(|it| it.zones().count() == 0)
        {
            return;
        }
        if self.watched.is_full() {
            self.unwatched
                .close(other.number, other.path, other.place(), FAR);
        } else {
            self.unwatched.open(other.number, other.path);
            (other.gone, other.news) = (true, News::None);
            let _ = self.watched.push(other);
        }
    }

    /// Adds a newcomer. Without room, of those who appear the one whose zones the ego enters last is not watched.
    fn add<R: Rules>(
        &mut self,
        (contract, way): (&Contract, Way<'_>),
        ego: &Own,
        mut newcomer: Other,
    ) {
        let spare = 2.0 * contract.position_error;
        if self.watched.is_full() {
            // What has left by more than sensors can err in two observations will never seem not to have; and who
            // keeps its distance behind the ego is known again when it is seen again.
            let idle = |other: &Other| {
                let open = other.unsettled::<R>(way, ego.least, spare);
                let left = other.entry::<R>(way, ego.least, spare).is_none();
                open.is_none() && (other.seen || left)
            };
            let place = self.watched.iter().position(idle);
            if let Some(idle) = place.and_then(|place| take(&mut self.watched, place)) {
                let (number, path) = (idle.number, idle.path);
                self.unwatched.close(number, path, idle.place(), FAR);
                if let Some(entry) = self.unwatched.placed(number, path) {
                    // Its track may be yet to come.
                    entry.seen = false;
                }
            }
        }
        if !self.watched.is_full() {
            if self.unwatched.open(newcomer.number, newcomer.path) {
                newcomer.news = News::None;
            }
            let _ = self.watched.push(newcomer);
            return;
        }
        let (number, path) = (newcomer.number, newcomer.path);
        let Some(mut entry) = newcomer.unsettled::<R>(way, ego.least, 0.0) else {
            // It has left or keeps its distance, and there is no room to watch it.
            self.unwatched.close(number, path, newcomer.place(), FAR);
            return;
        };
        // A plan may count on those who are known: only among those who appear with it is there a choice.
        for other in self
            .watched
            .iter_mut()
            .filter(|other| matches!(other.news, News::Appeared | News::Watched))
        {
            match other.unsettled::<R>(way, ego.least, 0.0) {
                Some(its) if its > entry => {
                    if self.unwatched.open(newcomer.number, newcomer.path) {
                        newcomer.news = News::None;
                    }
                    core::mem::swap(other, &mut newcomer);
                    entry = its;
                }
                _ => {}
            }
        }
        self.unwatched
            .close(newcomer.number, newcomer.path, newcomer.place(), entry);
    }

    /// Whether the plan in force is safe from everybody who is not watched; `holds` judges it against some hazards.
    /// Whoever it was safe from stays so, unless `all` are to be judged again.
    pub(crate) fn unwatched_hold<R: Rules>(
        &mut self,
        (contract, way): (&Contract, Way<'_>),
        ego: &Own,
        all: bool,
        holds: impl Fn(&[Hazard]) -> bool,
    ) -> bool {
        let stays_out = |closed| holds(&[Hazard::closed(contract, ego, closed)]);
        for entry in self.unwatched.iter_mut().filter(|it| all || !it.holds) {
            let Entry { number, from, .. } = *entry;
            entry.holds = stays_out(Closed { number, from })
                || newcomer::<R>((contract, way), ego, entry)
                    .is_some_and(|hazards| holds(&hazards));
        }
        let beyond = self.unwatched.beyond();
        self.unwatched.iter_mut().all(|entry| entry.holds) && beyond.is_none_or(stays_out)
    }

    /// A new plan stays out of everything that is closed, and is safe from everybody out of sight.
    pub(crate) fn unwatched_avoided(&mut self) {
        self.hidden.holds = true;
        self.unwatched
            .iter_mut()
            .for_each(|entry| entry.holds = true);
    }
}

/// Whether it keeps to one direction.
fn drives(track: &Track) -> bool {
    track.class != Class::Pedestrian
}

/// The hazards of somebody who is seen and not watched.
fn newcomer<R: Rules>(
    (contract, way): (&Contract, Way<'_>),
    ego: &Own,
    entry: &Entry,
) -> Option<Vec<Hazard, MAX_ZONES>> {
    let Entry { number, path, .. } = *entry;
    let Place::Known { base, at, settled } = entry.place else {
        return None;
    };
    if !entry.seen {
        return None;
    }
    let mut other = Other::at(number, path, 0.0, base, at);
    other.settled = settled;
    let mut hazards = Vec::new();
    for (index, zone) in (0_u8..).zip(way.conflict(path)?.zones()) {
        if let Some(hazard) = hazard::of::<R>((contract, way), (index, zone), ego, &other) {
            // Two paths have no more zones than that. `collect` would panic if they had.
            let _ = hazards.push(hazard);
        }
    }
    Some(hazards)
}
