//! All hazards at once, sorted, and where the ego comes to rest before them.

use super::contract::Contract;
use super::hazard::{Hazard, Passage, Who, arrival, of};
use super::hidden::MAX_SIGHTS;
use super::other::Other;
use super::own::Own;
use super::precedence::has;
use super::reach::Reach;
use super::rules::Rules;
use super::tracks::Tracks;
use super::unwatched::Closed;
use super::walkers::MAX_WALKERS;
use crate::junction::zone::{FAR, MAX_ZONES, Zone};
use crate::junction::{MAX_OTHERS, RightOfWay, RouteConflict, Way};
use crate::real::Real;
use heapless::Vec;

/// Every zone of every other, of everybody out of sight and of every pedestrian, and what is closed.
const CAPACITY: usize = (MAX_OTHERS + MAX_SIGHTS + MAX_WALKERS) * MAX_ZONES + 1;

/// An ego that comes to rest no farther beyond its line than this (m) waits at it.
const BEYOND: f32 = 1.0;

/// The hazards, sorted by [`Hazard::target`].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hazards {
    sorted: Vec<Hazard, CAPACITY>,
}

impl Hazards {
    /// No hazards.
    pub(super) const fn new() -> Self {
        Self { sorted: Vec::new() }
    }

    /// Adds the hazards of everybody who matters, but for those that the rule of precedence takes away. In place,
    /// because they are the largest thing on the stack.
    ///
    /// Cost: O(zones²) for the sorting, at most 61².
    pub(super) fn add<const N: usize, R: Rules>(
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
        for (index, zone) in (0_u8..).zip(conflict.zones()) {
            let Some(hazard) = of::<R>((contract, way), (index, zone), ego, other) else {
                continue;
            };
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
    /// the line, it is on its way. As long as the plan in force `goes`, it is not given up there for one that rests
    /// inside.
    pub(super) fn wait_at(&mut self, line: f32, stop: f32, goes: bool) {
        let rest = match stop > line + BEYOND {
            true if goes => line,
            true => return,
            false => Real::max(line, stop),
        };
        for hazard in &mut self.sorted {
            if !matches!(hazard.passage, Passage::Never) {
                hazard.rest = Real::min(hazard.rest, rest);
            }
        }
        self.look_beyond();
    }

    /// Only those are left for which `inside` is false, and the ego may rest before them wherever it stops short of them.
    pub(super) fn leave_out(&mut self, inside: impl Fn(&Hazard) -> bool) {
        self.sorted.retain_mut(|hazard| {
            hazard.rest = hazard.limit;
            !inside(hazard)
        });
        self.look_beyond();
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Hazard> {
        self.sorted.iter()
    }

    /// Where the ego comes to rest before all of them.
    pub(super) fn nearest_rest(&self) -> f32 {
        self.sorted
            .first()
            .map_or(FAR, |first| Real::min(first.rest, first.rest_beyond))
    }

    fn insert<R: Rules>(&mut self, hazard: Hazard) {
        // 8 others, 8 edges of sight and 4 pedestrians of 3 zones each, and what is closed: `Shield` and `MAX_ZONES` see to it that there are no more.
        let _ = self.sorted.push(hazard);
        let mut place = self.sorted.len().saturating_sub(1);
        for i in (1..self.sorted.len()).rev() {
            let Some([before, after]) = self.sorted.get_mut(i - 1..=i) else {
                break;
            };
            if !R::sooner(hazard.target, before.target) {
                break;
            }
            *after = *before;
            place = i - 1;
        }
        if let Some(it) = self.sorted.get_mut(place) {
            *it = hazard;
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
        let meets = |it: &&Zone| it.ego.contains(from);
        let before = conflict.zones().filter(open).filter(meets);
        before.map(|it| it.ego.from).fold(from, Real::min)
    })
}

/// Whether a zone in which the ego has precedence is no hazard: the other can still stop before it, and
/// stays out of it for as long as the ego likes. The ego may even wait in it.
///
/// A lane only once the ego has arrived at its line: until then, one that has to wait may enter ahead of it with the safe
/// gap.
fn granted(
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::instant::Instant;
    use crate::junction::zone::Span;
    use crate::junction::{ConflictKind, PathId};
    use crate::shield::bounds::Bounds;
    use crate::shield::rules::Sound;

    /// These hazards and no others.
    pub(in crate::shield) fn just(all: &[Hazard]) -> Hazards {
        let mut hazards = Hazards::new();
        for hazard in all {
            hazards.insert::<Sound>(*hazard);
        }
        hazards.look_beyond();
        hazards
    }

    /// All there can be: three zones of each of 8 others (24, if there may be many), 8 edges of sight and 4 pedestrians, and
    /// one that is closed.
    #[test]
    fn as_many_hazards_as_there_can_be_are_kept_in_order() {
        let count = if cfg!(feature = "many-others") {
            109_u8
        } else {
            61
        };
        let mut hazards = Hazards::new();
        for i in 0..count {
            let target = f32::from((u16::from(i) * 3 % u16::from(count)) as u8);
            hazards.insert::<Sound>(Hazard {
                who: Who::Unwatched(0),
                zone: 0,
                suspect: false,
                yields: false,
                target,
                limit: target,
                rest: target,
                rest_beyond: FAR,
                passage: Passage::Never,
            });
        }
        let targets: std::vec::Vec<_> = hazards.iter().map(|hazard| hazard.target).collect();
        let sorted: std::vec::Vec<_> = (0..count).map(f32::from).collect();
        assert_eq!(targets, sorted);
        hazards.look_beyond();
        let beyond: std::vec::Vec<_> = hazards.iter().map(|hazard| hazard.rest_beyond).collect();
        assert_eq!(beyond[..2], [1.0, 2.0]);
        assert_eq!(beyond.last(), Some(&FAR));
        // They are the largest thing on the stack: there is no room for more.
        assert_eq!(hazards.sorted.capacity(), usize::from(count));
    }

    /// Number `number`, passed before another comes.
    fn passed(number: u16, limit: f32, target: f32) -> Hazard {
        Hazard {
            who: Who::Unwatched(number),
            zone: 0,
            suspect: false,
            yields: false,
            target,
            limit,
            rest: limit,
            rest_beyond: FAR,
            passage: Passage::Before {
                distance: 9.0,
                speed: 5.0,
            },
        }
    }

    #[test]
    fn of_hazards_with_one_target_the_first_comes_first() {
        let all = [(1, 20.0), (2, 10.0), (3, 20.0), (4, 10.0)];
        let hazards = just(&all.map(|(number, target)| passed(number, 5.0, target)));
        let order: std::vec::Vec<_> = hazards.iter().map(|it| it.who).collect();
        assert_eq!(order, [2, 4, 1, 3].map(Who::Unwatched));
    }

    /// Its line is 10 m ahead, and the zone 30 m.
    #[test]
    fn one_that_rests_up_to_a_metre_beyond_its_line_waits_there() {
        let rests = |stop, goes| {
            let leader = Hazard {
                passage: Passage::Never,
                ..passed(2, 28.0, FAR)
            };
            let mut hazards = just(&[passed(1, 30.0, 40.0), leader]);
            hazards.wait_at(10.0, stop, goes);
            // Whom it follows, it comes up to.
            assert_eq!(hazards.sorted[1].rest, 28.0);
            hazards.sorted[0].rest
        };
        assert_eq!(
            [9.0, 10.5, 11.0, 11.1].map(|stop| rests(stop, false)),
            [10.0, 10.5, 11.0, 30.0]
        );
        assert_eq!(
            [9.0, 10.5, 11.0, 11.1].map(|stop| rests(stop, true)),
            [10.0, 10.5, 11.0, 10.0]
        );
    }

    #[test]
    fn what_precedence_opens_is_kept_clear_of_those_who_wait_for_nobody_with_a_right() {
        let rest = |limit: f32, change: fn(&mut Hazard)| {
            let mut hazard = passed(1, limit, limit + 8.0);
            change(&mut hazard);
            let mut hazards = just(&[hazard]);
            hazards.keep_clear([10.0, 20.0]);
            hazards.sorted[0].rest
        };
        assert_eq!(
            [9.9, 10.0, 15.0, 19.9, 20.0].map(|limit| rest(limit, |_| {})),
            [9.9, 10.0, 10.0, 10.0, 20.0]
        );
        assert_eq!(rest(15.0, |it| it.rest = 7.0), 7.0);
        assert_eq!(rest(15.0, |it| it.yields = true), 15.0);
        assert_eq!(rest(15.0, |it| it.passage = Passage::Never), 15.0);
    }

    /// A zone that both enter and leave at these arc lengths.
    fn zone(ego: [f32; 2], other: [f32; 2], kind: ConflictKind) -> Zone {
        let span = |[from, to]: [f32; 2]| Span { from, to };
        let lead = [ego[0] - other[1], ego[1] - other[0]];
        Zone {
            ego: span(ego),
            other: span(other),
            lead: span(lead),
            kind,
        }
    }

    /// Where the ego, at `ego`, waits before the last of `zones` for one at `other`.
    fn waits(zones: &[Zone], ego: f32, other: f32) -> f32 {
        let mut conflict = RouteConflict::NONE;
        for (place, zone) in conflict.zones.iter_mut().zip(zones) {
            *place = Some(*zone);
        }
        let own = Own {
            s: ego,
            speed: 0.0,
            least: ego,
        };
        let bounds = Bounds {
            s: Span {
                from: other,
                to: other,
            },
            speed: Span { from: 0.0, to: 0.0 },
        };
        let other = Other::at(1, PathId::new(1), 0.0, bounds, Instant::from_millis(1));
        clear_of::<Sound>(&conflict, zones.last().unwrap(), &own, &other)
    }

    #[test]
    fn the_ego_waits_before_the_first_of_the_crossings_without_a_gap_that_are_open() {
        let crossing = |ego, other| zone(ego, other, ConflictKind::Crossing);
        let first = crossing([10.0, 14.0], [30.0, 34.0]);
        let second = crossing([14.0, 18.0], [20.0, 24.0]);
        let third = crossing([18.0, 22.0], [10.0, 14.0]);
        assert_eq!(waits(&[first, second], 5.0, 0.0), 10.0);
        assert_eq!(waits(&[first, second, third], 5.0, 0.0), 10.0);
        // A gap.
        let beyond = crossing([14.1, 18.0], [20.0, 24.0]);
        assert_eq!(waits(&[first, beyond], 5.0, 0.0), 14.1);
        assert_eq!(waits(&[first, beyond, third], 5.0, 0.0), 14.1);
        // What the ego or the other has left.
        assert_eq!(waits(&[first, second], 13.9, 0.0), 10.0);
        assert_eq!(waits(&[first, second], 14.0, 0.0), 14.0);
        assert_eq!(waits(&[first, second], 5.0, 33.9), 10.0);
        assert_eq!(waits(&[first, second], 5.0, 34.0), 14.0);
        // A lane is no crossing, be it the one before or the last.
        let lane = zone([10.0, 14.0], [30.0, 34.0], ConflictKind::Merging);
        assert_eq!(waits(&[lane, second], 5.0, 0.0), 14.0);
        let last = zone([14.0, 18.0], [20.0, 24.0], ConflictKind::Merging);
        assert_eq!(waits(&[first, last], 5.0, 0.0), 14.0);
    }
}
