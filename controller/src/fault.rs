//! What is wrong with an input, or with what is left to do.

use core::fmt;

/// Why the controller cannot trust an input, or has nothing safe to do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Fault {
    /// No plan keeps the guarantee: the contract was broken, or control was handed over in danger.
    NoPlan,
    /// A number of the observation is out of its range.
    Input(InputFault),
    /// The call's time is not later than that of the last call.
    Backwards,
    /// The last call is not one period ago, within the contract's jitter.
    OffPeriod {
        /// Seconds since the last call.
        elapsed: f32,
        /// The contract's period in seconds.
        period: f32,
    },
    /// The proposed acceleration is not a finite number.
    Proposal,
}

/// A number of an observation that is out of its range.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct InputFault {
    /// Whose.
    pub subject: Subject,
    /// Which number.
    pub field: Field,
    /// What it is; perhaps not a number.
    pub value: f32,
    /// The least that is accepted.
    pub low: f32,
    /// The most that is accepted.
    pub high: f32,
}

/// Whose state it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Subject {
    /// The vehicle that is driven.
    Ego,
    /// The track with this number.
    Track(u16),
}

/// A number of a vehicle's state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Field {
    /// Arc length in m, outside the path.
    ArcLength,
    /// Speed in m/s.
    Speed,
    /// The coordinate (m) that is farther from 0.
    Position,
    /// Length of the direction, which is not a unit vector.
    Direction,
    /// Metres between the pose and where the path is at that arc length.
    Offset,
    /// Cosine of the angle between the direction and that of the path.
    Heading,
    /// Number of a path that the junction does not have, or that has another class than the track.
    Path,
    /// Number of a track that the observation has twice, on one path.
    Number,
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ego => f.write_str("the ego"),
            Self::Track(number) => write!(f, "track {number}"),
        }
    }
}

impl Field {
    const fn name(self) -> &'static str {
        match self {
            Self::ArcLength => "arc length (m)",
            Self::Speed => "speed (m/s)",
            Self::Position => "coordinate (m)",
            Self::Direction => "length of the direction",
            Self::Offset => "distance (m) of the pose from its place on the path",
            Self::Heading => "cosine of the angle to the path",
            Self::Path => "path of this class",
            Self::Number => "number, which is there twice,",
        }
    }
}

impl fmt::Display for InputFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            subject,
            value,
            low,
            high,
            ..
        } = self;
        let field = self.field.name();
        write!(f, "{subject}: {field} {value} is outside [{low}, {high}]")
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPlan => f.write_str("no plan is safe"),
            Self::Input(input) => input.fmt(f),
            Self::Backwards => f.write_str("the time of the call is before that of the last one"),
            Self::OffPeriod { elapsed, period } => write!(
                f,
                "the last call was {elapsed:.3} s ago instead of {period:.3} s"
            ),
            Self::Proposal => f.write_str("the proposed acceleration is not a finite number"),
        }
    }
}

impl core::error::Error for InputFault {}
impl core::error::Error for Fault {}
