//! Where vehicles go, and where they can touch: routes, the zones of two routes, the junction of all of them.

mod builder;
pub(crate) mod conflict;
mod control;
mod error;
pub(crate) mod kind;
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

pub use builder::JunctionBuilder;
pub use conflict::{Priority, RightOfWay, RouteConflict};
pub use control::Control;
pub use error::JunctionError;
pub use kind::ConflictKind;
pub use meeting::CONFLICT_RADIUS;
pub use path::{
    Class, MAX_FOOTPRINT, MAX_LIMITS, MAX_PACE, MAX_PATH_LENGTH, MAX_SPEED_LIMIT, PACE, Path,
    PathId, SpeedLimit,
};
pub use polyline::Polyline;
pub use prepared::{Junction, MAX_LATERAL, MAX_TOLERANCE};
pub use profile::{COMFORT, Profile};
pub use route::{Route, RouteError};
pub use way::Way;
pub use zone::{Span, Zone};

/// Most others that a shield watches at once, each on one path: 8, or 24 with the feature `many-others`.
pub const MAX_OTHERS: usize = if cfg!(feature = "many-others") { 24 } else { 8 };
