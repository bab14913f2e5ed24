//! From the XML of a Lanelet2 map to its lines, lanelets and regulations.

use super::lane::join;
use super::regulation::{RegulationKind, Sign, speed_of};
use super::{Lanelet, Line, LineKind, Map, MapPoint, Regulation};
use crate::projection::to_metres;
use roxmltree::{Document, Node};
use std::collections::HashMap;

/// Where in the text something is wrong, and what.
type Wrong = (usize, String);

/// The map of `document`.
pub(super) fn read(document: &Document<'_>) -> Result<Map, Wrong> {
    Reader::new(document)?.map()
}

struct Reader<'d, 'i> {
    document: &'d Document<'i>,
    ways: HashMap<&'d str, Vec<MapPoint>>,
    signs: HashMap<&'d str, Sign>,
    /// Speed limits (m/s) by the regulatory element that sets them.
    limits: HashMap<&'d str, f64>,
}

impl<'d, 'i> Reader<'d, 'i> {
    fn new(document: &'d Document<'i>) -> Result<Self, Wrong> {
        let mut nodes = HashMap::new();
        for node in elements(document, "node") {
            let [latitude, longitude] = [degrees(node, "lat")?, degrees(node, "lon")?];
            nodes.insert(attribute(node, "id")?, to_metres(latitude, longitude));
        }
        let (mut ways, mut signs) = (HashMap::new(), HashMap::new());
        for way in elements(document, "way") {
            let id = attribute(way, "id")?;
            let mut points = Vec::new();
            for nd in way.children().filter(|child| child.has_tag_name("nd")) {
                let reference = attribute(nd, "ref")?;
                let missing = || wrong(nd, format!("there is no node {reference}"));
                points.push(*nodes.get(reference).ok_or_else(missing)?);
            }
            ways.insert(id, points);
            if let (Some("traffic_sign"), Some(name)) = (tag(way, "type"), tag(way, "subtype")) {
                signs.extend(Sign::named(name).map(|sign| (id, sign)));
            }
        }
        let mut limits = HashMap::new();
        for element in regulatory(document, "speed_limit") {
            let limit = tag(element, "sign_type").and_then(speed_of);
            limits.extend(limit.map(|limit| (element.attribute("id").unwrap_or(""), limit)));
        }
        Ok(Self {
            document,
            ways,
            signs,
            limits,
        })
    }

    fn map(&self) -> Result<Map, Wrong> {
        let mut lanelets = Vec::new();
        let mut indices = HashMap::new();
        for relation in relations(self.document, "lanelet") {
            indices.insert(attribute(relation, "id")?, lanelets.len());
            lanelets.push(self.lanelet(relation)?);
        }
        join(&mut lanelets);
        let mut regulations = Vec::new();
        for kind in [RegulationKind::AllWayStop, RegulationKind::RightOfWay] {
            for element in regulatory(self.document, kind.name()) {
                regulations.push(self.regulation(kind, element, &indices)?);
            }
        }
        Ok(Map {
            lines: self.lines()?,
            lanelets,
            regulations,
        })
    }

    fn lines(&self) -> Result<Vec<Line>, Wrong> {
        let mut lines = Vec::new();
        for way in elements(self.document, "way") {
            let kind = tag(way, "type").and_then(|class| LineKind::of(class, tag(way, "subtype")));
            let points = &self.ways[attribute(way, "id")?];
            if let (Some(kind), true) = (kind, points.len() > 1) {
                let points = points.clone();
                lines.push(Line { kind, points });
            }
        }
        Ok(lines)
    }

    fn lanelet(&self, relation: Node<'d, 'i>) -> Result<Lanelet, Wrong> {
        let (left, right) = (
            self.bound(relation, "left")?,
            self.bound(relation, "right")?,
        );
        let set = |(_, reference): (Node<'_, '_>, &str)| self.limits.get(reference).copied();
        let limits = members(relation, "regulatory_element").filter_map(set);
        let limit = limits.reduce(f64::min);
        Ok(Lanelet::new(left, right, limit))
    }

    fn bound(&self, lanelet: Node<'d, 'i>, role: &str) -> Result<&[MapPoint], Wrong> {
        let missing = || wrong(lanelet, format!("a lanelet without a {role} bound"));
        let (member, reference) = members(lanelet, role).next().ok_or_else(missing)?;
        let missing = || wrong(member, format!("there is no way {reference}"));
        Ok(self.ways.get(reference).ok_or_else(missing)?)
    }

    fn regulation(
        &self,
        kind: RegulationKind,
        element: Node<'d, 'i>,
        indices: &HashMap<&str, usize>,
    ) -> Result<Regulation, Wrong> {
        let lanelets = |role: &'static str| {
            let relations =
                members(element, role).filter(|(m, _)| m.attribute("type") == Some("relation"));
            let index = |(member, reference): (Node<'_, '_>, &str)| {
                let missing = || wrong(member, format!("there is no lanelet {reference}"));
                indices.get(reference).copied().ok_or_else(missing)
            };
            relations.map(index).collect::<Result<Vec<_>, _>>()
        };
        let mut lines = Vec::new();
        for (member, reference) in members(element, "ref_line") {
            let missing = || wrong(member, format!("there is no way {reference}"));
            lines.push(self.ways.get(reference).ok_or_else(missing)?.clone());
        }
        let mut signs = members(element, "refers").filter_map(|(_, sign)| self.signs.get(sign));
        Ok(Regulation {
            kind,
            first: lanelets("right_of_way")?,
            yielding: lanelets("yield")?,
            lines,
            sign: signs.next().copied(),
        })
    }
}

fn elements<'d, 'i>(
    document: &'d Document<'i>,
    name: &'static str,
) -> impl Iterator<Item = Node<'d, 'i>> {
    let children = document.root_element().children();
    children.filter(move |child| child.has_tag_name(name))
}

fn relations<'d, 'i>(
    document: &'d Document<'i>,
    class: &'static str,
) -> impl Iterator<Item = Node<'d, 'i>> {
    elements(document, "relation").filter(move |relation| tag(*relation, "type") == Some(class))
}

fn regulatory<'d, 'i>(
    document: &'d Document<'i>,
    subtype: &'static str,
) -> impl Iterator<Item = Node<'d, 'i>> {
    let elements = relations(document, "regulatory_element");
    elements.filter(move |element| tag(*element, "subtype") == Some(subtype))
}

/// The members of a relation in this role, with what they refer to.
fn members<'d, 'i: 'd>(
    relation: Node<'d, 'i>,
    role: &str,
) -> impl Iterator<Item = (Node<'d, 'i>, &'d str)> {
    let in_role = move |child: &Node<'_, '_>| child.attribute("role") == Some(role);
    let children = relation.children().filter(in_role);
    children.filter_map(|member| Some((member, member.attribute("ref")?)))
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
