//! Where two lanes run along one, and who is in front there: by the attacker's own polylines and rectangles.
//!
//! Nothing here comes from the controller. Its zones bound all that the junction allows; what is measured here is where
//! vehicles of these sizes touch, however they turn at kinks. The contract's C6 speaks of one behind another in a lane: the
//! other is behind if, going on along its way, it runs into the ego from the rear, and the gap is how far it gets until then.

use crate::lane::Lane;
use crate::plane::{Place, Size, dot, minus, norm, separation};
use crate::sway::Sway;

/// An ego counts as in the stretch from so far (m) before it on: stations are that coarse, and the controller's zones begin
/// somewhat sooner.
pub const EARLY: f64 = 1.5;

/// Stations along a lane are at most so far (m) apart.
const STEP: f64 = 0.5;

/// Where vehicles turn or nearly touch, they are looked at again after this (m).
const SHORTEST: f64 = 0.1;

/// Rectangles are larger by this (m) on every side beside the tolerance, as the theorem (iv) has it.
const ROUNDING: f64 = 0.02;

/// Vehicles point the same way up to this angle (rad), and share a lane if they touch so over this distance (m) on the way
/// of either. A little more than what the theorem takes for a lane (D4): wherever C6 is counted on, others keep it.
const SAME_WAY: f64 = 0.56;
const LANE: f64 = 1.0;

/// Who is out of another's way for less than this (m) has not left it.
const APART: f64 = 3.0;

/// Who comes towards the ego, by more than this angle (cosine), is not behind it.
const OPPOSITE: f64 = -0.5;

/// In a lane, who is ahead differs by at most so many times the two lengths together.
const WIDEST: f64 = 2.0;

/// Kinks sharper than this (rad) are looked at in every way in which a vehicle may turn.
const SHARP: f64 = 0.26;

/// A stretch in which the ego's lane and another's are one.
#[derive(Clone, Debug)]
pub struct Shared {
    /// In the order of the ego's arc lengths, at least one.
    rows: Vec<Row>,
}

/// What is so while the ego is between one station and the next.
#[derive(Clone, Copy, Debug)]
struct Row {
    s: f64,
    /// Arc lengths of the other at which it touches the ego: first and last.
    touch: [f64; 2],
    /// By how much (m) the ego's arc length exceeds that of another that runs into it, here or farther on, at most.
    lead: f64,
}

/// How another is to the ego in a shared stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relation {
    /// It comes from behind.
    pub behind: bool,
    /// How far (m) it gets until it runs into the ego from behind, wherever in the stretch that is.
    pub gap: f64,
    /// How far (m) it is in front of the ego, if it is.
    pub front: f64,
}

impl Shared {
    /// The stretches of an ego's lane and another's, for vehicles that leave their lanes by `tolerance` (m) at most.
    #[must_use]
    pub fn between(ego: &Lane, other: &Lane, tolerance: f64) -> Vec<Self> {
        let [ego, other] = [ego, other].map(|lane| Outline::new(lane, tolerance));
        let lengths = ego.lane.size.length + other.lane.size.length;
        let mut parts: Vec<Part> = Vec::new();
        if !ego.ever_along(&other) {
            return Vec::new();
        }
        let mut free = f64::NEG_INFINITY;
        for (station, &s) in ego.stations.iter().enumerate() {
            if s < free {
                continue;
            }
            let away = other.distance(ego.lane.line.place(s)) - ego.radius() - other.radius();
            if away > 0.0 {
                free = s + away;
                continue;
            }
            let places: Vec<Place> = ego.places(s).collect();
            for touch in other.touches(&places, ego.size) {
                add(&mut parts, station, s, touch);
            }
        }
        let lanes = parts.into_iter().filter(|part| part.is_lane(lengths));
        lanes.map(Part::shared).collect()
    }

    /// How another at `t` is to an ego at `s` (m), which counts as in the stretch from `early` (m) before it on; none if
    /// the ego is not in it.
    #[must_use]
    pub fn relation(&self, s: f64, t: f64, early: f64) -> Option<Relation> {
        let (first, last) = (self.rows.first()?, self.rows.last()?);
        if s < first.s - early || s > last.s + STEP {
            return None;
        }
        let at = self.rows.partition_point(|row| row.s <= s).max(1) - 1;
        let row = self.rows[at];
        let next = self.rows.get(at + 1).copied().unwrap_or(row);
        let share = ((s - row.s) / (next.s - row.s).max(1e-9)).clamp(0.0, 1.0);
        let [from, to] = [0, 1].map(|i| row.touch[i] + share * (next.touch[i] - row.touch[i]));
        Some(Relation {
            behind: t <= 0.5 * (from + to),
            gap: s - t - row.lead,
            front: t - to,
        })
    }

