//! A footprint that moves along a polyline, as motions without turning: straight ahead, and askew near its points.
//!
//! At a point where the polyline changes its direction a vehicle has all directions in between, and some of them before
//! and after it ([`TURNING`]). Of a
//! rectangle with half diagonal r that is turned by some angle, each point moves by |p|·|u − v| ≤ r·|u − v|,
//! with u and v its directions before and after. So what it covers while its direction is
//! within a distance d of u lies in the rectangle with direction u, inflated by r·d on every side.

use super::INFLATION;
use crate::geometry::{Footprint, Point, Vector, length};
use crate::junction::polyline::{Piece, Polyline};
use crate::real::Real;

/// A change of direction that moves corners by less than this (m) inflates the pieces beside it, and no
/// turn is looked at for it.
const SMALL_SWEEP: f32 = 0.03;

/// The largest distance between the first and the last direction of one turn: 5°, in radians.
const STEP: f32 = 0.0873;

/// The most turns of half a change of direction: a right angle takes 2/[`STEP`].
const MOST_TURNS: u8 = 23;

/// A vehicle turns from one piece's direction to the next over this share of its length, before and after the point, and
/// not beyond the pieces' other ends: on each side it has the directions from the piece's to half-way.
const TURNING: f32 = 0.6;

/// Sum of two directions below which they are taken for opposite.
const OPPOSITE: f32 = 1.0e-3;

/// A change of direction by more than 90° has a cosine below this; rounding is allowed for.
const SHARP: f32 = -1.0e-5;

/// A footprint that moves along a polyline.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<'a> {
    pub(crate) polyline: Polyline<'a>,
    footprint: Footprint,
    /// By how much (m) the footprint is larger on every side, turns apart.
    inflation: f32,
    /// Half the diagonal (m) of the footprint.
    radius: f32,
}

/// A vehicle that moves along a piece without turning: straight ahead, or askew while it is about to turn or has turned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) start: Point,
    /// Metres of the plane for each metre of arc length.
    pub(super) velocity: Vector,
    /// Where the vehicle points: of length 1.
    pub(super) direction: Vector,
    /// Arc length at the start.
    pub(super) arc: f32,
    pub(super) length: f32,
    /// It points in a direction between two pieces'.
    pub(super) turning: bool,
    pub(super) first: bool,
    pub(super) last: bool,
    /// Half the footprint's length and width, inflated.
    pub(super) half: (f32, f32),
}

/// How the direction changes at a point of the polyline.
#[derive(Clone, Copy)]
struct Bend {
    middle: Vector,
    /// How far (m) corners move on the way from the middle direction to either side.
    sweep: f32,
}

impl<'a> Body<'a> {
    /// `footprint` along `polyline`, where each of its points may be off by `tolerance` (m).
    pub(crate) fn new(polyline: Polyline<'a>, footprint: Footprint, tolerance: f32) -> Self {
        let diagonal = Vector::new(footprint.length, footprint.width);
        Self {
            polyline,
            footprint,
            inflation: INFLATION + tolerance,
            radius: 0.5 * length(&diagonal),
        }
    }

    /// No part of the inflated footprint is farther (m) than this from the polyline.
    pub(super) fn reach(&self) -> f32 {
        let sweep = Real::max(SMALL_SWEEP, 0.5 * STEP * self.radius);
        // Sides that are moved out by x move a corner by √2 x; rounding is allowed for.
        1.001 * self.radius + 1.5 * (self.inflation + sweep)
    }

    /// The footprint with its inflation.
    pub(super) fn footprint(&self) -> Footprint {
        let inflated = |size: f32| size + 2.0 * self.inflation;
        Footprint {
            length: inflated(self.footprint.length),
            width: inflated(self.footprint.width),
        }
    }

