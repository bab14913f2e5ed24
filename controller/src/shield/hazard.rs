//! The conflict zones ahead, as distances from where the ego is now.

use super::contract::{Contract, Precedence};
use super::hidden::MAX_SIGHTS;
use super::own::Own;
use super::precedence::has;
use super::reach::Reach;
use super::rules::Rules;
use super::tracks::{News, Other, Tracks};
use super::unwatched::Closed;
use super::walkers::MAX_WALKERS;
use crate::junction::zone::{FAR, MAX_ZONES, Zone};
use crate::junction::{MAX_OTHERS, PathId, RightOfWay, RouteConflict, Way};
use crate::real::Real;
use heapless::Vec;

/// Every zone of every other, of everybody out of sight and of every pedestrian, and what is closed.
const CAPACITY: usize = (MAX_OTHERS + MAX_SIGHTS + MAX_WALKERS) * MAX_ZONES + 1;

/// An ego that comes to rest no farther beyond its line than this (m) waits at it.
const BEYOND: f32 = 1.0;

/// A zone that the ego has not cleared and the other has not left.
///
/// All distances are metres from where the ego is, sensing errors included on the safe side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hazard {
    /// Who may be in it.
    pub who: Who,
    /// Number of the zone.
    pub zone: u8,
    /// The plan that is remembered was not verified against it.
    pub suspect: bool,
    /// The other has the right of way over the ego.
    pub yields: bool,
    /// Having gone so far, the ego has certainly cleared the zone, and sees it.
    pub target: f32,
    /// The ego must come to rest within this distance unless it clears the zone in time.
    pub limit: f32,
    /// Where it does come to rest, so that it keeps other zones clear: no farther than `limit`.
    pub rest: f32,
    /// The least `rest` of the hazards whose targets are farther.
    pub rest_beyond: f32,
    /// What clearing in time means.
    pub passage: Passage,
}

/// Who may be in a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Who {
    /// A track.
    Watched {
        number: u16,
        /// Which of those that are watched it is.
        place: u8,
    },
    /// A track that nobody watches.
    Unwatched(u16),
    /// Somebody out of sight on this path.
    Hidden(PathId),
}

/// When the ego may clear a hazard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Passage {
    /// Before the other arrives at its zone.
    Before {
        /// Metres, at least, from the other to its zone; negative if it may be in it.
        distance: f32,
        /// The other's speed, at most, in m/s.
        speed: f32,
    },
    /// Ahead of the other, with the safe gap, into the lane that they share from there on.
    Ahead {
        /// The gap (m), at least, if the other stayed where it is.
        gap: f32,
        /// The other's speed, at most, in m/s.
        speed: f32,
        /// Metres, at least, from the other to where it arrives, if from there on it may count on the ego to stay out of
        /// the lane.
        arrives: f32,
    },
    /// Before a pedestrian comes to its zone, from whichever side.
    Walks {
        /// Metres, at least, from the pedestrian to its zone; negative if it may be in it.
        distance: f32,
        /// The pedestrian's speed, at most, in m/s.
        speed: f32,
    },
    /// Not as long as the other is where it is: the ego is behind it in one lane.
    Never,
}

/// The hazards, sorted by [`Hazard::target`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hazards {
    sorted: Vec<Hazard, CAPACITY>,
}

impl Hazards {
    /// No hazards.
    pub(crate) const fn new() -> Self {
        Self { sorted: Vec::new() }
    }

