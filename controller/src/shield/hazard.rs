//! The conflict zones ahead, as distances from where the ego is now.

use super::contract::{Contract, Precedence};
use super::lane::{behind, gap_ahead, is_ahead};
use super::other::{News, Other};
use super::own::Own;
use super::precedence::has;
use super::rules::Rules;
use super::unwatched::Closed;
use crate::junction::zone::{FAR, Zone};
use crate::junction::{PathId, Way};

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

/// The hazard that `other` is to the ego in a zone, the one with number `index` of the two, if it is one there.
#[inline(never)] // Once in flash.
pub(super) fn of<R: Rules>(
    (contract, way): (&Contract, Way<'_>),
    (index, zone): (u8, &Zone),
    ego: &Own,
    other: &Other,
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
                    arrives: match contract.precedence {
                        Some(rule) if waits => arrival(way, rule, other.path) - bounds.s.to,
                        _ => FAR,
                    },
                },
                ..crossing
            }
        },
    )
}

/// Arc length (m) at which a vehicle of `path` arrives.
pub(super) fn arrival(way: Way<'_>, rule: Precedence, path: PathId) -> f32 {
    way.path(path)
        .map_or(FAR, |path| path.line() - rule.distance)
}
