//! The lie of the land: arms, lanes, stop lines and the ways across.

use super::human::Right;
use super::plan::{Class, Control, Purpose, class_of, name_of, stream};
use super::profile::SpeedProfile;
use super::zone::{RouteRelation, parting, zone};
use crate::encounter::{Manoeuvre, SimRoute};
use cede_controller::geometry::{Point, Vector, distance};
use rand::RngExt;
use rand_pcg::Pcg64;

/// A road that leads to the intersection: one lane in, one lane out.
#[derive(Clone, Debug)]
pub(super) struct Arm {
    /// Unit vector from the centre outwards.
    pub(super) outward: Vector,
    /// Width of each of its lanes, m.
    pub(super) lane_width: f32,
    /// From the centre to its stop line, m.
    pub(super) line: f32,
    /// From the centre to the edge of the scene, m.
    pub(super) edge: f32,
    /// What people drive on it, m/s.
    pub(super) speed: f32,
    /// Whether it is part of the major road.
    pub(super) major: bool,
    /// Its share of the traffic, relative to the others.
    pub(super) demand: f32,
}

/// A way across: from one arm to another.
#[derive(Clone, Debug)]
pub(super) struct Movement {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) manoeuvre: Manoeuvre,
    pub(super) route: SimRoute,
    /// Arc length (m) of the stop line.
    pub(super) line: f32,
    pub(super) profile: SpeedProfile,
    /// What a plain driver drives at most from the line to the other side, m/s.
    pub(super) crossing_speed: f32,
    /// Its share of its arm's traffic, relative to the others.
    pub(super) demand: f32,
}

/// Two ways across that the site's encounters are made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conflict {
    /// The movement that has to give way, as an index in [`Layout::movements`].
    pub(super) yielding: usize,
    /// The one that it meets.
    pub(super) other: usize,
    /// As the description calls it.
    pub(super) kind: &'static str,
}

/// An intersection with its rules.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) number: u16,
    pub(super) name: String,
    pub(super) control: Control,
    pub(super) arms: Vec<Arm>,
    pub(super) movements: Vec<Movement>,
    /// `relations[i][j]`: how movement `i` meets movement `j`.
    pub(super) relations: Vec<Vec<RouteRelation>>,
    /// The pairs of movements that the site's encounters are made of.
    pub(super) conflicts: Vec<Conflict>,
}

/// The centre of every layout, m; away from the origin, as the recorded sites are.
pub(super) const CENTRE: Point = Point::new(1000.0, 1000.0);

impl Arm {
    /// Offset of the lane's centre from the road's axis: traffic keeps to the right.
    fn lane(&self, direction: Vector) -> Vector {
        Vector::new(direction.y, -direction.x) * (0.5 * self.lane_width)
    }

    /// The point of the lane towards the centre, `distance` m from it.
    pub(super) fn inbound(&self, distance: f32) -> Point {
        CENTRE + self.outward * distance + self.lane(self.outward * -1.0)
    }

    /// The point of the lane away from the centre, `distance` m from it.
    pub(super) fn outbound(&self, distance: f32) -> Point {
        CENTRE + self.outward * distance + self.lane(self.outward)
    }
}

impl Movement {
    fn meets(&self, other: &Self) -> RouteRelation {
        if self.from == other.from {
            return RouteRelation::Parting(parting(&self.route, &other.route));
        }
        let merging = self.to == other.to;
        zone(&self.route, &other.route, merging)
            .map_or(RouteRelation::Never, RouteRelation::Conflict)
    }
}

impl Layout {
    /// Site `number`, with measures drawn for its class.
    pub(super) fn draw(number: u16, seed: u64) -> Self {
        let Class { control, arms, .. } = class_of(number);
        let rng = &mut stream(seed, number, Purpose::Site);
        let style = Style::draw(control, rng);
        let arms: Vec<Arm> = (0..arms).map(|i| style.arm(i, rng)).collect();
        let mut movements = Vec::new();
        for from in 0..arms.len() {
            for to in (0..arms.len()).filter(|&to| to != from) {
                movements.extend(draw_movement(&style, &arms, from, to, rng));
            }
        }
        let relations = movements
            .iter()
            .map(|a| movements.iter().map(|b| a.meets(b)).collect())
            .collect();
        let mut layout = Self {
            number,
            name: name_of(number),
            control,
            arms,
            movements,
            relations,
            conflicts: Vec::new(),
        };
        layout.conflicts = layout.draw_conflicts(rng);
        layout
    }

