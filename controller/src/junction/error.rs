//! Why a junction cannot be built.

use crate::junction::path::{
    MAX_FOOTPRINT, MAX_LIMITS, MAX_PACE, MAX_PATH_LENGTH, MAX_SPEED_LIMIT, PathId,
};
use crate::junction::prepared::{MAX_LATERAL, MAX_TOLERANCE};
use core::fmt::{Display, Formatter, Result};

/// Why a junction cannot be built. Its display says what to do about it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum JunctionError {
    /// The junction was given no path.
    NoPaths,
    /// More paths than the junction's capacity `R`, or than 256.
    TooManyPaths {
        /// The most paths that it can hold.
        capacity: usize,
    },
    /// The points of all paths together are more than the junction's capacity `P`.
    TooManyPoints {
        /// The path that did not fit.
        path: PathId,
        /// The points of all paths with it.
        points: usize,
        /// The most points that the junction can hold.
        capacity: usize,
    },
    /// There is no such path.
    UnknownPath {
        /// The path that was asked for.
        path: PathId,
        /// The number of paths that there are.
        paths: usize,
    },
    /// A side of a footprint is not a number, not positive or larger than [`MAX_FOOTPRINT`].
    Footprint {
        /// The path of the footprint.
        path: PathId,
        /// Its length in metres.
        length: f32,
        /// Its width in metres.
        width: f32,
    },
    /// The tolerance is not a number or not in [0, [`MAX_TOLERANCE`]].
    Tolerance {
        /// The tolerance in metres.
        value: f32,
    },
    /// A path turns by more than 90° in one point.
    Kink {
        /// The path.
        path: PathId,
        /// The index of the point in the route.
        at: usize,
        /// The change of heading in degrees.
        degrees: f32,
    },
    /// A path is longer than [`MAX_PATH_LENGTH`].
    TooLong {
        /// The path.
        path: PathId,
        /// Its length in metres.
        length: f32,
    },
    /// A path comes back to where its own vehicles may still be: nobody on it could tell who is ahead.
    Returns {
        /// The path.
        path: PathId,
    },
    /// A line is not on its path.
    Line {
        /// The path.
        path: PathId,
        /// The arc length (m) that was given for the line.
        value: f32,
        /// The path's length in metres.
        length: f32,
    },
    /// A speed limit is not above 0 and up to [`MAX_SPEED_LIMIT`], or not on its path.
    SpeedLimit {
        /// The path.
        path: PathId,
        /// The arc length (m) from which it was to hold.
        from: f32,
        /// The speed in m/s.
        speed: f32,
        /// The path's length in metres.
        length: f32,
    },
    /// More speed limits of one path than [`MAX_LIMITS`].
    TooManyLimits {
        /// The path.
        path: PathId,
    },
    /// The lateral acceleration is not in (0, [`MAX_LATERAL`]].
    Lateral {
        /// In m/s².
        value: f32,
    },
    /// The highest speed of pedestrians is not in (0, [`MAX_PACE`]].
    Pace {
        /// The path.
        path: PathId,
        /// In m/s.
        value: f32,
    },
    /// A path was given the right of way over itself.
    RightOfWay {
        /// The path.
        path: PathId,
    },
}

impl Display for JunctionError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::NoPaths => f.write_str("a junction without paths: add one before it is built"),
            Self::TooManyPaths { capacity } => write!(
                f,
                "more than {capacity} paths: raise the junction's first parameter (up to 256), or leave paths out"
            ),
            Self::TooManyPoints {
                path,
                points,
                capacity,
            } => write!(
                f,
                "{path}: {points} points in all, and room for {capacity}: raise the junction's second parameter, or simplify the routes"
            ),
            Self::UnknownPath { path, paths } => write!(
                f,
                "{path}: there are {paths}, counted from 0: use what `path` or `variant` returned"
            ),
            Self::Footprint {
                path,
                length,
                width,
            } => write!(
                f,
                "{path}: a footprint of {length} m × {width} m: both sides must be in (0, {MAX_FOOTPRINT}] m"
            ),
            Self::Tolerance { value } => write!(
                f,
                "a tolerance of {value} m: it must be in [0, {MAX_TOLERANCE}] m"
            ),
            Self::Kink { path, at, degrees } => write!(
                f,
                "{path}: a turn of {degrees:.1}° at point {at}, more than 90°: round the corner with more points"
            ),
            Self::TooLong { path, length } => write!(
                f,
                "{path}: {length} m long, more than {MAX_PATH_LENGTH} m: cut it off before or after the junction"
            ),
            Self::Returns { path } => write!(
                f,
                "{path}: comes back to itself, nearer than its vehicles are wide: cut it in two"
            ),
            Self::Line {
                path,
                value,
                length,
            } => write!(
                f,
                "{path}: a line at {value} m: it must be on the path, in [0, {length}] m"
            ),
            Self::SpeedLimit {
                path,
                from,
                speed,
                length,
            } => write!(
                f,
                "{path}: a speed limit of {speed} m/s from {from} m on: it must be in (0, {MAX_SPEED_LIMIT}] m/s, from a place in [0, {length}] m"
            ),
            Self::TooManyLimits { path } => write!(
                f,
                "{path}: more than {MAX_LIMITS} speed limits: leave out those that matter least"
            ),
            Self::Lateral { value } => write!(
                f,
                "a lateral acceleration of {value} m/s²: it must be in (0, {MAX_LATERAL}] m/s²"
            ),
            Self::Pace { path, value } => write!(
                f,
                "{path}: pedestrians of {value} m/s at most: it must be in (0, {MAX_PACE}] m/s"
            ),
            Self::RightOfWay { path } => write!(
                f,
                "{path}: a right of way over itself: name two different paths"
            ),
        }
    }
}

impl core::error::Error for JunctionError {}
