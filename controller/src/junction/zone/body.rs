//! A footprint that moves along a polyline, as motions without turning: straight ahead, and turns on the spot.
//!
//! At a point where the polyline changes its direction a vehicle has all directions in between. Of a
//! rectangle with half diagonal r that is turned by some angle, each point moves by |p|·|u − v| ≤ r·|u − v|,
//! with u and v its directions before and after. So what it covers while its direction is
//! within a distance d of u lies in the rectangle with direction u, inflated by r·d on every side.

use super::INFLATION;
use crate::geometry::{Footprint, Point, Vector, length};
use crate::junction::polyline::{Piece, Polyline};

/// A change of direction that moves corners by less than this (m) inflates the pieces beside it, and no
/// turn is looked at for it.
const SMALL_SWEEP: f32 = 0.03;

/// The largest distance between the first and the last direction of one turn: 5°, in radians.
const STEP: f32 = 0.0873;

/// The most turns of half a change of direction: a right angle takes 2/[`STEP`].
const MOST_TURNS: u8 = 23;

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

/// A vehicle that moves straight ahead without turning, or one that turns a little where it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) start: Point,
    /// Metres of the plane for each metre of arc length.
    pub(super) velocity: Vector,
    /// Where the vehicle points: of length 1.
    pub(super) direction: Vector,
    /// Arc length at the start.
    pub(super) arc: f32,
    /// Zero for a turn.
    pub(super) length: f32,
    pub(super) first: bool,
    pub(super) last: bool,
    /// Half the footprint's length and width, inflated.
    pub(super) half: (f32, f32),
}

/// How the direction changes at a point of the polyline.
#[derive(Clone, Copy)]
struct Bend {
    before: Vector,
    middle: Vector,
    after: Vector,
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
        let sweep = 0.5 * STEP * self.radius;
        let sweep = if sweep > SMALL_SWEEP {
            sweep
        } else {
            SMALL_SWEEP
        };
        // Sides that are moved out by x move a corner by √2 x; rounding is allowed for.
        1.001 * self.radius + 1.5 * (self.inflation + sweep)
    }

    /// The length (m) of the footprint with its inflation.
    pub(super) fn length(&self) -> f32 {
        self.footprint.length + 2.0 * self.inflation
    }

    /// The motion along piece `i`.
    pub(super) fn straight(&self, i: usize) -> Option<Motion> {
        let piece = self.polyline.piece(i)?;
        let sweep = |bend: Option<Bend>| match bend {
            Some(bend) if bend.sweep <= SMALL_SWEEP => bend.sweep,
            _ => 0.0,
        };
        let (before, after) = (sweep(self.bend(i)), sweep(self.bend(i + 1)));
        Some(Motion {
            start: piece.start,
            velocity: piece.velocity(),
            direction: direction(&piece),
            arc: piece.from,
            length: piece.to - piece.from,
            first: i == 0,
            last: i + 1 == self.polyline.pieces(),
            half: self.half(if after > before { after } else { before }),
        })
    }

    /// The turns at point `i`, which together have all directions from the piece before to the one after.
    pub(super) fn turns(&self, i: usize) -> impl Iterator<Item = Motion> {
        let bend = self.bend(i).filter(|bend| bend.sweep > SMALL_SWEEP);
        let at = self.polyline.points().get(i).copied();
        let arc = self.polyline.arc().get(i).copied();
        let place = at.zip(arc).zip(bend);
        place
            .into_iter()
            .flat_map(move |((at, arc), bend)| self.turns_of(at, arc, bend))
    }

    fn turns_of(&self, at: Point, arc: f32, bend: Bend) -> impl Iterator<Item = Motion> {
        let whole = Arc::of(bend.before, bend.after, bend.middle);
        let arcs = match whole.turns {
            1 => [Some(whole), None],
            _ => [
                Some(Arc::halved(bend.before, bend.middle)),
                Some(Arc::halved(bend.middle, bend.after)),
            ],
        };
        let body = *self;
        arcs.into_iter()
            .flatten()
            .flat_map(Arc::directions)
            .map(move |(direction, spread)| Motion {
                start: at,
                velocity: Vector::new(0.0, 0.0),
                direction,
                arc,
                length: 0.0,
                first: false,
                last: false,
                half: body.half(body.radius * spread),
            })
    }

    fn half(&self, sweep: f32) -> (f32, f32) {
        let more = self.inflation + sweep;
        (
            0.5 * self.footprint.length + more,
            0.5 * self.footprint.width + more,
        )
    }

    /// The change of direction at point `i`; `None` at the ends.
    fn bend(&self, i: usize) -> Option<Bend> {
        let before = direction(&self.polyline.piece(i.checked_sub(1)?)?);
        let after = direction(&self.polyline.piece(i)?);
        let middle = middle(before, after);
        Some(Bend {
            before,
            middle,
            after,
            sweep: self.radius * length(&(middle - before)),
        })
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
}

impl Arc {
    fn halved(from: Vector, to: Vector) -> Self {
        Self::of(from, to, middle(from, to))
    }

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
        }
    }

    /// The middle direction of each turn, and how far its directions are from that.
    fn directions(self) -> impl Iterator<Item = (Vector, f32)> {
        (0..self.turns).map(move |i| {
            let along = (f32::from(i) + 0.5) / f32::from(self.turns);
            let point = self.from + (self.to - self.from) * along;
            (point * (1.0 / length(&point)), self.spread)
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
        (along < SHARP).then(|| (i, libm::atan2f(across, along).to_degrees()))
    })
}
