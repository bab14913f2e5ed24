//! How the SVO of the left-turner develops, and how far it strays from the record.
//!
//! The other's SVO is the complement to π/2, so its error is the same.

use super::deviation::root_mean;
use crate::episode::Episode;
use cede_controller::kinematics::State;
use cede_controller::policy::svo::{self, svo};
use cede_data::encounter::{Encounter, Role};

/// The left-turner's SVO (rad) towards the other in each of `states`, until one of the two has
/// reached its conflict point.
///
/// While both are at rest the last SVO is kept; before that it is π/4.
pub fn svo_series<'a>(
    encounter: &'a Encounter,
    states: impl Iterator<Item = [State; 2]> + 'a,
) -> impl Iterator<Item = f32> + 'a {
    states.scan(svo::FIRST, |last, [left, other]| {
        let distance = |role, state: State| encounter.judged(role).conflict_s - state.s;
        let d = distance(Role::Left, left);
        let other_d = distance(Role::Other, other);
        if d <= 0.0 || other_d <= 0.0 {
            return None;
        }
        *last = svo(left.v, d, other.v, other_d, *last);
        Some(*last)
    })
}

/// The recorded states of the two judged vehicles, step by step, while both records last.
pub fn recorded_states(encounter: &Encounter) -> impl Iterator<Item = [State; 2]> + '_ {
    let [left, other] = Role::BOTH.map(|role| encounter.judged(role).record.iter());
    left.zip(other).map(|(left, other)| {
        [left, other].map(|sample| State {
            s: sample.s,
            v: sample.v,
        })
    })
}

/// Root mean square error (rad) of the SVO while driven as well as recorded it is defined.
pub(super) fn error(encounter: &Encounter, episode: &Episode) -> Option<f64> {
    let driven = svo_series(encounter, episode.states.iter().copied());
    let recorded = svo_series(encounter, recorded_states(encounter));
    root_mean(driven.zip(recorded).map(|(a, b)| f64::from(a - b).powi(2)))
}
