//! SVO of many pairs at once: the same angle as [`cede_controller::svo`], by a polynomial that vectorises.

use super::{LANES, Lanes};
use cede_controller::svo::MIN_DISTANCE;
use core::f32::consts::FRAC_PI_2;

/// (atan t − t) / t³ on [0, 1] as a polynomial in t², lowest power first: a fit to the least
/// largest error, 4.9·10⁻⁸ before rounding.
const ARC_TANGENT: [f32; 7] = [
    -0.333_316_6,
    0.199_627_04,
    -0.139_765_81,
    0.097_942_34,
    -0.057_773_575,
    0.023_040_125,
    -0.004_355_403,
];

/// Speeds in m/s and distances to the conflict point in m of two vehicles, and the SVO of the first in rad.
///
/// Within 4·10⁻⁷ rad of [`cede_controller::svo::svo`] for speeds ≥ 0 that are 0 or ≥ 10⁻³⁰.
#[inline]
pub(super) fn svo(speed: [&Lanes; 2], distance: [&Lanes; 2], last: &Lanes) -> Lanes {
    let mut result = [0.0; LANES];
    for lane in 0..LANES {
        let own = speed[0][lane] * floor(distance[1][lane]);
        let others = speed[1][lane] * floor(distance[0][lane]);
        let angle = first_quadrant_angle(others, own);
        // At rest, both of them, the angle is not defined.
        result[lane] = if own + others > 0.0 {
            angle
        } else {
            last[lane]
        };
    }
    result
}

#[inline]
fn floor(distance: f32) -> f32 {
    if distance > MIN_DISTANCE {
        distance
    } else {
        MIN_DISTANCE
    }
}

/// atan2(y, x) for x, y ≥ 0, not both 0.
#[inline]
fn first_quadrant_angle(y: f32, x: f32) -> f32 {
    let steep = y > x;
    let (low, high) = if steep { (x, y) } else { (y, x) };
    let t = low / high;
    let square = t * t;
    let [c0, c1, c2, c3, c4, c5, c6] = ARC_TANGENT;
    let series = c5 + square * c6;
    let series = c4 + square * series;
    let series = c3 + square * series;
    let series = c2 + square * series;
    let series = c1 + square * series;
    let series = c0 + square * series;
    let angle = t + t * square * series;
    if steep { FRAC_PI_2 - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f32 = 4e-7;

    fn deviation(v: f32, d: f32, other_v: f32, other_d: f32) -> f32 {
        let all = |x| [x; LANES];
        let fast = svo(
            [&all(v), &all(other_v)],
            [&all(d), &all(other_d)],
            &all(0.3),
        );
        let exact = cede_controller::svo::svo(v, d, other_v, other_d, 0.3);
        (fast[0] - exact).abs()
    }

    #[test]
    fn agrees_with_the_controller_over_all_angles() {
        // Every angle in steps of 2⁻²⁰ of the slope, both ways round.
        for i in 0..=1_u32 << 20 {
            let slope = i as f32 / (1_u32 << 20) as f32;
            for worst in [
                deviation(1.0, 1.0, slope, 1.0),
                deviation(slope, 1.0, 1.0, 1.0),
            ] {
                assert!(worst <= TOLERANCE, "{slope}: {worst}");
            }
        }
    }

    #[test]
    fn agrees_at_the_edges() {
        for (v, d) in [
            (0.0, 10.0),
            (5.0, 0.0),
            (5.0, -1.0),
            (0.0, 0.0),
            (30.0, 200.0),
            (1e-30, 5.0),
        ] {
            for (other_v, other_d) in [(0.0, 10.0), (3.0, 0.0), (1e-3, 100.0), (0.0, 0.0)] {
                assert!(deviation(v, d, other_v, other_d) <= TOLERANCE);
            }
        }
    }
}
