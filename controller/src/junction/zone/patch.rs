//! A part of what two vehicles occupy, and the zone that it becomes.

use super::cell::Cell;
use super::{FAR, Span, WIDEST, Zone};
use crate::geometry::Footprint;
use crate::junction::MAX_PATH_LENGTH;
use crate::junction::kind::ConflictKind;

/// Vehicles share a way if they point the same way over this share of their lengths, and more than where they cross.
const ALONG: f32 = 0.4;

/// A part of the occupied set, on the way to a [`Zone`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    pub(super) ego: Span,
    pub(super) other: Span,
    pub(super) lead: Span,
    /// Arc lengths of the ego and of the other at which they touch while both point the same way.
    pub(super) parallel: Option<[Span; 2]>,
    /// They do so where a route starts.
    pub(super) starts: bool,
    /// They do so where a route ends.
    pub(super) ends: bool,
    /// Who leads in it is not who is ahead: they meet head-on in it too, or it holds parts that do not hang together.
    pub(super) mixed: bool,
}

impl Patch {
    /// Where they meet head-on is a zone of its own, also if it hangs together with a lane: there, who leads is not who is
    /// ahead.
    pub(super) fn touches(&self, other: &Self) -> bool {
        self.mixed == other.mixed && self.ego.touches(other.ego) && self.other.touches(other.other)
    }

    /// Whether nothing that is occupied in the cell would change the patch.
    pub(super) fn covers(&self, cell: &Cell) -> bool {
        let holds = |outer: Span, inner: Span| outer.from <= inner.from && inner.to <= outer.to;
        !cell.end
            && holds(self.ego, cell.ego)
            && holds(self.other, cell.other)
            && holds(self.lead, cell.lead)
            && self.mixed == cell.opposite
            && (!cell.parallel
                || self
                    .parallel
                    .is_some_and(|[ego, other]| holds(ego, cell.ego) && holds(other, cell.other)))
    }

    /// By how many m² of the (s, t) plane both in one cover more than each for itself.
    pub(super) fn growth(&self, other: &Self) -> f32 {
        let area = |ego: Span, other: Span| extent(ego) * extent(other);
        area(self.ego.hull(other.ego), self.other.hull(other.other))
            - area(self.ego, self.other)
            - area(other.ego, other.other)
    }

    pub(super) fn absorb(&mut self, other: &Self) {
        self.ego = self.ego.hull(other.ego);
        self.other = self.other.hull(other.other);
        self.lead = self.lead.hull(other.lead);
        self.parallel = match (self.parallel, other.parallel) {
            (Some([a, b]), Some([c, d])) => Some([a.hull(c), b.hull(d)]),
            (a, b) => a.or(b),
        };
        self.starts |= other.starts;
        self.ends |= other.ends;
        self.mixed |= other.mixed;
    }

    /// Whether they share a way in it, and do not just cross at a small angle: up to 30° they touch over a length and twice
    /// both widths. A way that begins or ends with a route is shared on beyond it.
    fn is_shared(&self, ego: Footprint, other: Footprint) -> bool {
        let Some([a, b]) = self.parallel else {
            return false;
        };
        let [a, b] = [a.to - a.from, b.to - b.from];
        let long = a >= ALONG * ego.length && b >= ALONG * other.length;
        let lengths = ego.length + other.length;
        // Of both together: in a bend, one turns while the other goes straight, and touches over less.
        let crossed = lengths + 4.0 * (ego.width + other.width);
        long && (self.starts || self.ends || a + b >= crossed + ALONG * lengths)
    }

    /// The zone of two vehicles.
    pub(super) fn zone(&self, ego: Footprint, other: Footprint) -> Zone {
        let lengths = ego.length + other.length;
        let narrow = self.lead.to - self.lead.from <= WIDEST * lengths;
        let lane = !self.mixed && narrow && self.is_shared(ego, other);
        // A shared lane goes on past the end of the shorter route, for both.
        let end = |interval: Span| Span {
            to: if lane && self.ends { FAR } else { interval.to },
            ..interval
        };
        Zone {
            ego: end(self.ego),
            other: end(self.other),
            lead: if lane && (self.starts || self.ends) {
                widened(self.lead, lengths)
            } else {
                self.lead
            },
            kind: match (lane, self.starts) {
                (true, true) => ConflictKind::Following,
                (true, false) => ConflictKind::Merging,
                (false, _) => ConflictKind::Crossing,
            },
        }
    }
}

/// The length of an interval; one that goes on past an end of a route is as long as a route may be.
fn extent(interval: Span) -> f32 {
    let length = interval.to - interval.from;
    if length > MAX_PATH_LENGTH {
        MAX_PATH_LENGTH
    } else {
        length
    }
}

/// A band at least `width` wide, on whichever side it is cut off. A lane that a route's end cuts off goes on beyond it.
fn widened(band: Span, width: f32) -> Span {
    band.hull(Span {
        from: band.to - width,
        to: band.from + width,
    })
}
