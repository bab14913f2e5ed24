//! x
pub mod actuator;
pub mod error;
pub mod motion;
pub mod plane;
pub mod polyline;
pub mod rng;
pub mod sketch;
pub mod sway;
