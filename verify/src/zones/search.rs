//! Branch and bound over the places that no zone holds.

use super::body::{Arc, Body, Piece, add, between, dot, length, point};
use super::cell::Cell;
use super::{Pair, Site, SiteError, Zone};
use crate::interval::Interval;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Below this size (m) a part is not divided again.
const FINEST: f64 = 1e-7;

/// What was found of two paths.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked {
    /// The ego's path.
    pub ego: usize,
    /// The other's.
    pub other: usize,
    /// The number of zones.
    pub zones: usize,
    /// The number of parts that were looked at.
    pub parts: u64,
    /// Whether the zones cover every overlap.
    pub verdict: Verdict,
}

/// Whether zones cover every overlap.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Proved: outside of the zones the footprints are apart.
    Covered,
    /// Not so: in these places the footprints, enlarged by tolerance and reserve, overlap.
    Uncovered(Failing),
    /// Not shown, with as many parts as were allowed; near these places.
    Open(Failing),
    /// Whoever is first at the zone's entry is not sure to be ahead: the entry of this lane is not in its band
    /// (the condition of Theorem 2).
    Corner(Zone),
}

/// Two vehicles in no zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failing {
    /// Arc length (m) of the ego.
    pub s: f64,
    /// Arc length (m) of the other.
    pub t: f64,
    /// Heading (degrees, from east to north) of the ego.
    pub heading: f64,
    /// Heading of the other.
    pub other_heading: f64,
    /// How far (m) the footprints are apart; 0 if they overlap.
    pub apart: f64,
    /// How far (m) they have to be.
    pub needed: f64,
}

/// Checks each two paths of `site`, with at most `parts` parts of the places of each two; `done` is called after each.
///
/// Footprints are larger than the tolerance makes them by `reserve` (m).
///
/// # Errors
/// If `site` is none.
pub fn check(
    site: &Site,
    reserve: f64,
    parts: u64,
    done: impl Fn(&Checked) + Sync,
) -> Result<Vec<Checked>, SiteError> {
    site.sound()?;
    site.complete()?;
    Ok(checked(site, reserve, parts, done))
}

/// Checks what is said of the paths.
pub(super) fn checked(
    site: &Site,
    reserve: f64,
    parts: u64,
    done: impl Fn(&Checked) + Sync,
) -> Vec<Checked> {
    let bodies: Vec<Body> = site.paths.iter().map(Body::new).collect();
    let pairs: Vec<&Pair> = site.each().collect();
    let needed =
        Interval::point(2.0).mul(Interval::point(site.tolerance).add(Interval::point(reserve)));
    let one = |pair: &&Pair| {
        let mut search = Search {
            ego: &bodies[pair.ego],
            other: &bodies[pair.other],
            needed: needed.hi,
            left: parts,
        };
        let verdict = search.verdict(&pair.zones);
        let checked = Checked {
            ego: pair.ego,
            other: pair.other,
            zones: pair.zones.len(),
            parts: parts - search.left,
            verdict,
        };
        done(&checked);
        checked
    };
    pairs.par_iter().map(one).collect()
}

/// The search for two paths.
struct Search<'a> {
    ego: &'a Body,
    other: &'a Body,
    /// How far (m) footprints have to be apart.
    needed: f64,
    /// How many parts may still be looked at.
    left: u64,
}

/// Places on a piece of each path, and directions there.
#[derive(Clone, Copy)]
struct Part {
    cell: Cell,
    arcs: [Arc; 2],
}

/// A part, the larger the nearer the footprints are in its middle.
struct Nearness {
    part: Part,
    failing: Failing,
}

impl Nearness {
    fn of(search: &Search<'_>, part: Part, a: &Piece, b: &Piece) -> Self {
        let failing = search.failing(&part, a, b);
        Self { part, failing }
    }
}

impl Ord for Nearness {
    fn cmp(&self, other: &Self) -> Ordering {
        other.failing.apart.total_cmp(&self.failing.apart)
    }
}

impl PartialOrd for Nearness {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Nearness {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Nearness {}

impl Search<'_> {
    fn verdict(&mut self, zones: &[Zone]) -> Verdict {
        if let Some(zone) = zones.iter().find(|zone| !corner_in_band(zone)) {
            return Verdict::Corner(*zone);
        }
        let whole = Cell::all(places(self.ego), places(self.other));
        let outside = whole.outside(zones);
        let (ego, other) = (self.ego, self.other);
        for a in &ego.pieces {
            for b in &other.pieces {
                if !self.near(a, b) {
                    continue;
                }
                for part in parts(&outside, a, b) {
                    if let Some(verdict) = self.fails(part, a, b) {
                        return verdict;
                    }
                }
            }
        }
        Verdict::Covered
    }

