//! Who has to stop, and who has to give way to whom.

use super::human::Right;
use super::layout::{Arm, Layout, Movement};
use super::plan::Control;
use crate::lanelet::Sign;
use crate::role::Manoeuvre;

impl Layout {
    /// Whether everybody on this way has to stop at the line.
    pub(super) fn must_stop(&self, movement: &Movement) -> bool {
        self.stops(&self.arms[movement.from])
    }

    /// Whether everybody on `arm` has to stop at its line.
    pub(super) fn stops(&self, arm: &Arm) -> bool {
        self.sign(arm) == Some(Sign::Stop)
    }

    /// The sign at the line of `arm`.
    pub(super) fn sign(&self, arm: &Arm) -> Option<Sign> {
        match self.control {
            Control::AllWayStop => Some(Sign::Stop),
            Control::TwoWayStop => (!arm.major).then_some(Sign::Stop),
            Control::Yield => (!arm.major).then_some(Sign::Yield),
            Control::Uncontrolled => None,
        }
    }

    /// Whether there is a sign on this way.
    pub(super) fn has_sign(&self, movement: &Movement) -> bool {
        self.sign(&self.arms[movement.from]).is_some()
    }

    /// Who goes first if both come at once: the major road, who comes from the
    /// right, and oncoming traffic before who turns left across it.
    pub(super) fn rule(&self, own: &Movement, other: &Movement) -> Right {
        let bound = [own, other].map(|m| self.has_sign(m));
        let theirs = match bound {
            [true, false] => true,
            [false, true] => false,
            _ => self.gives_way_aside(own, other),
        };
        if theirs { Right::Theirs } else { Right::Mine }
    }

    fn gives_way_aside(&self, own: &Movement, other: &Movement) -> bool {
        let side = self.arms[own.from]
            .outward
            .perp(&self.arms[other.from].outward);
        let left = |m: &Movement| m.manoeuvre == Manoeuvre::Left;
        side > 0.5 || (side > -0.5 && left(own) && !left(other))
    }
}
