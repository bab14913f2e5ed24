//! Traffic across a layout: people arrive, queue, go and leave.

use super::human::{Character, Human, Leader, Right, Rival, Situation};
use super::layout::{Layout, Movement};
use super::zone::RouteRelation;
use crate::{RawState, STEP_MS, Track};
use cede_controller::geometry::length;
use cede_controller::kinematics::{STEP, State, advance};
use cede_controller::{Footprint, Point, Vector};
use rand::{RngExt, SeedableRng};
use rand_distr::{Exp1, StandardNormal};
use rand_pcg::Pcg64;

/// So many vehicles are in the scene at once at most; others wait outside.
const CAPACITY: usize = 20;
/// Within this distance (m) of its line, and slower than [`ARRIVED_SPEED`], a vehicle has arrived.
const ARRIVED_DISTANCE: f32 = 3.0;
const ARRIVED_SPEED: f32 = 3.0;
/// Of two of whom neither gives way the nearer is ahead from this distance (m) to their zone on.
const NEARER: f32 = 15.0;
/// Two who arrive within this time (s) came together.
const TOGETHER: f32 = 0.5;

struct Vehicle {
    id: u32,
    movement: usize,
    footprint: Footprint,
    human: Human,
    state: State,
    /// Distance (m) to the left of the route at its start, in the middle and at its end.
    aside: [f32; 3],
    /// Step at which it came to the line.
    arrived: Option<u32>,
    /// Step at which it entered the intersection.
    entered: Option<u32>,
    first_ms: u64,
    states: Vec<RawState>,
}

/// A running scene.
pub(super) struct Traffic<'a> {
    layout: &'a Layout,
    rng: Pcg64,
    step: u32,
    vehicles: Vec<Vehicle>,
    /// Mean time (s) between two arrivals on each arm, and when the next one is due.
    arrivals: Vec<(f32, f32)>,
    next_id: u32,
    left: Vec<Track>,
}

impl<'a> Traffic<'a> {
    /// An empty scene with `flow` vehicles a second wanting to cross.
    pub(super) fn new(layout: &'a Layout, flow: f32, mut rng: Pcg64) -> Self {
        let total: f32 = layout.arms.iter().map(|arm| arm.demand).sum();
        let arrivals = layout.arms.iter().map(|arm| {
            let mean = total / (flow * arm.demand);
            (mean, mean * rng.sample::<f32, _>(Exp1))
        });
        Self {
            arrivals: arrivals.collect(),
            layout,
            rng,
            step: 0,
            vehicles: Vec::new(),
            next_id: 1,
            left: Vec::new(),
        }
    }

    /// Lets `warm_up` steps pass unseen, then records `steps` steps.
    pub(super) fn record(mut self, warm_up: u32, steps: u32) -> Vec<Track> {
        for step in 0..warm_up + steps {
            self.step = step;
            self.admit();
            self.take_note();
            if step >= warm_up {
                // The recordings count frames from 1.
                let time = u64::from(step - warm_up + 1) * STEP_MS;
                let layout = self.layout;
                self.vehicles
                    .iter_mut()
                    .for_each(|v| v.film(&layout.movements[v.movement], time));
            }
            self.drive();
        }
        let mut tracks = self.left;
        tracks.extend(self.vehicles.into_iter().filter_map(Vehicle::into_track));
        tracks.sort_by_key(|track| track.id);
        tracks
    }

    fn admit(&mut self) {
        let now = self.step as f32 * STEP;
        for arm in 0..self.arrivals.len() {
            let (mean, due) = self.arrivals[arm];
            if now < due || self.vehicles.len() >= CAPACITY {
                continue;
            }
            if self.enter(arm) {
                // A demand that waited outside is not forgotten, but does not pile up either.
                let next = due.max(now - mean) + mean * self.rng.sample::<f32, _>(Exp1);
                self.arrivals[arm].1 = next.max(now + 0.5);
            }
        }
    }

    /// A new vehicle at the edge of `arm`, if there is room.
    fn enter(&mut self, arm: usize) -> bool {
        let layout = self.layout;
        let movement = self.choose(arm);
        let lane = |movement: usize| {
            let movement = &layout.movements[movement];
            (movement.from, movement.lanes[0])
        };
        let last = self
            .vehicles
            .iter()
            .filter(|v| lane(v.movement) == lane(movement))
            .min_by(|a, b| a.state.s.total_cmp(&b.state.s));
        let room = last.map_or(f32::INFINITY, |last| {
            last.state.s - 0.5 * (last.footprint.length + 5.0)
        });
        if room < 4.0 {
            return false;
        }
        let ahead = last.map_or(0.0, |last| last.state.v);
        let character = Character::draw(&mut self.rng);
        let wanted = layout.movements[movement].profile.at(0.0).0 * character.pace;
        let spare = (room - character.standstill).max(0.0);
        let safe = libm::sqrtf(ahead * ahead + 2.0 * spare);
        let mut vary = |mean: f32, spread: f32| {
            let normal: f32 = self.rng.sample(StandardNormal);
            mean + spread * normal.clamp(-2.5, 2.5)
        };
        let vehicle = Vehicle {
            id: self.next_id,
            movement,
            footprint: Footprint {
                length: vary(4.7, 0.35),
                width: vary(1.82, 0.12),
            },
            aside: [vary(0.0, 0.2), vary(0.0, 0.3), vary(0.0, 0.25)],
            human: Human::new(character, Pcg64::from_rng(&mut self.rng)),
            state: State {
                s: 0.0,
                v: wanted
                    .min(safe)
                    .min((0.3 + spare) / character.headway + ahead * 0.3),
            },
            arrived: None,
            entered: None,
            first_ms: 0,
            states: Vec::new(),
        };
        self.vehicles.push(vehicle);
        self.next_id += 1;
        true
    }