    /// What moves on piece `i`.
    // Not inlined: it is long, and it is called from two places.
    #[inline(never)]
    pub(super) fn stage(&self, i: usize) -> Option<Stage> {
        let piece = self.polyline.piece(i)?;
        let along = direction(&piece);
        let next_to = |i: Option<usize>| Some(direction(&self.polyline.piece(i?)?));
        let before = next_to(i.checked_sub(1)).map(|before| self.bend(before, along));
        let after = next_to(i.checked_add(1)).map(|after| self.bend(along, after));
        let small = |bend: &Option<Bend>| match bend {
            Some(bend) if bend.sweep <= SMALL_SWEEP => bend.sweep,
            _ => 0.0,
        };
        let sweeps = (small(&before), small(&after));
        let straight = Motion {
            start: piece.start,
            velocity: piece.velocity(),
            direction: along,
            arc: piece.from,
            length: piece.to - piece.from,
            turning: false,
            first: i == 0,
            last: i + 1 == self.polyline.pieces(),
            half: self.half(Real::max(sweeps.0, sweeps.1)),
        };
        let window = Real::min(straight.length, TURNING * self.footprint.length);
        let starts = before.and_then(|bend| self.arc(&bend, [bend.middle, along]));
        let ends = after.and_then(|bend| self.arc(&bend, [along, bend.middle]));
        Some(Stage::new(straight, window, [starts, ends]))
    }

    /// The directions of one half of a bend; none, if it is small.
    fn arc(&self, bend: &Bend, [from, to]: [Vector; 2]) -> Option<Arc> {
        if bend.sweep <= SMALL_SWEEP {
            return None;
        }
        let mut arc = Arc::of(from, to, middle(from, to));
        arc.half = self.half(self.radius * arc.spread);
        Some(arc)
    }

    fn half(&self, sweep: f32) -> (f32, f32) {
        let more = self.inflation + sweep;
        (
            0.5 * self.footprint.length + more,
            0.5 * self.footprint.width + more,
        )
    }

    /// The change from one direction to another.
    fn bend(&self, before: Vector, after: Vector) -> Bend {
        let middle = middle(before, after);
        Bend {
            middle,
            sweep: self.radius * length(&(middle - before)),
        }
    }
}

/// Directions between two that are at most 90° apart, as points of their chord.
#[derive(Clone, Copy)]
struct Arc {
    from: Vector,
    to: Vector,
    /// The number of turns that it takes.
    turns: u8,
    /// How far a direction of one of these turns is from the turn's middle, at most.
    spread: f32,
    /// Half the footprint's length and width, inflated.
    half: (f32, f32),
    middle: Vector,
}

/// What moves on one piece of a polyline.
#[derive(Clone, Copy)]
pub(super) struct Stage {
    straight: Motion,
    /// The directions that a vehicle has besides, at the start of the piece and at its end, over `window` metres.
    arcs: [Option<Arc>; 2],
    window: f32,
    /// Half the length and the width of a footprint along the piece that covers those of all motions.
    half: (f32, f32),
    /// The largest distance of a direction from the piece's; 0 without turns.
    pub(super) askew: f32,
}

impl Stage {
    fn new(straight: Motion, window: f32, arcs: [Option<Arc>; 2]) -> Self {
        let (mut half, mut askew) = (straight.half, 0.0);
        for arc in arcs.iter().flatten() {
            let away = length(&(arc.to - arc.from));
            // The sine of the angle is less than the distance; rounding is allowed for.
            let sine = 1.01 * away;
            half = (
                Real::max(half.0, arc.half.0 + sine * arc.half.1),
                Real::max(half.1, arc.half.1 + sine * arc.half.0),
            );
            askew = Real::max(askew, away);
        }
        Self {
            straight,
            arcs,
            window,
            half,
            askew,
        }
    }

    /// The motions of a vehicle that is about to turn or has turned. Together with those of the neighbouring pieces they
    /// have all directions at each point.
    pub(super) fn turns(&self) -> impl Iterator<Item = Motion> {
        let (straight, window) = (self.straight, self.window);
        let offsets = [0.0, straight.length - window];
        self.arcs
            .into_iter()
            .zip(offsets)
            .filter_map(|(arc, offset)| Some((arc?, offset)))
            .flat_map(move |(arc, offset)| {
                arc.directions().map(move |direction| Motion {
                    start: straight.start + straight.velocity * offset,
                    direction,
                    arc: straight.arc + offset,
                    length: window,
                    turning: true,
                    first: false,
                    last: false,
                    half: arc.half,
                    ..straight
                })
            })
    }

    /// Calls `meet` for each pair of motions of two stages of which one turns at least.
    // Not generic: once in flash.
    #[inline(never)]
    pub(super) fn turns_with(&self, other: &Self, meet: &mut dyn FnMut(&Motion, &Motion)) {
        for turn in other.turns() {
            meet(&self.straight, &turn);
        }
        for turn in self.turns() {
            meet(&turn, &other.straight);
            for other in other.turns() {
                meet(&turn, &other);
            }
        }
    }

