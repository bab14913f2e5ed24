//! Where the two vehicles have left their conflict zones.

use crate::observation_model::scene;
use cede_controller::RouteConflict;
use cede_data::encounter::{Encounter, Role};

/// The arc lengths (m) at which the two have left the last of their conflict zones for good; where the
/// routes end in one lane, the routes' ends.
#[must_use]
pub fn clearance(encounter: &Encounter) -> [f32; 2] {
    Role::BOTH.map(|role| {
        let scene = scene(encounter, role as usize);
        let zones = scene
            .iter()
            .flat_map(|scene| scene.conflicts().iter().flat_map(RouteConflict::zones));
        let last = zones.map(|zone| zone.ego.to).fold(0.0, f32::max);
        last.min(encounter.judged(role).route.length())
    })
}
