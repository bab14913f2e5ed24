//! Where two motions can be at most: their rectangle in the (s, t) plane.

use super::body::Motion;
use super::{INFLATION, Span};

/// Two directions whose cosine is above this point the same way: within 30°.
const PARALLEL: f32 = 0.866;

/// Two directions whose cosine is below this come towards each other: more than 120° apart.
const OPPOSITE: f32 = -0.5;

/// Where two motions can be at most.
pub(super) struct Cell {
    pub(super) ego: Span,
    pub(super) other: Span,
    pub(super) lead: Span,
    /// The two may point the same way.
    pub(super) parallel: bool,
    /// They meet head-on.
    pub(super) opposite: bool,
    /// An end of a route is in it.
    pub(super) end: bool,
}

impl Cell {
    pub(super) fn of(a: &Motion, b: &Motion) -> Self {
        let span = |motion: &Motion| Span {
            from: motion.arc,
            to: motion.arc + motion.length,
        };
        let (ego, other) = (span(a), span(b));
        Self {
            ego,
            other,
            lead: Span {
                from: ego.from - other.to - INFLATION,
                to: ego.to - other.from + INFLATION,
            },
            parallel: parallel(a, b),
            opposite: opposite(a, b),
            end: a.first || a.last || b.first || b.last,
        }
    }
}

/// Whether the vehicles point the same way. Turns do not count: they are in no lane.
pub(super) fn parallel(a: &Motion, b: &Motion) -> bool {
    !a.turning && !b.turning && a.direction.dot(&b.direction) > PARALLEL
}

/// Whether the vehicles come towards each other.
pub(super) fn opposite(a: &Motion, b: &Motion) -> bool {
    a.direction.dot(&b.direction) < OPPOSITE
}