    fn choose(&mut self, arm: usize) -> usize {
        let ways = || {
            self.layout
                .movements
                .iter()
                .enumerate()
                .filter(|(_, m)| m.from == arm)
        };
        let total: f32 = ways().map(|(_, m)| m.demand).sum();
        let mut pick = self.rng.random::<f32>() * total;
        let mut chosen = 0;
        for (i, movement) in ways() {
            chosen = i;
            pick -= movement.demand;
            if pick < 0.0 {
                break;
            }
        }
        chosen
    }

    /// Who has come to the line, who has entered the intersection.
    fn take_note(&mut self) {
        for v in &mut self.vehicles {
            let to_line = v.to_line(&self.layout.movements[v.movement]);
            if to_line < ARRIVED_DISTANCE && v.state.v < ARRIVED_SPEED || to_line < 0.0 {
                v.arrived.get_or_insert(self.step);
            }
            if to_line < -0.5 && v.human.is_going() {
                v.entered.get_or_insert(self.step);
            }
        }
    }

    fn drive(&mut self) {
        let mut rivals = Vec::with_capacity(CAPACITY);
        let mut wishes = Vec::with_capacity(CAPACITY);
        for i in 0..self.vehicles.len() {
            rivals.clear();
            rivals.extend(self.others(i).filter_map(|j| self.rival(i, j)));
            let leader = self
                .others(i)
                .filter_map(|j| self.leader(i, j))
                .min_by(|a, b| a.gap.total_cmp(&b.gap));
            let v = &self.vehicles[i];
            let movement = &self.layout.movements[v.movement];
            let situation = Situation {
                speed: v.state.v,
                profile: movement.profile.at(v.state.s),
                crossing_speed: movement.crossing_speed,
                to_line: movement.waits - v.state.s - 0.5 * v.footprint.length,
                must_stop: self.layout.must_stop(movement),
                leader,
                rivals: &rivals,
            };
            wishes.push(self.vehicles[i].human.accelerate(&situation));
        }
        for (v, &a) in self.vehicles.iter_mut().zip(&wishes) {
            v.state = advance(v.state, a);
        }
        let layout = self.layout;
        let gone = |v: &mut Vehicle| v.state.s > layout.movements[v.movement].route.length();
        let gone = self.vehicles.extract_if(.., gone);
        self.left.extend(gone.filter_map(Vehicle::into_track));
    }

    fn others(&self, i: usize) -> impl Iterator<Item = usize> + use<> {
        (0..self.vehicles.len()).filter(move |&j| j != i)
    }

    /// Vehicle `j` as a vehicle ahead of `i` in one lane.
    fn leader(&self, i: usize, j: usize) -> Option<Leader> {
        let (own, other) = (&self.vehicles[i], &self.vehicles[j]);
        let half_lengths = 0.5 * (own.footprint.length + other.footprint.length);
        let ahead = match self.layout.relations[own.movement][other.movement] {
            RouteRelation::Parting(s) if other.state.s - 0.5 * other.footprint.length < s => {
                other.state.s - own.state.s
            }
            RouteRelation::Conflict(zone)
                if self.one_exit(i, j) && other.state.s > zone.other.0 + 2.0 =>
            {
                self.rest(i) - self.rest(j)
            }
            _ => return None,
        };
        // Two on one spot: who came first leads.
        let leads = ahead > 0.0 || (ahead == 0.0 && j < i);
        leads.then_some(Leader {
            gap: ahead - half_lengths,
            speed: other.state.v,
        })
    }

    fn one_exit(&self, i: usize, j: usize) -> bool {
        let [own, other] = [i, j].map(|k| &self.layout.movements[self.vehicles[k].movement]);
        own.one_exit(other)
    }

    /// Distance (m) to the end of the route.
    fn rest(&self, i: usize) -> f32 {
        let v = &self.vehicles[i];
        self.layout.movements[v.movement].route.length() - v.state.s
    }

