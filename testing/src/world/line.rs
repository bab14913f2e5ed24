//! Roads in double precision.

use cede_controller::Polyline;

/// A polyline, straight on beyond its ends.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    points: Vec<[f64; 2]>,
    arc: Vec<f64>,
}

/// A place and a direction of length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub(crate) at: [f64; 2],
    pub(crate) towards: [f64; 2],
}

impl Line {
    pub(crate) fn new(polyline: Polyline<'_>) -> Self {
        let points = polyline.points().iter();
        let points: Vec<_> = points.map(|p| [f64::from(p.x), f64::from(p.y)]).collect();
        let mut arc = vec![0.0];
        for pair in points.windows(2) {
            let [x, y] = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            arc.push(arc[arc.len() - 1] + x.hypot(y));
        }
        Self { points, arc }
    }

    /// Metres.
    pub(crate) fn length(&self) -> f64 {
        self.arc.last().copied().unwrap_or(0.0)
    }

    /// At arc length `s` (m), `beside` metres to the left.
    pub(crate) fn place(&self, s: f64, beside: f64) -> Place {
        let after = self.arc.partition_point(|&a| a <= s);
        let i = after.clamp(1, self.points.len() - 1);
        let ([x, y], [u, v]) = (self.points[i - 1], self.points[i]);
        let length = self.arc[i] - self.arc[i - 1];
        let [cos, sin] = [(u - x) / length, (v - y) / length];
        let along = s - self.arc[i - 1];
        Place {
            at: [
                x + along * cos - beside * sin,
                y + along * sin + beside * cos,
            ],
            towards: [cos, sin],
        }
    }
}
