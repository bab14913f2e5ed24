//! Ways that no arms give: curves, ways side by side, ways that weave, lanes.

use super::pen::Pen;
use super::{APPROACH, LEAVING, Users, Way, smooth};
use crate::plane::{V2, along, heading};
use crate::rng::Rng;
use std::f64::consts::{PI, TAU};

/// A way that passes `through` a point at `angle` with a constant curvature (1/m) from well before it to well after.
fn bent(through: V2, angle: f64, curvature: f64, entry: usize, users: Users, rng: &mut Rng) -> Way {
    let kind = users.kind(rng);
    let size = kind.size(rng);
    let bend = smooth(size.radius());
    // Drawn backwards to where the bend begins, then forwards.
    let half = (1.6 / curvature.abs().max(1e-9)).min(45.0);
    let back = Pen::at(through, angle + PI).arc(half, -curvature, bend);
    let from = back.done();
    let begin = from[from.len() - 1].map(f64::from);
    let begins = angle - half * curvature;
    let start = along(begin, heading(begins), half - APPROACH);
    let points = Pen::at(start, begins)
        .straight(APPROACH - half)
        .arc(2.0 * half, curvature, bend)
        .straight(LEAVING)
        .done();
    Way::whole(points, kind, size, entry)
}

/// Ways that bend all along.
#[must_use]
pub fn curves(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let way = |entry| {
        let through = [rng.within(-5.0, 5.0), rng.within(-5.0, 5.0)];
        let curvature = rng.sign() / rng.within(14.0, 70.0);
        bent(through, rng.within(0.0, TAU), curvature, entry, users, rng)
    };
    (0..count).map(way).collect()
}

/// Two straight ways across each other.
#[must_use]
pub fn across(users: Users, rng: &mut Rng) -> Vec<Way> {
    let base = rng.within(0.0, TAU);
    let angles = [base, base + rng.sign() * rng.within(0.9, 2.2)];
    let way = |(entry, &angle): (usize, &f64)| bent([0.0; 2], angle, 0.0, entry, users, rng);
    angles.iter().enumerate().map(way).collect()
}

/// Ways in nearly the same direction, or nearly the opposite one, that touch over a long way.
#[must_use]
pub fn near_parallel(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let base = rng.within(0.0, TAU);
    let way = |entry| {
        let through = [rng.within(-3.0, 3.0), rng.within(-3.0, 3.0)];
        let opposite = if rng.chance(0.25) { PI } else { 0.0 };
        let angle = base + opposite + rng.within(-0.12, 0.12);
        let curvature = rng.pick(&[0.0, 0.0, 0.002, -0.004]);
        bent(through, angle, curvature, entry, users, rng)
    };
    (0..count).map(way).collect()
}

/// Arcs to the left and right in turns, across a straight line that it crosses two or three times.
#[must_use]
pub fn weaving(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let base = rng.within(0.0, TAU);
    let way = |entry| match entry % 2 {
        0 => bent([0.0, rng.within(-1.0, 1.0)], base, 0.0, entry, users, rng),
        _ => weave(base, entry, users, rng),
    };
    (0..count).map(way).collect()
}

/// Crosses the line through the origin in the direction `base` two or three times.
fn weave(base: f64, entry: usize, users: Users, rng: &mut Rng) -> Way {
    let kind = users.kind(rng);
    let size = kind.size(rng);
    let bend = smooth(size.radius());
    let side = rng.sign();
    let curvature = side / rng.within(12.0, 25.0);
    // The angle at which it crosses the line each time.
    let slant = side * rng.within(0.5, 1.2);
    let arc = 2.0 * slant / curvature;
    let arcs = 1 + rng.below(2);
    let first = [rng.within(-25.0, -5.0), 0.0];
    let first = along([0.0, 0.0], heading(base), first[0]);
    let mut pen = Pen::at(along(first, heading(base - slant), -APPROACH), base - slant);
    pen = pen.straight(APPROACH);
    for i in 0..arcs {
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        pen = pen.arc(arc.abs(), sign * curvature, bend);
    }
    Way::whole(pen.straight(LEAVING).done(), kind, size, entry)
}

/// Ways with hairpins, some of them through the same ground twice.
#[must_use]
pub fn winding(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let way = |entry| {
        let kind = users.kind(rng);
        let size = kind.size(rng);
        let bend = smooth(size.radius());
        let mut pen = Pen::at(
            [rng.within(-70.0, -50.0), rng.within(-8.0, 8.0)],
            rng.within(-0.2, 0.2),
        );
        pen = pen.straight(APPROACH - 40.0);
        for _ in 0..2 + rng.below(2) {
            let radius = rng.within(8.0, 20.0);
            let length = radius * rng.within(0.5, 2.8);
            pen = pen
                .arc(length, rng.sign() / radius, bend)
                .straight(rng.within(1.0, 12.0));
        }
        Way::whole(pen.straight(LEAVING).done(), kind, size, entry)
    };
    (0..count).map(way).collect()
}

/// One lane, straight or bent, and ways across it.
#[must_use]
pub fn lanes(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let base = rng.within(0.0, TAU);
    let way = |entry| {
        let curvature = rng.pick(&[0.0, 0.0, 0.01, -0.02]);
        let through = [rng.within(-4.0, 4.0), rng.within(-4.0, 4.0)];
        if entry == 0 {
            bent([0.0, 0.0], base, curvature, entry, users, rng)
        } else {
            let across = rng.sign() * rng.within(0.7, 2.4);
            bent(through, base + across, 0.0, entry, users, rng)
        }
    };
    (0..count).map(way).collect()
}

/// Crossing ways, and as many others that are far from all of them.
#[must_use]
pub fn with_bystanders(count: usize, users: Users, rng: &mut Rng) -> Vec<Way> {
    let mut ways = super::crossroads(count, users, rng);
    for entry in 0..2 {
        let aside = 118.0 + 20.0 * entry as f64;
        ways.push(bent([aside, 0.0], 1.5 * PI, 0.0, 10 + entry, users, rng));
    }
    ways
}
