//! What a vehicle covers at an arc length: D2 of `docs/theorem.md`, in intervals.

use super::Path;
use crate::interval::Interval;
use cede_controller::Real as _;

/// A vehicle has headings besides the path's within this share of its length of a kink.
const TURNING: f64 = 0.6;

/// A vector in the plane, enclosed.
pub(super) type Vector = [Interval; 2];

/// All directions between two that are less than 180° apart, which have length 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    from: Vector,
    to: Vector,
}

/// Directions that a vehicle may have between two arc lengths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heading {
    pub(super) places: Interval,
    pub(super) arc: Arc,
}

/// A straight piece of a path.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) places: Interval,
    pub(super) start: [f64; 2],
    /// Metres of the plane for each metre of arc length.
    pub(super) velocity: Vector,
    pub(super) headings: Vec<Heading>,
}

/// A footprint that moves along a path.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) pieces: Vec<Piece>,
    /// Half of the footprint's length and width.
    half: [f64; 2],
}

pub(super) fn point([x, y]: [f64; 2]) -> Vector {
    [Interval::point(x), Interval::point(y)]
}

pub(super) fn dot(a: Vector, b: Vector) -> Interval {
    a[0].mul(b[0]).add(a[1].mul(b[1]))
}

pub(super) fn cross(a: Vector, b: Vector) -> Interval {
    a[0].mul(b[1]).sub(a[1].mul(b[0]))
}

pub(super) fn add(a: Vector, b: Vector) -> Vector {
    [a[0].add(b[0]), a[1].add(b[1])]
}

pub(super) fn between(from: [f64; 2], to: [f64; 2]) -> Vector {
    let [from, to] = [from, to].map(point);
    [to[0].sub(from[0]), to[1].sub(from[1])]
}

fn divided(v: Vector, by: Interval) -> Vector {
    [v[0].div(by), v[1].div(by)]
}

pub(super) fn length(v: Vector) -> Interval {
    dot(v, v).sqrt()
}

fn unit(v: Vector) -> Vector {
    divided(v, length(v))
}

impl Arc {
    const fn straight(direction: Vector) -> Self {
        Self {
            from: direction,
            to: direction,
        }
    }

    /// The direction half-way.
    fn halfway(&self) -> Vector {
        unit(add(self.from, self.to))
    }

    pub(super) fn halves(self) -> [Self; 2] {
        let halfway = self.halfway();
        let [from, to] = [self.from, self.to];
        [Self { from, to: halfway }, Self { from: halfway, to }]
    }

    /// The distance between first and last direction.
    pub(super) fn width(&self) -> f64 {
        let [a, b] = [self.from, self.to].map(|v| v.map(Interval::middle));
        (b[0] - a[0]).hypot(b[1] - a[1])
    }

    /// Some direction near the middle.
    pub(super) fn middle(&self) -> [f64; 2] {
        self.halfway().map(Interval::middle)
    }

    /// Where the tangents at first and last direction meet: all directions between are in the triangle of the three.
    fn tip(&self) -> Vector {
        let cosine = dot(self.from, self.to);
        divided(add(self.from, self.to), Interval::point(1.0).add(cosine))
    }
}

impl Body {
    pub(super) fn new(path: &Path) -> Self {
        let ends: Vec<_> = path.points.windows(2).map(|p| (p[0], p[1])).collect();
        let directions: Vec<Vector> = ends.iter().map(|&(p, q)| unit(between(p, q))).collect();
        let window = (TURNING * path.length).next_up();
        let pieces = ends.iter().zip(path.arc.windows(2)).enumerate();
        let pieces = pieces.map(|(i, (&(start, end), arc))| {
            let places = Interval::new(arc[0], arc[1]);
            let long = places.high().sub(places.low());
            let before = i.checked_sub(1).and_then(|i| directions.get(i));
            Piece {
                places,
                start,
                velocity: divided(between(start, end), long),
                headings: headings(
                    places,
                    window,
                    directions[i],
                    [before, directions.get(i + 1)],
                ),
            }
        });
        Self {
            pieces: pieces.collect(),
            half: [0.5 * path.length, 0.5 * path.width],
        }
    }

    /// No point of the footprint is farther (m) from its middle.
    pub(super) fn radius(&self) -> f64 {
        length(point(self.half)).hi
    }

    pub(super) const fn half(&self) -> [f64; 2] {
        self.half
    }

    /// How far (m) the footprint goes from its middle along `axis` at most, in every direction of `arc`.
    pub(super) fn extent(&self, arc: &Arc, axis: Vector) -> f64 {
        let [long, wide] = self.half.map(Interval::point);
        // It is convex in the direction, so it is largest at a corner of the triangle.
        let at = |direction: Vector| {
            let along = Interval::point(dot(direction, axis).magnitude());
            let across = Interval::point(cross(direction, axis).magnitude());
            long.mul(along).add(wide.mul(across)).hi
        };
        at(arc.from).max(at(arc.to)).max(at(arc.tip()))
    }
}

/// The headings on a piece with `direction`, between the pieces before and after it.
fn headings(
    places: Interval,
    window: f64,
    direction: Vector,
    [before, after]: [Option<&Vector>; 2],
) -> Vec<Heading> {
    let first = Interval::new(places.lo, (places.lo + window).next_up().min(places.hi));
    let last = Interval::new((places.hi - window).next_down().max(places.lo), places.hi);
    let to_halfway = |next: &Vector| Arc {
        from: direction,
        to: unit(add(direction, *next)),
    };
    let straight = Heading {
        places,
        arc: Arc::straight(direction),
    };
    let turning = [(first, before), (last, after)];
    let turning = turning.into_iter().filter_map(|(places, next)| {
        let arc = to_halfway(next?);
        Some(Heading { places, arc })
    });
    std::iter::once(straight).chain(turning).collect()
}
