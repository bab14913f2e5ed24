//! Why a call is refused.

use cede_controller::{ContractError, EnterError, JunctionError, RouteError};
use core::fmt;

/// Why a call is refused. Nothing is changed then.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// There is no such call.
    Call,
    /// Words are missing.
    Short,
    /// A word that chooses has no such choice.
    Choice,
    /// More tracks than a desk takes.
    Tracks,
    /// The junction is not built yet, or has no such path.
    NotBuilt,
    /// The junction is built already.
    Built,
    /// Nobody drives yet.
    NotEntered,
    /// The points are no route.
    Route(RouteError),
    /// The paths are no junction.
    Junction(JunctionError),
    /// The approach cannot begin, or not go on.
    Enter(EnterError),
    /// The numbers are no contract.
    Contract(ContractError),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Call => f.write_str("no such call"),
            Self::Short => f.write_str("words are missing"),
            Self::Choice => f.write_str("no such choice"),
            Self::Tracks => f.write_str("too many tracks"),
            Self::NotBuilt => f.write_str("the junction is not built, or has no such path"),
            Self::Built => f.write_str("the junction is built already"),
            Self::NotEntered => f.write_str("nobody drives yet"),
            Self::Route(error) => error.fmt(f),
            Self::Junction(error) => error.fmt(f),
            Self::Enter(error) => error.fmt(f),
            Self::Contract(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for Refusal {}

impl From<RouteError> for Refusal {
    fn from(error: RouteError) -> Self {
        Self::Route(error)
    }
}

impl From<JunctionError> for Refusal {
    fn from(error: JunctionError) -> Self {
        Self::Junction(error)
    }
}

impl From<EnterError> for Refusal {
    fn from(error: EnterError) -> Self {
        Self::Enter(error)
    }
}

impl From<ContractError> for Refusal {
    fn from(error: ContractError) -> Self {
        Self::Contract(error)
    }
}