    /// Arc lengths of the ego from which on, and up to which, it is in the stretch.
    #[must_use]
    pub fn span(&self) -> [f64; 2] {
        let s = |row: Option<&Row>| row.map_or(0.0, |row| row.s);
        [s(self.rows.first()), s(self.rows.last())]
    }
}

/// Where two touch, while one is at one station and the other moves on.
#[derive(Clone, Copy, Debug)]
struct Touch {
    /// Arc lengths of the other: first and last.
    at: [f64; 2],
    /// In some of it they point the same way.
    same_way: Option<[f64; 2]>,
}

impl Touch {
    /// It goes on up to `t`, where they point the same way or not.
    fn extend(&mut self, t: f64, same_way: bool) {
        self.at[1] = t;
        if same_way {
            self.same_way = hulls(self.same_way, Some([t; 2]));
        }
    }
}

fn hull([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a.min(c), b.max(d)]
}

fn hulls(a: Option<[f64; 2]>, b: Option<[f64; 2]>) -> Option<[f64; 2]> {
    a.zip(b).map(|(a, b)| hull(a, b)).or(a).or(b)
}

/// A connected part of the pairs of arc lengths at which two touch.
#[derive(Clone, Debug)]
struct Part {
    rows: Vec<Row>,
    /// The station of the last row.
    station: usize,
    /// What is touched at the station before that.
    before: Option<[f64; 2]>,
    /// Arc lengths of the ego and of the other at which they point the same way in it.
    same_way: [Option<[f64; 2]>; 2],
}

/// Adds what is touched at a station to the parts that it hangs together with, or as a new one.
fn add(parts: &mut Vec<Part>, station: usize, s: f64, touch: Touch) {
    let touches = |part: &Part| part.touches(station, s, touch.at);
    let mut whole = Part {
        rows: vec![Row {
            s,
            touch: touch.at,
            lead: 0.0,
        }],
        station,
        before: None,
        same_way: [touch.same_way.map(|_| [s; 2]), touch.same_way],
    };
    while let Some(found) = parts.iter().position(touches) {
        whole.absorb(parts.swap_remove(found));
    }
    parts.push(whole);
}

impl Part {
    /// Whether it hangs together with what is touched at a station, `s` (m), the last one or a later one.
    fn touches(&self, station: usize, s: f64, [from, to]: [f64; 2]) -> bool {
        let near = |[first, last]: [f64; 2]| from <= last + APART && first <= to + APART;
        let recent = self.rows[self.rows.len() - 1].s >= s - APART;
        recent && (near(self.last()) || (self.station == station && self.before.is_some_and(near)))
    }

    fn last(&self) -> [f64; 2] {
        self.rows[self.rows.len() - 1].touch
    }

    fn absorb(&mut self, other: Self) {
        let before = if other.station == self.station {
            other.before
        } else {
            Some(other.last())
        };
        self.before = hulls(self.before, before);
        for (mine, its) in self.same_way.iter_mut().zip(other.same_way) {
            *mine = hulls(*mine, its);
        }
        self.rows.extend(other.rows);
        self.rows.sort_by(|a, b| a.s.total_cmp(&b.s));
        self.rows.dedup_by(|later, row| {
            let same = later.s <= row.s;
            if same {
                row.touch = hull(row.touch, later.touch);
            }
            same
        });
    }

    fn is_lane(&self, lengths: f64) -> bool {
        let leads = |end: usize| self.rows.iter().map(move |row| row.s - row.touch[end]);
        let most = leads(0).fold(f64::NEG_INFINITY, f64::max);
        let least = leads(1).fold(f64::INFINITY, f64::min);
        let mut same_way = self.same_way.iter().flatten();
        same_way.any(|[from, to]| to - from >= LANE) && most - least <= WIDEST * lengths
    }

