//! From the road network of a scenario to a map.

use super::xml::{
    Fault, attribute, children, fault, find, number, points, references, required, word,
};
use crate::lanelet::{Lanelet, Line, LineKind, Map, MapPoint, Regulation, RegulationKind, Sign};
use roxmltree::Node;
use std::collections::HashMap;

/// The map of a scenario.
pub(super) fn read(root: Node<'_, '_>) -> Result<Map, Fault> {
    let signs = signs(root)?;
    let mut lanes = Vec::new();
    let mut lines = Vec::new();
    for lanelet in children(root, "lanelet") {
        lanes.push(Lane::read(lanelet, &signs)?);
        lines.extend(drawn(lanelet)?);
    }
    let indices = lanes.iter().map(|lane| lane.id).zip(0..).collect();
    let regulations = regulations(root, &lanes, &indices)?;
    let successors = lanes.iter().map(|lane| lane.successors(&indices));
    let successors = successors.collect::<Result<Vec<_>, _>>()?;
    let lanelets = lanes.iter().zip(successors).map(|(lane, successors)| {
        let mut lanelet = Lanelet::new(&lane.left, &lane.right, lane.limit);
        lanelet.successors = successors;
        lanelet
    });
    Ok(Map {
        lines,
        lanelets: lanelets.collect(),
        regulations,
    })
}

/// Indices of lanelets by their identifiers.
type Indices<'d> = HashMap<&'d str, usize>;

/// What a sign tells a driver, as far as it matters here.
#[derive(Clone, Copy)]
enum Told {
    GiveWay(Sign),
    /// The road has priority.
    Priority,
    /// Right before left.
    RightFirst,
    /// At most so fast (m/s).
    Limit(f64),
}

impl Told {
    /// By the sign's number in the catalogue of Germany, which is that of Zamunda, or of the USA.
    fn of(element: Node<'_, '_>) -> Result<Option<Self>, Fault> {
        Ok(match word(required(element, &["trafficSignID"])?) {
            "206" | "R1-1" => Some(Self::GiveWay(Sign::Stop)),
            "205" | "R1-2" => Some(Self::GiveWay(Sign::Yield)),
            "301" | "306" => Some(Self::Priority),
            "102" => Some(Self::RightFirst),
            "274" | "R2-1" => Some(Self::Limit(number(element, &["additionalValue"])?)),
            _ => None,
        })
    }
}

/// What each sign says.
fn signs<'d>(root: Node<'d, '_>) -> Result<HashMap<&'d str, Vec<Told>>, Fault> {
    let mut signs = HashMap::new();
    for sign in children(root, "trafficSign") {
        let told = children(sign, "trafficSignElement").map(Told::of);
        let told = told.collect::<Result<Vec<_>, _>>()?;
        signs.insert(attribute(sign, "id")?, told.into_iter().flatten().collect());
    }
    Ok(signs)
}

/// A lanelet as it stands in the file.
struct Lane<'d, 'i> {
    node: Node<'d, 'i>,
    id: &'d str,
    left: Vec<MapPoint>,
    right: Vec<MapPoint>,
    told: Vec<Told>,
    limit: Option<f64>,
}

impl<'d, 'i: 'd> Lane<'d, 'i> {
    fn read(node: Node<'d, 'i>, signs: &HashMap<&str, Vec<Told>>) -> Result<Self, Fault> {
        let of_line = find(node, &["stopLine"]).into_iter();
        let of_line = of_line.flat_map(|line| references(line, "trafficSignRef"));
        let mut told = Vec::new();
        for reference in references(node, "trafficSignRef").chain(of_line) {
            let (child, sign) = reference?;
            let missing = || fault(child, format!("there is no traffic sign {sign}"));
            told.extend(signs.get(sign).ok_or_else(missing)?);
        }
        let limits = told.iter().filter_map(|told| match told {
            Told::Limit(limit) => Some(*limit),
            _ => None,
        });
        let limit = limits.reduce(f64::min);
        let bound = |name| {
            let bound = required(node, &[name])?;
            let points = points(bound)?;
            let few = || fault(bound, format!("<{name}> has fewer than 2 points"));
            (points.len() > 1).then_some(points).ok_or_else(few)
        };
        Ok(Self {
            node,
            id: attribute(node, "id")?,
            left: bound("leftBound")?,
            right: bound("rightBound")?,
            limit,
            told,
        })
    }

    fn successors(&self, indices: &Indices<'_>) -> Result<Vec<usize>, Fault> {
        let all = references(self.node, "successor");
        all.map(|reference| index(indices, reference?)).collect()
    }

    /// The sign that tells it to give way; the strictest one.
    fn sign(&self) -> Option<Sign> {
        let signs = self.told.iter().filter_map(|told| match told {
            Told::GiveWay(sign) => Some(*sign),
            _ => None,
        });
        signs.min_by_key(|sign| *sign as u8)
    }

    fn has_priority(&self) -> bool {
        self.told.iter().any(|told| matches!(told, Told::Priority))
    }

    /// Where its vehicles wait: its stop line, or else its end.
    fn line(&self) -> Result<Vec<MapPoint>, Fault> {
        let line = find(self.node, &["stopLine"]).map(points).transpose()?;
        let end = || [&self.left, &self.right].map(|bound| bound[bound.len() - 1]);
        Ok(line
            .filter(|line| line.len() > 1)
            .unwrap_or_else(|| end().to_vec()))
    }
}

