//! What a tube is made of: sets of states.

use crate::interval::Interval;

/// A set of states of an encounter: a box, and what there is to spare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct States {
    /// Ego's metres to its conflict point.
    pub(super) distance: Interval,
    /// Ego's speed in m/s.
    pub(super) speed: Interval,
    /// Other's metres to its conflict point.
    pub(super) other_distance: Interval,
    /// Other's speed in m/s.
    pub(super) other_speed: Interval,
    /// Metres that the ego has to spare to its zone if it brakes at once: not free to vary within
    /// the box, which without it would hold states from which nobody could stop.
    pub(super) spare: Interval,
}

/// What is known of one moment of a tube: ranges of the ego's distance (m) to its conflict point and
/// speed (m/s), then of the other's.
pub type Moment = [[f64; 2]; 4];

impl States {
    pub(super) fn moment(&self) -> Moment {
        let sides = [
            self.distance,
            self.speed,
            self.other_distance,
            self.other_speed,
        ];
        sides.map(|side| [side.lo, side.hi])
    }
}
