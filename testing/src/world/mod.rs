//! The world of a closed loop, in double precision, with kinematics of its own.

pub(crate) mod boxes;
mod commanded;
pub(crate) mod follower;
pub(crate) mod line;
pub(crate) mod motion;
mod other;

use crate::case::Case;
use crate::place::{Road, TestJunction};
use crate::vehicle::Truth;
use boxes::Rectangle;
use cede_controller::geometry::unit;
use cede_controller::{
    Contract, Footprint, Instant, Observation, Point, Pose, Track, Vehicle, Zone,
};
use commanded::Commanded;
use line::Line;
use motion::State;
use other::Driven;

/// Looks at the motion between two calls, at least.
const PIECES: u32 = 5;
/// Longest time (s) between two looks.
const LONGEST: f64 = 0.02;
/// Longest time (s) of a run.
const DURATION: f64 = 25.0;
/// The first call, in µs.
const BEGINNING: u64 = 5_000_000;
/// Overlaps by less than this (m) are rounding.
const TOUCH: f64 = 1e-3;

/// What is sensed at one call.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Seen {
    pub(crate) now: Instant,
    pub(crate) ego: Vehicle,
    pub(crate) tracks: Vec<Track>,
}

impl Seen {
    pub(crate) fn observation(&self) -> Observation<'_> {
        Observation {
            ego: self.ego,
            tracks: &self.tracks,
        }
    }
}

/// Two vehicles overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Overlap {
    /// Track number of the other.
    pub(crate) other: u16,
    /// Seconds since the first call.
    pub(crate) time: f64,
    /// The ego's speed and the other's, in m/s.
    pub(crate) speeds: [f64; 2],
}

/// The ego and everybody else.
pub(crate) struct World<'j> {
    pub(crate) case: &'j Case,
    pub(crate) contract: Contract,
    pub(crate) truth: Truth,
    pub(crate) junction: &'j TestJunction,
    own: Footprint,
    lines: Vec<Line>,
    pub(crate) ego: Commanded,
    pub(crate) others: Vec<Driven<'j>>,
    /// Seconds since the first call on the grid.
    time: f64,
    pub(crate) step: u32,
    pub(crate) overlap: Option<Overlap>,
    /// Longest time (s) of the run.
    pub(crate) duration: f64,
}

impl<'j> World<'j> {
    /// The world at the start of `case`.
    ///
    /// # Errors
    /// Why it is no start within the contract.
    pub(crate) fn new(
        (case, junction): (&'j Case, &'j TestJunction),
        own: Footprint,
        (contract, truth): (&Contract, &Truth),
    ) -> Result<Self, String> {
        let lines = Road::ALL.map(|road| junction.polyline(road.path()).map(Line::new));
        let lines: Vec<Line> = lines.into_iter().flatten().collect();
        let line = junction
            .path(Road::Own.path())
            .map_or(0.0, |path| f64::from(path.line()));
        let s = line - f64::from(case.before) / 10.0;
        let ego = Commanded::new(State {
            s,
            v: f64::from(case.speed) / 10.0,
        });
        let others = case.others.iter().enumerate();
        let others =
            others.map(|(i, other)| Driven::new(i, other, ego.state, (contract, junction)));
        let world = Self {
            case,
            contract: *contract,
            truth: *truth,
            junction,
            own,
            lines,
            others: others.collect::<Result<_, _>>()?,
            ego,
            time: 0.0,
            step: 0,
            overlap: None,
            duration: DURATION,
        };
        world.check_start()?;
        Ok(world)
    }

    /// Everybody is on the road and apart, and whoever is behind the ego in its lane has the gap that it needs.
    fn check_start(&self) -> Result<(), String> {
        if !(self.ego.state.s > 1.0 && self.ego.state.s < self.lines[0].length()) {
            return Err("the ego would start off its road".to_owned());
        }
        for other in &self.others {
            let length = self.lines[other.road as usize].length();
            if !(other.state.s > 1.0 && other.state.s < length - 1.0) {
                return Err("another would start off its road".to_owned());
            }
            if self.overlaps(other) > 0.0 {
                return Err("two would overlap at the start".to_owned());
            }
            let (ego, state) = (self.ego.state, other.state);
            let needs = follower::safe_gap(&self.contract, ego.v, state.v);
            let short = |zone: &Zone| {
                follower::is_ahead(zone, ego.s, state.s)
                    && follower::gap(zone, ego.s, state.s) < needs + 0.05 * state.v
            };
            if self.zones(other.road).any(short) {
                return Err("another would start too near behind the ego".to_owned());
            }
        }
        Ok(())
    }

    fn zones(&self, road: Road) -> impl Iterator<Item = &'j Zone> + use<'j> {
        let conflict = self.junction.conflict(Road::Own.path(), road.path());
        conflict.into_iter().flat_map(|conflict| conflict.zones())
    }

    /// What is sensed now; nothing, if the run is over.
    pub(crate) fn look(&mut self) -> Option<Seen> {
        if self.overlap.is_some() || self.time > self.duration || self.is_over() {
            return None;
        }
        let now = self.now();
        self.others.retain(|other| !other.gone);
        let noise = &self.case.noise;
        let mut ego = self.sensed(Road::Own, self.ego.state, 0);
        if self.step > 0 && noise.misses(noise.missing / 2, self.step, 90) {
            ego.s = f32::NAN;
        }
        let seen = self.others.iter().filter(|other| {
            let channel = 91 + u32::from(other.number);
            self.step == 0 || !noise.misses(noise.missing, self.step, channel)
        });
        let tracks = seen.map(|other| self.track(other)).collect();
        Some(Seen { now, ego, tracks })
    }

