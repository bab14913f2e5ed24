//! Where two ways across get into each other's way.

use crate::encounter::SimRoute;
use cede_controller::Footprint;
use cede_controller::geometry::distance;
use cede_controller::separation::OrientedBox;

/// How one movement meets another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RouteRelation {
    /// They never touch.
    Never,
    /// They share a lane up to this arc length (m) and then part.
    Parting(f32),
    /// They cross, or run into one lane.
    Conflict(Zone),
}

/// Arc lengths (m) of the vehicles' centres between which both are in each other's way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    /// Where it begins and ends on one's own route.
    pub own: (f32, f32),
    /// Where it begins and ends on the other's route.
    pub other: (f32, f32),
}

/// The vehicle for which zones are laid out: a car with some room about it.
const ROOMY: Footprint = Footprint {
    length: 5.4,
    width: 2.6,
};
/// Routes closer than this (m) count as one lane.
const ONE_LANE: f32 = 0.8;
/// Distance (m) between samples along the routes.
const SPACING: f32 = 0.5;

/// Arc length (m) up to which two routes from one start lie side by side.
pub(crate) fn parting(own: &SimRoute, other: &SimRoute) -> f32 {
    let aside = |s: f32| distance(&own.pose(s).position, &other.pose(s).position);
    let parted = samples(own.length()).find(|&s| aside(s) > ROOMY.width);
    parted.unwrap_or(own.length())
}

/// The zone of two routes; where they run into one lane it ends when they have become one.
pub fn zone(own: &SimRoute, other: &SimRoute, merging: bool) -> Option<Zone> {
    let boxes = |route: &SimRoute| -> Vec<OrientedBox> {
        samples(route.length())
            .map(|s| OrientedBox::new(route.pose(s), ROOMY))
            .collect()
    };
    let (ours, theirs) = (boxes(own), boxes(other));
    let reach = ROOMY.length + ROOMY.width;
    let mut own_range = Range::default();
    let mut other_range = Range::default();
    for (i, a) in ours.iter().enumerate() {
        for (j, b) in theirs.iter().enumerate() {
            let between = a.centre - b.centre;
            if between.dot(&between) < reach * reach && a.overlaps(b) {
                own_range.include(i);
                other_range.include(j);
            }
        }
    }
    let (mut zone_own, mut zone_other) = (own_range.metres()?, other_range.metres()?);
    if merging {
        let rest = one_lane_rest(own, other);
        zone_own.1 = zone_own.1.min(own.length() - rest);
        zone_other.1 = zone_other.1.min(other.length() - rest);
    }
    Some(Zone {
        own: zone_own,
        other: zone_other,
    })
}

/// How long (m) a stretch at the end of both routes is one lane.
fn one_lane_rest(own: &SimRoute, other: &SimRoute) -> f32 {
    let at = |route: &SimRoute, rest: f32| route.pose(route.length() - rest).position;
    let apart = |rest: f32| distance(&at(own, rest), &at(other, rest)) > ONE_LANE;
    samples(own.length().min(other.length()))
        .find(|&rest| apart(rest))
        .unwrap_or(0.0)
}

fn samples(length: f32) -> impl Iterator<Item = f32> {
    (0..=(length / SPACING) as u16).map(|i| f32::from(i) * SPACING)
}

/// First and last sample that belong to a zone.
#[derive(Default)]
struct Range(Option<(usize, usize)>);

impl Range {
    fn include(&mut self, i: usize) {
        let (first, last) = self.0.unwrap_or((i, i));
        self.0 = Some((first.min(i), last.max(i)));
    }

    fn metres(&self) -> Option<(f32, f32)> {
        self.0
            .map(|(first, last)| (first as f32 * SPACING, last as f32 * SPACING))
    }
}