    /// Adds the hazards of everybody who matters, but for those that the rule of precedence takes away. In place,
    /// because they are the largest thing on the stack.
    ///
    /// Cost: O(zones²) for the sorting, at most 61².
    pub(crate) fn add<const N: usize, R: Rules>(
        &mut self,
        contract: &Contract,
        way: Way<'_>,
        (ego, tracks): (&Own, &Tracks<N>),
        closed: Option<Closed>,
    ) {
        // From where the first zone that precedence opens begins to where the last one ends.
        let mut open = [FAR, -FAR];
        for (place, other) in (0_u8..).zip(tracks.iter()) {
            let number = other.number;
            let who = Who::Watched { number, place };
            self.add_other::<R>((contract, way), (ego, other), who, &mut open);
        }
        for other in tracks.hidden.others::<R>(contract, way, ego) {
            let who = Who::Hidden(other.path);
            self.add_other::<R>((contract, way), (ego, &other), who, &mut open);
        }
        for hazard in tracks.walkers.hazards(contract, way, ego) {
            self.insert::<R>(hazard);
        }
        if open[0] >= 0.0 {
            self.keep_clear(open);
        }
        if let Some(closed) = closed {
            self.insert::<R>(Hazard::closed(contract, ego, closed));
        }
        self.look_beyond();
    }

