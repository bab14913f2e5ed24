//! The lie of the land: arms, lanes, stop lines and the ways across.

use super::human::Right;
use super::plan::{Class, Control, Purpose, class_of, name_of, stream};
use super::profile::SpeedProfile;
use super::zone::{RouteRelation, parting, zone};
use crate::encounter::SimRoute;
use crate::role::Manoeuvre;
use cede_controller::geometry::{Point, Vector, distance};
use rand::RngExt;
use rand_pcg::Pcg64;

/// A road that leads to the intersection, with as many lanes in as out.
#[derive(Clone, Debug)]
pub(super) struct Arm {
    /// Unit vector from the centre outwards.
    pub(super) outward: Vector,
    /// Width of each of its lanes, m.
    pub(super) lane_width: f32,
    /// Lanes in each direction, 1 or 2; of two, the inner one is for those who turn left.
    pub(super) lanes: u8,
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
    /// Lanes of the arms that it comes from and leads to, counted from the road's axis.
    pub(super) lanes: [u8; 2],
    pub(super) manoeuvre: Manoeuvre,
    pub(super) route: SimRoute,
    /// Arc length (m) of the line.
    pub(super) line: f32,
    /// Arc length (m) at which the front bumper waits for those who go first: the line, or beyond it if
    /// there is no sign.
    pub(super) waits: f32,
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
    /// Whether its map has signs.
    pub(super) signs: bool,
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
    /// The lane of a `manoeuvre`, counted from the road's axis.
    fn lane(&self, manoeuvre: Manoeuvre) -> u8 {
        match manoeuvre {
            Manoeuvre::Left => 0,
            _ => self.lanes - 1,
        }
    }

    /// The point of the middle of `lane` towards the centre, `distance` m from it: traffic keeps to the right.
    fn inbound(&self, distance: f32, lane: u8) -> Point {
        self.across(distance, self.middle(lane))
    }

    /// The point of the middle of `lane` away from the centre, `distance` m from it.
    fn outbound(&self, distance: f32, lane: u8) -> Point {
        self.across(distance, -self.middle(lane))
    }

    fn middle(&self, lane: u8) -> f32 {
        (f32::from(lane) + 0.5) * self.lane_width
    }

    /// The point `out` m from the centre and `aside` m to the left of the axis, seen outwards.
    pub(super) fn across(&self, out: f32, aside: f32) -> Point {
        CENTRE + self.outward * out + Vector::new(-self.outward.y, self.outward.x) * aside
    }
}

impl Movement {
    fn meets(&self, other: &Self) -> RouteRelation {
        if self.from == other.from {
            let parting = parting(&self.route, &other.route);
            return if parting > 0.0 {
                RouteRelation::Parting(parting)
            } else {
                RouteRelation::Never
            };
        }
        let merging = self.one_exit(other);
        zone(&self.route, &other.route, merging)
            .map_or(RouteRelation::Never, RouteRelation::Conflict)
    }

    /// Whether both leave on one lane.
    pub(super) fn one_exit(&self, other: &Self) -> bool {
        (self.to, self.lanes[1]) == (other.to, other.lanes[1])
    }
}

