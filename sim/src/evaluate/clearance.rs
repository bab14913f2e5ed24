//! Where the two vehicles have left their conflict zones.

use crate::meeting::Meeting;
use cede_controller::RouteConflict;
use cede_data::encounter::Role;

/// The arc lengths (m) at which the two have left the last of their conflict zones for good; where the
/// routes end in one lane, the routes' ends.
#[must_use]
pub fn clearance(meeting: &Meeting<'_>) -> [f32; 2] {
    Role::BOTH.map(|role| {
        let end = meeting.encounter.judged(role).route.length();
        let conflict = meeting.conflict(role as usize);
        // Where only the roads past the records meet, nobody was seen to drive.
        let zones = conflict.into_iter().flat_map(RouteConflict::zones);
        let zones = zones.filter(|zone| zone.ego.from < end);
        zones.map(|zone| zone.ego.to).fold(0.0, f32::max).min(end)
    })
}
