//! Where vehicles go, and where they can touch: routes, the zones of two routes, the junction of all of them.

mod builder;
pub(crate) mod conflict;
mod control;
mod error;
mod meeting;
mod path;
mod polyline;
mod prepared;
mod profile;
pub(crate) mod route;
#[cfg(test)]
mod tests;
mod way;
pub mod zone;

pub use builder::{JunctionBuilder, MAX_LATERAL, MAX_TOLERANCE};
pub use conflict::{ConflictKind, Priority, RightOfWay, RouteConflict};
pub use control::Control;
pub use error::JunctionError;
pub use meeting::CONFLICT_RADIUS;
pub use path::{
    Class, MAX_FOOTPRINT, MAX_LIMITS, MAX_PACE, MAX_PATH_LENGTH, MAX_SPEED_LIMIT, PACE, Path,
    PathId, SpeedLimit,
};
pub use polyline::Polyline;
pub use prepared::Junction;
pub use profile::{COMFORT, Profile};
pub use route::{Route, RouteError};
pub use way::Way;
pub use zone::{Span, Zone};

/// Most others that a shield watches at once, each on one path: 8, or 24 with the feature `many-others`.
pub const MAX_OTHERS: usize = if cfg!(feature = "many-others") { 24 } else { 8 };
