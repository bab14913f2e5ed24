//! Two junctions in a row along one road.

use super::{APPROACH, Cut, Kind, LEAVING, Users, Way};
use crate::plane::{V2, along, heading};
use crate::rng::Rng;

/// Where the second junction is on the road, from the first.
const APART: f64 = 110.0;

/// A road through two junctions (the first way), and ways across it in both.
#[must_use]
pub fn row(across: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let mut ways = vec![road(rng)];
    for entry in 1..=across {
        let junction = entry % 2;
        let at = [APART * junction as f64 + rng.within(-3.0, 3.0), 0.0];
        ways.push(crossing(at, junction, entry, users, rng));
    }
    ways
}

fn road(rng: &mut Rng) -> Way {
    let kind = Kind::Car;
    let size = kind.size(rng);
    let stations = [-APPROACH, 60.0, APART + LEAVING];
    let points = stations.map(|x| [x as f32, 0.0]).to_vec();
    let cut = |junction, from, to| Cut { junction, from, to };
    Way {
        pace: 0.0,
        points,
        kind,
        size,
        entry: 0,
        // Those at the second junction see it from the beginning: nobody appears there.
        cuts: vec![cut(0, 0, 2), cut(1, 0, 3)],
    }
}

fn crossing(at: V2, junction: usize, entry: usize, users: Users, rng: &mut Rng) -> Way {
    let kind = users.kind(rng);
    let size = kind.size(rng);
    let to = heading(rng.sign() * rng.within(0.8, 2.3));
    let points = [-APPROACH, LEAVING].map(|k| along(at, to, k).map(|c| c as f32));
    Way {
        cuts: vec![Cut {
            junction,
            from: 0,
            to: 2,
        }],
        ..Way::whole(points.to_vec(), kind, size, entry)
    }
}
