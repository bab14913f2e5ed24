//! How fast a vehicle drives along its path, by speed limits and in bends, with nobody else there.

use crate::junction::path::SpeedLimit;
use crate::junction::polyline::{Piece, Polyline};
use crate::real::{Real, sqrt};
use core::ops::Range;

/// Braking (m/s²) with which a vehicle comes down to a lower speed ahead.
pub const COMFORT: f32 = 1.5;

/// The speed is what is allowed after so long (s): a shorter time makes it jerk.
const SMOOTH: f32 = 0.5;

/// A bend is as sharp as a path turns over this length (m).
const WINDOW: f32 = 4.0;

/// What bounds the speed of a vehicle along its path, whoever is there.
///
/// A proposal is bounded by it; a plan that a shield falls back on is not.
#[derive(Clone, Copy, Debug)]
pub struct Profile<'j> {
    polyline: Polyline<'j>,
    limits: &'j [SpeedLimit],
    lateral: f32,
}

/// A stretch of the path, and the speed that is allowed on it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stretch {
    /// From where to where (m).
    from: f32,
    to: f32,
    /// In m/s.
    speed: f32,
}

impl<'j> Profile<'j> {
    pub(super) const fn new(
        polyline: Polyline<'j>,
        limits: &'j [SpeedLimit],
        lateral: f32,
    ) -> Self {
        Self {
            polyline,
            limits,
            lateral,
        }
    }

    /// The speed (m/s) that is allowed at arc length `s` (m); infinite, if nothing bounds it there.
    ///
    /// Cost: O(points) if bends count.
    #[must_use]
    pub fn speed(self, s: f32) -> f32 {
        let here = |it: &Stretch| it.from <= s && s < it.to;
        let stretches = self.stretches(s, s).filter(here);
        stretches.fold(f32::INFINITY, |least, it| Real::min(least, it.speed))
    }

    /// The largest acceleration (m/s²) with which a vehicle at arc length `s` (m) with `speed` (m/s) keeps to the profile, if
    /// a command is followed after `response` (s): it comes down to a lower speed ahead at [`COMFORT`]. Infinite, if nothing
    /// bounds it.
    ///
    /// Cost: O(points) if bends count.
    #[must_use]
    pub fn acceleration(self, s: f32, speed: f32, response: f32) -> f32 {
        let time = SMOOTH + response;
        let ahead = self.stretches(s, s + sight(speed, time));
        let ahead = ahead.filter(|it| s < it.to);
        ahead.fold(f32::INFINITY, |least, it| {
            Real::min(least, slowing(it.speed, it.from - s, speed, time))
        })
    }

    /// Everything that bounds the speed between two arc lengths (m), and perhaps more.
    fn stretches(self, from: f32, to: f32) -> impl Iterator<Item = Stretch> + use<'j> {
        let ends = self.limits.iter().skip(1).map(|next| next.from);
        let ends = ends.chain([f32::INFINITY]);
        let limits = self.limits.iter().zip(ends).map(|(limit, to)| Stretch {
            from: limit.from,
            to,
            speed: limit.speed,
        });
        limits.chain(self.bends(from, to))
    }

    /// The bends of which a part is between two arc lengths (m).
    fn bends(self, from: f32, to: f32) -> impl Iterator<Item = Stretch> + use<'j> {
        let corners = if self.lateral.is_finite() {
            self.corners(from, to)
        } else {
            0..0
        };
        corners.filter_map(move |corner| self.bend(corner))
    }

    /// The points at which bends may begin of which a part is between two arc lengths (m).
    fn corners(self, from: f32, to: f32) -> Range<usize> {
        let arc = self.polyline.arc();
        let first = arc.partition_point(|&s| s < from - 2.0 * WINDOW).max(1);
        let last = arc.partition_point(|&s| s < to + WINDOW);
        first..last
    }

    /// The bend that begins at point number `corner`: as much as the path turns from there on over a window.
    fn bend(self, corner: usize) -> Option<Stretch> {
        let piece = |i| self.polyline.piece(i);
        let first = piece(corner.checked_sub(1)?)?;
        let (start, mut before, mut last) = (first.to, first, piece(corner)?);
        let mut turn = angle(&before, &last);
        let mut next = corner + 1;
        while let Some(after) = piece(next).filter(|after| after.from <= start + WINDOW) {
            turn += angle(&last, &after);
            (before, last, next) = (last, after, next + 1);
        }
        let (from, to) = (start - half(&first), last.from + half(&last));
        // What is straight before and after a bend does not make it wider.
        let inner = piece(corner)?;
        let lead = if long(&first, &inner) {
            0.0
        } else {
            start - from
        };
        let tail = if long(&last, &before) {
            0.0
        } else {
            to - last.from
        };
        let curvature = turn.abs() / Real::max(lead + last.from - start + tail, WINDOW);
        let speed = sqrt(self.lateral / curvature);
        // Straight on, anything is allowed.
        speed.is_finite().then_some(Stretch { from, to, speed })
    }
}

