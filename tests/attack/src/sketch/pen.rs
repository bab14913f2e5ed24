//! Draws one way piece by piece.

use crate::plane::{Place, V2, along, direction, dot, heading, minus, norm};

/// A way that is being drawn, and where its end points.
#[derive(Clone, Debug)]
pub(super) struct Pen {
    points: Vec<V2>,
    angle: f64,
}

impl Pen {
    /// Begins at `at` in the direction `angle` (rad).
    pub(super) fn at(at: V2, angle: f64) -> Self {
        Self {
            points: vec![at],
            angle,
        }
    }

    fn end(&self) -> V2 {
        self.points[self.points.len() - 1]
    }

    /// Straight on.
    pub(super) fn straight(mut self, length: f64) -> Self {
        self.points
            .push(along(self.end(), heading(self.angle), length));
        self
    }

    /// Turns on the spot by `angle` (rad), to the left if positive.
    pub(super) fn turn(mut self, angle: f64) -> Self {
        self.angle += angle;
        self
    }

    /// A circular arc of `length` m with this curvature (1/m, to the left if positive); no kink exceeds `bend`.
    pub(super) fn arc(mut self, length: f64, curvature: f64, bend: f64) -> Self {
        let steps = (length * curvature.abs() / bend).ceil().max(1.0);
        let (step, turn) = (length / steps, length * curvature / steps);
        for _ in 0..steps as usize {
            // The chord of an arc points halfway between the directions at its ends.
            self.points
                .push(along(self.end(), heading(self.angle + 0.5 * turn), step));
            self.angle += turn;
        }
        self
    }

    /// A smooth curve to `to`; as many points as no kink exceeds `bend` with, `None` if that takes too many.
    pub(super) fn curve(mut self, to: Place, bend: f64) -> Option<Self> {
        let from = Place {
            at: self.end(),
            to: heading(self.angle),
        };
        for count in [1, 4, 8, 16, 24, 32, 48] {
            let drawn = hermite(from, to, count);
            if bends_at_most(from, &drawn, to.to, bend) {
                self.points.extend(drawn);
                self.angle = to.to[1].atan2(to.to[0]);
                return Some(self);
            }
        }
        None
    }

    /// The points, in the precision in which the controller gets them.
    pub(super) fn done(self) -> Vec<[f32; 2]> {
        let points = self.points.iter().map(|p| p.map(|c| c as f32));
        points.collect()
    }
}

/// `count` points after `from`, the last one at `to`, on the cubic that has both directions.
fn hermite(from: Place, to: Place, count: usize) -> Vec<V2> {
    let scale = 1.2 * norm(minus(to.at, from.at));
    let point = |i: usize| {
        let t = i as f64 / count as f64;
        let (h1, h2) = (t * t * (3.0 - 2.0 * t), t * (1.0 - t) * (1.0 - t));
        let h3 = t * t * (t - 1.0);
        let straight = along(from.at, minus(to.at, from.at), h1);
        along(along(straight, from.to, scale * h2), to.to, scale * h3)
    };
    (1..count).map(point).chain([to.at]).collect()
}

/// Whether no kink of the curve after `from`, the one at its end included, exceeds `bend` (rad).
fn bends_at_most(from: Place, points: &[V2], after: V2, bend: f64) -> bool {
    let (mut at, mut heading) = (from.at, from.to);
    for &point in points {
        let step = direction(minus(point, at));
        if dot(heading, step) < bend.cos() {
            return false;
        }
        (at, heading) = (point, step);
    }
    dot(heading, after) >= bend.cos()
}