    /// Whether there is any.
    pub(super) fn turns_at_all(&self) -> bool {
        self.askew > 0.0
    }

    /// The motion along the piece with a footprint that covers those of all motions on it.
    pub(super) const fn whole(&self) -> Motion {
        Motion {
            half: self.half,
            ..self.straight
        }
    }

    /// The motion along the piece.
    pub(super) const fn straight(&self) -> &Motion {
        &self.straight
    }
}

impl Arc {
    /// Points of the chord at distance x have directions at distance x/m at most, m being the chord's
    /// distance from the origin.
    fn of(from: Vector, to: Vector, middle: Vector) -> Self {
        let nearest = middle.dot(&from);
        let wide = length(&(to - from));
        let mut turns = 1;
        while turns < MOST_TURNS && wide > STEP * nearest * f32::from(turns) {
            turns += 1;
        }
        let spread = match turns {
            1 => length(&(middle - from)),
            _ => 0.5 * wide / (nearest * f32::from(turns)),
        };
        Self {
            from,
            to,
            turns,
            spread,
            half: (0.0, 0.0),
            middle,
        }
    }

    /// The middle direction of each turn.
    fn directions(self) -> impl Iterator<Item = Vector> {
        (0..self.turns).map(move |i| {
            if self.turns == 1 {
                return self.middle;
            }
            let along = (f32::from(i) + 0.5) / f32::from(self.turns);
            let point = self.from + (self.to - self.from) * along;
            point * (1.0 / length(&point))
        })
    }
}

/// The direction of a piece, of length 1 also where arc lengths are rounded.
fn direction(piece: &Piece) -> Vector {
    let along = piece.end - piece.start;
    along * (1.0 / length(&along))
}

/// The direction half-way between two; the left of `before`, if they are opposite.
fn middle(before: Vector, after: Vector) -> Vector {
    let sum = before + after;
    let size = length(&sum);
    if size > OPPOSITE {
        sum * (1.0 / size)
    } else {
        Vector::new(-before.y, before.x)
    }
}

