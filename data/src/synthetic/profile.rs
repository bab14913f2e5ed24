//! What a route allows: how fast people take it, foot by foot.

use crate::encounter::SimRoute;

/// Sideways acceleration (m/s²) that a plain driver accepts in a curve.
const CORNERING: f32 = 1.1;
/// Deceleration (m/s²) at which a plain driver slows down for a curve.
const SLOWING: f32 = 1.0;
/// Distance (m) between the profile's samples.
const SPACING: f32 = 1.0;
/// Half the stretch (m) over which curvature is measured: recorded routes have kinks.
const HALF_STRETCH: f32 = 3.0;

/// Speed (m/s) of a plain driver along a route, if nothing is in its way.
#[derive(Clone, Debug)]
pub struct SpeedProfile {
    speeds: Vec<f32>,
}

impl SpeedProfile {
    /// The profile of `route`, at most `speed_at(s)` m/s. Cost: O(length · log points).
    #[must_use]
    pub fn new(route: &SimRoute, speed_at: impl Fn(f32) -> f32) -> Self {
        let mut speeds = Vec::new();
        let mut s = 0.0;
        while s <= route.length() + SPACING {
            speeds.push(speed_at(s).min(in_curve(route, s)));
            s += SPACING;
        }
        for i in (1..speeds.len()).rev() {
            let before = libm::sqrtf(speeds[i] * speeds[i] + 2.0 * SLOWING * SPACING);
            speeds[i - 1] = speeds[i - 1].min(before);
        }
        Self { speeds }
    }

    /// Speed (m/s) at arc length `s` (m), and its slope in 1/s; constant beyond both ends.
    #[must_use]
    pub fn at(&self, s: f32) -> (f32, f32) {
        let last = self.speeds.len() - 2;
        let x = (s / SPACING).clamp(0.0, last as f32);
        let i = x as usize;
        let (a, b) = (self.speeds[i.min(last)], self.speeds[i.min(last) + 1]);
        (a + (b - a) * (x - i as f32), (b - a) / SPACING)
    }

    /// The least speed (m/s) from `from` to `to` (m).
    #[must_use]
    pub fn slowest(&self, from: f32, to: f32) -> f32 {
        let index = |s: f32| ((s / SPACING).max(0.0) as usize).min(self.speeds.len() - 1);
        let speeds = &self.speeds[index(from)..=index(to.max(from))];
        speeds.iter().copied().fold(f32::INFINITY, f32::min)
    }
}

fn in_curve(route: &SimRoute, s: f32) -> f32 {
    let (before, after) = (route.pose(s - HALF_STRETCH), route.pose(s + HALF_STRETCH));
    let turn = libm::atan2f(
        before.direction.perp(&after.direction),
        before.direction.dot(&after.direction),
    );
    let curvature = turn.abs() / (2.0 * HALF_STRETCH);
    libm::sqrtf(CORNERING / curvature.max(1e-3))
}
