//! Where another vehicle is now, and how fast, as far as that is known.

use super::contract::Contract;
use super::margin;
use crate::junction::zone::Span;

/// Bounds on another vehicle's arc length (m) and speed (m/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Arc length in m.
    pub s: Span,
    /// Speed in m/s, not negative.
    pub speed: Span,
}

impl Bounds {
    /// Of a vehicle that was sensed at arc length `s` (m) with `speed` (m/s) so many seconds ago.
    ///
    /// It coasts: from then on it does anything that the contract allows. At `time` 0 these are the errors of sensing.
    #[must_use]
    pub fn after(contract: &Contract, s: f32, speed: f32, time: f32) -> Self {
        let (place, error) = (contract.position_error, contract.speed_error);
        let slowest = margin::dawdle(contract, speed - error, time);
        let fastest = margin::rush(contract, speed + error, time);
        Self {
            s: Span {
                from: s - place + slowest.distance,
                to: s + place + fastest.distance,
            },
            speed: Span {
                from: slowest.speed,
                to: fastest.speed,
            },
        }
    }

    /// Whether a vehicle within these bounds can be sensed at arc length `s` (m) with `speed` (m/s), `slack` for rounding.
    pub(crate) fn allow(&self, contract: &Contract, s: f32, speed: f32) -> bool {
        let around = |span: Span, error: f32, value: f32| {
            let spare = error + contract.slack;
            span.from - spare <= value && value <= span.to + spare
        };
        around(self.s, contract.position_error, s)
            && around(self.speed, contract.speed_error, speed)
    }
}
