//! One vehicle of each encounter of a block: state, pose, and the segment of the route that it is on.

use super::lanes::{Boxes, advance};
use super::library::{Library, Track};
use super::{LANES, Lanes};
use cede_controller::geometry::{Point, Pose, unit};
use cede_controller::kinematics::State;
use wide::f32x8;

/// One vehicle of each of the encounters that a block steps together; entry `i` of each array
/// belongs to encounter `i`.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Arc length in metres.
    pub s: Lanes,
    /// Speed in m/s, never negative.
    pub v: Lanes,
    /// Centre of the footprint, metres east.
    pub x: Lanes,
    /// Centre of the footprint, metres north.
    pub y: Lanes,
    /// Cosine of the heading.
    pub cos: Lanes,
    /// Sine of the heading.
    pub sin: Lanes,
    /// Metres driven in the last step.
    pub(super) moved: Lanes,
    /// The segment that the vehicle is on starts here: position (m) and arc length (m).
    from_x: Lanes,
    from_y: Lanes,
    from_s: Lanes,
    /// It ends at this arc length (m); infinite for a route's last segment.
    to_s: Lanes,
    /// Its index in the library.
    segment: [u32; LANES],
}

impl Motion {
    pub(super) fn new() -> Self {
        let zero = [0.0; LANES];
        Self {
            s: zero,
            v: zero,
            x: zero,
            y: zero,
            cos: [1.0; LANES],
            sin: zero,
            moved: zero,
            from_x: zero,
            from_y: zero,
            from_s: zero,
            to_s: [f32::INFINITY; LANES],
            segment: [0; LANES],
        }
    }

    /// The state of the vehicle in encounter `lane` of the block.
    #[must_use]
    pub fn state(&self, lane: usize) -> State {
        State {
            s: self.s[lane],
            v: self.v[lane],
        }
    }

    /// The pose of the vehicle in encounter `lane` of the block.
    #[must_use]
    #[inline]
    pub fn pose(&self, lane: usize) -> Pose {
        Pose {
            position: Point::new(self.x[lane], self.y[lane]),
            direction: unit(self.cos[lane], self.sin[lane]),
        }
    }

    #[inline]
    pub(super) fn boxes(&self) -> Boxes {
        Boxes {
            centre: [self.x.into(), self.y.into()],
            direction: [self.cos.into(), self.sin.into()],
        }
    }

    /// Puts the vehicle of encounter `lane` at the start of `track`.
    pub(super) fn place(&mut self, lane: usize, library: &Library, track: &Track) {
        self.s[lane] = track.start.s;
        self.v[lane] = track.start.v;
        self.segment[lane] = track.first_segment;
        self.enter(lane, library);
        self.follow(library);
    }

    /// One step under `accelerations` (m/s²), clamped.
    #[inline]
    pub(super) fn advance(&mut self, library: &Library, accelerations: &Lanes) {
        let (s, v) = advance(self.s.into(), self.v.into(), (*accelerations).into());
        self.moved = (s - f32x8::from(self.s)).to_array();
        self.s = s.to_array();
        self.v = v.to_array();
        self.follow(library);
    }

    /// Moves on to the segments that hold `s`, and takes the poses from them.
    #[inline]
    fn follow(&mut self, library: &Library) {
        let s = f32x8::from(self.s);
        let mut left = s.simd_ge(f32x8::from(self.to_s)).to_bitmask();
        while left != 0 {
            self.leave_segment(left.trailing_zeros() as usize, library);
            left &= left - 1;
        }
        let along = s - f32x8::from(self.from_s);
        let at = |from: Lanes, direction: Lanes| {
            (f32x8::from(from) + f32x8::from(direction) * along).to_array()
        };
        self.x = at(self.from_x, self.cos);
        self.y = at(self.from_y, self.sin);
    }

    fn leave_segment(&mut self, lane: usize, library: &Library) {
        while self.s[lane] >= self.to_s[lane] {
            self.segment[lane] += 1;
            self.enter(lane, library);
        }
    }

    fn enter(&mut self, lane: usize, library: &Library) {
        let segment = library.segment(self.segment[lane]);
        self.from_x[lane] = segment.from.x;
        self.from_y[lane] = segment.from.y;
        self.cos[lane] = segment.direction.x;
        self.sin[lane] = segment.direction.y;
        self.from_s[lane] = segment.start;
        self.to_s[lane] = segment.end;
    }
}
