//! Where another vehicle is now, and how fast, as far as that is known.

use super::contract::Contract;
use super::margin;
use super::reach::Reach;
use crate::headroom::Room;
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
    /// Of a vehicle that is sensed at arc length `s` (m) with `speed` (m/s).
    #[must_use]
    pub fn sensed(contract: &Contract, s: f32, speed: f32) -> Self {
        let (place, error) = (contract.position_error, contract.speed_error);
        Self {
            s: Span {
                from: s - place,
                to: s + place,
            },
            speed: Span {
                from: Reach::start(speed - error).speed,
                to: Reach::start(speed + error).speed,
            },
        }
    }

    /// The bounds after `time` (s), in which the vehicle does anything that the contract allows.
    #[must_use]
    pub fn after(&self, contract: &Contract, time: f32) -> Self {
        let slowest = margin::dawdle(contract, self.speed.from, time);
        let fastest = margin::rush(contract, self.speed.to, time);
        Self {
            s: Span {
                from: self.s.from + slowest.distance,
                to: self.s.to + fastest.distance,
            },
            speed: Span {
                from: slowest.speed,
                to: fastest.speed,
            },
        }
    }

    /// How far inside of what a vehicle within these bounds can be sensed at arc length `s` (m) and `speed` (m/s) are, `slack`
    /// for rounding.
    pub(crate) fn rooms(&self, contract: &Contract, s: f32, speed: f32) -> [Room; 2] {
        let around = |span: Span, error: f32, value: f32| {
            let spare = error + contract.slack;
            Room::between(value, [span.from - spare, span.to + spare])
        };
        [
            around(self.s, contract.position_error, s),
            around(self.speed, contract.speed_error, speed),
        ]
    }
}
