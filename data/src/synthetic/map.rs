//! The map of a synthetic site: kerbs, lines, lanes and signs, as Lanelet2 has them.

use super::layout::{Arm, Layout, Movement, curve};
use super::plan::Control;
use crate::lanelet::Sign;
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
        for (i, arm) in self.arms.iter().enumerate() {
            let next = &self.arms[(i + 1) % self.arms.len()];
            for way in [kerb(arm, next), axis(arm)] {
                osm.way(&way);
            }
        }
        let bound: Vec<(&Arm, Bound)> = self
            .arms
            .iter()
            .map(|arm| (arm, self.approach(arm, &mut osm)))
            .collect();
        for movement in &self.movements {
            let arm = &self.arms[movement.from];
            let bounds = bounds(movement, arm, &self.arms[movement.to]);
            let [left, right] = bounds.map(|bound| osm.way(&virtual_line(bound)));
            osm.lanelet(left, right);
        }
        if self.signs {
            self.regulate(&bound, &mut osm);
        }
        osm.finish()
    }

    /// The lanes towards the centre and away from it on `arm`, and the line at their end.
    fn approach(&self, arm: &Arm, osm: &mut Osm) -> Bound {
        let line = osm.way(&Way {
            class: if self.stops(arm) {
                "stop_line"
            } else {
                "virtual"
            },
            subtype: "",
            points: vec![
                arm.across(arm.line, 0.0),
                arm.across(arm.line, arm.half_width()),
            ],
        });
        let mut lanelets = Vec::new();
        for lane in 0..arm.lanes {
            let sides = [lane, lane + 1].map(|lanes| arm.side(lanes));
            let [left, right] = sides.map(|side| {
                let ends = [arm.edge, arm.line].map(|out| arm.across(out, side));
                osm.way(&virtual_line(ends.to_vec()))
            });
            lanelets.push(osm.lanelet(left, right));
            let [left, right] = sides.map(|side| {
                let ends = [arm.line, arm.edge].map(|out| arm.across(out, -side));
                osm.way(&virtual_line(ends.to_vec()))
            });
            osm.lanelet(left, right);
        }
        Bound { line, lanelets }
    }

    /// The signs, and what they oblige to. Without any sign a rule that binds nobody says that this is known.
    fn regulate(&self, bound: &[(&Arm, Bound)], osm: &mut Osm) {
        let subtype = match self.control {
            Control::AllWayStop => "all_way_stop",
            _ => "right_of_way",
        };
        let mut members = String::new();
        for (arm, bound) in bound {
            let Some(sign) = self.sign(arm) else {
                continue;
            };
            let sign = osm.way(&Way {
                class: "traffic_sign",
                subtype: match sign {
                    Sign::Stop => "usR1-1",
                    Sign::Yield => "usR1-2",
                },
                points: vec![
                    arm.across(arm.line, arm.half_width() + 1.0),
                    arm.across(arm.line, arm.half_width() + 1.5),
                ],
            });
            members += &member("way", sign, "refers");
            members += &member("way", bound.line, "ref_line");
            for &lanelet in &bound.lanelets {
                members += &member("relation", lanelet, "yield");
            }
        }
        osm.regulation(subtype, &members);
    }
}

/// The line that ends the lanes of an arm towards the centre, and their lanelets.
struct Bound {
    line: u32,
    lanelets: Vec<u32>,
}

impl Arm {
    /// Width (m) of so many `lanes`.
    fn side(&self, lanes: u8) -> f32 {
        f32::from(lanes) * self.lane_width
    }

    /// From the road's axis to its kerb, m.
    fn half_width(&self) -> f32 {
        self.side(self.lanes)
    }
}

/// The road's axis up to the line.
fn axis(arm: &Arm) -> Way {
    Way {
        class: "line_thin",
        subtype: "solid_solid",
        points: vec![arm.across(arm.line, 0.0), arm.across(arm.edge, 0.0)],
    }
}

/// From the edge of `arm` along its outer inbound lane, round the corner and out along `next`.
fn kerb(arm: &Arm, next: &Arm) -> Way {
    let begin = arm.across(arm.line - CORNER, arm.half_width());
    let end = next.across(next.line - CORNER, -next.half_width());
    let mut points = vec![arm.across(arm.edge, arm.half_width())];
    points.extend(curve(begin, arm.outward * -1.0, end, next.outward));
    points.push(next.across(next.edge, -next.half_width()));
    Way {
        class: "curbstone",
        subtype: "low",
        points,
    }
}

/// The left and the right bound of the way of `movement` from the line of `from` to that of `to`. They begin and
/// end in the very points in which those of the lanes of the arms end and begin.
fn bounds(movement: &Movement, from: &Arm, to: &Arm) -> [Vec<Point>; 2] {
    let route = &movement.route;
    let (begin, end) = (movement.line, route.length() - (to.edge - to.line));
    let count = ((end - begin) / SPACING) as u16;
    let [inbound, outbound] = movement.lanes;
    let half = 0.5 * from.lane_width;
    [(0, half), (1, -half)].map(|(side, left)| {
        let between = (1..count).map(|i| {
            let pose = route.pose(begin + (end - begin) * f32::from(i) / f32::from(count));
            pose.position + Vector::new(-pose.direction.y, pose.direction.x) * left
        });
        [from.across(from.line, from.side(inbound + side))]
            .into_iter()
            .chain(between)
            .chain([to.across(to.line, -to.side(outbound + side))])
            .collect()
    })
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

    fn lanelet(&mut self, left: u32, right: u32) -> u32 {
        let members = member("way", left, "left") + &member("way", right, "right");
        let tags = [
            ("type", "lanelet"),
            ("subtype", "road"),
            ("location", "urban"),
            ("one_way", "yes"),
        ];
        self.relation(&members, &tags)
    }

    fn regulation(&mut self, subtype: &str, members: &str) -> u32 {
        self.relation(
            members,
            &[("type", "regulatory_element"), ("subtype", subtype)],
        )
    }

    fn relation(&mut self, members: &str, tags: &[(&str, &str)]) -> u32 {
        let number = self.number();
        let tags: String = tags.iter().map(|(key, value)| tag(key, value)).collect();
        let _ = writeln!(
            self.relations,
            "  <relation id=\"{number}\" visible=\"true\" version=\"1\">\n{members}{tags}  </relation>",
        );
        number
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

fn member(class: &str, number: u32, role: &str) -> String {
    format!("    <member type=\"{class}\" ref=\"{number}\" role=\"{role}\" />\n")
}
