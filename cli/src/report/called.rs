//! What the two judged vehicles of an encounter are called.

use cede_data::{Encounter, Manoeuvre, Role};

/// What the vehicle in `role` is called. Only who turns left is a left-turner: at some sites vehicles that do not have
/// this role, too.
pub(crate) fn called(encounter: &Encounter, role: Role) -> String {
    match role {
        Role::Left if turns_left(encounter) => "left-turner".to_owned(),
        Role::Left => format!("vehicle {}", encounter.id.left),
        Role::Other => "other".to_owned(),
    }
}

/// The same within a sentence.
pub(super) fn the(encounter: &Encounter, role: Role) -> String {
    let name = called(encounter, role);
    match role {
        Role::Left if !turns_left(encounter) => name,
        _ => format!("the {name}"),
    }
}

fn turns_left(encounter: &Encounter) -> bool {
    encounter.judged(Role::Left).manoeuvre == Manoeuvre::Left
}
