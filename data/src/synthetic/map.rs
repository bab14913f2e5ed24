//! The map of a synthetic site: kerbs, lines and lanes, as Lanelet2 has them.

use super::layout::{Arm, CENTRE, Layout, Movement, curve};
use crate::projection::to_degrees;
use cede_controller::{Point, Vector};
use std::fmt::Write;

/// Spacing (m) of the points of a lane's bounds.
const SPACING: f32 = 2.0;
/// How far (m) inside the line a corner's rounding begins.
const CORNER: f32 = 3.0;

/// A line of the map with Lanelet2's words for it.
struct Way {
    class: &'static str,
    subtype: &'static str,
    points: Vec<Point>,
}

impl Layout {
    /// The map in OSM XML, in degrees about (0°, 0°) as INTERACTION's maps are.
    pub(super) fn osm(&self) -> String {
        let mut osm = Osm::default();
        for way in self.roads() {
            osm.way(&way);
        }
        for movement in &self.movements {
            let [left, right] = bounds(movement, 0.5 * self.arms[movement.from].lane_width);
            let (left, right) = (osm.way(&virtual_line(left)), osm.way(&virtual_line(right)));
            osm.lanelet(left, right);
        }
        osm.finish()
    }

    fn roads(&self) -> Vec<Way> {
        let mut ways = Vec::new();
        for (i, arm) in self.arms.iter().enumerate() {
            let next = &self.arms[(i + 1) % self.arms.len()];
            ways.push(Way {
                class: "curbstone",
                subtype: "low",
                points: kerb(arm, next),
            });
            ways.push(Way {
                class: "line_thin",
                subtype: "solid_solid",
                points: vec![arm.across(arm.line, 0.0), arm.across(arm.edge, 0.0)],
            });
            if self.stops(arm) {
                ways.push(Way {
                    class: "stop_line",
                    subtype: "",
                    points: vec![
                        arm.across(arm.line, 0.0),
                        arm.across(arm.line, arm.lane_width),
                    ],
                });
            }
        }
        ways
    }
}

impl Arm {
    /// The point `out` m from the centre and `aside` m to the left of the axis, seen outwards.
    fn across(&self, out: f32, aside: f32) -> Point {
        CENTRE + self.outward * out + Vector::new(-self.outward.y, self.outward.x) * aside
    }
}

/// From the edge of `arm` along its inbound lane, round the corner and out along `next`.
fn kerb(arm: &Arm, next: &Arm) -> Vec<Point> {
    let begin = arm.across(arm.line - CORNER, arm.lane_width);
    let end = next.across(next.line - CORNER, -next.lane_width);
    let mut points = vec![arm.across(arm.edge, arm.lane_width)];
    points.extend(curve(begin, arm.outward * -1.0, end, next.outward));
    points.push(next.across(next.edge, -next.lane_width));
    points
}

fn bounds(movement: &Movement, half_width: f32) -> [Vec<Point>; 2] {
    let route = &movement.route;
    let count = (route.length() / SPACING) as u16;
    let side = |sign: f32| {
        (0..=count)
            .map(|i| {
                let pose = route.pose(route.length() * f32::from(i) / f32::from(count));
                pose.position
                    + Vector::new(-pose.direction.y, pose.direction.x) * (sign * half_width)
            })
            .collect()
    };
    [side(1.0), side(-1.0)]
}

fn virtual_line(points: Vec<Point>) -> Way {
    Way {
        class: "virtual",
        subtype: "",
        points,
    }
}

/// A map under construction; every element has a number of its own.
#[derive(Default)]
struct Osm {
    nodes: String,
    ways: String,
    relations: String,
    last: u32,
}

impl Osm {
    fn number(&mut self) -> u32 {
        self.last += 1;
        self.last
    }

    fn way(&mut self, way: &Way) -> u32 {
        let mut references = String::new();
        for point in &way.points {
            let node = self.number();
            let [latitude, longitude] = to_degrees([point.x.into(), point.y.into()]);
            let _ = writeln!(
                self.nodes,
                "  <node id=\"{node}\" visible=\"true\" version=\"1\" lat=\"{latitude:.12}\" lon=\"{longitude:.12}\" />"
            );
            let _ = writeln!(references, "    <nd ref=\"{node}\" />");
        }
        let number = self.number();
        let _ = writeln!(
            self.ways,
            "  <way id=\"{number}\" visible=\"true\" version=\"1\">\n{references}{}{}  </way>",
            tag("type", way.class),
            tag("subtype", way.subtype),
        );
        number
    }

    fn lanelet(&mut self, left: u32, right: u32) {
        let number = self.number();
        let _ = writeln!(
            self.relations,
            "  <relation id=\"{number}\" visible=\"true\" version=\"1\">\n\
             \x20   <member type=\"way\" ref=\"{left}\" role=\"left\" />\n\
             \x20   <member type=\"way\" ref=\"{right}\" role=\"right\" />\n{}{}{}{}  </relation>",
            tag("type", "lanelet"),
            tag("subtype", "road"),
            tag("location", "urban"),
            tag("one_way", "yes"),
        );
    }

    fn finish(self) -> String {
        format!(
            "<?xml version=\"1.0\"?>\n<osm version=\"0.6\" generator=\"cede\">\n{}{}{}</osm>\n",
            self.nodes, self.ways, self.relations
        )
    }
}

fn tag(key: &str, value: &str) -> String {
    if value.is_empty() {
        return String::new();
    }
    format!("    <tag k=\"{key}\" v=\"{value}\" />\n")
}
