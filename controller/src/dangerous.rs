//! Ways around what the types promise, for proofs and for tests that plant errors. Nothing here may drive.
//!
//! A campaign must notice a shield with a single broken rule; [`Rules`] is where it is broken:
//!
//! ```
//! use cede_controller::dangerous::Rules;
//! use cede_controller::{Contract, EnterError, Junction, PathId, Plan, Shield};
//!
//! /// Forgets that a command of the plan was carried out.
//! struct StalePlan;
//! impl Rules for StalePlan {
//!     fn tail(plan: Plan) -> Plan {
//!         plan
//!     }
//! }
//! fn broken(junction: &Junction<4, 64>, path: PathId) -> Result<Shield<'_, 8, StalePlan>, EnterError> {
//!     Shield::with_rules(Contract::WORST_CASE, junction, path)
//! }
//! ```

pub use crate::shield::rules::{Rules, Sound};

/// The rule of precedence as it flies, for a model checker: what one shield remembers of two vehicles.
pub mod precedence {
    pub use crate::shield::precedence::{PairMemory, Right};
    pub use crate::shield::waiting::{Arrival, Presence, RestState, Sighting};
}

use crate::shield::{Contract, ContractBuilder};

/// A contract whose numbers nobody has checked: a solver puts stand-ins there, a test leaves out what it tests.
#[must_use]
pub const fn unchecked(builder: ContractBuilder) -> Contract {
    builder.unchecked()
}
