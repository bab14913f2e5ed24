//! Decides how a vehicle crosses an unsignalized intersection.
//!
//! `no_std`, no allocation, no `unsafe`, no panic, no recursion. SI units
//! throughout (m, s, rad, m/s, m/s²); headings counter-clockwise from +x; arc
//! length `s` along a [`Route`]; a vehicle's reference point is the centre of
//! its footprint.
#![no_std]
#![forbid(unsafe_code)]

pub mod conflict;
pub mod features;
pub mod geometry;
pub mod mlp;
pub mod pair;
pub mod policy;
pub mod route;
pub mod svo;
pub mod weights;

pub use conflict::ConflictKind;
pub use features::FeatureSet;
pub use geometry::{Footprint, Point, Pose};
pub use mlp::Mlp;
pub use pair::{Leader, Pair, Part, Party, RightOfWay};
pub use policy::Policy;
pub use route::{Route, RouteError};
pub use weights::{Perspective, Weights, WeightsError};
