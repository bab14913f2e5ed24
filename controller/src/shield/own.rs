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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Pose, unit};

    #[test]
    fn what_the_ego_has_passed_it_has_passed_unless_that_cannot_be() {
        let contract = Contract::builder().position_error(0.5).build().unwrap();
        let pose = Pose {
            position: Point::origin(),
            direction: unit(1.0, 0.0),
        };
        let vehicle = Vehicle {
            s: 10.0,
            speed: 3.0,
            pose,
        };
        let own = |least| Own::new(&contract, &vehicle, least);
        assert_eq!(
            [9.0, 9.7, 10.5, 10.6].map(|least| own(least).least),
            [9.5, 9.7, 10.5, 9.5]
        );
        let span = own(9.7).span(&contract);
        assert_eq!((span.from, span.to), (9.7, 10.5));
    }
}
