//! The safety file, `docs/safety/`: hazards and goals, requirements, assumptions of use, and what each of them is
//! tied to.

mod defects;
mod model;
mod places;

pub(crate) use defects::{Known, defects};
#[cfg(test)]
pub(crate) use model::EvidenceNames;
pub(crate) use model::{Assumption, Evidence, Hazards, Kind, Requirement, SafetyFile};