    /// How two different movements conflict, if they do.
    fn conflict_kind(&self, a: usize, b: usize) -> Option<&'static str> {
        let (own, other) = (&self.movements[a], &self.movements[b]);
        match self.relations[a][b] {
            RouteRelation::Conflict(_) if own.to == other.to => Some("merging"),
            RouteRelation::Conflict(_) => Some("crossing"),
            RouteRelation::Parting(_) => Some("following"),
            RouteRelation::Never => None,
        }
    }

    /// Left-turners against oncoming traffic, as at the recorded sites, and some of all other pairs.
    fn draw_conflicts(&self, rng: &mut Pcg64) -> Vec<Conflict> {
        const SHARE: f64 = 0.15;
        let mut conflicts = Vec::new();
        for yielding in 0..self.movements.len() {
            for other in 0..self.movements.len() {
                let (own, theirs) = (&self.movements[yielding], &self.movements[other]);
                let Some(kind) = self.conflict_kind(yielding, other) else {
                    continue;
                };
                if kind == "following" {
                    // Whoever is behind gives way; one order of the two is enough.
                    if yielding <= other && rng.random_bool(SHARE) {
                        conflicts.push(Conflict {
                            yielding,
                            other,
                            kind,
                        });
                    }
                    continue;
                }
                if self.rule(own, theirs) != Right::Theirs {
                    continue;
                }
                let oncoming = self.arms[own.from]
                    .outward
                    .dot(&self.arms[theirs.from].outward)
                    < -0.5;
                if (oncoming && own.manoeuvre == Manoeuvre::Left) || rng.random_bool(SHARE) {
                    conflicts.push(Conflict {
                        yielding,
                        other,
                        kind,
                    });
                }
            }
        }
        conflicts
    }
}

/// What the arms of one site have in common.
struct Style {
    control: Control,
    /// From 0, a narrow crossing of residential streets, to 1, a wide one.
    size: f32,
    /// Usual speed, m/s.
    speed: f32,
}

impl Style {
    fn draw(control: Control, rng: &mut Pcg64) -> Self {
        Self {
            control,
            size: rng.random_range(0.0..1.0),
            speed: rng.random_range(5.5..11.0),
        }
    }

    /// Arm `index`: 0 east, 1 north, 2 west, 3 south, each turned by up to 10°.
    fn arm(&self, index: usize, rng: &mut Pcg64) -> Arm {
        let degrees = 90.0 * index as f32 + rng.random_range(-10.0..10.0);
        let angle = degrees.to_radians();
        let major = index.is_multiple_of(2);
        let line = 10.5 + 7.0 * self.size + rng.random_range(0.0..3.0);
        let minor = self.control == Control::TwoWayStop && !major;
        // Some arms are much busier than others.
        let uneven: f32 = rng.random_range(0.35..1.2);
        Arm {
            outward: Vector::new(libm::cosf(angle), libm::sinf(angle)),
            lane_width: rng.random_range(3.3..4.0),
            line,
            edge: line + rng.random_range(20.0..50.0),
            speed: self.speed * rng.random_range(0.8..1.25),
            major,
            demand: uneven * uneven * uneven * if minor { 0.4 } else { 1.0 },
        }
    }

    /// How far from the centre (m) the curve of a `manoeuvre` begins and ends.
    fn reach(&self, manoeuvre: Manoeuvre, rng: &mut Pcg64) -> f32 {
        let wider = rng.random_range(0.0..1.5);
        match manoeuvre {
            Manoeuvre::Left => 8.0 + 6.0 * self.size + wider,
            Manoeuvre::Right => 9.5 + 4.0 * self.size + wider,
            _ => 10.0,
        }
    }
}

fn draw_movement(
    style: &Style,
    arms: &[Arm],
    from: usize,
    to: usize,
    rng: &mut Pcg64,
) -> Option<Movement> {
    let (a, b) = (&arms[from], &arms[to]);
    let (entry, exit) = (a.outward * -1.0, b.outward);
    let turn = libm::atan2f(entry.perp(&exit), entry.dot(&exit)).to_degrees();
    let manoeuvre = match turn {
        50.0..=130.0 => Manoeuvre::Left,
        -40.0..=40.0 => Manoeuvre::Straight,
        -130.0..=-50.0 => Manoeuvre::Right,
        _ => return None,
    };
    let reach = style.reach(manoeuvre, rng);
    let points = curve(a.inbound(reach), entry, b.outbound(reach), exit);
    let points = [a.inbound(a.edge)]
        .into_iter()
        .chain(points)
        .chain([b.outbound(b.edge)]);
    let route = SimRoute::new(points).ok()?;
    let line = route.project(a.inbound(a.line));
    let speed_at = |s: f32| if s <= line { a.speed } else { b.speed };
    let profile = SpeedProfile::new(&route, speed_at);
    Some(Movement {
        from,
        to,
        manoeuvre,
        line,
        crossing_speed: profile.slowest(line, line + 12.0),
        profile,
        route,
        demand: rng.random_range(0.3..1.2),
    })
}

/// A cubic Bézier curve from `a` in direction `u` to `b` in direction `w`; close to a circle's arc.
pub(super) fn curve(a: Point, u: Vector, b: Point, w: Vector) -> impl Iterator<Item = Point> {
    const PIECES: u8 = 24;
    let handle = 0.39 * distance(&a, &b);
    let control = [a, a + u * handle, b - w * handle, b].map(|point| point.coords);
    (0..=PIECES).map(move |i| {
        let t = f32::from(i) / f32::from(PIECES);
        let r = 1.0 - t;
        let [a, c, d, b] = control;
        let at = a * (r * r * r) + c * (3.0 * r * r * t) + d * (3.0 * r * t * t) + b * (t * t * t);
        Point::from(at)
    })
}
