//! Lanelet2 maps (OSM XML): for drawing, and for the places of stop lines.

use super::error::{DataError, Problem};
use super::projection::to_metres;
use roxmltree::{Document, Node};
use std::collections::HashMap;
use std::path::Path;

/// What of a map can be drawn, in the recordings' frame.
#[derive(Clone, Debug, Default)]
pub struct Map {
    /// Lines on and beside the road.
    pub lines: Vec<Line>,
    /// Outlines of the lanes, closed by joining the last point to the first.
    pub lanes: Vec<Vec<[f64; 2]>>,
}

/// A line of a map.
#[derive(Clone, Debug)]
pub struct Line {
    /// What it is.
    pub kind: LineKind,
    /// Its points in metres, at least two.
    pub points: Vec<[f64; 2]>,
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
    let wrong = |problem: String| DataError::new(path, Problem::Map(problem));
    let document = Document::parse(&text).map_err(|error| {
        let line = u64::from(error.pos().row);
        wrong(error.to_string()).at_line(line)
    })?;
    Reader::new(&document)
        .and_then(|reader| reader.map())
        .map_err(|(place, problem)| {
            let line = u64::from(document.text_pos_at(place).row);
            wrong(problem).at_line(line)
        })
}

/// Where in the text something is wrong, and what.
type Wrong = (usize, String);

struct Reader<'d, 'i> {
    document: &'d Document<'i>,
    ways: HashMap<&'d str, Vec<[f64; 2]>>,
}

impl<'d, 'i> Reader<'d, 'i> {
    fn new(document: &'d Document<'i>) -> Result<Self, Wrong> {
        let mut nodes = HashMap::new();
        for node in elements(document, "node") {
            let [latitude, longitude] = [degrees(node, "lat")?, degrees(node, "lon")?];
            nodes.insert(attribute(node, "id")?, to_metres(latitude, longitude));
        }
        let mut ways = HashMap::new();
        for way in elements(document, "way") {
            let mut points = Vec::new();
            for nd in way.children().filter(|child| child.has_tag_name("nd")) {
                let reference = attribute(nd, "ref")?;
                let missing = || wrong(nd, format!("there is no node {reference}"));
                points.push(*nodes.get(reference).ok_or_else(missing)?);
            }
            ways.insert(attribute(way, "id")?, points);
        }
        Ok(Self { document, ways })
    }

    fn map(&self) -> Result<Map, Wrong> {
        let mut map = Map::default();
        for way in elements(self.document, "way") {
            let kind = tag(way, "type").and_then(|class| LineKind::of(class, tag(way, "subtype")));
            let points = &self.ways[attribute(way, "id")?];
            if let (Some(kind), true) = (kind, points.len() > 1) {
                let points = points.clone();
                map.lines.push(Line { kind, points });
            }
        }
        let lanelets = elements(self.document, "relation");
        for lanelet in lanelets.filter(|relation| tag(*relation, "type") == Some("lanelet")) {
            let (left, right) = (self.bound(lanelet, "left")?, self.bound(lanelet, "right")?);
            map.lanes.push(outline(left, right));
        }
        Ok(map)
    }

    fn bound(&self, lanelet: Node<'d, 'i>, role: &str) -> Result<&[[f64; 2]], Wrong> {
        let member = lanelet
            .children()
            .find(|child| child.attribute("role") == Some(role))
            .ok_or_else(|| wrong(lanelet, format!("a lanelet without a {role} bound")))?;
        let reference = attribute(member, "ref")?;
        let missing = || wrong(member, format!("there is no way {reference}"));
        Ok(self.ways.get(reference).ok_or_else(missing)?)
    }
}

/// The left bound, and the right one backwards; either may be drawn in the wrong direction.
fn outline(left: &[[f64; 2]], right: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut outline = left.to_vec();
    let apart = |a: Option<&[f64; 2]>, b: Option<&[f64; 2]>| match (a, b) {
        (Some(a), Some(b)) => (b[0] - a[0]).hypot(b[1] - a[1]),
        _ => 0.0,
    };
    if apart(left.last(), right.last()) <= apart(left.last(), right.first()) {
        outline.extend(right.iter().rev());
    } else {
        outline.extend(right);
    }
    outline
}

fn elements<'d, 'i>(
    document: &'d Document<'i>,
    name: &'static str,
) -> impl Iterator<Item = Node<'d, 'i>> {
    let children = document.root_element().children();
    children.filter(move |child| child.has_tag_name(name))
}

fn tag<'d>(element: Node<'d, '_>, key: &str) -> Option<&'d str> {
    element
        .children()
        .find(|child| child.attribute("k") == Some(key))?
        .attribute("v")
}

fn attribute<'d>(element: Node<'d, '_>, name: &str) -> Result<&'d str, Wrong> {
    let missing = || wrong(element, format!("an element without `{name}`"));
    element.attribute(name).ok_or_else(missing)
}

fn degrees(node: Node<'_, '_>, name: &str) -> Result<f64, Wrong> {
    let text = attribute(node, name)?;
    let value = text.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| wrong(node, format!("`{text}` is not a number of degrees")))
}

fn wrong(element: Node<'_, '_>, problem: String) -> Wrong {
    (element.range().start, problem)
}