    /// Whether footprints on two pieces may touch, by the circles around them.
    fn near(&self, a: &Piece, b: &Piece) -> bool {
        let middles = [a, b].map(|piece| {
            let half = Interval::point(piece.places.radius());
            add(point(piece.start), piece.velocity.map(|v| v.mul(half)))
        });
        let [a, b] = [a, b].map(|piece| piece.places.radius());
        let apart = length([
            middles[0][0].sub(middles[1][0]),
            middles[0][1].sub(middles[1][1]),
        ]);
        let reach = [
            a,
            b,
            self.ego.radius(),
            self.other.radius(),
            self.needed,
            0.01,
        ];
        apart.lo <= 1.001 * reach.iter().sum::<f64>()
    }

    /// What is wrong with a part; none if footprints are apart in all of it. What is nearest is looked at first.
    fn fails(&mut self, part: Part, a: &Piece, b: &Piece) -> Option<Verdict> {
        let mut parts = BinaryHeap::from([Nearness::of(self, part, a, b)]);
        while let Some(Nearness { part, failing }) = parts.pop() {
            let Some(left) = self.left.checked_sub(1) else {
                return Some(Verdict::Open(failing));
            };
            self.left = left;
            if self.apart(&part, a, b) {
                continue;
            }
            if failing.apart < self.needed {
                return Some(Verdict::Uncovered(failing));
            }
            match self.divided(&part) {
                Some(halves) => {
                    let halves = halves.into_iter();
                    parts.extend(halves.map(|half| Nearness::of(self, half, a, b)));
                }
                None => return Some(Verdict::Open(failing)),
            }
        }
        None
    }

    /// Whether some axis shows that the footprints are apart.
    fn apart(&self, part: &Part, a: &Piece, b: &Piece) -> bool {
        let between = between(b.start, a.start);
        let origin = [a.places.lo, b.places.lo];
        axes(part, self.shapes(part, a, b)).into_iter().any(|axis| {
            let axis = point(axis);
            let slopes = [dot(axis, a.velocity), dot(axis, b.velocity).scale(-1.0)];
            let centres = Interval::point(part.cell.least(slopes, origin)).add(dot(axis, between));
            let extents = [
                self.ego.extent(&part.arcs[0], axis),
                self.other.extent(&part.arcs[1], axis),
                length(axis).mul(Interval::point(self.needed)).hi,
            ];
            let reach = extents
                .map(Interval::point)
                .into_iter()
                .fold(Interval::ZERO, Interval::add);
            centres.sub(reach).lo > 0.0
        })
    }

    /// Two halves of what is largest in the part; none if it is too small for that.
    fn divided(&self, part: &Part) -> Option<Vec<Part>> {
        let Part { cell, arcs } = *part;
        let width = |interval: Interval| interval.hi - interval.lo;
        let sizes = [
            width(cell.ego),
            width(cell.other),
            self.ego.radius() * arcs[0].width(),
            self.other.radius() * arcs[1].width(),
        ];
        let largest = (0..4).max_by(|&i, &j| sizes[i].total_cmp(&sizes[j]))?;
        if sizes[largest] < FINEST {
            return None;
        }
        Some(match largest {
            0 | 1 => cell
                .halves(largest == 0)
                .map(|cell| Part { cell, arcs })
                .collect(),
            2 => arcs[0]
                .halves()
                .map(|arc| Part {
                    cell,
                    arcs: [arc, arcs[1]],
                })
                .to_vec(),
            _ => arcs[1]
                .halves()
                .map(|arc| Part {
                    cell,
                    arcs: [arcs[0], arc],
                })
                .to_vec(),
        })
    }

    /// The footprints in the middle of a part.
    fn shapes(&self, part: &Part, a: &Piece, b: &Piece) -> [Corners; 2] {
        let (s, t) = part.cell.middle();
        let [heading, other] = part.arcs.map(|arc| arc.middle());
        [
            corners(place(a, s), heading, self.ego.half()),
            corners(place(b, t), other, self.other.half()),
        ]
    }

