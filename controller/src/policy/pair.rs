//! The ego and one other vehicle, as the policy sees them.

use crate::geometry::{Footprint, Pose, UnitVector};
use crate::junction::Control;
use crate::junction::conflict::RightOfWay;
use crate::junction::kind::ConflictKind;
use crate::real::Elementary;
use core::f32::consts::FRAC_PI_2;
use nalgebra::Scalar;

/// One vehicle of a [`Pair`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleState<R: Scalar = f32> {
    /// Where it is and where it points.
    pub pose: Pose<R>,
    /// Unit vector of the direction in which its route ends: left of `pose.direction` for a left-turner.
    pub exit: UnitVector,
    /// Speed in m/s, never negative.
    pub speed: R,
    /// Metres along its route to its conflict point with the other; negative once past it.
    pub distance: R,
    /// The rectangle that it covers.
    pub footprint: Footprint,
    /// The vehicle ahead of it in its lane, if there is one.
    pub leader: Option<Leader<R>>,
    /// The third vehicle that will first be where its route meets this one's, if there is one.
    pub crosser: Option<Crosser<R>>,
    /// What obliges it to give way where it enters the junction.
    pub control: Control,
}

/// The vehicle ahead in the same lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leader<R = f32> {
    /// Metres from the follower's front bumper to the leader's rear bumper, along the route.
    pub gap: R,
    /// The leader's speed in m/s, never negative.
    pub speed: R,
}

/// A third vehicle whose route meets a vehicle's own, and that has not yet left the place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crosser<R = f32> {
    /// Metres that the vehicle still has to where the routes meet; negative once past it.
    pub distance: R,
    /// Metres that the third one still has to it.
    pub its_distance: R,
    /// The third one's speed in m/s, never negative.
    pub its_speed: R,
}

/// Which part the ego plays; it says which output of a joint policy is the ego's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// The left-turner's (in generic encounters: that of the vehicle that has to give way).
    Left,
    /// That of the vehicle which the left-turner meets.
    Other,
}

/// The ego and one other vehicle whose routes conflict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair<R: Scalar = f32> {
    /// The vehicle that is driven.
    pub ego: VehicleState<R>,
    /// The vehicle that it meets.
    pub other: VehicleState<R>,
    /// How the two routes conflict.
    pub kind: ConflictKind,
    /// Who may go first.
    pub right_of_way: RightOfWay,
    /// The part that the ego plays.
    pub part: Part,
    /// The ego's SVO at the last step in radians, in [0, π/2]: kept while both are at rest; π/4 at the start.
    pub last_svo: R,
}

impl Pair {
    /// The same pair as the other vehicle sees it. Its own inverse, but for the rounding of the SVO.
    #[must_use]
    pub fn swapped(&self) -> Self {
        Self {
            ego: self.other,
            other: self.ego,
            kind: self.kind,
            right_of_way: match self.right_of_way {
                RightOfWay::Ego => RightOfWay::Other,
                RightOfWay::Other => RightOfWay::Ego,
                RightOfWay::Unsettled => RightOfWay::Unsettled,
            },
            part: match self.part {
                Part::Left => Part::Other,
                Part::Other => Part::Left,
            },
            last_svo: FRAC_PI_2 - self.last_svo,
        }
    }
}

impl<R: Elementary> Pair<R> {
    /// The ego's SVO now, in radians, in [0, π/2]. See [`crate::policy::svo::svo`].
    #[must_use]
    pub fn svo(&self) -> R {
        let (ego, other) = (&self.ego, &self.other);
        crate::policy::svo::svo(
            ego.speed,
            ego.distance,
            other.speed,
            other.distance,
            self.last_svo,
        )
    }
}

#[cfg(test)]
pub(crate) mod testing {
    use super::*;
    use crate::geometry::{Point, unit};

    /// A left-turner 12 m before the conflict point at 6 m/s, the oncoming other 20 m before it at 8 m/s.
    pub(crate) fn pair() -> Pair {
        let vehicle_state = |x, y, direction, exit, speed, distance| VehicleState {
            pose: Pose {
                position: Point::new(x, y),
                direction,
            },
            exit,
            speed,
            distance,
            footprint: Footprint::PAPER,
            leader: None,
            crosser: None,
            control: Control::Unknown,
        };
        let (east, north, west) = (unit(1.0, 0.0), unit(0.0, 1.0), unit(-1.0, 0.0));
        Pair {
            ego: vehicle_state(-12.0, 0.0, east, north, 6.0, 12.0),
            other: vehicle_state(20.0, 3.0, west, west, 8.0, 20.0),
            kind: ConflictKind::Crossing,
            right_of_way: RightOfWay::Other,
            part: Part::Left,
            last_svo: core::f32::consts::FRAC_PI_4,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::testing::pair;
    use super::*;

    #[test]
    fn swapping_twice_changes_nothing_but_rounding() {
        let (once, twice) = (pair().swapped(), pair().swapped().swapped());
        assert_eq!(once.part, Part::Other);
        assert_eq!(once.right_of_way, RightOfWay::Ego);
        assert!((twice.last_svo - pair().last_svo).abs() < 1e-6);
        assert_eq!(
            Pair {
                last_svo: pair().last_svo,
                ..twice
            },
            pair()
        );
    }

    #[test]
    fn the_two_orientations_are_complements() {
        assert!((pair().svo() + pair().swapped().svo() - FRAC_PI_2).abs() < 1e-6);
    }
}
