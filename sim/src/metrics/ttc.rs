//! Time to collision: when the two would touch if both kept their speeds.

use cede_controller::Footprint;
use cede_controller::geometry::distance;
use cede_controller::kinematics::{STEP, State};
use cede_controller::separation::OrientedBox;
use cede_data::encounter::{Encounter, Role};

/// Times to collision beyond this many seconds count as none.
pub const HORIZON: f32 = 5.0;

/// The least time to collision (s) over `states` of vehicles with these `bodies`, in steps of 0.1 s, and the step at
/// which it is first so small; 0 if they touch. `None` above [`HORIZON`].
#[must_use]
pub fn least_ttc(
    encounter: &Encounter,
    states: &[[State; 2]],
    bodies: [Footprint; 2],
) -> Option<(usize, f64)> {
    let mut least: Option<(usize, u32)> = None;
    for (step, &now) in states.iter().enumerate() {
        // Only what is sooner than the least so far matters.
        let horizon = least.map_or((HORIZON / STEP) as u32 + 1, |(_, ahead)| ahead);
        if let Some(ahead) = (0..horizon).find(|&ahead| touch(encounter, now, bodies, ahead)) {
            least = Some((step, ahead));
        }
    }
    least.map(|(step, ahead)| (step, f64::from(ahead) * f64::from(STEP)))
}

/// Whether the two touch `ahead` steps after `states` at constant speed.
fn touch(encounter: &Encounter, states: [State; 2], bodies: [Footprint; 2], ahead: u32) -> bool {
    let time = ahead as f32 * STEP;
    let [left, other] = Role::BOTH.map(|role| {
        let state = states[role as usize];
        encounter.judged(role).route.pose(state.s + state.v * time)
    });
    let reach = half_diagonal(bodies[0]) + half_diagonal(bodies[1]);
    distance(&left.position, &other.position) <= reach
        && OrientedBox::new(left, bodies[0]).overlaps(&OrientedBox::new(other, bodies[1]))
}

/// From the middle of a footprint to its corners (m).
pub(crate) fn half_diagonal(body: Footprint) -> f32 {
    0.5 * libm::hypotf(body.length, body.width)
}