    fn track(&self, other: &Driven<'_>) -> Track {
        let sensed = self.sensed(other.road, other.state, other.number);
        Track::on(other.number, other.road.path(), sensed).class(other.road.class())
    }

    /// The time of this call.
    fn now(&self) -> Instant {
        let (noise, grid) = (&self.case.noise, self.grid());
        // Each call is the beginning of a grid for those after it: from one to another it is twice this.
        let off = 0.5 * self.truth.jitter * noise.share(noise.jitter, self.step, 99);
        let off = if self.step == 0 { 0.0 } else { off };
        Instant::from_micros(grid.saturating_add_signed((off * 1e6) as i64))
    }

    /// The moment of this call on the grid of periods, in µs.
    fn grid(&self) -> u64 {
        let period = (f64::from(self.contract.period()) * 1e6).round() as u64;
        BEGINNING + u64::from(self.step) * period
    }

    /// `state` as it is sensed on `road`, with the noise of `channel`.
    fn sensed(&self, road: Road, state: State, channel: u16) -> Vehicle {
        let noise = &self.case.noise;
        let error = |kind: u32| noise.share(noise.errors, self.step, u32::from(channel) * 4 + kind);
        let place = self.lines[road as usize].place(state.s, self.beside(channel));
        let ([x, y], [cos, sin]) = (place.at, place.towards);
        let speed = state.v + self.truth.speed_error * error(1);
        Vehicle {
            s: (state.s + self.truth.position_error * error(0)) as f32,
            speed: speed.max(-f64::from(Vehicle::REVERSING)) as f32,
            pose: Pose {
                position: Point::new(x as f32, y as f32),
                direction: unit(cos as f32, sin as f32),
            },
        }
    }

    /// How far (m) vehicle number `channel` is beside its road.
    fn beside(&self, channel: u16) -> f64 {
        let noise = &self.case.noise;
        f64::from(self.junction.tolerance())
            * noise.share(noise.beside, 0, 1000 + u32::from(channel))
    }

    /// Everybody moves on until the next call, after `command` (m/s²) was given.
    pub(crate) fn go(&mut self, command: f32) {
        let (from, step) = (self.now(), self.step);
        let noise = self.case.noise;
        let delay = |channel| noise.share(noise.delay, step, channel).abs();
        self.ego.command(command, self.truth.latency * delay(98));
        for i in 0..self.others.len() {
            let view = self.view_of(i, from);
            let late = delay(200 + u32::from(self.others[i].number));
            self.others[i].decide(&self.contract, view, (step, late));
        }
        self.step += 1;
        let time = (self.now().micros() - from.micros()) as f64 * 1e-6;
        let pieces = PIECES.max((time / LONGEST).ceil() as u32);
        for _ in 0..pieces {
            self.advance(time / f64::from(pieces));
        }
    }

    /// What another sees that drives with a shield of its own.
    fn view_of(&self, i: usize, now: Instant) -> Option<Seen> {
        let me = self.others.get(i).filter(|other| other.is_shielded())?;
        let ego = self.sensed(Road::Own, self.ego.state, 500);
        let mut tracks = vec![Track::on(1000, Road::Own.path(), ego)];
        tracks.extend(
            self.others
                .iter()
                .filter(|other| other.number != me.number)
                .map(|other| self.track(other)),
        );
        Some(Seen {
            now,
            ego: self.sensed(me.road, me.state, me.number + 300),
            tracks,
        })
    }

    fn advance(&mut self, time: f64) {
        self.time += time;
        let before = self.ego.state;
        self.ego.advance(&self.truth, time);
        for i in 0..self.others.len() {
            let lanes = self.zones(self.others[i].road);
            self.others[i].advance(&self.contract, lanes, before, time);
            let other = &self.others[i];
            let overlaps = self.overlaps(other);
            if overlaps > TOUCH && self.overlap.is_none() {
                self.overlap = Some(Overlap {
                    other: other.number,
                    time: self.time,
                    speeds: [self.ego.state.v, other.state.v],
                });
            }
            let zones = self.zones(self.others[i].road);
            let length = self.lines[self.others[i].road as usize].length();
            self.others[i].leave(zones, length);
        }
    }

    fn overlaps(&self, other: &Driven<'_>) -> f64 {
        let body = |road: Road, state: State, channel| {
            let place = self.lines[road as usize].place(state.s, self.beside(channel));
            Rectangle::new(place, road.footprint(self.own))
        };
        let ego = body(Road::Own, self.ego.state, 0);
        ego.overlap(&body(other.road, other.state, other.number))
    }

    /// Whether the ego is at the end of its road, or another at the end of its own that is still in its zone.
    fn is_over(&self) -> bool {
        let near = |road: Road, s: f64| s > self.lines[road as usize].length() - 5.0;
        near(Road::Own, self.ego.state.s)
            || self
                .others
                .iter()
                .any(|other| !other.gone && near(other.road, other.state.s))
    }

    /// Whether the ego has passed every zone that ends.
    pub(crate) fn is_through(&self) -> bool {
        let s = self.ego.state.s;
        let mut zones = Road::ALL.into_iter().flat_map(|road| self.zones(road));
        zones.all(|zone| {
            s >= f64::from(zone.ego.to) || (zone.is_lane() && s >= f64::from(zone.ego.from) + 1.0)
        })
    }

    /// Seconds since the first call.
    pub(crate) fn time(&self) -> f64 {
        self.time
    }
}
