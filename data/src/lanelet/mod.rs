//! Lanelet2 maps (OSM XML), read as a driver reads them: lanes, lines, signs, and who gives way to whom.

mod area;
mod lane;
mod reader;
mod regulation;
mod trace;

pub use area::{ConflictArea, rectangle};
pub use lane::Lanelet;
pub use regulation::{Regulation, RegulationKind, Sign};
pub use trace::{OnLanelet, Trace};

use super::error::{DataError, Problem};
use roxmltree::Document;
use std::path::Path;

/// A point in metres, in the recordings' frame.
pub type MapPoint = [f64; 2];

/// A map, in the recordings' frame.
#[derive(Clone, Debug, Default)]
pub struct Map {
    /// Lines on and beside the road.
    pub lines: Vec<Line>,
    /// The lanelets.
    pub lanelets: Vec<Lanelet>,
    /// Who gives way to whom, as far as the map says so. Lanelets are told by their indices in `lanelets`.
    pub regulations: Vec<Regulation>,
}

/// A line of a map.
#[derive(Clone, Debug)]
pub struct Line {
    /// What it is.
    pub kind: LineKind,
    /// Its points in metres, at least two.
    pub points: Vec<MapPoint>,
}

/// What a line of a map is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineKind {
    /// A kerb or another border of the road.
    Edge,
    /// A line between lanes or along the border, painted through.
    Solid,
    /// A broken line between lanes.
    Dashed,
    /// Where vehicles stop.
    Stop,
    /// The marking of a pedestrian crossing.
    Crosswalk,
}

impl LineKind {
    /// The kind of Lanelet2's `type` and `subtype`; `None` for what is not seen on the road.
    fn of(class: &str, subtype: Option<&str>) -> Option<Self> {
        match class {
            "curbstone" | "road_border" | "guard_rail" | "wall" | "fence" => Some(Self::Edge),
            "line_thin" | "line_thick" if subtype.is_some_and(|s| s.contains("dashed")) => {
                Some(Self::Dashed)
            }
            "line_thin" | "line_thick" => Some(Self::Solid),
            "stop_line" => Some(Self::Stop),
            "pedestrian_marking" | "zebra_marking" => Some(Self::Crosswalk),
            _ => None,
        }
    }
}

/// The map at `path`.
///
/// # Errors
/// When the file cannot be read, is no XML, or refers to what it does not hold.
pub fn read(path: &Path) -> Result<Map, DataError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| DataError::new(path, Problem::Unreadable(error)))?;
    parse(path, &text)
}

/// The map that `text` is; errors name `path`.
pub(crate) fn parse(path: &Path, text: &str) -> Result<Map, DataError> {
    let wrong = |problem: String| DataError::new(path, Problem::Map(problem));
    let document = Document::parse(text).map_err(|error| {
        let line = u64::from(error.pos().row);
        wrong(error.to_string()).at_line(line)
    })?;
    reader::read(&document).map_err(|(place, problem)| {
        let line = u64::from(document.text_pos_at(place).row);
        wrong(problem).at_line(line)
    })
}
