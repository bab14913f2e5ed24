//! Decides how a vehicle crosses an unsignalized intersection.
//!
//! `no_std`, no allocation, no `unsafe`, no panic, no recursion. SI units
//! throughout (m, s, rad, m/s, m/s²); headings counter-clockwise from +x; arc
//! length `s` along a [`Route`]; a vehicle's reference point is the centre of
//! its footprint.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod conflict;
pub mod controller;
pub mod decision;
pub mod embedded;
pub mod features;
pub mod geometry;
pub mod mlp;
pub mod observation;
pub mod pair;
pub mod policy;
pub mod route;
pub mod scene;
pub mod shield;
pub mod surroundings;
pub mod svo;
pub mod weights;
pub mod zone;

pub use conflict::ConflictKind;
pub use controller::Controller;
pub use decision::{Action, Breach, Cause, Decision, Intervention, Outlook, Reason};
pub use features::FeatureSet;
pub use geometry::{Footprint, Point, Pose};
pub use mlp::Mlp;
pub use observation::{Fault, Observation, Vehicle};
pub use pair::{Crosser, Leader, Pair, Part, Party, RightOfWay};
pub use policy::Policy;
pub use route::{Route, RouteError};
pub use scene::{Meeting, Path, Scene, SceneError};
pub use shield::{Contract, ContractError, Plan, Shield};
pub use surroundings::{Around, Surroundings};
pub use weights::{Perspective, Weights, WeightsError};
pub use zone::{Interval, Zone};
