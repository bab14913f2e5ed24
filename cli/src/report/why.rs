//! Why the shield acted, for people.

use cede_controller::{Cause, Reason};
use cede_data::Role;
use serde::Serialize;

/// What made the shield act, in classes that can be counted.
#[derive(Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Class {
    /// The other may arrive before the zone is cleared.
    Arrival,
    /// The other is in the zone.
    Occupied,
    /// There is no safe gap ahead of the other in its lane.
    Entry,
    /// There is hardly room to stop.
    Stop,
    /// Nothing was safe.
    Fallback,
    /// Something that has no class here.
    Other,
}

impl Class {
    /// The class of `cause`; `None` if the driver was not overruled.
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
pub(crate) fn words(role: Role, cause: Cause) -> String {
    let rival = match role {
        Role::Left => "the other",
        Role::Other => "the left-turner",
    };
    match cause {
        Cause::Shielded(intervention) => {
            format!("shielded: {}", intervention.reason.naming(rival))
        }
        _ => cause.to_string(),
    }
}
