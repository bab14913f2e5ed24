//! Ways with kinks of up to a right angle, as a map without detail has them.

use super::pen::Pen;
use super::{APPROACH, LEAVING, Users, Way};
use crate::rng::Rng;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Ways that turn in single points near the middle.
#[must_use]
pub fn corners(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let way = |entry| {
        let kind = users.kind(rng);
        let size = kind.size(rng);
        let angle = rng.within(0.0, TAU);
        let (cos, sin) = (angle.cos(), angle.sin());
        let (back, aside) = (APPROACH + rng.within(-4.0, 4.0), rng.within(-4.0, 4.0));
        let start = [-back * cos - aside * sin, -back * sin + aside * cos];
        let mut pen = Pen::at(start, angle).straight(APPROACH);
        for _ in 0..1 + rng.below(2) {
            let turn = rng.within(-0.99, 0.99) * FRAC_PI_2;
            pen = pen.turn(turn).straight(rng.within(3.0, 14.0));
        }
        let points = pen.straight(LEAVING).done();
        Way::whole(points, kind, size, entry)
    };
    (0..count).map(way).collect()
}
