//! The words by which Python names classes, controls and priorities.

use crate::error::named;
use cede_controller::{Class, Control, Priority};
use pyo3::prelude::*;

const CLASSES: [(&str, Class); 4] = [
    ("car", Class::Car),
    ("lorry", Class::Lorry),
    ("bicycle", Class::Bicycle),
    ("pedestrian", Class::Pedestrian),
];

pub(crate) const CONTROLS: [(&str, Control); 5] = [
    ("unknown", Control::Unknown),
    ("free", Control::Free),
    ("yield", Control::Yield),
    ("stop", Control::Stop),
    ("all-way-stop", Control::AllWayStop),
];

pub(crate) const PRIORITIES: [(&str, Priority); 3] = [
    ("first-come", Priority::FirstCome),
    ("unsigned", Priority::Unsigned),
    ("signed", Priority::Signed),
];

pub(crate) fn control_name(control: Control) -> &'static str {
    let found = CONTROLS.iter().find(|(_, known)| *known == control);
    found.map_or("unknown", |(name, _)| name)
}

pub(crate) fn class_named(name: &str) -> PyResult<Class> {
    named("kind", name, &CLASSES)
}
