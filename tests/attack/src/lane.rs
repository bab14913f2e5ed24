//! Where vehicles of one size drive, through one junction after the other.

use crate::plane::Size;
use crate::polyline::Polyline;
use cede_controller::{Class, PathId};

/// The part of a lane that is a path of one junction.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// Which junction.
    pub junction: usize,
    /// The path there.
    pub path: PathId,
    /// Arc length of the lane at which the path begins.
    pub offset: f64,
    /// Length of the path.
    pub length: f64,
}

/// Where vehicles of one size drive.
#[derive(Clone, Debug)]
pub struct Lane {
    /// Its course.
    pub line: Polyline,
    /// Their footprint.
    pub size: Size,
    /// Their class.
    pub class: Class,
    /// The highest speed (m/s) of those on foot, either way; 0 of vehicles.
    pub pace: f64,
    /// Its parts in junctions, in order.
    pub legs: Vec<Leg>,
    /// Lanes with the same number begin alike.
    pub entry: usize,
    /// No kink moves a corner by more than this, in m.
    pub jump: f64,
}
