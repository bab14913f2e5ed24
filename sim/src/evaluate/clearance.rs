//! Where the two vehicles have left their conflict zone.

use crate::encounter::{Encounter, Role, SimRoute};
use crate::overlap::OrientedBox;
use cede_controller::Footprint;

/// Routes are searched in steps of this many metres.
const SPACING: f32 = 0.5;

/// The arc lengths (m) beyond which the two footprints cannot touch any more, wherever the
/// other is on its route; where the routes end in one lane, the routes' ends.
#[must_use]
pub fn clearance(encounter: &Encounter) -> [f32; 2] {
    let routes = Role::BOTH.map(|role| &encounter.judged(role).route);
    let swept = routes.map(boxes);
    [0, 1].map(|i: usize| {
        let last = swept[i]
            .iter()
            .rposition(|own| swept[1 - i].iter().any(|other| own.overlaps(other)));
        last.map_or(0.0, |last| {
            ((last + 1) as f32 * SPACING).min(routes[i].length())
        })
    })
}

fn boxes(route: &SimRoute) -> Vec<OrientedBox> {
    let count = (route.length() / SPACING).ceil() as u16;
    (0..=count)
        .map(|i| {
            let pose = route.pose(f32::from(i) * SPACING);
            OrientedBox::new(pose, Footprint::PAPER)
        })
        .collect()
}
