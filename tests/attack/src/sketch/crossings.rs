//! Ways on foot across the road.

use super::pen::Pen;
use super::{Kind, Users, Way};
use crate::plane::{along, heading};
use crate::rng::Rng;
use std::f64::consts::FRAC_PI_2;

/// The paces (m/s) of those on foot: slow, as a controller expects unless it is told, and running.
const PACES: [f64; 3] = [1.5, 3.0, 6.0];

/// A star of `count` ways, which up to three ways on foot cross somewhere. Those come last.
#[must_use]
pub fn with_crossings(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let mut ways = super::star(count, users, rng);
    let roads = ways.len();
    if roads == 0 {
        return ways;
    }
    for number in 0..1 + rng.below(3) {
        let road = &ways[rng.below(roads)].points;
        let end = 1 + rng.below(road.len() - 1);
        let [from, to] = [end - 1, end].map(|i| road[i].map(f64::from));
        let share = rng.within(0.0, 1.0);
        let middle = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
        let along_road = (to[1] - from[1]).atan2(to[0] - from[0]);
        let angle = along_road + rng.sign() * FRAC_PI_2 + rng.within(-0.5, 0.5);
        let half = rng.within(6.0, 14.0);
        let start = along(middle, heading(angle), -half);
        let points = Pen::at(start, angle).straight(2.0 * half).done();
        let kind = Kind::Pedestrian;
        let mut way = Way::whole(points, kind, kind.size(rng), 100 + number);
        way.pace = rng.pick(&PACES);
        ways.push(way);
    }
    ways
}
