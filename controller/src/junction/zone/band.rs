//! The band of two vehicles on one route: how far apart along it they can be and still touch.

use super::body::{Motion, Stage};
use super::cell::{Cell, opposite};
use super::clip::{least_lead, limits, meet};
use crate::real::Real;

/// How far apart two vehicles on one route can touch.
pub(super) struct Band {
    /// Along the route (m).
    pub(super) widest: f32,
    /// They meet head-on.
    pub(super) head_on: bool,
}

impl Band {
    /// Of two that touch wherever they are nearer to each other than `widest` (m).
    pub(super) const fn new(widest: f32) -> Self {
        Self {
            widest,
            head_on: false,
        }
    }

    /// Takes in how two touch on one piece each, the first of which is not ahead of the second.
    pub(super) fn widen_by_stages(&mut self, behind: &Stage, ahead: &Stage) {
        let cell = Cell::of(behind.straight(), ahead.straight());
        let one_way = Cell::of_turns(behind, ahead).is_some_and(|cell| !cell.opposite);
        // Most are as near as in the band, or never touch.
        if one_way && -cell.lead.from <= self.widest
            || limits(&behind.whole(), &ahead.whole()).is_none()
        {
            return;
        }
        self.widen(behind.straight(), ahead.straight());
        behind.turns_with(ahead, &mut |behind, ahead| self.widen(behind, ahead));
    }

    fn widen(&mut self, behind: &Motion, ahead: &Motion) {
        let one_way = !opposite(behind, ahead);
        // In a bend that goes on, all pieces touch as far apart: no polygon is cut for what widens nothing.
        if one_way && least_lead(behind, ahead).is_none_or(|lead| -lead <= self.widest) {
            return;
        }
        if let Some(patch) = meet(behind, ahead) {
            let widest = Real::max(patch.lead.to, -patch.lead.from);
            self.widest = Real::max(self.widest, widest);
            self.head_on |= patch.mixed;
        }
    }
}
