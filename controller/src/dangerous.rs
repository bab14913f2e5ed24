//! Ways around what the types promise, for proofs and for tests that plant errors. Nothing here may drive.
//!
//! A campaign must notice a shield with a single broken rule; [`Rules`] is where it is broken:
//!
//! ```
//! use cede_controller::dangerous::Rules;
//! use cede_controller::{Contract, Plan, Shield};
//!
//! /// Forgets that a command of the plan was carried out.
//! struct StalePlan;
//! impl Rules for StalePlan {
//!     fn tail(plan: Plan) -> Plan {
//!         plan
//!     }
//! }
//! let broken = Shield::<8, StalePlan>::with_rules(Contract::WORST_CASE);
//! # assert_eq!(broken.plan(), None);
//! ```

pub use crate::shield::rules::{Rules, Sound};

use crate::shield::{Contract, ContractBuilder};

/// A contract whose numbers nobody has checked: a solver puts stand-ins there, a test leaves out what it tests.
#[must_use]
pub const fn unchecked(builder: ContractBuilder) -> Contract {
    builder.unchecked()
}
