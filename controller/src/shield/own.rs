//! Where the ego is.

use super::contract::Contract;
use crate::junction::zone::Span;
use crate::observation::Vehicle;

/// The ego as it is sensed, and what is certain of where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Own {
    /// Arc length (m) as sensed.
    pub(crate) s: f32,
    /// Speed (m/s) as sensed.
    pub(crate) speed: f32,
    /// Arc length (m), at least. It never falls: what the ego has passed, it has passed for ever.
    pub(crate) least: f32,
}

impl Own {
    /// The ego that is sensed as `vehicle`, and was at `least` (m) before.
    pub(crate) fn new(contract: &Contract, vehicle: &Vehicle, least: f32) -> Self {
        let Vehicle { s, speed, .. } = *vehicle;
        let seen = s - contract.position_error;
        let believed = least > seen && least <= s + contract.position_error;
        Self {
            s,
            speed,
            least: if believed { least } else { seen },
        }
    }

    /// Bounds on the arc length (m).
    pub(crate) fn span(&self, contract: &Contract) -> Span {
        Span {
            from: self.least,
            to: self.s + contract.position_error,
        }
    }
}
