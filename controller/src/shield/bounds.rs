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

#[cfg(test)]
mod tests {
    use super::*;

    const ERRS: Contract = match Contract::builder()
        .position_error(0.3)
        .speed_error(0.2)
        .slack(0.05)
        .build()
    {
        Ok(contract) => contract,
        Err(_) => panic!("a number is out of its range"),
    };

    fn is(span: Span, from: f32, to: f32) {
        let near = (span.from - from).abs() < 1e-5 && (span.to - to).abs() < 1e-5;
        assert!(near, "{span:?}, {from}, {to}");
    }

    #[test]
    fn what_is_sensed_errs_either_way_and_nobody_drives_backwards() {
        let seen = Bounds::sensed(&ERRS, 10.0, 5.0);
        is(seen.s, 9.7, 10.3);
        is(seen.speed, 4.8, 5.2);
        is(Bounds::sensed(&ERRS, 10.0, 0.1).speed, 0.0, 0.3);
    }

    #[test]
    fn after_some_time_one_has_braked_or_accelerated_all_along() {
        let later = Bounds::sensed(&ERRS, 10.0, 5.0).after(&ERRS, 0.5);
        is(later.s, 9.7 + 1.4, 10.3 + 2.975);
        is(later.speed, 0.8, 6.7);
    }

    #[test]
    fn what_is_seen_has_room_by_its_error_and_the_slack() {
        let seen = Bounds::sensed(&ERRS, 10.0, 5.0);
        let room = |s, speed| {
            seen.rooms(&ERRS, s, speed)
                .map(|room| (room.left, room.share))
        };
        let near = |(a, b): (f32, f32), (c, d): (f32, f32)| {
            assert!(
                (a - c).abs() < 1e-5 && (b - d).abs() < 1e-4,
                "{a} {b}, {c} {d}"
            );
        };
        let [place, pace] = room(9.5, 5.0);
        near(place, (0.15, 0.15 / 0.65));
        near(pace, (0.45, 1.0));
        let [place, pace] = room(10.65, 5.5);
        near(place, (0.0, 0.0));
        near(pace, (-0.05, -0.05 / 0.45));
    }
}