    fn shared(mut self) -> Shared {
        let mut lead = f64::NEG_INFINITY;
        for row in self.rows.iter_mut().rev() {
            lead = lead.max(row.s - row.touch[0]);
            row.lead = lead;
        }
        Shared { rows: self.rows }
    }
}

/// A lane, and every way in which its vehicles may turn.
struct Outline<'a> {
    lane: &'a Lane,
    size: Size,
    turns: Vec<Sway>,
    /// It has sharp kinks.
    sharp: bool,
    /// Nobody turns farther than this (m) from a kink.
    turning: f64,
    stations: Vec<f64>,
}

impl<'a> Outline<'a> {
    fn new(lane: &'a Lane, tolerance: f64) -> Self {
        let wider = 2.0 * (tolerance + ROUNDING);
        let sharp = lane.line.sharpest() > SHARP;
        let turns = Sway::turns(lane.size, sharp);
        Self {
            size: Size {
                length: lane.size.length + wider,
                width: lane.size.width + wider,
            },
            stations: stations(lane, if sharp { &turns } else { &[] }),
            sharp,
            turning: turns.iter().map(Sway::reach).fold(0.0, f64::max),
            lane,
            turns,
        }
    }

    fn radius(&self) -> f64 {
        self.size.radius()
    }

    fn distance(&self, place: Place) -> f64 {
        let line = &self.lane.line;
        norm(minus(line.place(line.project(place.at)).at, place.at))
    }

    /// Where a vehicle may be at `s` (m), for every heading.
    fn places(&self, s: f64) -> impl Iterator<Item = Place> {
        let straight = self.lane.line.from_kink(s) >= self.turning;
        let turns = if straight {
            &self.turns[..1]
        } else {
            &self.turns
        };
        turns.iter().map(move |turn| turn.place(&self.lane.line, s))
    }

    /// Whether a vehicle on a lane points the same way as one on another anywhere, as far as this can be told from their
    /// segments.
    fn ever_along(&self, other: &Self) -> bool {
        let [mine, its] = [self, other].map(|outline| outline.lane.line.directions());
        mine.iter()
            .any(|&a| its.iter().any(|&b| dot(a, b) >= (SAME_WAY + SHARP).cos()))
    }

    /// Where a vehicle on this lane touches one of this `size` that is at one of `places`.
    fn touches(&self, places: &[Place], size: Size) -> Vec<Touch> {
        let reach = self.radius() + size.radius();
        let mut found: Vec<Touch> = Vec::new();
        let mut open = false;
        let (mut t, mut before) = (0.0, 0.0);
        while t <= self.lane.line.length() {
            let away = norm(minus(self.lane.line.place(t).at, places[0].at)) - reach;
            let (gap, same_way) = if away > 0.0 {
                (away, false)
            } else {
                self.gap(places, size, t)
            };
            if open != (gap < 0.0) {
                let edge = self.edge(places, size, before, t);
                if open && let Some(last) = found.last_mut() {
                    last.extend(edge, last.same_way.is_some_and(|[_, to]| to == last.at[1]));
                } else {
                    let same_way = same_way.then_some([edge; 2]);
                    found.push(Touch {
                        at: [edge; 2],
                        same_way,
                    });
                }
                open = !open;
            }
            if open && let Some(last) = found.last_mut() {
                last.extend(t, same_way);
            }
            before = t;
            t += if away > 0.0 {
                away.max(SHORTEST)
            } else {
                self.step(t, gap)
            };
        }
        found
    }

    /// How far (m) from `t` on nothing is missed, if the gap there is this.
    fn step(&self, t: f64, gap: f64) -> f64 {
        let turns = self.sharp && self.lane.line.from_kink(t) < self.turning + 2.0 * SHORTEST;
        if turns {
            SHORTEST
        } else {
            (0.6 * gap.abs()).clamp(SHORTEST, STEP)
        }
    }

    /// Where between `from` and `to`, of which one touches and the other does not, a touch begins or ends.
    fn edge(&self, places: &[Place], size: Size, mut from: f64, mut to: f64) -> f64 {
        let begins = self.gap(places, size, from).0 < 0.0;
        while to - from > 1e-3 {
            let middle = 0.5 * (from + to);
            if (self.gap(places, size, middle).0 < 0.0) == begins {
                from = middle;
            } else {
                to = middle;
            }
        }
        // The end that touches.
        if begins { from } else { to }
    }