    /// Vehicle `j` as somebody whose way `i` crosses.
    fn rival(&self, i: usize, j: usize) -> Option<Rival> {
        let (own, other) = (&self.vehicles[i], &self.vehicles[j]);
        let RouteRelation::Conflict(zone) = self.layout.relations[own.movement][other.movement]
        else {
            return None;
        };
        let (before, its_before) = (zone.own.0 - own.state.s, zone.other.0 - other.state.s);
        let rival = Rival {
            own: (before, zone.own.1 - own.state.s),
            other: (its_before, zone.other.1 - other.state.s),
            speed: other.state.v,
            ahead: self.is_ahead(i, j, before, its_before),
            right: self.right(own, other),
        };
        (rival.own.1 > 0.0 && rival.other.1 > 0.0).then_some(rival)
    }

    /// Whether vehicle `j` is ahead of `i`, if they have `before` and `its_before` (m) left to their shared zone:
    /// it is in the zone already, or has entered the intersection earlier. Of two of whom neither gives way to
    /// the other by the rules the nearer is ahead.
    fn is_ahead(&self, i: usize, j: usize, before: f32, its_before: f32) -> bool {
        let (own, other) = (&self.vehicles[i], &self.vehicles[j]);
        let inside = before > 0.0 && its_before < 0.0;
        let earlier = match (own.entered, other.entered) {
            (Some(mine), Some(theirs)) => (theirs, j) < (mine, i),
            (mine, theirs) => theirs.is_some() && mine.is_none(),
        };
        let nearer = its_before < NEARER && (its_before, j) < (before, i);
        inside || earlier || (nearer && own.entered.is_none() && self.is_open(own, other))
    }

    /// Whether neither has a sign, and no rule tells one to give way to the other.
    fn is_open(&self, own: &Vehicle, other: &Vehicle) -> bool {
        let layout = self.layout;
        let [mine, theirs] = [own, other].map(|v| &layout.movements[v.movement]);
        let unsigned = [mine, theirs].iter().all(|m| !layout.has_sign(m));
        let rules = [layout.rule(mine, theirs), layout.rule(theirs, mine)];
        unsigned && rules == [Right::Mine; 2]
    }

    /// Who of the two goes first.
    fn right(&self, own: &Vehicle, other: &Vehicle) -> Right {
        let layout = self.layout;
        let (mine, theirs) = (
            &layout.movements[own.movement],
            &layout.movements[other.movement],
        );
        let rule = layout.rule(mine, theirs);
        if layout.must_stop(mine) && layout.must_stop(theirs) {
            first_come(own.arrived, other.arrived, rule)
        } else {
            rule
        }
    }
}

/// Who came first goes first; if both came together, `rule` decides.
fn first_come(own: Option<u32>, other: Option<u32>, rule: Right) -> Right {
    let Some(other) = other else {
        return Right::Mine;
    };
    let Some(own) = own else {
        return Right::FirstCome(f32::INFINITY);
    };
    let lead = (f64::from(own) - f64::from(other)) as f32 * STEP;
    let tie = match rule {
        Right::Theirs => TOGETHER,
        _ => -TOGETHER,
    };
    Right::FirstCome(if lead.abs() < TOGETHER { tie } else { lead })
}

impl Vehicle {
    /// From the front bumper to the line, m.
    fn to_line(&self, movement: &Movement) -> f32 {
        movement.line - self.state.s - 0.5 * self.footprint.length
    }

    fn film(&mut self, movement: &Movement, time: u64) {
        if self.states.is_empty() {
            self.first_ms = time;
        }
        let s = self.state.s;
        let (behind, ahead) = (
            self.position(movement, s - 0.5),
            self.position(movement, s + 0.5),
        );
        let direction = (ahead - behind) * (1.0 / length(&(ahead - behind)));
        let position = self.position(movement, s);
        self.states.push(RawState {
            x: round(position.x),
            y: round(position.y),
            vx: round(self.state.v * direction.x),
            vy: round(self.state.v * direction.y),
            heading: round(libm::atan2f(direction.y, direction.x)),
        });
    }

    fn position(&self, movement: &Movement, s: f32) -> Point {
        let pose = movement.route.pose(s);
        let middle = movement.line + 8.0;
        let [start, centre, end] = self.aside;
        let aside = if s < middle {
            blend(start, centre, s / middle)
        } else {
            blend(
                centre,
                end,
                (s - middle) / (movement.route.length() - middle),
            )
        };
        pose.position + Vector::new(-pose.direction.y, pose.direction.x) * aside
    }

    fn into_track(self) -> Option<Track> {
        (!self.states.is_empty()).then_some(Track {
            id: self.id,
            first_ms: self.first_ms,
            length: round(self.footprint.length),
            width: round(self.footprint.width),
            states: self.states,
        })
    }
}

/// To three decimals, as the files have it.
fn round(x: f32) -> f64 {
    (f64::from(x) * 1000.0).round() / 1000.0
}

/// From `a` to `b` as `share` goes from 0 to 1, smoothly.
fn blend(a: f32, b: f32, share: f32) -> f32 {
    let x = share.clamp(0.0, 1.0);
    a + (b - a) * x * x * (3.0 - 2.0 * x)
}
