//! Encounters at unsignalized intersections, and the drivers that are judged on them.
#![forbid(unsafe_code)]

pub mod driver;
pub mod encounter;
pub mod kinematics;
pub mod overlap;

pub use driver::{Driver, DriverFactory, State, View};
pub use encounter::{Encounter, EncounterId, Manoeuvre, Participant, Role, Sample, SimRoute};
pub use kinematics::{advance, clamp_acceleration};
pub use overlap::OrientedBox;
