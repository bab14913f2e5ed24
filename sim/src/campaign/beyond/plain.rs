//! The plain rule that the shield is compared with: brake if two times overlap.

use crate::campaign::scenario::Scenario;
use crate::meeting::path;
use cede_controller::kinematics::State;
use cede_controller::{RouteConflict, Zone};

/// Braking of the rule in m/s².
const BRAKING: f32 = 3.0;

/// Time (s) to a collision with a leader below which it brakes.
const TIME_TO_COLLISION: f32 = 3.0;

/// `proposal` (m/s²), or braking if vehicle 0 and another one would be in a zone at the same time, both at the speeds
/// that they have. `seen`: the sensed states, the ego's first; `None` for who is not seen.
pub(super) fn filter(scenario: &Scenario, seen: &[Option<State>], proposal: f32) -> f32 {
    let Some(Some(ego)) = seen.first() else {
        return -BRAKING;
    };
    let others = seen.iter().enumerate().skip(1);
    let brakes = others
        .filter_map(|(i, state)| Some((i, state.as_ref()?)))
        .any(|(i, other)| {
            let conflict = scenario.junction.conflict(path(0), path(i));
            let mut zones = conflict.into_iter().flat_map(RouteConflict::zones);
            zones.any(|zone| meets(zone, ego, other))
        });
    if brakes { -BRAKING } else { proposal }
}

fn meets(zone: &Zone, ego: &State, other: &State) -> bool {
    if zone.is_lane() && ego.s >= zone.ego.from && other.s >= zone.other.from {
        let gap = zone.lead.from - (ego.s - other.s);
        let closing = ego.v - other.v;
        return gap >= 0.0 && closing > 0.0 && gap < TIME_TO_COLLISION * closing;
    }
    let times = |from: f32, to: f32, state: &State| {
        let speed = state.v.max(0.1);
        [
            (from - state.s) / speed,
            (to.min(from + 20.0) - state.s) / speed,
        ]
    };
    let mine = times(zone.ego.from, zone.ego.to, ego);
    let theirs = times(zone.other.from, zone.other.to, other);
    // One that is in the zone already does not mend it by braking.
    mine[0] > 0.0 && theirs[1] > 0.0 && mine[0] < theirs[1] && theirs[0] < mine[1]
}