impl Layout {
    /// Site `number`, with measures drawn for its class.
    pub(super) fn draw(number: u16, seed: u64) -> Self {
        let Class {
            control,
            arms,
            signs,
            ..
        } = class_of(number);
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
            signs,
            arms,
            movements,
            relations,
            conflicts: Vec::new(),
        };
        for i in 0..layout.movements.len() {
            layout.movements[i].waits = layout.waits(i);
        }
        layout.conflicts = layout.draw_conflicts(rng);
        layout
    }

    /// Where the front bumper on movement `i` waits: without a sign before the first zone with another that goes
    /// first, or with one that neither gives way nor goes first, unless both turn left.
    fn waits(&self, i: usize) -> f32 {
        const SETBACK: f32 = 1.2;
        const HALF_CAR: f32 = 2.4;
        let own = &self.movements[i];
        if self.has_sign(own) {
            return own.line;
        }
        let both_left =
            |other: &Movement| [own, other].map(|m| m.manoeuvre) == [Manoeuvre::Left; 2];
        let gives_way = |other| self.rule(other, own) == Right::Theirs;
        let zones = self.relations[i].iter().zip(&self.movements);
        let bound = zones.filter_map(|(relation, other)| match relation {
            RouteRelation::Conflict(zone) if !gives_way(other) && !both_left(other) => {
                Some(zone.own.0 - SETBACK + HALF_CAR)
            }
            _ => None,
        });
        let first = bound.min_by(f32::total_cmp);
        first.map_or(own.line, |first| first.max(own.line))
    }

    /// How two different movements conflict, if they do.
    fn conflict_kind(&self, a: usize, b: usize) -> Option<&'static str> {
        let (own, other) = (&self.movements[a], &self.movements[b]);
        match self.relations[a][b] {
            RouteRelation::Conflict(_) if own.one_exit(other) => Some("merging"),
            RouteRelation::Conflict(_) => Some("crossing"),
            RouteRelation::Parting(_) => Some("following"),
            RouteRelation::Never => None,
        }
    }

    /// Left-turners against oncoming traffic, as at the recorded sites, and some of all other pairs.
    fn draw_conflicts(&self, rng: &mut Pcg64) -> Vec<Conflict> {
        const SHARE: f64 = 0.15;
        const FOLLOWING: f64 = 0.05;
        let mut conflicts = Vec::new();
        for yielding in 0..self.movements.len() {
            for other in 0..self.movements.len() {
                let (own, theirs) = (&self.movements[yielding], &self.movements[other]);
                let Some(kind) = self.conflict_kind(yielding, other) else {
                    continue;
                };
                if kind == "following" {
                    // Whoever is behind gives way; one order of the two is enough.
                    if yielding <= other && rng.random_bool(FOLLOWING) {
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
    /// Usual speed of the major and of the minor road, m/s.
    speeds: [f32; 2],
    /// Lanes in each direction of the major and of the minor road.
    lanes: [u8; 2],
}

impl Style {
    fn draw(control: Control, rng: &mut Pcg64) -> Self {
        let size = rng.random_range(0.0..1.0);
        let mut two = |share| if rng.random_bool(share) { 2 } else { 1 };
        let lanes = match control {
            Control::AllWayStop => [two(0.4), two(0.25)],
            Control::TwoWayStop => [two(0.6), 1],
            Control::Yield => [two(0.3), 1],
            Control::Uncontrolled => [1, 1],
        };
        let speeds = match control {
            Control::AllWayStop => [rng.random_range(5.5..12.0); 2],
            Control::TwoWayStop => [rng.random_range(8.0..16.0), rng.random_range(5.5..11.0)],
            Control::Yield => [rng.random_range(6.0..14.0), rng.random_range(5.5..11.0)],
            Control::Uncontrolled => [rng.random_range(5.0..9.0); 2],
        };
        Self {
            control,
            size,
            speeds,
            lanes,
        }
    }

    /// By how much (m) lines and curves are farther out than where every road has one lane each way.
    fn widening(&self) -> f32 {
        3.5 * f32::from(self.lanes[0].max(self.lanes[1]) - 1)
    }

    /// Arm `index`: 0 east, 1 north, 2 west, 3 south, each turned by up to 10°.
    fn arm(&self, index: usize, rng: &mut Pcg64) -> Arm {
        let degrees = 90.0 * index as f32 + rng.random_range(-10.0..10.0);
        let angle = degrees.to_radians();
        let road = index % 2;
        let speed = self.speeds[road] * rng.random_range(0.8..1.25);
        let line = 10.5 + 7.0 * self.size + 1.3 * self.widening() + rng.random_range(0.0..3.0);
        let minor = self.control != Control::AllWayStop
            && self.control != Control::Uncontrolled
            && road == 1;
        // Some arms are much busier than others.
        let uneven: f32 = rng.random_range(0.35..1.2);
        Arm {
            outward: Vector::new(libm::cosf(angle), libm::sinf(angle)),
            lane_width: rng.random_range(3.3..4.0),
            lanes: self.lanes[road],
            line,
            edge: line + rng.random_range(20.0..50.0) + 3.0 * (speed - 8.0).max(0.0),
            speed,
            major: road == 0,
            demand: uneven * uneven * uneven * if minor { 0.6 } else { 1.0 },
        }
    }

    /// How far from the centre (m) the curve of a `manoeuvre` begins and ends.
    fn reach(&self, manoeuvre: Manoeuvre, rng: &mut Pcg64) -> f32 {
        let wider = rng.random_range(0.0..1.5);
        self.widening()
            + match manoeuvre {
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
    let lanes = [a, b].map(|arm| arm.lane(manoeuvre));
    let from_lane = |distance| a.inbound(distance, lanes[0]);
    let to_lane = |distance| b.outbound(distance, lanes[1]);
    let points = curve(from_lane(reach), entry, to_lane(reach), exit);
    let points = [from_lane(a.edge)]
        .into_iter()
        .chain(points)
        .chain([to_lane(b.edge)]);
    let route = SimRoute::new(points).ok()?;
    let line = route.project(from_lane(a.line));
    let speed_at = |s: f32| if s <= line { a.speed } else { b.speed };
    let profile = SpeedProfile::new(&route, speed_at);
    Some(Movement {
        from,
        to,
        lanes,
        manoeuvre,
        line,
        waits: line,
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
