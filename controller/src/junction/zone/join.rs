//! The occupied polygons that hang together become one zone.

use super::clip::Cell;
use super::{FAR, MAX_ZONES, Span, WIDEST, Zone};
use crate::junction::conflict::ConflictKind;

/// Vehicles that touch while they point the same way share a lane if they do so over this distance (m).
const LANE: f32 = 2.0;

/// A part of the occupied set, on the way to a [`Zone`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    pub(super) ego: Span,
    pub(super) other: Span,
    pub(super) lead: Span,
    /// Arc lengths of the ego at which it touches the other while both point the same way.
    pub(super) parallel: Option<Span>,
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
    fn touches(&self, other: &Self) -> bool {
        self.mixed == other.mixed && self.ego.touches(other.ego) && self.other.touches(other.other)
    }

    /// Whether nothing that is occupied in the cell would change the patch.
    fn covers(&self, cell: &Cell) -> bool {
        let holds = |outer: Span, inner: Span| outer.from <= inner.from && inner.to <= outer.to;
        !cell.end
            && holds(self.ego, cell.ego)
            && holds(self.other, cell.other)
            && holds(self.lead, cell.lead)
            && self.mixed == cell.opposite
            && (!cell.parallel || self.parallel.is_some_and(|known| holds(known, cell.ego)))
    }

    fn absorb(&mut self, other: &Self) {
        self.ego = self.ego.hull(other.ego);
        self.other = self.other.hull(other.other);
        self.lead = self.lead.hull(other.lead);
        self.parallel = match (self.parallel, other.parallel) {
            (Some(a), Some(b)) => Some(a.hull(b)),
            (a, b) => a.or(b),
        };
        self.starts |= other.starts;
        self.ends |= other.ends;
        self.mixed |= other.mixed;
    }

    /// The zone of vehicles that are `lengths` (m) long together.
    pub(super) fn zone(&self, lengths: f32) -> Zone {
        let narrow = self.lead.to - self.lead.from <= WIDEST * lengths;
        let lane = !self.mixed && narrow && self.parallel.is_some_and(|p| p.to - p.from >= LANE);
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

/// A band at least `width` wide, on whichever side it is cut off. A lane that a route's end cuts off goes on beyond it.
fn widened(band: Span, width: f32) -> Span {
    band.hull(Span {
        from: band.to - width,
        to: band.from + width,
    })
}

/// Whether nothing that is occupied in the cell would change the patches: one covers it, and no other
/// one touches it.
pub(super) fn covered(patches: &[Option<Patch>; MAX_ZONES], cell: &Cell) -> bool {
    let touches = |patch: &&Patch| {
        patch.mixed == cell.opposite
            && patch.ego.touches(cell.ego)
            && patch.other.touches(cell.other)
    };
    let mut touching = patches.iter().flatten().filter(touches);
    touching.next().is_some_and(|patch| patch.covers(cell)) && touching.next().is_none()
}

/// Adds a patch, or widens those that it touches: what hangs together ends up in one.
pub(super) fn insert(patches: &mut [Option<Patch>; MAX_ZONES], mut patch: Patch) {
    let touched = |patches: &mut [Option<Patch>], patch: &Patch| {
        patches
            .iter_mut()
            .find(|slot| slot.is_some_and(|met| met.touches(patch)))
            .and_then(Option::take)
    };
    // Each round empties a slot. The wider patch may touch one that was passed over.
    while let Some(met) = touched(patches, &patch) {
        patch.absorb(&met);
    }
    if let Some(slot) = patches.iter_mut().find(|slot| slot.is_none()) {
        *slot = Some(patch);
    } else if let Some(last) = patches.last_mut().and_then(Option::as_mut) {
        last.absorb(&patch);
        last.mixed = true;
    }
}