    /// The same, as a pair of places that should be in a zone.
    fn failing(&self, part: &Part, a: &Piece, b: &Piece) -> Failing {
        let (s, t) = part.cell.middle();
        let headings = part.arcs.map(|arc| arc.middle());
        let [heading, other_heading] = headings.map(|[x, y]| y.atan2(x).to_degrees());
        Failing {
            s,
            t,
            heading,
            other_heading,
            apart: distance(&self.shapes(part, a, b)),
            needed: self.needed,
        }
    }
}

/// The condition of Theorem 2 on a lane that has an entry.
fn corner_in_band(zone: &Zone) -> bool {
    // No path is so long: an end as far as this stands for none.
    let entered = [zone.ego[0], zone.other[0]]
        .iter()
        .all(|end| end.abs() < 1e6);
    let corner = Interval::point(zone.ego[0]).sub(Interval::point(zone.other[0]));
    let [from, to] = zone.lead;
    !zone.lane || !entered || (from <= corner.lo && corner.hi <= to)
}

fn places(body: &Body) -> Interval {
    let places = body.pieces.iter().map(|piece| piece.places);
    places.reduce(Interval::hull).unwrap_or(Interval::ZERO)
}

/// The parts of the cells on two pieces.
fn parts(cells: &[Cell], a: &Piece, b: &Piece) -> Vec<Part> {
    let mut parts = Vec::new();
    let here = cells.iter().filter_map(|cell| cell.at(a.places, b.places));
    for cell in here {
        for ego in &a.headings {
            for other in &b.headings {
                let arcs = [ego.arc, other.arc];
                let cell = cell.at(ego.places, other.places);
                parts.extend(cell.map(|cell| Part { cell, arcs }));
            }
        }
    }
    parts
}

/// Where the vehicle is on the piece.
fn place(piece: &Piece, s: f64) -> [f64; 2] {
    let more = s - piece.places.lo;
    let [x, y] = piece.velocity.map(|v| v.middle() * more);
    [piece.start[0] + x, piece.start[1] + y]
}

/// Axes along which the footprints of a part may be apart, each from the other to the ego.
fn axes(part: &Part, shapes: [Corners; 2]) -> [[f64; 2]; 6] {
    let [a, b] = part.arcs.map(|arc| arc.middle());
    let [p, q] = shapes.map(|shape| middle(shape[0], shape[2]));
    let separation = [p[0] - q[0], p[1] - q[1]];
    let left = |[x, y]: [f64; 2]| [-y, x];
    let towards = |[x, y]: [f64; 2]| {
        let ahead = x * separation[0] + y * separation[1];
        if ahead < 0.0 { [-x, -y] } else { [x, y] }
    };
    [nearest(&shapes), separation, left(a), left(b), a, b].map(towards)
}

fn middle(p: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]
}

type Corners = [[f64; 2]; 4];

fn corners(place: [f64; 2], [x, y]: [f64; 2], [long, wide]: [f64; 2]) -> Corners {
    [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)].map(|(along, across)| {
        let (l, w) = (along * long, across * wide);
        [place[0] + l * x - w * y, place[1] + l * y + w * x]
    })
}

/// How far two rectangles are apart; 0 if they overlap.
fn distance(shapes: &[Corners; 2]) -> f64 {
    let beyond = |[a, b]: [&Corners; 2]| {
        sides(a).iter().any(|(p, q)| {
            let left = |r: &[f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
            b.iter().all(|r| left(r) > 0.0)
        })
    };
    let [a, b] = shapes;
    if !beyond([a, b]) && !beyond([b, a]) {
        return 0.0;
    }
    let [x, y] = nearest(shapes);
    x.hypot(y)
}

/// From a point of the second rectangle to one of the first, of those that are nearest to each other.
fn nearest([a, b]: &[Corners; 2]) -> [f64; 2] {
    let from_corner = |p: &[f64; 2], of: &Corners| {
        let sides = sides(of).map(|side| to_side(*p, side));
        sides.into_iter().fold([f64::INFINITY; 2], shorter)
    };
    let of_a = a.iter().map(|p| from_corner(p, b));
    let of_b = b.iter().map(|q| from_corner(q, a).map(|x| -x));
    of_a.chain(of_b).fold([f64::INFINITY; 2], shorter)
}

fn shorter(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    if a[0].hypot(a[1]) <= b[0].hypot(b[1]) {
        a
    } else {
        b
    }
}

fn sides(shape: &Corners) -> [([f64; 2], [f64; 2]); 4] {
    [0, 1, 2, 3].map(|i| (shape[i], shape[(i + 1) % 4]))
}

/// From the nearest point of the side from p to q to the point r.
fn to_side(r: [f64; 2], (p, q): ([f64; 2], [f64; 2])) -> [f64; 2] {
    let (along, to) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
    let share = (along[0] * to[0] + along[1] * to[1]) / (along[0] * along[0] + along[1] * along[1]);
    let share = share.clamp(0.0, 1.0);
    [to[0] - share * along[0], to[1] - share * along[1]]
}
