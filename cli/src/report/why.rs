//! The shield's reasons, in words.

use super::called::the;
use cede_controller::{Cause, Reason};
use cede_data::{Encounter, Role};
use serde::Serialize;

/// Classes of reasons for an intervention.
#[derive(Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Class {
    /// The other may arrive before the zone is cleared.
    Arrival,
    /// The other is in the zone.
    Occupied,
    /// There is no safe gap ahead of the other in its lane.
    Entry,
    /// The distance is just enough to stop.
    Stop,
    /// No command was safe.
    Fallback,
    /// Something that has no class here.
    Other,
}

impl Class {
    /// The class of `cause`; `None` if the shield did not deviate from the driver's command.
    pub(crate) fn of(cause: Cause) -> Option<Self> {
        match cause {
            Cause::Policy => None,
            Cause::Fallback(_) => Some(Self::Fallback),
            Cause::Shielded(intervention) => Some(match intervention.reason {
                Reason::Arrival { arrives, .. } if arrives > 0.0 => Self::Arrival,
                Reason::Arrival { .. } => Self::Occupied,
                Reason::Entry { .. } => Self::Entry,
                Reason::Stop { .. } => Self::Stop,
                _ => Self::Other,
            }),
            _ => Some(Self::Other),
        }
    }
}

/// `cause` in words, as the shield of the vehicle in `role` would log it.
pub(crate) fn words(encounter: &Encounter, role: Role, cause: Cause) -> String {
    let rival = match role {
        Role::Left => Role::Other,
        Role::Other => Role::Left,
    };
    match cause {
        Cause::Shielded(intervention) => {
            let rival = the(encounter, rival);
            format!("shielded: {}", intervention.reason.naming(&rival))
        }
        _ => cause.to_string(),
    }
}
