//! Every state that two or three vehicles and their shields' memories of precedence can be in, within stated bounds.
//!
//! What is run is the controller's own code (`cede_controller::dangerous::precedence`); only the world around it is a
//! model. Time goes in steps, a few a period. In each step every vehicle does anything that is physically possible,
//! and every shield that is due senses anything that its errors allow.
//!
//! What is bounded, and by which field of [`Setting`]: by when all have arrived (`arrive_by`), how often something
//! unusual happens (`disturbances`), and for how long all rest (`longest`). Within that the search is exhaustive, but for
//! two states of one 64-bit hash.

pub mod body;
pub mod broken;
pub mod deadlock;
pub mod search;
pub mod setting;
pub mod suite;
pub mod watch;
pub mod world;

pub use search::{Outcome, search};
pub use setting::Setting;
pub use world::Watched;