fn index(indices: &Indices<'_>, (node, id): (Node<'_, '_>, &str)) -> Result<usize, Fault> {
    let missing = || fault(node, format!("there is no lanelet {id}"));
    indices.get(id).copied().ok_or_else(missing)
}

/// Who gives way: whoever has a sign; at an intersection where all have a stop sign, everybody; at one with a
/// priority road, whoever is not on it. A sign `right before left` says that the general rules count.
fn regulations(
    root: Node<'_, '_>,
    lanes: &[Lane<'_, '_>],
    indices: &Indices<'_>,
) -> Result<Vec<Regulation>, Fault> {
    let mut regulations = Vec::new();
    let mut settled = vec![false; lanes.len()];
    for intersection in children(root, "intersection") {
        let incoming = children(intersection, "incoming");
        let incoming = incoming.flat_map(|incoming| references(incoming, "incomingLanelet"));
        let incoming = incoming.map(|reference| index(indices, reference?));
        let incoming = incoming.collect::<Result<Vec<_>, _>>()?;
        let stops = |&&lane: &&usize| lanes[lane].sign() == Some(Sign::Stop);
        let minor = |&&lane: &&usize| lanes[lane].sign().is_none() && !lanes[lane].has_priority();
        let major = incoming
            .iter()
            .copied()
            .filter(|&lane| lanes[lane].has_priority());
        let major: Vec<usize> = major.collect();
        let (kind, sign, yielding) = if incoming.iter().filter(stops).count() == incoming.len() {
            (RegulationKind::AllWayStop, Some(Sign::Stop), incoming)
        } else if major.is_empty() {
            continue;
        } else {
            let minor = incoming.iter().filter(minor).copied().collect();
            (RegulationKind::RightOfWay, None, minor)
        };
        if kind == RegulationKind::AllWayStop {
            yielding.iter().for_each(|&lane| settled[lane] = true);
        }
        let lines = yielding.iter().map(|&lane| lanes[lane].line());
        regulations.push(Regulation {
            kind,
            first: major,
            lines: lines.collect::<Result<_, _>>()?,
            yielding,
            sign,
        });
    }
    for (index, lane) in lanes.iter().enumerate() {
        let general = lane
            .told
            .iter()
            .any(|told| matches!(told, Told::RightFirst));
        let signed = lane.sign().filter(|_| !settled[index]);
        if signed.is_some() || general {
            regulations.push(Regulation {
                kind: RegulationKind::RightOfWay,
                first: Vec::new(),
                yielding: signed.map(|_| index).into_iter().collect(),
                lines: vec![lane.line()?],
                sign: signed,
            });
        }
    }
    Ok(regulations)
}

/// The lines that are painted along a lanelet and at its end.
fn drawn(lanelet: Node<'_, '_>) -> Result<Vec<Line>, Fault> {
    let mut lines = Vec::new();
    for name in ["leftBound", "rightBound", "stopLine"] {
        let Some(bound) = find(lanelet, &[name]) else {
            continue;
        };
        let kind = match find(bound, &["lineMarking"]).map(word) {
            _ if name == "stopLine" => LineKind::Stop,
            Some("solid" | "broad_solid") => LineKind::Solid,
            Some("dashed" | "broad_dashed") => LineKind::Dashed,
            Some("curb" | "lowered_curb") => LineKind::Edge,
            _ => continue,
        };
        let points = points(bound)?;
        if points.len() > 1 {
            lines.push(Line { kind, points });
        }
    }
    Ok(lines)
}
