//! What the controller decides, and why.

use crate::fault::Fault;
use crate::headroom::Headroom;
use crate::plan::Plan;
#[cfg(feature = "estimates")]
use crate::policy::Estimate;
use core::fmt;

/// The ego's acceleration for the period that begins, and why it is what it is.
///
/// Displays as one line for a log, as in
/// `shielded: other 2 may arrive in 1.3 s, clearing needs 1.9 s`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Decision {
    /// The acceleration in m/s²; always finite, and within [−braking, acceleration] of the contract's ego.
    pub acceleration: f32,
    /// Who decided.
    pub cause: Cause,
    /// Metres to spare of the best plan that follows; negative if no plan is safe. Not a number is
    /// never; without an observation that can be trusted it is 0.
    pub margin: f32,
    /// The plan that is carried out if nothing better is found; none is no guarantee.
    pub plan: Option<Plan>,
    /// A motion since the last decision that exceeds the contract's bounds.
    pub breach: Option<Breach>,
    /// What is wrong with the inputs, if something is. A track with a fault counts as not seen.
    pub fault: Option<Fault>,
    /// Number of a track that matters and for which there is no room: the ego stays out of its zones.
    pub unwatched: Option<u16>,
    /// What the policy thinks of the other that restricts the ego most, if it was asked.
    pub prediction: Option<Prediction>,
    /// How near each monitored condition of the contract is to its limit.
    #[cfg_attr(feature = "serde", serde(default))]
    pub headroom: Headroom,
}

/// What the policy thinks of one other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Prediction {
    /// Track number of the other.
    pub other: u16,
    /// The ego's social value orientation towards it in rad, in [0, π/2].
    pub svo: f32,
    /// The acceleration (m/s²) that is expected of it, within ± 3.
    pub acceleration: f32,
    /// The orientation that it has shown, if that is [estimated](crate::Approach::set_estimates).
    #[cfg(feature = "estimates")]
    #[cfg_attr(feature = "serde", serde(default))]
    pub shown: Option<Estimate>,
}

/// Who decided.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Cause {
    /// The policy: its proposal is safe.
    Policy,
    /// The shield: the proposal is not.
    Shielded(Intervention),
    /// Neither of them. [`Fault::NoPlan`], before everything else, if no plan is safe: the ego brakes; if it stands in
    /// crossing zones whose others are all outside, and nobody stands in its way, it accelerates to leave them. Another
    /// fault if the ego's own state or the call's time cannot be trusted: it carries on with the plan that was verified
    /// last. [`Fault::Proposal`] if only the proposal is at fault: it counted as braking, or as the limit on its side.
    Fallback(Fault),
}

/// What the shield did instead, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Intervention {
    /// What it did.
    pub action: Action,
    /// What the proposal would have led to.
    pub reason: Reason,
}

/// What the shield does instead of what was proposed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Action {
    /// The nearest acceleration that is safe.
    Nearest,
    /// The next command of the plan that was verified last.
    Remembered,
}

/// Why a proposal is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Reason {
    /// The ego could not clear the zone before the other's earliest arrival.
    Arrival {
        /// Track number of the other.
        other: u16,
        /// The other's earliest arrival, s from now.
        arrives: f32,
        /// When the ego would have cleared the zone, s from now.
        clears: f32,
    },
    /// The ego would enter the other's lane without the gap in which the other can stop.
    Entry {
        /// Track number of the other.
        other: u16,
        /// The gap on entry in m; negative if the other is ahead by then.
        gap: f32,
        /// The gap that is needed in m.
        needs: f32,
    },
    /// The ego could not stop short of the other's zone, or behind the other in its lane.
    Stop {
        /// Track number of the other.
        other: u16,
        /// Metres to where it must be at rest; negative if it is past that.
        available: f32,
        /// Metres that it needs.
        needs: f32,
    },
    /// The ego could not clear the zone before somebody arrives who may be out of sight.
    Hidden {
        /// Number of the path on which that is.
        path: u8,
        /// Their earliest arrival, s from now.
        arrives: f32,
        /// When the ego would have cleared the zone, s from now.
        clears: f32,
    },
}

/// Whose motion since the last decision exceeds the contract's bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Breach {
    /// The ego deviated from the command.
    Ego,
    /// The track with this number exceeds the contract's motion bounds.
    Other(u16),
}

impl Decision {
    /// Of no more than the ego's `acceleration` (m/s²): nothing is safe, and nothing else is known.
    pub(crate) const fn none(acceleration: f32) -> Self {
        Self {
            acceleration,
            cause: Cause::Fallback(Fault::NoPlan),
            margin: 0.0,
            plan: None,
            breach: None,
            fault: None,
            unwatched: None,
            prediction: None,
            headroom: Headroom::NONE,
        }
    }
}

impl fmt::Display for Decision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.cause.fmt(f)?;
        match self.breach {
            None => {}
            Some(Breach::Ego) => f.write_str("; the ego deviated from the command")?,
            Some(Breach::Other(other)) => {
                write!(f, "; other {other} exceeds the contract's motion bounds")?;
            }
        }
        match self.fault {
            Some(fault) if self.cause != Cause::Fallback(fault) => write!(f, "; {fault}")?,
            _ => {}
        }
        match self.unwatched {
            Some(other) => write!(f, "; no room to watch other {other}"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Policy => f.write_str("policy"),
            Self::Shielded(Intervention { reason, .. }) => write!(f, "shielded: {reason}"),
            Self::Fallback(fault) => write!(f, "fallback: {fault}"),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Arrival { other, .. } | Self::Entry { other, .. } | Self::Stop { other, .. } => {
                self.tell(f, format_args!("other {other}"))
            }
            Self::Hidden { path, .. } => {
                self.tell(f, format_args!("somebody out of sight on path {path}"))
            }
        }
    }
}

impl Reason {
    /// The reason in words, with `other` for whom it is about: `the lorry may arrive in 1.3 s, …`.
    pub fn naming<'n>(&self, other: &'n str) -> impl fmt::Display + use<'n> {
        Named(*self, other)
    }

    fn tell(&self, f: &mut fmt::Formatter<'_>, who: fmt::Arguments<'_>) -> fmt::Result {
        match *self {
            Self::Arrival {
                arrives, clears, ..
            }
            | Self::Hidden {
                arrives, clears, ..
            } if arrives > 0.0 => write!(
                f,
                "{who} may arrive in {arrives:.1} s, clearing needs {clears:.1} s"
            ),
            Self::Arrival { .. } => write!(f, "{who} is in its zone"),
            Self::Hidden { .. } => write!(f, "{who} may be in its zone"),
            Self::Entry { gap, needs, .. } if gap < 0.0 => write!(
                f,
                "{who} may overlap by {:.1} m, entering needs {needs:.1} m",
                -gap
            ),
            Self::Entry { gap, needs, .. } => write!(
                f,
                "{who} may be as near as {gap:.1} m, entering needs {needs:.1} m"
            ),
            Self::Stop {
                available, needs, ..
            } => write!(
                f,
                "stopping needs {needs:.1} m, to {who} there are {available:.1} m"
            ),
        }
    }
}

/// A reason, and the name of the other.
struct Named<'n>(Reason, &'n str);

impl fmt::Display for Named<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.tell(f, format_args!("{}", self.1))
    }
}
