//! What the sensors report, and what is wrong with it.

use crate::geometry::Pose;

/// A vehicle as it is sensed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vehicle {
    /// Arc length (m) of its footprint's centre along its route, within ± [`Vehicle::MAX_ARC`].
    pub s: f32,
    /// Speed along its route in m/s, in [−[`Vehicle::REVERSING`], [`Vehicle::MAX_SPEED`]]; what is below 0 counts as 0.
    pub speed: f32,
    /// Where it is and where it points; the direction is a unit vector to within 10 %
    /// ([`crate::geometry::unit`] takes it as it is sensed).
    pub pose: Pose,
}

impl Vehicle {
    /// Largest arc length in metres, either way.
    pub const MAX_ARC: f32 = 16_384.0;
    /// Highest speed in m/s.
    pub const MAX_SPEED: f32 = 100.0;
    /// A vehicle at rest may be sensed to roll backwards at this speed (m/s) at most.
    pub const REVERSING: f32 = 1.0;

    /// The vehicle, its speed not negative, if every number is in its range. NaN is in none.
    fn checked(mut self) -> Option<Self> {
        let within = |value: f32, limit: f32| value.abs() <= limit;
        let (position, direction) = (self.pose.position, self.pose.direction);
        let norm = direction.dot(&direction);
        let good = within(self.s, Self::MAX_ARC)
            && (-Self::REVERSING..=Self::MAX_SPEED).contains(&self.speed)
            && within(position.x, crate::Route::<2>::MAX_COORDINATE)
            && within(position.y, crate::Route::<2>::MAX_COORDINATE)
            && (0.81..=1.21).contains(&norm);
        if self.speed < 0.0 {
            self.speed = 0.0;
        }
        good.then_some(self)
    }
}

/// What the sensors report at one moment: the ego, and the others in the order of their scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation<const N: usize> {
    /// The vehicle that is driven.
    pub ego: Vehicle,
    /// The others, in the order in which [`crate::Scene::new`] was given their routes; `None` while one
    /// is not there. One that is not in the scene at all is a [`Fault::Other`].
    pub others: [Option<Vehicle>; N],
}

/// Why the controller cannot trust its inputs, or has nothing safe to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Fault {
    /// The ego's own state is not a number or out of range.
    Ego,
    /// The state of this other is not a number or out of range, or it is not in the scene.
    Other(u8),
    /// The proposed acceleration is not a number.
    Proposal,
    /// No plan keeps the guarantee: the contract was broken, or the controller was switched on in danger.
    Unverified,
}

impl core::fmt::Display for Fault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Ego => f.write_str("the ego's own state is out of range"),
            Self::Other(other) => write!(f, "the state of other {other} is out of range"),
            Self::Proposal => f.write_str("the proposed acceleration is not a number"),
            Self::Unverified => f.write_str("no plan is safe"),
        }
    }
}

impl core::error::Error for Fault {}

impl<const N: usize> Observation<N> {
    /// The observation, with every number in its range, for a scene with `others` others.
    ///
    /// Cost: O(N).
    ///
    /// # Errors
    /// [`Fault::Ego`] or [`Fault::Other`], whichever is first.
    pub(crate) fn checked(&self, others: usize) -> Result<Self, Fault> {
        let mut seen = *self;
        seen.ego = seen.ego.checked().ok_or(Fault::Ego)?;
        for (i, slot) in (0_u8..).zip(seen.others.iter_mut()) {
            if let Some(other) = *slot {
                let known = usize::from(i) < others;
                let checked = other.checked().filter(|_| known);
                *slot = Some(checked.ok_or(Fault::Other(i))?);
            }
        }
        Ok(seen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, unit};

    fn vehicle() -> Vehicle {
        Vehicle {
            s: 1.0,
            speed: -0.1,
            pose: Pose {
                position: Point::new(1.0, 2.0),
                direction: unit(0.0, -1.0),
            },
        }
    }

    #[test]
    fn good_states_pass_and_rolling_back_counts_as_rest() {
        let observation = Observation {
            ego: vehicle(),
            others: [None, Some(vehicle())],
        };
        let checked = observation.checked(2).unwrap();
        assert_eq!(checked.ego.speed, 0.0);
        assert_eq!(checked.others[0], None);
        assert_eq!(observation.checked(1), Err(Fault::Other(1)));
    }

    #[test]
    fn every_number_is_checked() {
        for bad in [f32::NAN, f32::INFINITY, -1e9] {
            let broken: [fn(&mut Vehicle, f32); 6] = [
                |v, x| v.s = x,
                |v, x| v.speed = x,
                |v, x| v.pose.position.x = x,
                |v, x| v.pose.position.y = x,
                |v, x| v.pose.direction = unit(x, v.pose.direction.y),
                |v, x| v.pose.direction = unit(v.pose.direction.x, x),
            ];
            for set in broken {
                let mut other = vehicle();
                set(&mut other, bad);
                let observation = Observation {
                    ego: vehicle(),
                    others: [Some(other)],
                };
                assert_eq!(observation.checked(1), Err(Fault::Other(0)));
                let observation = Observation::<1> {
                    ego: other,
                    others: [None],
                };
                assert_eq!(observation.checked(1), Err(Fault::Ego));
            }
        }
    }
}
