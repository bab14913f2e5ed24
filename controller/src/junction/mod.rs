//! Where vehicles go, and where they can touch: routes, the zones of two routes, the scene of all of them.

pub(crate) mod conflict;
pub(crate) mod route;
pub(crate) mod scene;
pub mod zone;

pub use conflict::{ConflictKind, RightOfWay};
pub use route::{Route, RouteError};
pub use scene::{CONFLICT_RADIUS, MAX_OTHERS, Path, RouteConflict, Scene, SceneError};
pub use zone::{Span, Zone};
