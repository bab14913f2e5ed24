//! Intersections of arms: in by one, out by another.

use super::pen::Pen;
use super::{APPROACH, LEAVING, Users, Way, smooth};
use crate::plane::{Place, V2, along, heading, left};
use crate::rng::Rng;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Where the lanes of one arm meet the intersection.
#[derive(Clone, Copy)]
struct Arm {
    angle: f64,
    radius: f64,
    /// Of each lane from the middle of the arm.
    aside: f64,
}

impl Arm {
    fn outwards(self) -> V2 {
        heading(self.angle)
    }

    /// Where its incoming lane ends; driving is on the right.
    fn entry(self) -> Place {
        let out = self.outwards();
        Place {
            at: along(
                [out[0] * self.radius, out[1] * self.radius],
                left(out),
                self.aside,
            ),
            to: [-out[0], -out[1]],
        }
    }

    /// Where its outgoing lane begins.
    fn exit(self) -> Place {
        let out = self.outwards();
        Place {
            at: along(
                [out[0] * self.radius, out[1] * self.radius],
                left(out),
                -self.aside,
            ),
            to: out,
        }
    }
}

/// The way in by one arm and out by another; `None` where it would bend too much.
fn way(arms: &[Arm], from: usize, to: usize, users: Users, rng: &mut Rng) -> Option<Way> {
    let kind = users.kind(rng);
    let size = kind.size(rng);
    let (entry, exit) = (arms[from].entry(), arms[to].exit());
    let start = along(entry.at, entry.to, -APPROACH);
    let pen = Pen::at(start, entry.to[1].atan2(entry.to[0])).straight(APPROACH);
    let points = pen
        .curve(exit, smooth(size.radius()))?
        .straight(LEAVING)
        .done();
    Some(Way::whole(points, kind, size, from))
}

/// `count` ways between random arms of `arms`, all out by the same one if `merging`.
fn ways(arms: &[Arm], count: usize, merging: bool, users: Users, rng: &mut Rng) -> Vec<Way> {
    let out = rng.below(arms.len());
    let mut found: Vec<Way> = Vec::new();
    for _ in 0..8 * count {
        let from = rng.below(arms.len());
        let to = if merging { out } else { rng.below(arms.len()) };
        if from != to
            && let Some(way) = way(arms, from, to, users, rng)
            && found.iter().all(|other| other.points != way.points)
        {
            found.push(way);
        }
        if found.len() == count {
            break;
        }
    }
    found
}

fn four(rng: &mut Rng) -> Vec<Arm> {
    let (turn, radius) = (rng.within(0.0, TAU), rng.within(7.0, 12.0));
    let aside = rng.within(1.6, 2.2);
    let arm = |i| Arm {
        angle: turn + FRAC_PI_2 * f64::from(i),
        radius,
        aside,
    };
    (0..4).map(arm).collect()
}

/// Arms at random angles, no two nearer than half a radian.
fn any(rng: &mut Rng) -> Vec<Arm> {
    let count = 3 + rng.below(3);
    let mut arms: Vec<Arm> = Vec::new();
    for _ in 0..60 {
        let angle = rng.within(0.0, TAU);
        let near = |arm: &Arm| (angle - arm.angle).cos() > 0.5_f64.cos();
        if !arms.iter().any(near) && arms.len() < count {
            arms.push(Arm {
                angle,
                radius: rng.within(10.0, 16.0),
                aside: rng.within(1.6, 2.5),
            });
        }
    }
    arms
}

/// Four arms at right angles.
#[must_use]
pub fn crossroads(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let arms = four(rng);
    ways(&arms, count, false, users, rng)
}

/// Three to five arms at any angles.
#[must_use]
pub fn star(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let arms = any(rng);
    ways(&arms, count, false, users, rng)
}

/// Everybody leaves by one arm.
#[must_use]
pub fn merge(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let arms = if rng.chance(0.5) { four(rng) } else { any(rng) };
    ways(&arms, count, true, users, rng)
}