/// The first point at which the direction changes by more than 90°, and the change in degrees.
pub(crate) fn sharp_kink(polyline: Polyline<'_>) -> Option<(usize, f32)> {
    (1..polyline.pieces()).find_map(|i| {
        let before = direction(&polyline.piece(i - 1)?);
        let after = direction(&polyline.piece(i)?);
        let (along, across) = (before.dot(&after), before.perp(&after).abs());
        (along < SHARP).then(|| (i, crate::real::atan2(across, along).to_degrees()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::junction::route::Route;
    use proptest::prelude::*;

    proptest! {
        /// Whatever direction a vehicle has at a point, some motion there covers all of its corners.
        #[test]
        fn every_direction_at_a_point_is_covered_by_a_motion(
            turn in prop_oneof![-90.0_f64..90.0, -6.0_f64..6.0, -1.3_f64..1.3],
            share in 0.0_f64..1.0,
            length in 0.5_f32..12.0,
            width in 0.5_f32..3.0,
        ) {
            let (sin, cos) = turn.to_radians().sin_cos();
            let points = [(-20.0, 0.0), (0.0, 0.0), (20.0 * cos as f32, 20.0 * sin as f32)];
            let route = Route::<3>::new(points.map(|(x, y)| Point::new(x, y))).unwrap();
            let body = Body::new(route.polyline(), Footprint { length, width }, 0.0);
            let before = *body.stage(0).unwrap().straight();
            let mut at: std::vec::Vec<_> = body.stage(0).unwrap().turns().collect();
            at.extend(body.stage(1).unwrap().turns());
            let after = *body.stage(1).unwrap().straight();
            let (sin, cos) = (share * turn.to_radians()).sin_cos();
            let corners = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, y)| {
                let (l, w) = (0.5 * x * f64::from(length), 0.5 * y * f64::from(width));
                (l * cos - w * sin, l * sin + w * cos)
            });
            let covers = |motion: &Motion| {
                let (x, y) = (f64::from(motion.direction.x), f64::from(motion.direction.y));
                // Without what is there for rounding, all but 0.1 mm.
                let spare = f64::from(INFLATION) - 1.0e-4;
                corners.iter().all(|(p, q)| {
                    (p * x + q * y).abs() <= f64::from(motion.half.0) - spare
                        && (q * x - p * y).abs() <= f64::from(motion.half.1) - spare
                })
            };
            prop_assert!(at.iter().chain([&before, &after]).any(covers));
        }
    }

    fn corner(degrees: f32) -> Route<4> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let points = [(-20.0, 0.0), (0.0, 0.0), (10.0 * cos, 10.0 * sin)];
        Route::new(points.map(|(x, y)| Point::new(x, y))).unwrap()
    }

    #[track_caller]
    fn near(a: f32, b: f32) {
        assert!((a - b).abs() < 1e-3, "{a}, {b}");
    }

    const CAR: Footprint = Footprint {
        length: 4.0,
        width: 3.0,
    };

    #[test]
    fn a_footprint_is_inflated_on_every_side() {
        let route = corner(0.0);
        let body = Body::new(route.polyline(), CAR, 0.1);
        near(body.footprint().length, 4.24);
        near(body.footprint().width, 3.24);
        near(body.half(0.05).0, 2.17);
        near(body.half(0.05).1, 1.67);
        // Half a diagonal of 5 m turns by half a step of 5°, or a small one by less than what is not looked at.
        near(body.reach(), 1.001 * 2.5 + 1.5 * (0.12 + 0.109_125));
        let small = Footprint {
            length: 0.4,
            width: 0.3,
        };
        near(
            Body::new(route.polyline(), small, 0.1).reach(),
            1.001 * 0.25 + 1.5 * (0.12 + 0.03),
        );
    }

    #[test]
    fn a_piece_is_a_motion_between_two_points() {
        let route = corner(60.0);
        let body = Body::new(route.polyline(), CAR, 0.0);
        let [before, after] = [0, 1].map(|i| body.stage(i).unwrap());
        assert!(body.stage(2).is_none());
        let (one, two) = (before.straight(), after.straight());
        assert_eq!(
            (one.first, one.last, two.first, two.last),
            (true, false, false, true)
        );
        assert_eq!((one.arc, one.length, two.arc), (0.0, 20.0, 20.0));
        near(two.length, 10.0);
        near(two.direction.x, 0.5);
        near(two.velocity.y, 60.0_f32.to_radians().sin());
        near(one.half.0, 2.02);
        // Six tenths of a length before and after the corner.
        let turns: [std::vec::Vec<Motion>; 2] =
            [&before, &after].map(|stage| stage.turns().collect());
        for (turns, arc, x) in [(&turns[0], 17.6, -2.4), (&turns[1], 20.0, 0.0)] {
            assert!(
                turns
                    .iter()
                    .all(|turn| turn.turning && !turn.first && !turn.last)
            );
            for turn in turns {
                near(turn.arc, arc);
                near(turn.length, 2.4);
                near(turn.start.x, x);
                near(length(&turn.direction), 1.0);
            }
        }
        // 30° in steps of 5° at most, from the piece's direction to half-way.
        for (turns, from) in [(&turns[0], 0.0), (&turns[1], 30.0)] {
            let headings = turns
                .iter()
                .map(|turn| turn.direction.y.atan2(turn.direction.x).to_degrees());
            let headings: std::vec::Vec<f32> = headings.collect();
            assert!((6..=8).contains(&headings.len()), "{headings:?}");
            let step = 30.0 / headings.len() as f32;
            for (i, heading) in headings.iter().enumerate() {
                let middle = from + step * (i as f32 + 0.5);
                assert!((heading - middle).abs() < 0.3, "{headings:?}");
            }
            // It is inflated for half a step.
            for turn in turns {
                let sweep = turn.half.0 - 2.02;
                let least = 2.5 * (0.5 * step).to_radians();
                assert!(
                    (0.999 * least..1.06 * least).contains(&sweep),
                    "{sweep}, {least}"
                );
                near(turn.half.1 - 1.52, sweep);
            }
        }
    }

    #[test]
    fn the_whole_of_a_piece_covers_all_motions_on_it() {
        for degrees in [-90.0, -37.0, -3.0, 0.0, 4.0, 60.0] {
            let route = corner(degrees);
            let body = Body::new(route.polyline(), CAR, 0.1);
            for stage in [0, 1].map(|i| body.stage(i).unwrap()) {
                let whole = stage.whole();
                let covers = |motion: Motion, ahead: f32, beside: f32| {
                    let side = Vector::new(-motion.direction.y, motion.direction.x);
                    let start = motion.start
                        + motion.direction * (ahead * motion.half.0)
                        + side * (beside * motion.half.1);
                    let ends = [start, start + motion.velocity * motion.length];
                    ends.iter().all(|corner| {
                        let from = corner - whole.start;
                        let along = whole.direction.dot(&from);
                        let across = whole.direction.perp(&from).abs();
                        -whole.half.0 - 1e-3 <= along
                            && along <= whole.length + whole.half.0 + 1e-3
                            && across <= whole.half.1 + 1e-3
                    })
                };
                for motion in stage.turns().chain([*stage.straight()]) {
                    for (ahead, beside) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                        assert!(covers(motion, ahead, beside), "{degrees}: {motion:?}");
                    }
                    let away = length(&(motion.direction - whole.direction));
                    assert!(away <= stage.askew + 1e-6, "{degrees}: {away}");
                }
                assert_eq!(stage.turns_at_all(), stage.turns().count() > 0);
            }
        }
        // No larger than it has to be: where nothing turns, it is the motion along the piece.
        let small = corner(1.0);
        let stage = Body::new(small.polyline(), CAR, 0.1).stage(0).unwrap();
        assert_eq!(stage.whole().half, stage.straight().half);
    }

    #[test]
    fn a_short_piece_is_turned_on_all_along() {
        let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 9.0)].map(|(x, y)| Point::new(x, y));
        let route = Route::<3>::new(points).unwrap();
        let stage = Body::new(route.polyline(), CAR, 0.0).stage(0).unwrap();
        for turn in stage.turns() {
            assert_eq!((turn.arc, turn.length), (0.0, 1.0));
        }
        assert!(stage.turns().count() > 5);
    }

    #[test]
    fn a_small_bend_inflates_the_pieces_beside_it_and_is_no_turn() {
        // Corners, 2.5 m from the middle, move by 2.5 m · 0.5 · 1°.
        let route = corner(1.0);
        let body = Body::new(route.polyline(), CAR, 0.0);
        for i in [0, 1] {
            let stage = body.stage(i).unwrap();
            near(stage.straight().half.0, 2.02 + 0.021_816);
            assert_eq!(stage.turns().count(), 0);
            assert!(!stage.turns_at_all());
        }
    }

    #[test]
    fn half_way_between_two_directions_is_their_middle() {
        let at = |degrees: f32| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            Vector::new(cos, sin)
        };
        let is = |a: Vector, b: Vector| assert!(length(&(a - b)) < 1e-4, "{a}, {b}");
        is(middle(at(10.0), at(70.0)), at(40.0));
        is(middle(at(10.0), at(190.0)), at(100.0));
    }

    #[test]
    fn a_kink_of_more_than_a_right_angle_is_found_with_its_angle() {
        let kink = |degrees: f32| sharp_kink(corner(degrees).polyline());
        assert!(kink(89.9).is_none() && kink(90.0).is_none() && kink(-89.9).is_none());
        for degrees in [100.0, -100.0] {
            let (at, angle) = kink(degrees).unwrap();
            assert_eq!(at, 1);
            assert!((angle - 100.0).abs() < 0.01);
        }
    }

    /// By 1.5° on either side, at once: 0.75° from the middle.
    #[test]
    fn a_bend_of_less_than_a_step_is_one_turn() {
        let route = corner(3.0);
        let body = Body::new(route.polyline(), CAR, 0.0);
        for (i, heading) in [(0, 0.75), (1, 2.25)] {
            let turns: std::vec::Vec<Motion> = body.stage(i).unwrap().turns().collect();
            assert_eq!(turns.len(), 1);
            let direction = turns[0].direction;
            assert!((direction.y.atan2(direction.x).to_degrees() - heading).abs() < 1e-2);
            near(turns[0].half.0, 2.02 + 2.5 * 0.75_f32.to_radians());
            near(turns[0].half.1, 1.52 + 2.5 * 0.75_f32.to_radians());
        }
    }
}
