//! A part of what two vehicles occupy, and the zone that it becomes.

use super::cell::Cell;
use super::{FAR, Span, WIDEST, Zone};
use crate::geometry::Footprint;
use crate::junction::MAX_PATH_LENGTH;
use crate::junction::kind::ConflictKind;
use crate::real::Real;

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
    Real::min(interval.to - interval.from, MAX_PATH_LENGTH)
}

/// A band at least `width` wide, on whichever side it is cut off. A lane that a route's end cuts off goes on beyond it.
fn widened(band: Span, width: f32) -> Span {
    band.hull(Span {
        from: band.to - width,
        to: band.from + width,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const EGO: Footprint = Footprint {
        length: 5.0,
        width: 2.0,
    };
    const OTHER: Footprint = Footprint {
        length: 4.0,
        width: 1.0,
    };

    fn span(from: f32, to: f32) -> Span {
        Span { from, to }
    }

    /// Where both point the same way over so many metres.
    fn along(ego: f32, other: f32) -> Patch {
        Patch {
            ego: span(10.0, 40.0),
            other: span(20.0, 50.0),
            lead: span(-16.0, -6.0),
            parallel: Some([span(11.0, 11.0 + ego), span(21.0, 21.0 + other)]),
            starts: false,
            ends: false,
            mixed: false,
        }
    }

    #[test]
    fn a_way_is_shared_over_more_than_where_two_cross_at_a_small_angle() {
        // 9 m and 4 times 3 m; and 0.4 of the lengths.
        let shared = |ego, other| along(ego, other).is_shared(EGO, OTHER);
        assert!(shared(20.0, 4.61) && !shared(20.0, 4.59));
        assert!(shared(3.0, 30.0) && !shared(1.99, 30.0) && !shared(30.0, 1.59));
        let short = |starts, ends| Patch {
            starts,
            ends,
            ..along(2.01, 1.61)
        };
        assert!(!short(false, false).is_shared(EGO, OTHER));
        for (starts, ends) in [(true, false), (false, true)] {
            assert!(short(starts, ends).is_shared(EGO, OTHER));
            assert!(
                !Patch {
                    parallel: None,
                    ..short(starts, ends)
                }
                .is_shared(EGO, OTHER)
            );
        }
    }

    #[test]
    fn a_lane_is_narrow_and_goes_on_beyond_the_end_of_a_route() {
        let zone = |patch: Patch| patch.zone(EGO, OTHER);
        let lane = along(20.0, 20.0);
        let merging = zone(lane);
        assert_eq!(
            (merging.ego, merging.other, merging.lead),
            (lane.ego, lane.other, lane.lead)
        );
        assert_eq!(merging.kind, ConflictKind::Merging);
        let ends = zone(Patch {
            ends: true,
            lead: span(-10.0, -6.0),
            ..lane
        });
        assert_eq!((ends.ego, ends.other), (span(10.0, FAR), span(20.0, FAR)));
        // Widened to 9 m, on either side.
        assert_eq!(
            (ends.lead, ends.kind),
            (span(-15.0, -1.0), ConflictKind::Merging)
        );
        let starts = zone(Patch {
            starts: true,
            lead: span(-10.0, -6.0),
            ..lane
        });
        assert_eq!((starts.ego, starts.lead), (lane.ego, span(-15.0, -1.0)));
        assert_eq!(starts.kind, ConflictKind::Following);
        // Twice both lengths, and more.
        let wide = |width: f32| {
            zone(Patch {
                lead: span(0.0, width),
                ends: true,
                ..lane
            })
        };
        assert!(wide(18.0).is_lane() && wide(18.1).kind == ConflictKind::Crossing);
        assert_eq!(
            (wide(18.1).ego, wide(18.1).lead),
            (lane.ego, span(0.0, 18.1))
        );
        assert_eq!(
            zone(Patch {
                mixed: true,
                ..lane
            })
            .kind,
            ConflictKind::Crossing
        );
    }

    #[test]
    fn patches_grow_by_what_neither_covers() {
        let square = |at: f32, size: f32| Patch {
            ego: span(at, at + size),
            other: span(2.0 * at, 2.0 * at + size),
            ..along(1.0, 1.0)
        };
        assert_eq!(
            square(0.0, 2.0).growth(&square(5.0, 3.0)),
            8.0 * 13.0 - 4.0 - 9.0
        );
        assert_eq!(square(0.0, 2.0).growth(&square(0.0, 2.0)), -4.0);
        assert_eq!(extent(span(-FAR, 5.0)), 512.0);
        assert_eq!(extent(span(1.0, 513.0)), 512.0);
    }

    #[test]
    fn what_is_absorbed_is_in_the_patch() {
        let mut whole = along(5.0, 6.0);
        let other = Patch {
            ego: span(38.0, 60.0),
            other: span(10.0, 30.0),
            lead: span(-8.0, 0.0),
            parallel: Some([span(50.0, 55.0), span(12.0, 13.0)]),
            starts: true,
            ends: true,
            mixed: true,
        };
        assert!(
            !whole.touches(&other)
                && whole.touches(&Patch {
                    mixed: false,
                    ..other
                })
        );
        assert!(!whole.touches(&Patch {
            mixed: false,
            ego: span(41.0, 60.0),
            ..other
        }));
        assert!(!whole.touches(&Patch {
            mixed: false,
            other: span(51.0, 60.0),
            ..other
        }));
        whole.absorb(&other);
        assert_eq!(
            (whole.ego, whole.other),
            (span(10.0, 60.0), span(10.0, 50.0))
        );
        assert_eq!(whole.lead, span(-16.0, 0.0));
        assert_eq!(whole.parallel, Some([span(11.0, 55.0), span(12.0, 27.0)]));
        assert!(whole.starts && whole.ends && whole.mixed);
        let mut plain = along(5.0, 6.0);
        plain.absorb(&along(5.0, 6.0));
        assert!(!plain.starts && !plain.ends && !plain.mixed);
    }

    #[test]
    fn a_cell_is_covered_if_it_changes_nothing() {
        let patch = along(20.0, 20.0);
        let cell = |change: fn(&mut Cell)| {
            let mut cell = Cell {
                ego: span(12.0, 20.0),
                other: span(22.0, 30.0),
                lead: span(-15.0, -7.0),
                parallel: true,
                opposite: false,
                end: false,
            };
            change(&mut cell);
            cell
        };
        assert!(patch.covers(&cell(|_| {})));
        let changes: [fn(&mut Cell); 9] = [
            |cell| cell.end = true,
            |cell| cell.opposite = true,
            |cell| cell.ego.from = 9.0,
            |cell| cell.ego.to = 41.0,
            |cell| cell.other.from = 19.0,
            |cell| cell.other.to = 51.0,
            |cell| cell.lead.to = -5.0,
            |cell| cell.ego.from = 10.5,
            |cell| cell.other.to = 42.0,
        ];
        for (i, change) in changes.into_iter().enumerate() {
            assert!(!patch.covers(&cell(change)), "{i}");
        }
        // Beyond where they point the same way, if these two do not.
        assert!(patch.covers(&cell(|cell| (cell.parallel, cell.ego.from) = (false, 10.5))));
        assert!(
            !Patch {
                parallel: None,
                ..patch
            }
            .covers(&cell(|_| {}))
        );
    }
}
