//! Random ways through an intersection: points only, nothing computed about them.

mod arms;
mod corners;
mod crossings;
mod free;
mod pen;
mod row;
mod turns;
mod zipper;

pub use arms::{crossroads, merge, star};
pub use corners::corners;
pub use crossings::with_crossings;
pub use free::{across, curves, lanes, near_parallel, weaving, winding, with_bystanders};
pub use row::row;
pub use turns::turns;
pub use zipper::zipper;

use crate::plane::Size;
use crate::rng::Rng;

/// Which vehicles drive along a way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A passenger car.
    Car,
    /// Long and wide.
    Lorry,
    /// Short and narrow.
    Bicycle,
    /// On foot: may point anywhere.
    Pedestrian,
}

impl Kind {
    /// A vehicle of this kind.
    #[must_use]
    pub fn size(self, rng: &mut Rng) -> Size {
        let (length, width) = match self {
            Self::Car => rng.pick(&[(5.0, 2.0), (4.2, 1.8), (4.6, 1.9)]),
            Self::Lorry => rng.pick(&[(12.0, 2.55), (8.0, 2.5)]),
            Self::Bicycle => rng.pick(&[(1.8, 0.6), (2.1, 0.8)]),
            Self::Pedestrian => rng.pick(&[(0.5, 0.5), (0.8, 0.8)]),
        };
        Size { length, width }
    }
}

/// The largest bend in one point (rad) of a finely drawn way for vehicles whose corners are `radius` m from the centre.
#[must_use]
pub fn smooth(radius: f64) -> f64 {
    2.0 * (1.0 - 0.02 / radius).acos() * 0.95
}

/// A way, and who drives along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// Its points in metres.
    pub points: Vec<[f32; 2]>,
    /// Whose way it is.
    pub kind: Kind,
    /// Their footprint.
    pub size: Size,
    /// The highest speed (m/s) of those on foot, either way; 0 of vehicles.
    pub pace: f64,
    /// Ways with the same number share their points up to where they part.
    pub entry: usize,
    /// Its parts in junctions.
    pub cuts: Vec<Cut>,
}

/// The part of a way that is a path of one junction: its points `from` to `to`, the last one not included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Which junction.
    pub junction: usize,
    /// First point.
    pub from: usize,
    /// One past the last point.
    pub to: usize,
}

impl Way {
    /// The whole of `points` in the one junction that there is.
    #[must_use]
    pub fn whole(points: Vec<[f32; 2]>, kind: Kind, size: Size, entry: usize) -> Self {
        let cut = Cut {
            junction: 0,
            from: 0,
            to: points.len(),
        };
        Self {
            points,
            kind,
            size,
            pace: 0.0,
            entry,
            cuts: vec![cut],
        }
    }
}

/// Whose ways a sketch has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Users {
    /// Cars alone.
    Cars,
    /// Cars and lorries.
    Lorries,
    /// Cars and bicycles.
    Bicycles,
    /// All of them.
    Mixed,
}

impl Users {
    /// One of them.
    #[must_use]
    pub fn kind(self, rng: &mut Rng) -> Kind {
        match self {
            Self::Cars => Kind::Car,
            Self::Lorries => rng.pick(&[Kind::Car, Kind::Lorry, Kind::Lorry]),
            Self::Bicycles => rng.pick(&[Kind::Car, Kind::Bicycle, Kind::Bicycle]),
            Self::Mixed => rng.pick(&[Kind::Car, Kind::Car, Kind::Lorry, Kind::Bicycle]),
        }
    }
}

/// Metres from the beginning of a way to the intersection.
pub const APPROACH: f64 = 90.0;
/// Metres from the intersection to the end of a way.
pub const LEAVING: f64 = 70.0;
