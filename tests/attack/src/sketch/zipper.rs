//! Lanes side by side that become one.

use super::pen::Pen;
use super::{APPROACH, LEAVING, Users, Way, smooth};
use crate::plane::{Place, along, heading, left};
use crate::rng::Rng;
use std::f64::consts::TAU;

/// One straight lane, and others beside it that run into it over 10 to 50 m; some leave it again.
#[must_use]
pub fn zipper(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let base = rng.within(0.0, TAU);
    let to = heading(base);
    let way = |entry| {
        let kind = users.kind(rng);
        let size = kind.size(rng);
        let aside = match entry % 3 {
            0 => 0.0,
            _ => rng.sign() * rng.within(0.8, 4.5),
        };
        let (from, length) = (rng.within(-20.0, 5.0), rng.within(10.0, 50.0));
        let beside = |ahead: f64, aside: f64| along(along([0.0, 0.0], to, ahead), left(to), aside);
        let joined = |ahead: f64, aside: f64| Place {
            at: beside(ahead, aside),
            to,
        };
        let bend = smooth(size.radius());
        let straight = Pen::at(beside(from - APPROACH, aside), base).straight(APPROACH);
        let mut drawn = || {
            let merged = straight.clone().curve(joined(from + length, 0.0), bend)?;
            if entry % 3 != 2 {
                return Some(merged);
            }
            let beyond = from + length + rng.within(5.0, 30.0);
            let again = joined(beyond + length, -aside);
            merged.straight(beyond - from - length).curve(again, bend)
        };
        // Too sharp a curve: it stays beside.
        let pen = (aside != 0.0).then(&mut drawn).flatten();
        let points = pen.unwrap_or(straight).straight(LEAVING).done();
        Way::whole(points, kind, size, entry)
    };
    (0..count).map(way).collect()
}
