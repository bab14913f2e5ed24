//! How a vehicle drives once it is known who goes first: one goes, the other stops and waits.

use super::View;
use cede_controller::kinematics::MAX_ACCELERATION;
use cede_data::encounter::Role;

/// Acceleration (m/s²) with which a vehicle takes up its speed.
const PULL_AWAY: f32 = 2.0;
/// Speed (m/s) of a vehicle that has the right of way: that of a calm turn from a stop.
pub(super) const CRUISE: f32 = 4.0;
/// The stopping vehicle aims at this many metres before its conflict point.
const STOP_SHORT: f32 = 1.0;
/// Metres beyond its conflict point at which a vehicle has left the crossing: the point lies up
/// to 5 m before the crossing itself, and half a vehicle and half a lane follow.
const PASSED: f32 = 10.0;

/// The acceleration (m/s²) of the view's vehicle if `first` goes first; `cruise` is the speed (m/s) that it
/// takes up where it may.
///
/// The first goes; the other stops short of its conflict point, and goes when the first has passed.
pub(super) fn accelerate(view: &View<'_>, first: Role, cruise: f32) -> f32 {
    let Some((own, state)) = view.own() else {
        return 0.0;
    };
    let rival_passed = view
        .rival()
        .is_none_or(|(rival, state)| state.s > rival.conflict_s + PASSED);
    if view.ego == first as usize || rival_passed {
        return go(state.v, cruise);
    }
    stop(state.v, cruise, own.conflict_s - state.s - STOP_SHORT)
}

/// Takes up the speed `cruise` from `speed` (m/s), and never brakes hard for it.
fn go(speed: f32, cruise: f32) -> f32 {
    (cruise - speed).clamp(-1.0, PULL_AWAY)
}

/// Stops within `distance` (m) from `speed` (m/s): holds back no sooner than comfort asks.
fn stop(speed: f32, cruise: f32, distance: f32) -> f32 {
    if distance <= 0.0 {
        return -MAX_ACCELERATION;
    }
    let needed = speed * speed / (2.0 * distance);
    if needed < 1.0 {
        go(speed, cruise).min(0.0)
    } else {
        -needed
    }
}
