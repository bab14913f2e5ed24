//! Who touched whom.

use super::car::Car;
use super::ride::STANDS;

/// Two vehicles that touched, one of them driven at least.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Collision {
    /// Tracks of the two, the driven one first.
    pub tracks: [u32; 2],
    /// Both were driven.
    pub both: bool,
    /// Steps since the recording's start.
    pub step: u32,
    /// The driven one stood, or was hit from behind.
    pub struck: bool,
}

impl Collision {
    /// `None` if neither of the two is driven.
    pub(super) fn of(cars: &[Car<'_>], [a, b]: [usize; 2], step: u32) -> Option<Self> {
        let [a, b] = if cars[a].driven { [a, b] } else { [b, a] };
        let (ego, other) = (&cars[a], &cars[b]);
        if !ego.driven {
            return None;
        }
        let body = ego.body();
        let behind = (other.body().centre - body.centre).dot(&body.direction) < 0.0;
        Some(Self {
            tracks: [ego, other].map(|car| car.vehicle.track),
            both: other.driven,
            step,
            struck: ego.state().v < STANDS || behind,
        })
    }
}