    /// The gap between a vehicle at `t` and one at `places`, if it does not come towards it, negative if they touch; and
    /// whether they touch while both point the same way.
    fn gap(&self, places: &[Place], size: Size, t: f64) -> (f64, bool) {
        let (mut least, mut same_way) = (STEP, false);
        for mine in self.places(t) {
            for &place in places {
                let along = dot(mine.to, place.to);
                if along > OPPOSITE {
                    let gap = separation(mine, self.size, place, size);
                    least = least.min(gap);
                    same_way |= gap < 0.0 && along >= SAME_WAY.cos();
                }
            }
        }
        (least, same_way)
    }
}

/// Arc lengths at which a lane is looked at: evenly, and where a `turn` begins and ends.
fn stations(lane: &Lane, turns: &[Sway]) -> Vec<f64> {
    let count = (lane.line.length() / STEP).ceil();
    let mut stations: Vec<f64> = (0..=count as usize)
        .map(|i| i as f64 / count * lane.line.length())
        .collect();
    let arc = lane.line.arc();
    for &kink in &arc[1..arc.len() - 1] {
        for turn in turns {
            let reach = turn.reach();
            stations.extend([-1.0, 1.0].map(|side| kink + side * 0.999 * reach));
        }
        stations.push(kink);
    }
    stations.retain(|s| (0.0..=lane.line.length()).contains(s));
    stations.sort_by(f64::total_cmp);
    stations
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::site::Site;
    use crate::sketch::{Kind, Way};

    fn site(ways: &[&[[f32; 2]]]) -> Site {
        let size = Size {
            length: 5.0,
            width: 2.0,
        };
        let way = |points: &&[[f32; 2]]| Way::whole(points.to_vec(), Kind::Car, size, 0);
        let ways: Vec<Way> = ways.iter().map(way).collect();
        Site::new(&ways, 0.0, None).unwrap()
    }

    const EAST: &[[f32; 2]] = &[[-80.0, 0.0], [80.0, 0.0]];

    #[test]
    fn in_one_lane_the_gap_is_that_between_bumpers() {
        let site = site(&[EAST]);
        let [shared] = site.shared(0, 0) else {
            panic!("one stretch")
        };
        let behind = shared.relation(60.0, 40.0, 0.0).unwrap();
        assert!(behind.behind && (behind.gap - 15.0).abs() < 0.05);
        let front = shared.relation(60.0, 72.0, 0.0).unwrap();
        assert!(!front.behind && (front.front - 7.0).abs() < 0.05);
    }

    #[test]
    fn a_lane_around_a_corner_is_one_stretch() {
        let site = site(&[&[[-60.0, 0.0], [0.0, 0.0], [10.0, 12.0], [10.0, 60.0]]]);
        let [shared] = site.shared(0, 0) else {
            panic!("one stretch")
        };
        let [from, to] = shared.span();
        assert!(from == 0.0 && to > site.lanes[0].line.length() - 1.0);
    }

    #[test]
    fn ways_that_cross_or_meet_head_on_share_nothing() {
        let north = [[0.0, -80.0], [0.0, 80.0]];
        let west = [[80.0, 0.5], [-80.0, 0.5]];
        let site = site(&[EAST, &north, &west]);
        assert!(site.shared(0, 1).is_empty() && site.shared(1, 0).is_empty());
        assert!(site.shared(0, 2).is_empty());
    }

    #[test]
    fn a_ramp_shares_the_road_from_where_it_comes_near() {
        let ramp = [[-60.0, -40.0], [-6.0, -4.0], [4.0, 0.0], [80.0, 0.0]];
        let site = site(&[&ramp, EAST]);
        let [shared] = site.shared(0, 1) else {
            panic!("one stretch")
        };
        let [zone] = site.areas(0, 1) else {
            panic!("one zone")
        };
        let [from, _] = shared.span();
        // The controller's zone begins no later, and not much sooner.
        assert!(zone.ego[0] <= from + 1e-3 && from < zone.ego[0] + 1.0);
        let relation = shared.relation(from, from - 40.0, 0.0).unwrap();
        assert!(relation.behind && relation.gap >= 40.0 - zone.lead[1]);
        assert!(shared.relation(from - 1.0, 40.0, 0.5).is_none());
    }
}
