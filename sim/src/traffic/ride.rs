//! What became of one vehicle.

use cede_controller::kinematics::{STEP, State};
use cede_controller::{Cause, Decision, Fault};
use cede_data::Participant;

/// Braking (m/s²) from here on is hard.
pub(super) const HARD: f32 = 4.0;
/// Slower than this (m/s) a vehicle stands.
pub(super) const STANDS: f32 = 0.1;
/// Metres over which the direction of a route is compared for its curvature.
const PIECE: f32 = 1.0;

/// What became of one vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ride {
    /// Its number in the recording.
    pub track: u32,
    /// It was to be driven.
    pub chosen: bool,
    /// Steps from its appearance to where it was gone.
    pub steps: u32,
    /// Steps that were driven.
    pub driven: u32,
    /// Of these, those in which the shield decided.
    pub shielded: u32,
    /// Of these, those without a safe plan.
    pub unplanned: u32,
    /// Seconds later than in its record that it arrived at the record's end; `None` if it did not.
    pub arrived: Option<f32>,
    /// It was taken away: see [`super::PATIENCE`].
    pub stuck: bool,
    /// The longest time (s) that it stood.
    pub wait: f32,
    /// Metres that it went.
    pub distance: f32,
    /// How often it began to brake harder than 4 m/s².
    pub hard_brakes: u32,
    /// Sum of the squares of its jerk (m/s³) over the steps.
    pub jerk: f64,
    /// The highest lateral acceleration (m/s²) in a bend.
    pub lateral: f32,
    stands: u32,
    acceleration: Option<f32>,
}

impl Ride {
    pub(super) fn new(vehicle: &Participant, chosen: bool) -> Self {
        Self {
            track: vehicle.track,
            chosen,
            ..Self::default()
        }
    }

    /// What the shield said.
    pub(super) fn decided(&mut self, decision: &Decision) {
        self.shielded += u32::from(decision.cause != Cause::Policy);
        self.unplanned += u32::from(decision.cause == Cause::Fallback(Fault::NoPlan));
    }

    /// Seconds for which it has stood.
    pub(super) fn stands(&self) -> f32 {
        self.stands as f32 * STEP
    }

    /// A step, driven or not.
    pub(super) fn note(
        &mut self,
        vehicle: &Participant,
        [before, after]: [State; 2],
        driven: bool,
    ) {
        self.steps += 1;
        self.driven += u32::from(driven);
        self.distance += after.s - before.s;
        self.stands = if after.v < STANDS { self.stands + 1 } else { 0 };
        self.wait = self.wait.max(self.stands());
        let acceleration = (after.v - before.v) / STEP;
        if let Some(last) = self.acceleration {
            self.jerk += f64::from((acceleration - last) / STEP).powi(2);
        }
        let was_hard = self.acceleration.is_some_and(|last| last < -HARD);
        self.hard_brakes += u32::from(acceleration < -HARD && !was_hard);
        self.acceleration = Some(acceleration);
        let route = &vehicle.route;
        let [from, to] = [after.s, after.s + PIECE].map(|s| route.pose(s).direction);
        let curvature = from.perp(&to).abs() / PIECE;
        self.lateral = self.lateral.max(after.v * after.v * curvature);
    }
}