/// How far (m) ahead a vehicle at `speed` (m/s) looks that keeps to what is allowed after some `time` (s): it can stop at
/// [`COMFORT`].
fn sight(speed: f32, time: f32) -> f32 {
    speed * speed * (0.5 / COMFORT) + 2.0 * speed * time + WINDOW
}

/// Half a piece (m), or half a window.
fn half(piece: &Piece) -> f32 {
    0.5 * Real::min(piece.to - piece.from, WINDOW)
}

/// Whether a piece is longer than the one beside it, by more than points on a curve differ.
fn long(piece: &Piece, beside: &Piece) -> bool {
    piece.to - piece.from > 1.5 * (beside.to - beside.from)
}

/// The angle (rad) by which a path turns from one piece to the next; a little more, if it turns much.
fn angle(before: &Piece, after: &Piece) -> f32 {
    let (a, b) = (before.velocity(), after.velocity());
    // 2 tan(θ/2). A turn is 90° at most.
    2.0 * a.perp(&b) / (1.0 + a.dot(&b))
}

/// The acceleration (m/s²), for some `time` (s), of a vehicle at `speed` (m/s) that comes down at [`COMFORT`] to `allowed`
/// (m/s) within `distance` (m).
fn slowing(allowed: f32, distance: f32, speed: f32, time: f32) -> f32 {
    // v² = allowed² + 2 · COMFORT · (distance − ½ · (speed + v) · time).
    let lost = 0.5 * COMFORT * time;
    let left = allowed * allowed + 2.0 * COMFORT * distance - 2.0 * lost * speed;
    let then = sqrt(Real::max(lost * lost + left, 0.0)) - lost;
    let after = (Real::max(then, allowed) - speed) / time;
    if then >= allowed || speed <= allowed || distance <= 0.0 {
        return after;
    }
    // It is there before the time is over.
    let within = (allowed * allowed - speed * speed) / (2.0 * distance);
    Real::min(after, Real::max(within, -2.0 * COMFORT))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Footprint, Point};
    use crate::junction::{Class, Junction, JunctionError, PathId, Route};
    use crate::kinematics::{State, advance};
    use proptest::prelude::*;
    use std::vec::Vec;

    type Site = Junction<1, 64>;
    const PATH: PathId = PathId::new(0);

    /// 80 m straight on, a quarter of a circle to the left, and 80 m more.
    fn bend(radius: f32, points: u8) -> Route<64> {
        let turn = (0..=points).map(|i| {
            let angle = core::f32::consts::FRAC_PI_2 * f32::from(i) / f32::from(points);
            Point::new(80.0 + radius * angle.sin(), radius - radius * angle.cos())
        });
        let end = Point::new(80.0 + radius, radius + 80.0);
        let points: Vec<Point> = [Point::new(0.0, 0.0)]
            .into_iter()
            .chain(turn)
            .chain([end])
            .collect();
        Route::new(points).unwrap()
    }

    fn site(
        route: &Route<64>,
        limits: &[(f32, f32)],
        lateral: Option<f32>,
    ) -> Result<Site, JunctionError> {
        let mut builder = Site::builder();
        let path = builder.path(route, Class::Car, Footprint::PAPER)?;
        for &(from, speed) in limits {
            builder.speed_limit(path, from, speed)?;
        }
        if let Some(lateral) = lateral {
            builder.lateral(lateral);
        }
        builder.build()
    }

    /// A drive that keeps to the profile, and would accelerate at 2 m/s²: arc lengths and speeds.
    fn drive(site: &Site, speed: f32) -> Vec<(f32, f32)> {
        let profile = site.way(PATH).unwrap().profile();
        let (mut s, mut v) = (0.0, speed);
        let mut places = Vec::new();
        while s < 150.0 && places.len() < 3000 {
            places.push((s, v));
            let acceleration = profile.acceleration(s, v, 0.0).clamp(-3.0, 2.0);
            State { s, v } = advance(State { s, v }, acceleration);
        }
        places
    }

    proptest! {
        #[test]
        fn limits_and_bends_are_kept_without_a_jerk(
            radius in 5.0_f32..25.0, points in 12_u8..40, speed in 3.0_f32..8.0, first in 8.0_f32..14.0, second in 3.0_f32..14.0, at in 90.0_f32..140.0,
        ) {
            let site = site(&bend(radius, points), &[(0.0, first), (at, second)], Some(2.0)).unwrap();
            let places = drive(&site, speed);
            prop_assert!(places.len() < 3000, "it stands");
            for window in places.windows(2) {
                let [(s, v), (_, next)] = window else { unreachable!() };
                let limit = if *s < at { first } else { second };
                prop_assert!(*v <= limit + 0.05, "{v} m/s at {s} m, limit {limit}");
                if (80.5..79.5 + radius * core::f32::consts::FRAC_PI_2).contains(s) {
                    let lateral = v * v / radius;
                    prop_assert!(lateral <= 2.0 * 1.05, "{lateral} m/s² at {s} m");
                }
                prop_assert!(next - v >= -0.1 * (COMFORT + 0.1), "{v} to {next} m/s at {s} m");
            }
        }
    }

    #[test]
    fn a_bend_is_taken_about_as_fast_as_it_may() {
        for points in [6, 12, 40] {
            let site = site(&bend(12.0, points), &[], Some(2.0)).unwrap();
            let middle = site.way(PATH).unwrap().profile().speed(89.0);
            let most = (2.0_f32 * 12.0).sqrt();
            assert!(
                (0.9 * most..=1.001 * most).contains(&middle),
                "{middle} m/s of {most}, {points} points"
            );
        }
    }

    #[test]
    fn nothing_bounds_a_path_without_limits() {
        let site = site(&bend(12.0, 12), &[], None).unwrap();
        let profile = site.way(PATH).unwrap().profile();
        assert_eq!(profile.speed(89.0), f32::INFINITY);
        assert_eq!(profile.acceleration(60.0, 14.0, 0.1), f32::INFINITY);
    }

    #[test]
    fn limits_out_of_range_are_named() {
        let route = bend(12.0, 12);
        let said = |limits: &[(f32, f32)], lateral| {
            std::string::ToString::to_string(&site(&route, limits, lateral).unwrap_err())
        };
        assert!(said(&[(0.0, 0.0)], None).starts_with("path 0: a speed limit of 0 m/s from 0 m"));
        assert!(said(&[(500.0, 5.0)], None).contains("from 500 m"));
        assert!(said(&[(0.0, 5.0); 5], None).starts_with("path 0: more than 4 speed limits"));
        assert!(said(&[], Some(0.0)).starts_with("a lateral acceleration of 0 m/s²"));
    }

    #[test]
    fn limits_may_come_in_any_order() {
        let site = site(
            &bend(12.0, 12),
            &[(50.0, 5.0), (0.0, 10.0), (20.0, 7.0)],
            None,
        )
        .unwrap();
        let profile = site.way(PATH).unwrap().profile();
        assert_eq!(
            [0.0, 19.0, 20.0, 60.0].map(|s| profile.speed(s)),
            [10.0, 10.0, 7.0, 5.0]
        );
    }

    #[test]
    fn of_two_limits_from_one_place_on_the_last_one_counts() {
        let site = site(&bend(12.0, 12), &[(20.0, 9.0), (20.0, 7.0)], None).unwrap();
        let profile = site.way(PATH).unwrap().profile();
        assert_eq!(profile.speed(30.0), 7.0);
    }

    /// Pieces of these lengths (m), with a turn to the left, or to the right, by `degrees` before each but the first.
    fn polygon(lengths: &[f32], degrees: f32) -> Site {
        let (mut at, mut heading) = (Point::origin(), 0.0_f32);
        let mut points = std::vec![at];
        for length in lengths {
            at += crate::geometry::Vector::new(heading.cos(), heading.sin()) * *length;
            points.push(at);
            heading += degrees.to_radians();
        }
        site(&Route::new(points).unwrap(), &[], Some(2.0)).unwrap()
    }

    #[track_caller]
    fn allows(lengths: &[f32], degrees: f32, speeds: &[(f32, f32)]) {
        for degrees in [degrees, -degrees] {
            let site = polygon(lengths, degrees);
            let profile = site.way(PATH).unwrap().profile();
            for &(s, speed) in speeds {
                let is = profile.speed(s);
                let near = is == speed || (is - speed).abs() < 1e-3;
                assert!(near, "{is} m/s at {s} m, not {speed}");
            }
        }
    }

    #[test]
    fn a_bend_is_as_sharp_as_the_path_turns_over_a_window() {
        const ANY: f32 = f32::INFINITY;
        // 2 tan(θ/2) over 4 m, half of them on either side of a corner.
        allows(
            &[20.0, 20.0],
            90.0,
            &[(17.9, ANY), (18.1, 2.0), (21.9, 2.0), (22.1, ANY)],
        );
        // Two corners in one window, between straights that do not make it wider: twice 2 tan(22.5°) over 4 m.
        allows(
            &[20.0, 2.0, 20.0],
            45.0,
            &[(17.9, ANY), (18.1, 2.1974), (23.9, 2.1974), (24.1, ANY)],
        );
        // Three, of which a window has two: twice 2 tan(15°) over 5.85 m.
        let three = [20.0, 3.9, 3.9, 20.0];
        allows(
            &three,
            30.0,
            &[
                (17.9, ANY),
                (18.1, 3.3041),
                (25.0, 3.3041),
                (29.7, 3.3041),
                (29.9, ANY),
            ],
        );
        // Half of the short pieces before and after: 2 tan(30°) over 4 m, from 1 m before to 1 m after.
        allows(
            &[2.0, 2.0],
            60.0,
            &[(0.9, ANY), (1.1, 2.6321), (2.9, 2.6321), (3.1, ANY)],
        );
        // What is a little longer than the piece beside it is on the curve: twice 2 tan(20°) over 7.9 m, or over 4 m.
        allows(
            &[5.5, 3.9, 5.5],
            40.0,
            &[(5.6, 3.2943), (11.3, 3.2943), (11.5, ANY)],
        );
        allows(
            &[7.0, 3.9, 7.0],
            40.0,
            &[(7.1, 2.3441), (12.8, 2.3441), (13.0, ANY)],
        );
    }

    #[test]
    fn one_looks_as_far_ahead_as_it_takes_to_stop_and_two_windows_back() {
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-4, "{a}, {b}");
        // 33.33 m at 1.5 m/s², what it goes in twice the time, and a window.
        near(sight(10.0, 0.5), 33.333_33 + 10.0 + 4.0);
        near(sight(3.0, 1.5), 3.0 + 9.0 + 4.0);
        let site = polygon(&[2.0; 30], 1.0);
        let profile = site.way(PATH).unwrap().profile();
        let all = |from, to| profile.corners(from, to);
        // Of points 2 m apart: from 12 m on, and up to before 34 m.
        assert_eq!([all(20.0, 30.0), all(19.9, 30.1)], [6..17, 6..18]);
        assert_eq!([all(3.0, 3.0), all(90.0, 99.0)], [1..4, 31..31]);
    }

    #[test]
    fn every_bend_in_sight_counts() {
        let site = site(&bend(6.0, 20), &[], Some(2.0)).unwrap();
        let profile = site.way(PATH).unwrap().profile();
        let all: Vec<Stretch> = (1..30).filter_map(|corner| profile.bend(corner)).collect();
        for s in (0..1100_u16).map(|i| 0.1 * f32::from(i)) {
            let here = all.iter().filter(|it| it.from <= s && s < it.to);
            let least = here.fold(f32::INFINITY, |least, it| least.min(it.speed));
            assert_eq!(profile.speed(s), least, "{s}");
            for (speed, response) in [(5.0, 0.0), (11.0, 1.0), (14.0, 0.0)] {
                let ahead = all.iter().filter(|it| s < it.to);
                let slow = |it: &Stretch| slowing(it.speed, it.from - s, speed, SMOOTH + response);
                let least = ahead.map(slow).fold(f32::INFINITY, f32::min);
                let is = profile.acceleration(s, speed, response);
                assert!(
                    is == least || is > 1.4 && least > 1.4,
                    "{is}, {least} at {s}"
                );
            }
        }
    }

    #[test]
    fn a_limit_ahead_is_come_down_to_and_one_behind_is_kept() {
        let site = site(
            &bend(12.0, 12),
            &[(0.0, 20.0), (40.0, 5.0), (60.0, 9.0)],
            None,
        )
        .unwrap();
        let profile = site.way(PATH).unwrap().profile();
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-3, "{a}, {b}");
        near(
            profile.acceleration(30.0, 10.0, 0.5),
            slowing(5.0, 10.0, 10.0, 1.0),
        );
        near(profile.acceleration(40.0, 10.0, 0.0), -10.0);
        near(profile.acceleration(70.0, 4.0, 0.5), 5.0);
    }

    proptest! {
        /// At `COMFORT` it comes down to what is allowed just there.
        #[test]
        fn what_is_left_after_some_time_is_enough_to_slow_down(
            allowed in 0.0_f32..15.0, distance in 0.0_f32..200.0, speed in 0.0_f32..20.0, time in 0.3_f32..1.5,
        ) {
            let then = speed + slowing(allowed, distance, speed, time) * time;
            if then > allowed + 1e-3 && speed > allowed {
                let left = distance - 0.5 * (speed + then) * time;
                let needs = (then * then - allowed * allowed) / (2.0 * COMFORT);
                prop_assert!((left - needs).abs() < 0.02 * (1.0 + distance), "{left} m, {needs} m");
            }
            if speed <= allowed {
                prop_assert!(then >= allowed - 1e-3);
            }
        }
    }

    #[test]
    fn one_that_is_there_before_the_time_is_over_brakes_at_twice_comfort_at_most() {
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-3, "{a}, {b}");
        near(slowing(10.0, 0.0, 5.0, 0.5), 10.0);
        near(slowing(5.0, 100.0, 10.0, 0.5), 14.895);
        near(slowing(5.0, 2.5, 6.0, 0.5), -2.2);
        near(slowing(5.0, 1.0, 6.0, 0.5), -3.0);
        near(slowing(5.0, 0.0, 6.0, 0.5), -2.0);
        near(slowing(5.0, -1.0, 6.0, 0.5), -2.0);
        near(slowing(5.0, 5.0, 5.0, 0.5), 1.3149);
    }

    /// The lengths have these bits.
    #[test]
    fn a_piece_of_half_as_much_again_is_not_longer() {
        let piece = |to| Piece {
            start: Point::origin(),
            end: Point::new(to, 0.0),
            from: 0.0,
            to,
        };
        assert!(!long(&piece(3.0), &piece(2.0)));
        assert!(long(&piece(3.1), &piece(2.0)));
    }
}
