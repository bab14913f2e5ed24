//! One vehicle of each encounter of a block: state, pose, and the segment of the route that it is on.

use super::library::{Library, Track};
use super::{LANES, Lanes};
use crate::stepper::Eight;
use cede_controller::Real;
use cede_controller::geometry::unit;
use cede_controller::kinematics::State;
use cede_controller::separation::OrientedBox;
use cede_controller::{Footprint, Point, Pose, Vector};

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

    /// What the vehicles cover, all of this `footprint`.
    #[inline]
    pub(super) fn outlines(&self, footprint: Footprint) -> OrientedBox<Eight> {
        OrientedBox {
            centre: Point::new(self.x.into(), self.y.into()),
            direction: Vector::new(self.cos.into(), self.sin.into()),
            half_length: Eight::of(0.5 * footprint.length),
            half_width: Eight::of(0.5 * footprint.width),
        }
    }

    /// The states of all vehicles.
    #[inline]
    pub(super) fn states(&self) -> State<Eight> {
        State {
            s: self.s.into(),
            v: self.v.into(),
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

    /// Takes all vehicles on to `states`, none of them behind where it is.
    #[inline]
    pub(super) fn move_to(&mut self, states: &State<Eight>, library: &Library) {
        self.s = states.s.lanes();
        self.v = states.v.lanes();
        self.follow(library);
    }

    /// Moves on to the segments that hold `s`, and takes the poses from them.
    #[inline]
    fn follow(&mut self, library: &Library) {
        let s = Eight::from(self.s);
        let mut left = s.at_least(self.to_s.into());
        while left != 0 {
            self.leave_segment(left.trailing_zeros() as usize, library);
            left &= left - 1;
        }
        let along = s - self.from_s.into();
        let at = |from: Lanes, direction: Lanes| {
            (Eight::from(from) + Eight::from(direction) * along).lanes()
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
