//! Where vehicles go, and where they can touch: routes, the zones of two routes, the scene of all of them.

pub mod conflict;
pub mod route;
pub mod scene;
pub mod zone;

pub use conflict::ConflictKind;
pub use route::{Route, RouteError};
pub use scene::{Path, RouteConflict, Scene, SceneError};
pub use zone::{Span, Zone};
