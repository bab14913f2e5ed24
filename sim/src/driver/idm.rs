//! The intelligent driver model with stop-sign behaviour.

use super::{Driver, DriverFactory, View};
use crate::meeting::Meeting;
use cede_controller::geometry::distance;
use cede_controller::kinematics::STEP;
use cede_controller::kinematics::State;
use cede_data::encounter::Participant;

/// Car following by the intelligent driver model; at the intersection it stops, and the one that stopped first goes first.
///
/// Source: Treiber, Hennecke, Helbing, "Congested traffic states in empirical observations
/// and microscopic simulations", Physical Review E 62 (2000). The stop line is a standing
/// leader until the vehicle has stopped, waited and found the crossing free.
#[derive(Clone, Copy, Debug)]
pub struct Idm;

/// Desired speed in m/s.
const DESIRED: f32 = 8.0;
/// Maximum acceleration in m/s².
const ACCELERATION: f32 = 2.0;
/// Comfortable deceleration in m/s².
const DECELERATION: f32 = 2.0;
/// Gap to a standing leader in metres.
const STANDSTILL: f32 = 2.0;
/// Time gap to a moving leader in seconds.
const HEADWAY: f32 = 1.2;
/// The vehicle's centre stops this far before its conflict point, in metres.
const LINE: f32 = 2.0;
/// How far from the line a vehicle may rest and still count as waiting at it, in metres.
const AT_LINE: f32 = 3.0;
/// Below this speed (m/s) a vehicle counts as stopped.
const STOPPED: f32 = 0.3;
/// Seconds that it waits at the line at least.
const DWELL: f32 = 1.0;
/// Metres beyond its conflict point at which a vehicle has left the crossing.
const PASSED: f32 = 10.0;

impl DriverFactory for Idm {
    fn name(&self) -> &str {
        "idm"
    }

    fn driver<'m>(&self, _: &'m Meeting<'_>, _: usize, _: u64) -> Box<dyn Driver + 'm> {
        Box::new(AtStopSign {
            waited: 0,
            rival_waited: 0,
            released: false,
        })
    }
}

struct AtStopSign {
    /// Steps for which the vehicle has stood at its line.
    waited: u32,
    /// The same of the rival.
    rival_waited: u32,
    /// Whether it has stopped at the stop sign.
    released: bool,
}

impl Driver for AtStopSign {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        let Some((own, state)) = view.own() else {
            return 0.0;
        };
        self.observe(view, own, state);
        let mut acceleration = follow(state.v, DESIRED, f32::INFINITY, 0.0);
        if let Some((gap, speed)) = leader(view) {
            acceleration = acceleration.min(follow(state.v, DESIRED, gap, speed));
        }
        if !self.released {
            let gap = own.conflict_s - LINE - state.s + STANDSTILL;
            acceleration = acceleration.min(follow(state.v, DESIRED, gap, 0.0));
        }
        acceleration
    }
}

impl AtStopSign {
    fn observe(&mut self, view: &View<'_>, own: &Participant, state: State) {
        let to_line = own.conflict_s - LINE - state.s;
        let waits = |vehicle: &Participant, state: State| {
            state.v < STOPPED && (vehicle.conflict_s - LINE - state.s).abs() < AT_LINE
        };
        self.waited += u32::from(waits(own, state));
        let Some((rival, rival_state)) = view.rival() else {
            self.released |= self.waited as f32 * STEP >= DWELL;
            return;
        };
        self.rival_waited += u32::from(waits(rival, rival_state));
        // Already beyond the line at the start: it has stopped before.
        let beyond = to_line < -0.5;
        let ready = self.waited as f32 * STEP >= DWELL && self.has_turn(view, rival, rival_state);
        self.released |= beyond || ready;
    }

    /// Whether the crossing is this vehicle's: the rival has left it, or has still to stop, or stopped later.
    fn has_turn(&self, view: &View<'_>, rival: &Participant, state: State) -> bool {
        let to_line = rival.conflict_s - LINE - state.s;
        if state.s > rival.conflict_s + PASSED {
            true
        } else if to_line < -0.5 {
            false
        } else if state.v < STOPPED {
            // Who stopped at the same moment as the left-turner goes before it.
            self.waited > self.rival_waited || (self.waited == self.rival_waited && view.ego == 1)
        } else {
            to_line > state.v * state.v / (2.0 * DECELERATION)
        }
    }
}

/// Acceleration (m/s²) at `speed` (m/s), `gap` metres behind the rear of a leader at `leader` m/s, where one would like to
/// drive at `desired` (m/s).
pub(crate) fn follow(speed: f32, desired: f32, gap: f32, leader: f32) -> f32 {
    let ratio = (speed / desired) * (speed / desired);
    let closing = speed * (speed - leader) / (2.0 * (ACCELERATION * DECELERATION).sqrt());
    let wanted = STANDSTILL + (speed * HEADWAY + closing).max(0.0);
    let interaction = wanted / gap.max(0.1);
    ACCELERATION * (1.0 - ratio * ratio - interaction * interaction)
}

/// The gap (m) to the rear of the nearest vehicle ahead in the driver's lane, and its speed (m/s).
pub(super) fn leader(view: &View<'_>) -> Option<(f32, f32)> {
    let (own, state) = view.own()?;
    let mut nearest: Option<(f32, f32)> = None;
    for (index, vehicle) in view.encounter.participants.iter().enumerate() {
        let Some(theirs) = view.state(index).filter(|_| index != view.ego) else {
            continue;
        };
        let pose = vehicle.route.pose(theirs.s);
        let s = own.route.project(pose.position);
        let lane = own.route.pose(s);
        let beside = distance(&lane.position, &pose.position) > 1.5;
        let crossing = lane.direction.dot(&pose.direction) < 0.7;
        if s <= state.s || beside || crossing {
            continue;
        }
        let gap = s - state.s - 0.5 * (own.footprint.length + vehicle.footprint.length);
        if nearest.is_none_or(|(least, _)| gap < least) {
            nearest = Some((gap, theirs.v));
        }
    }
    nearest
}
