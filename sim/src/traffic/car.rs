//! A vehicle in traffic.

use super::PATIENCE;
use super::human::Human;
use super::ride::Ride;
use cede_controller::kinematics::{STEP, State, advance};
use cede_controller::separation::OrientedBox;
use cede_data::Participant;

/// A vehicle in traffic.
pub(super) struct Car<'t> {
    pub(super) vehicle: &'t Participant,
    /// A seat decided in the last step; before the shield is ready the record does.
    pub(super) driven: bool,
    pub(super) human: Human,
    pub(super) ride: Ride,
    state: Option<State>,
    gone: bool,
}

impl<'t> Car<'t> {
    /// One that is to be driven, if it is `chosen`.
    pub(super) fn new(vehicle: &'t Participant, chosen: bool) -> Self {
        Self {
            vehicle,
            driven: false,
            human: Human::default(),
            ride: Ride::new(vehicle, chosen),
            state: None,
            gone: false,
        }
    }

    /// Where it appears.
    pub(super) fn first(&self) -> Option<State> {
        let first = self.vehicle.record.first()?;
        Some(State {
            s: first.s,
            v: first.v,
        })
    }

    /// It enters the site.
    pub(super) fn appear(&mut self) {
        self.state = self.first();
        self.gone = self.state.is_none();
    }

    /// Its record has begun, and it has not entered yet.
    pub(super) const fn is_due(&self, step: u32) -> bool {
        self.vehicle.appears <= step && self.state.is_none() && !self.gone
    }

    pub(super) const fn is_there(&self) -> bool {
        self.state.is_some()
    }

    pub(super) const fn is_gone(&self) -> bool {
        self.gone
    }

    /// Where it is and how fast; only while it is there.
    pub(super) fn state(&self) -> State {
        self.state.unwrap_or_default()
    }

    /// Where its body is; only while it is there.
    pub(super) fn body(&self) -> OrientedBox {
        OrientedBox::new(
            self.vehicle.route.pose(self.state().s),
            self.vehicle.footprint,
        )
    }

    /// Whether it is behind its record at `step`.
    pub(super) fn is_late(&self, step: u32) -> bool {
        let recorded = self.vehicle.recorded(step);
        recorded.is_none_or(|recorded| self.state().s < recorded.s - 0.05)
    }

    /// One step at `command` (m/s²); a record is followed exactly.
    pub(super) fn advance(&mut self, command: f32, step: u32) {
        let before = self.state();
        let after = if self.driven {
            self.human.leave();
            advance(before, command)
        } else {
            self.human.advance(self.vehicle, before, command)
        };
        self.ride.note(self.vehicle, [before, after], self.driven);
        self.state = Some(after);
        let last = self.vehicle.record.last().map_or(0.0, |last| last.s);
        let end = self.vehicle.appears + self.vehicle.record.len() as u32;
        let late = (step + 1) as f32 - end as f32;
        if after.s >= last - 1e-3
            && (self.human.is_done(self.vehicle) || self.driven || late >= 0.0)
        {
            self.ride.arrived = Some(late * STEP);
        } else if self.ride.stands() > PATIENCE {
            self.ride.stuck = true;
        } else {
            return;
        }
        self.leave();
    }

    /// It is not there any more, and does not come back.
    pub(super) const fn leave(&mut self) {
        self.state = None;
        self.gone = true;
    }

    pub(super) fn into_ride(self) -> Ride {
        self.ride
    }
}