    /// Adds the hazards of one other, and notes those that precedence opens.
    #[inline(never)] // Once in flash.
    fn add_other<R: Rules>(
        &mut self,
        (contract, way): (&Contract, Way<'_>),
        (ego, other): (&Own, &Other),
        who: Who,
        open: &mut [f32; 2],
    ) {
        let Some(conflict) = way.conflict(other.path) else {
            return;
        };
        for (zone, hazard) in of::<R>(contract, way, ego, other) {
            if has(other.claims, hazard.zone)
                && granted(contract, way, hazard.passage, zone, (ego, other))
            {
                let entry = zone.ego.from - ego.s - contract.position_error;
                *open = [Real::min(open[0], entry), Real::max(open[1], hazard.target)];
                continue;
            }
            let clear = clear_of::<R>(conflict, zone, ego, other);
            let clear = clear - ego.s - contract.position_error;
            let waits = !zone.is_lane() && clear >= 0.0;
            self.insert::<R>(Hazard {
                who,
                yields: conflict.right_of_way == RightOfWay::Other,
                rest: if waits { clear } else { hazard.rest },
                ..hazard
            });
        }
    }

    /// In zones that precedence opens, the ego waits only for those who have the right of way. Whoever it holds up there
    /// may hold up others: if all waited so, each in the way of the next, their rights would form a cycle.
    ///
    /// It may still come to rest there behind those who are ahead in its lane.
    fn keep_clear(&mut self, [from, to]: [f32; 2]) {
        for hazard in &mut self.sorted {
            let waits = !matches!(hazard.passage, Passage::Never);
            if waits && !hazard.yields && (from..to).contains(&hazard.limit) {
                hazard.rest = Real::min(hazard.rest, from);
            }
        }
    }

    /// The ego waits at its line, `line` metres ahead, for everybody but those that it follows: inside the junction it
    /// would be in the way of others. It comes to rest `stop` metres ahead at the earliest; once that is too far beyond
    /// the line, it is on its way.
    pub(crate) fn wait_at(&mut self, line: f32, stop: f32) {
        if stop > line + BEYOND {
            return;
        }
        for hazard in &mut self.sorted {
            if !matches!(hazard.passage, Passage::Never) {
                hazard.rest = Real::min(hazard.rest, Real::max(line, stop));
            }
        }
        self.look_beyond();
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Hazard> {
        self.sorted.iter()
    }

    /// Where the ego comes to rest before all of them.
    pub(crate) fn nearest_rest(&self) -> f32 {
        self.sorted
            .first()
            .map_or(FAR, |first| Real::min(first.rest, first.rest_beyond))
    }

    fn insert<R: Rules>(&mut self, hazard: Hazard) {
        // 8 others, 8 edges of sight and 4 pedestrians of 3 zones each, and what is closed: `Shield` and `MAX_ZONES` see to it that there are no more.
        let _ = self.sorted.push(hazard);
        for i in (1..self.sorted.len()).rev() {
            if let Some([before, after]) = self.sorted.get_mut(i - 1..=i)
                && R::sooner(after.target, before.target)
            {
                core::mem::swap(before, after);
            }
        }
    }

    fn look_beyond(&mut self) {
        let mut least = FAR;
        for hazard in self.sorted.iter_mut().rev() {
            hazard.rest_beyond = least;
            least = Real::min(least, hazard.rest);
        }
    }
}

impl Hazard {
    /// Whether nobody watches it.
    pub(super) const fn is_closed(&self) -> bool {
        matches!(self.who, Who::Unwatched(_))
    }

    /// Zones that nobody watches.
    pub(super) fn closed(contract: &Contract, ego: &Own, closed: Closed) -> Self {
        Self {
            who: Who::Unwatched(closed.number),
            zone: u8::MAX,
            suspect: false,
            yields: false,
            target: FAR,
            limit: closed.from - ego.s - contract.position_error,
            rest: closed.from - ego.s - contract.position_error,
            rest_beyond: FAR,
            passage: Passage::Never,
        }
    }
}

/// The hazards that `other` is to the ego, each with its zone.
pub(super) fn of<'z, R: Rules>(
    contract: &Contract,
    way: Way<'z>,
    ego: &Own,
    other: &Other,
) -> impl Iterator<Item = (&'z Zone, Hazard)> {
    let zones = way.conflict(other.path).map(RouteConflict::zones);
    let arrives = contract.precedence.map_or(FAR, |rule| {
        arrival(way, rule, other.path) - other.bounds.s.to
    });
    (0_u8..)
        .zip(zones.into_iter().flatten())
        .filter_map(move |(index, zone)| {
            let hazard = hazard::<R>(contract, (index, zone), ego, other, arrives)?;
            Some((zone, hazard))
        })
}

/// Arc length (m) at which the ego waits for `other` before the crossing `zone`: where crossings of the two follow each other without
/// a gap, before the first of them. Two that stood in different ones, each before the other's, would wait for ever.
fn clear_of<R: Rules>(conflict: &RouteConflict, zone: &Zone, ego: &Own, other: &Other) -> f32 {
    if zone.is_lane() {
        return zone.ego.from;
    }
    let open =
        |it: &&Zone| !it.is_lane() && ego.least < it.ego.to && !R::left(it, other.bounds.s.from);
    // As often as there are zones before the last one.
    (1..MAX_ZONES).fold(zone.ego.from, |from, _| {
        let meets = |it: &&Zone| it.ego.from < from && from <= it.ego.to;
        let before = conflict.zones().filter(open).filter(meets);
        before.map(|it| it.ego.from).fold(from, Real::min)
    })
}

/// The hazard of one zone, if it is one.
fn hazard<R: Rules>(
    contract: &Contract,
    (index, zone): (u8, &Zone),
    ego: &Own,
    other: &Other,
    arrives: f32,
) -> Option<Hazard> {
    let error = contract.position_error;
    let bounds = other.bounds;
    if ego.least >= zone.ego.to || R::left(zone, bounds.s.from) {
        return None;
    }
    let stop = zone.ego.from - ego.s - error;
    let speed = bounds.speed.to;
    let crossing = Hazard {
        who: Who::Watched {
            number: other.number,
            place: 0,
        },
        zone: index,
        suspect: !matches!(other.news, News::None | News::Emerged),
        yields: false,
        // The ego is then past the zone by twice the error, so that it will be seen to be.
        target: R::cleared_at(zone) - ego.s + 3.0 * error,
        limit: stop,
        rest: stop,
        rest_beyond: FAR,
        passage: Passage::Before {
            distance: zone.other.from - bounds.s.to,
            speed,
        },
    };
    if !zone.is_lane() {
        return Some(crossing);
    }
    if other.is_settled(index) {
        // The ego is ahead in the lane: the other is the one who has to keep its distance.
        return None;
    }
    let behind = behind::<R>(contract, zone, ego, other);
    let waits = ego.least < zone.ego.from && !has(other.claims, index);
    Some(
        if !is_ahead::<R>(contract, zone, ego, other) && behind > stop {
            Hazard {
                target: FAR,
                limit: behind,
                rest: behind,
                passage: Passage::Never,
                ..crossing
            }
        } else {
            Hazard {
                target: zone.ego.from - ego.s + 3.0 * error,
                passage: Passage::Ahead {
                    gap: gap_ahead(zone, ego, other),
                    speed,
                    arrives: if waits { arrives } else { FAR },
                },
                ..crossing
            }
        },
    )
}

/// Whether the ego is certainly in the lane, and ahead of the other in it.
///
/// Two vehicles in a lane do not overlap, and the middle of the band is where they would: sensing errors are too small
/// to take one side for the other ([`super::EnterError::PositionError`]). One that coasts counts where it may be farthest.
pub(super) fn is_ahead<R: Rules>(
    contract: &Contract,
    zone: &Zone,
    ego: &Own,
    other: &Other,
) -> bool {
    let lead = ego.s - (other.bounds.s.to - contract.position_error);
    ego.least >= zone.ego.from && R::is_ahead(zone, lead)
}

/// The gap (m), at least, from the other to the ego ahead of it once that has entered the lane.
pub(super) fn gap_ahead(zone: &Zone, ego: &Own, other: &Other) -> f32 {
    let place = Real::max(zone.ego.from, ego.least);
    place - other.bounds.s.to - zone.lead.to
}

/// How far (m) the ego may go and still be at rest behind an other that is ahead and brakes as hard as it can.
fn behind<R: Rules>(contract: &Contract, zone: &Zone, ego: &Own, other: &Other) -> f32 {
    let gap = zone.lead.from - (ego.s + contract.position_error - other.bounds.s.from);
    if gap < 0.0 {
        // Not behind it at all.
        return gap;
    }
    gap + R::earliest_rest(contract, other.bounds.speed.from)
}

/// Whether a zone in which the ego has precedence is no hazard: the other can still stop before it, and
/// stays out of it for as long as the ego likes. The ego may even wait in it.
///
/// A lane only once the ego has arrived at its line: until then, one that has to wait may enter ahead of it with the safe
/// gap.
pub(super) fn granted(
    contract: &Contract,
    way: Way<'_>,
    passage: Passage,
    zone: &Zone,
    (ego, other): (&Own, &Other),
) -> bool {
    let Some(rule) = contract.precedence else {
        return false;
    };
    let settled = match passage {
        Passage::Before { .. } => true,
        Passage::Ahead { .. } => ego.least >= arrival(way, rule, way.ego()),
        Passage::Walks { .. } | Passage::Never => false,
    };
    let farthest = Reach {
        distance: other.bounds.s.to,
        speed: other.bounds.speed.to,
    };
    // Who stands at the very edge of its zone may take itself for one that is in it; one that is shielded rests a whole
    // slack before it.
    settled && zone.other.from - 0.5 * contract.slack >= farthest.rest(rule.braking)
}

/// Arc length (m) at which a vehicle of `path` arrives.
fn arrival(way: Way<'_>, rule: Precedence, path: PathId) -> f32 {
    way.path(path)
        .map_or(FAR, |path| path.line() - rule.distance)
}

/// Notes for each lane that the ego shares with `other` whether it is ahead there, and the other keeps its distance
/// from now on: the plan in force counted on it, or the gap is enough, or it was so when the other appeared.
pub(super) fn settle<'z, R: Rules>(
    contract: &Contract,
    zones: impl Iterator<Item = &'z Zone>,
    ego: &Own,
    other: &mut Other,
) {
    let appeared = other.news == News::Appeared;
    for (index, zone) in (0_u8..).zip(zones) {
        if !zone.is_lane() || !is_ahead::<R>(contract, zone, ego, other) {
            continue;
        }
        let slowest = Real::max(ego.speed - contract.speed_error, 0.0);
        let needs = R::safe_gap(contract, other.bounds.speed.to, slowest);
        let enough = gap_ahead(zone, ego, other) >= needs;
        if appeared || has(other.counted, index) || enough {
            other.settled |= 1 << index;
        }
    }
}
