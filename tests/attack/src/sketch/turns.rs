//! Roads that turn in single points, shared by many, and the wide arcs of lorries beside them.

use super::pen::Pen;
use super::{APPROACH, Kind, LEAVING, Users, Way, smooth};
use crate::plane::{V2, along, heading};
use crate::rng::Rng;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A corner that many turn at.
#[derive(Clone, Copy)]
struct Corner {
    at: V2,
    /// Directions (rad) of the two roads that meet there.
    roads: [f64; 2],
}

/// Ways around two corners: they are one lane before a kink and after it.
#[must_use]
pub fn turns(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let base = rng.within(0.0, TAU);
    let corners = [0.0, rng.within(5.0, 14.0)].map(|ahead| Corner {
        at: along([0.0, 0.0], heading(base), ahead),
        roads: [base, base + rng.sign() * rng.within(0.4, 0.99) * FRAC_PI_2],
    });
    let way = |entry| {
        let kind = users.kind(rng);
        let size = kind.size(rng);
        let pen = around(rng.pick(&corners), kind, smooth(size.radius()), rng);
        Way::whole(pen.straight(LEAVING).done(), kind, size, entry)
    };
    (0..count).map(way).collect()
}

/// Along one road to the corner and along one away from it: by a kink, by two, or by an arc.
fn around(corner: Corner, kind: Kind, bend: f64, rng: &mut Rng) -> Pen {
    let [from, to] = [(); 2].map(|()| rng.pick(&corner.roads));
    let pen = Pen::at(along(corner.at, heading(from), -APPROACH), from).straight(APPROACH);
    let angle = to - from;
    match rng.below(4) {
        0 if angle != 0.0 && kind == Kind::Lorry => {
            let radius = rng.within(9.0, 14.0);
            pen.arc(radius * angle.abs(), angle.signum() / radius, bend)
        }
        1 => pen
            .turn(0.5 * angle)
            .straight(rng.within(2.0, 8.0))
            .turn(0.5 * angle),
        _ => pen.turn(angle),
    }
}
