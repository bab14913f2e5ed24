//! What one observation shows besides where everybody is.

use super::unwatched::Closed;
use crate::fault::Fault;
use crate::headroom::{Headroom, Room};

/// What was wrong with an observation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Findings {
    /// Track that moved beyond the contract's bounds.
    pub(crate) breach: Option<u16>,
    pub(crate) fault: Option<Fault>,
    /// Zones that nobody watches.
    pub(crate) closed: Option<Closed>,
    pub(crate) headroom: Headroom,
}

impl Findings {
    /// Track `number` moved to where so much is left of its place and speed.
    pub(super) fn moved(&mut self, number: u16, rooms: [Room; 2]) {
        self.headroom.note_track(number, rooms);
        if !Room::hold(rooms) {
            self.breach = self.breach.or(Some(number));
        }
    }
}
