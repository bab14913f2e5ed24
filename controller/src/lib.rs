//! Decides how a vehicle crosses an unsignalized intersection.
//!
//! `no_std`, no allocation, no `unsafe`, no recursion. No function panics, whatever the bits of its
//! arguments; where nothing else is said, its cost is constant. SI units
//! throughout (m, s, rad, m/s, m/s²); headings counter-clockwise from +x; arc
//! length `s` along a [`Route`]; a vehicle's reference point is the centre of
//! its footprint.
//!
//! # On an ECU
//!
//! At start-up, [`Policy::new`] checks the weights where they lie in flash, and [`Drive`] keeps what drives at every
//! intersection. A [`Junction`] is its paths: its geometry is computed once. [`Drive::enter`] begins an [`Approach`],
//! which lives until the ego has left that junction. Every 100 ms,
//! [`Approach::decide`] turns what is sensed into an acceleration, and says why. What must hold for its
//! guarantee is in the [`Contract`]: put your vehicle's numbers there.
//!
#![cfg_attr(feature = "embedded-policy", doc = "```")]
#![cfg_attr(not(feature = "embedded-policy"), doc = "```ignore")]
//! use cede_controller::{
//!     Cause, Class, Contract, Drive, Footprint, Instant, Junction, Observation, Part, Point, Policy, Route, Track, Vehicle,
//! };
//!
//! // From the map, in metres: the ego turns left, the oncoming vehicle goes straight on.
//! let mine = Route::<8>::new(
//!     [(-40.0, -2.0), (-6.0, -2.0), (0.0, 0.0), (2.0, 6.0), (2.0, 40.0)].map(|(x, y)| Point::new(x, y)),
//! )?;
//! let theirs = Route::<8>::new([(40.0, 2.0), (-40.0, 2.0)].map(|(x, y)| Point::new(x, y)))?;
//! let car = Footprint { length: 4.6, width: 1.9 };
//! let mut builder = Junction::<2, 16>::builder();
//! let left = builder.path(&mine, Class::Car, car)?;
//! let oncoming = builder.path(&theirs, Class::Car, car)?;
//! builder.right_of_way(oncoming, left)?;
//! let junction = builder.build()?;
//!
//! // Once: the policy that ships, or `include_weights!("own.cede")`; and this vehicle's brakes.
//! let policy = Policy::new(cede_controller::policy::embedded::words())?;
//! let contract = Contract::builder().ego_braking(4.0).build()?;
//! let drive = Drive::new(policy, contract, Part::Left);
//!
//! // At each intersection; every 100 ms from localisation and tracking: arc length and speed along the path, and the pose.
//! let mut approach = drive.enter(&junction, left)?;
//! let sensed = |route: &Route<8>, s: f32, speed: f32| Vehicle { s, speed, pose: route.pose(s) };
//! let tracks = [Track::on(17, oncoming, sensed(&theirs, 20.0, 8.0))]; // in any order; 17 is tracking's number
//! let seen = Observation { ego: sensed(&mine, 15.0, 6.0), tracks: &tracks };
//! let now = Instant::from_millis(1_000);
//! approach.ready(now, &seen)?; // before control is handed over
//! let decision = approach.decide(now, &seen);
//!
//! let command = decision.acceleration; // m/s², to the longitudinal actuator
//! assert!((-4.0..=3.0).contains(&command));
//! match decision.cause {
//!     Cause::Policy => {}
//!     // The decision displays as a line for the log: "shielded: other 17 may arrive in 1.3 s, …".
//!     _ => { /* log(format_args!("{decision}")) */ }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where things are
//!
//! What drives is here at the root. The modules hold the formulas and constants that others build on:
//!
//! | | |
//! |---|---|
//! | [`geometry`] | points, vectors, directions, poses, footprints |
//! | [`junction`] | where two routes can touch, and who may go first there |
//! | [`policy`] | features, SVO, network, weights file, the policy that ships |
//! | [`shield`] | margins and reach, as proved |
//! | [`kinematics`], [`separation`] | one step of motion, and whether two footprints touch |
//! | [`dangerous`] | for proofs, and for tests that plant errors |
//!
//! # Features
//!
//! All but the last only add.
//!
//! | | |
//! |---|---|
//! | `embedded-policy` (default) | the policy that ships, `policy::embedded`: 24 KiB |
//! | `serde` | contracts and decisions as serde data; a contract that is read is validated |
//! | `defmt` | contracts and decisions in a `defmt` log |
//! | `many-others` | room for 24 others instead of 8, for hosts |
//! | `estimates` | the orientations that others show, estimated online: `Approach::set_estimates` |
//! | `core-sqrt` | square roots by the core, where it has an instruction for them: the same bits in less time |
//! | `micromath` | tanh and atan2 by micromath: in fewer instructions, with other bits, so that decisions differ from those of every build without it |
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod approach;
#[cfg(any(test, feature = "micromath"))]
mod coarse;
pub mod dangerous;
mod decision;
mod fault;
pub mod geometry;
mod headroom;
mod instant;
pub mod junction;
pub mod kinematics;
mod observation;
mod plan;
pub mod policy;
mod real;
pub mod separation;
pub mod shield;

pub use approach::{Approach, Drive, FREE, GENTLE};
pub use decision::{Action, Breach, Cause, Decision, Intervention, Prediction, Reason};
pub use fault::{Fault, Field, InputFault, Subject};
pub use geometry::{Footprint, Point, Pose, UnitVector, Vector};
pub use headroom::{Condition, Headroom, Room};
pub use instant::Instant;
pub use junction::{
    CONFLICT_RADIUS, Class, ConflictKind, Control, Junction, JunctionBuilder, JunctionError,
    MAX_OTHERS, Path, PathId, Polyline, Priority, Profile, RightOfWay, Route, RouteConflict,
    RouteError, Span, SpeedLimit, Way, Zone,
};
pub use observation::{Candidate, MAX_CANDIDATES, Observation, Sight, Track, Vehicle};
pub use policy::{
    Crosser, Estimate, FeatureSet, FixedMlp, Leader, Mlp, NearbyVehicle, Network, Orientation,
    OrientationError, OrientationFilter, Pair, Part, Perspective, Policy, TrafficContext,
    VehicleState, Weights, WeightsError,
};
pub use real::{Elementary, Real};
pub use separation::OrientedBox;
pub use shield::{
    Bounds, Contract, ContractBuilder, ContractError, Ego, EnterError, Follower, MAX_SIGHTS,
    NotReady, Other, Plan, Precedence, Shield, SightError,
};
