//! What the shield refuses to begin with.

use crate::decision::Reason;
use crate::fault::Fault;
use crate::junction::PathId;
use core::fmt;

/// Why an approach cannot begin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum EnterError {
    /// The junction has no such path, or has not prepared it to be entered.
    Path {
        /// Its number.
        path: PathId,
    },
    /// In a lane that the ego shares with another path, nobody could tell who is ahead: `position_error` of the contract
    /// is too large for it.
    PositionError {
        /// The other path.
        path: PathId,
        /// The contract's value in m.
        value: f32,
        /// It must be less than this (m): a quarter of the width of the lane's band, and of the two lengths together.
        below: f32,
    },
}

impl fmt::Display for EnterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Path { path } => write!(
                f,
                "path {} is not one that the junction lets an ego enter by",
                path.index()
            ),
            Self::PositionError { path, value, below } => write!(
                f,
                "position_error = {value} is outside [0, {below}): in the lane shared with path {} \
                 it would not tell who is ahead",
                path.index()
            ),
        }
    }
}

impl core::error::Error for EnterError {}

/// Why control cannot be handed over.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NotReady {
    /// The ego's state cannot be trusted.
    Fault(Fault),
    /// No plan is safe. What stands in the way of the one that goes farthest, by how many metres it falls short, and
    /// what is wrong with the tracks, if something is.
    NoPlan {
        /// What stands in the way.
        reason: Reason,
        /// Metres to spare of the best plan, negative.
        margin: f32,
        /// What is wrong with the tracks.
        fault: Option<Fault>,
    },
}

impl fmt::Display for NotReady {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fault(fault) => write!(f, "not ready: {fault}"),
            Self::NoPlan { reason, fault, .. } => {
                write!(f, "no plan is safe: {reason}")?;
                fault.map_or(Ok(()), |fault| write!(f, "; {fault}"))
            }
        }
    }
}

impl core::error::Error for NotReady {}
