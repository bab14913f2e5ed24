//! What a junction keeps of each route and of the class of vehicles that drives along it.

use crate::geometry::{Footprint, UnitVector};
use crate::junction::control::Control;
use core::ops::Range;

/// Largest side of a footprint in metres.
pub const MAX_FOOTPRINT: f32 = 40.0;

/// Longest path of a junction in metres: an `f32` resolves arc lengths up to it to 0.03 mm.
pub const MAX_PATH_LENGTH: f32 = 512.0;

/// Most speed limits of a path.
pub const MAX_LIMITS: usize = 4;

/// Highest speed limit in m/s.
pub const MAX_SPEED_LIMIT: f32 = 100.0;

/// Highest speed (m/s) of a pedestrian for which the builder was not given one.
pub const PACE: f32 = 3.0;

/// Highest speed (m/s) that a pedestrian may be given.
pub const MAX_PACE: f32 = 10.0;

/// How fast an ego drives from some place of its path on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLimit {
    /// Arc length (m) of the footprint's centre from which it holds, until the next one.
    pub from: f32,
    /// In m/s, in (0, [`MAX_SPEED_LIMIT`]].
    pub speed: f32,
}

/// What kind of vehicle: a track has one, and so has a path.
#[non_exhaustive]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Class {
    /// A car or anything of its size.
    #[default]
    Car,
    /// A lorry or a bus.
    Lorry,
    /// A bicycle or a motorcycle.
    Bicycle,
    /// Somebody on foot on a crossing, who may turn back at any time. An ego is none.
    Pedestrian,
}

/// The number of a path in its junction, counted from 0 in the order in which the builder was given the paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PathId(u8);

impl PathId {
    /// Path number `number`, whether or not a junction has so many.
    #[must_use]
    pub const fn new(number: u8) -> Self {
        Self(number)
    }

    /// The number, to index [`crate::Junction::paths`].
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

impl core::fmt::Display for PathId {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "path {}", self.0)
    }
}

/// A route and the class of vehicles that drives along it. Its points are in the junction's pool.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    pub(super) class: Class,
    pub(super) footprint: Footprint,
    pub(super) exit: UnitVector,
    pub(super) line: f32,
    pub(super) waits_at_line: bool,
    pub(super) control: Control,
    pub(super) pace: f32,
    pub(super) order: u16,
    /// Its points in the pool.
    pub(super) range: Range<usize>,
}

impl Path {
    /// The class of vehicles that the footprint is for.
    #[must_use]
    pub const fn class(&self) -> Class {
        self.class
    }

    /// What such a vehicle covers at most; both sides in (0, [`MAX_FOOTPRINT`]] metres.
    #[must_use]
    pub const fn footprint(&self) -> Footprint {
        self.footprint
    }

    /// The direction in which the route ends.
    #[must_use]
    pub const fn exit(&self) -> UnitVector {
        self.exit
    }

    /// Arc length (m) of the footprint's centre while the vehicle waits at its line, in [0, length].
    #[must_use]
    pub const fn line(&self) -> f32 {
        self.line
    }

    /// Whether the builder was told the line: a vehicle then waits there for all the others, and not in the junction.
    #[must_use]
    pub const fn waits_at_line(&self) -> bool {
        self.waits_at_line
    }

    /// Highest speed (m/s) of a pedestrian on it, either way.
    #[must_use]
    pub const fn pace(&self) -> f32 {
        self.pace
    }

    /// Its place in the order in which vehicles at rest take turns: its number, unless the builder was told.
    #[must_use]
    pub const fn order(&self) -> u16 {
        self.order
    }

    /// What obliges a vehicle to give way where it enters the junction; unknown unless the builder was told.
    #[must_use]
    pub const fn control(&self) -> Control {
        self.control
    }
}
