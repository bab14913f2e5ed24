//! Who drives: Cede, or a plain profile, behind the shield.

use super::Settings;
use super::car::Car;
use super::obstacle::Obstacle;
use crate::driver::idm::follow;
use crate::meeting::{instant, path, sensed};
use cede_controller::kinematics::State;
use cede_controller::{
    Approach, Class, ConflictKind, Decision, Drive, Instant, Junction, JunctionBuilder,
    Observation, Part, PathId, RouteConflict, Shield, Track,
};
use cede_data::{Participant, Traffic};

/// What drives a vehicle in traffic; behind all of them is the shield.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The policy, where it has to be asked; a car-following model elsewhere.
    Cede,
    /// The car-following model alone: what a policy has to beat.
    Profile,
}

/// Speed (m/s) that is wanted where the map has no limit: 50 km/h.
const WANTED: f32 = 13.9;
/// Lateral acceleration (m/s²) in bends.
const LATERAL: f32 = 2.6;
/// Paths and points of the junction of a vehicle.
const PATHS: usize = 256;
const POINTS: usize = 16_384;
type Builder = JunctionBuilder<PATHS, POINTS, 1>;
/// Metres from a route at which another is too far off to meet it.
const FAR_OFF: f32 = 30.0;
/// Metres for which a path goes on straight past the end of the record: who leaves on one road is seen to.
const BEYOND: f32 = 30.0;

/// The way of a vehicle, which is path 0, through those of all others whose ways are near, whenever they come: who is late
/// is late without limit.
pub(super) struct Crossing {
    junction: Junction<PATHS, POINTS, 1>,
    /// The vehicles of the other paths, in order.
    others: Vec<usize>,
    wanted: f32,
}

impl Crossing {
    /// The crossing of vehicle `ego` with those of the others that are `there`. `None` if they are too many for a junction: such
    /// a vehicle is not driven.
    pub(super) fn new(traffic: &Traffic, ego: usize, there: &[bool]) -> Option<Self> {
        let own = traffic.vehicles.get(ego)?;
        let wanted = own.entry.limit.unwrap_or(WANTED);
        let mut builder = Junction::builder();
        builder.tolerance(0.0).lateral(LATERAL);
        let way = join(&mut builder, ego, own)?;
        builder.speed_limit(way, 0.0, wanted).ok()?;
        let mut others = Vec::new();
        for (index, (other, &there)) in traffic.vehicles.iter().zip(there).enumerate() {
            if index == ego || !there || !near(own, other) {
                continue;
            }
            let path = join(&mut builder, index, other)?;
            match traffic.goes_first(ego, index) {
                Some(true) => builder.right_of_way(way, path).ok()?,
                Some(false) => builder.right_of_way(path, way).ok()?,
                None => {}
            }
            others.push(index);
        }
        Some(Self {
            junction: builder.build().ok()?,
            others,
            wanted,
        })
    }

    /// Whether at `s` (m) it is where its way meets that of one of `tracks`, other than behind or ahead of him on one road.
    fn is_inside(&self, s: f32, tracks: &[Track]) -> bool {
        let conflicts = tracks.iter().filter_map(|track| {
            let conflict = self
                .junction
                .conflict(path(0), PathId::new(track.number as u8));
            conflict.filter(|conflict| conflict.kind != ConflictKind::Following)
        });
        conflicts
            .flat_map(RouteConflict::zones)
            .any(|zone| zone.ego.from < s && s < zone.ego.to)
    }
}

/// Whether the way of `vehicle` is a path of a junction. One that comes back to itself is none, nor one with a sharp kink.
pub(super) fn is_path(vehicle: &Participant) -> bool {
    let mut builder = Box::new(Junction::builder());
    join(&mut builder, 0, vehicle).is_some() && builder.build_in_place().is_ok()
}

/// The way of `vehicle`, which is number `index` of all, becomes a path.
fn join(builder: &mut Builder, index: usize, vehicle: &Participant) -> Option<PathId> {
    let route = vehicle.route.extended(0.0, BEYOND).ok()?;
    let path = builder.path(&route, Class::Car, vehicle.footprint).ok()?;
    builder.control(path, vehicle.entry.control).ok()?;
    builder.order(path, index as u16).ok()?;
    // It waits with its front at its line, if the map has one on its way.
    let front = 0.5 * vehicle.footprint.length;
    if let Some(line) = vehicle.entry.line.filter(|&line| line > front) {
        builder.line(path, line - front).ok()?;
    }
    Some(path)
}

/// Whether the ways of two are so close that they may meet.
fn near(own: &Participant, other: &Participant) -> bool {
    let bounds = |vehicle: &Participant| {
        let points = vehicle.route.points().iter();
        points.fold(
            [
                f32::INFINITY,
                f32::INFINITY,
                f32::NEG_INFINITY,
                f32::NEG_INFINITY,
            ],
            |b, p| [b[0].min(p.x), b[1].min(p.y), b[2].max(p.x), b[3].max(p.y)],
        )
    };
    let (a, b) = (bounds(own), bounds(other));
    a[0] <= b[2] + FAR_OFF
        && b[0] <= a[2] + FAR_OFF
        && a[1] <= b[3] + FAR_OFF
        && b[1] <= a[3] + FAR_OFF
}

/// A driver at its place.
pub(super) struct Seat<'t> {
    crossing: &'t Crossing,
    driver: Option<Driver<'t>>,
    /// The shield was ready once.
    ready: bool,
    /// Who was there in the last step.
    seen: Vec<bool>,
}

#[derive(Clone)]
enum Driver<'t> {
    Cede(Box<Approach<'t, 't>>),
    Profile(Box<Shield<'t>>),
}

impl Driver<'_> {
    fn ready(&mut self, now: Instant, observation: &Observation<'_>) -> bool {
        match self {
            Self::Cede(approach) => approach.ready(now, observation).is_ok(),
            Self::Profile(shield) => shield.ready(now, observation).is_ok(),
        }
    }

    /// The decision of one that is to accelerate at `most` (m/s²) at most.
    fn decide(&mut self, now: Instant, observation: &Observation<'_>, most: f32) -> Decision {
        match self {
            Self::Cede(approach) => approach.decide_up_to(now, observation, most),
            Self::Profile(shield) => {
                let (ego, response) = (observation.ego, shield.contract().response());
                let profile = shield.way().profile();
                let allowed = profile.acceleration(ego.s, ego.speed, response);
                shield.filter(now, observation, most.min(allowed))
            }
        }
    }

    fn forget(&mut self, number: u16) {
        match self {
            Self::Cede(approach) => approach.forget(number),
            Self::Profile(shield) => shield.forget(number),
        }
    }
}

impl<'t> Seat<'t> {
    pub(super) fn new(crossing: &'t Crossing, settings: &Settings<'t>) -> Self {
        let (junction, ego) = (&crossing.junction, path(0));
        let driver = match settings.kind {
            Kind::Cede => Drive::new(settings.policy, settings.contract, Part::Left)
                .enter(junction, ego)
                .map(|approach| Driver::Cede(Box::new(approach))),
            Kind::Profile => Shield::enter(settings.contract, junction, ego)
                .map(|shield| Driver::Profile(Box::new(shield))),
        };
        Self {
            crossing,
            driver: driver.ok(),
            ready: false,
            seen: vec![false; crossing.others.len()],
        }
    }

    /// The acceleration (m/s²) of car `ego` at `step`; `None` as long as the shield is not ready.
    pub(super) fn decide(
        &mut self,
        cars: &[Car<'_>],
        ego: usize,
        step: u32,
        leader: Option<Obstacle>,
    ) -> Option<Decision> {
        let (own, now) = (&cars[ego], instant(step));
        let tracks = self.tracks(cars);
        self.forget_all_but(&tracks);
        let observation = Observation {
            ego: sensed(&own.vehicle.route, own.state()),
            tracks: &tracks,
        };
        let (speed, wanted) = (own.state().v, self.crossing.wanted);
        let (gap, leads) = leader.map_or((f32::INFINITY, 0.0), |it| (it.gap, it.speed));
        let driver = self.driver.as_mut()?;
        if !self.ready {
            // Who comes to a place where two ways meet finds there who has come before; nobody is handed over inside.
            self.ready =
                !self.crossing.is_inside(own.state().s, &tracks) && driver.ready(now, &observation);
        }
        (self.ready).then(|| driver.decide(now, &observation, follow(speed, wanted, gap, leads)))
    }

    /// Whether the plan of car `ego`, if there is one, is still safe when car `newcomer` appears (U3): in a recording vehicles
    /// appear nearer than they would come into sight.
    pub(super) fn bears(&self, cars: &[Car<'_>], [ego, newcomer]: [usize; 2], step: u32) -> bool {
        let Some(driver) = self.driver.as_ref().filter(|_| self.ready) else {
            return true;
        };
        let mut paths = self.crossing.others.iter().zip(1..);
        let Some((_, number)) = paths.find(|&(&index, _)| index == newcomer) else {
            return true;
        };
        let has_plan = |tracks: &[Track]| {
            let observation = Observation {
                ego: sensed(&cars[ego].vehicle.route, cars[ego].state()),
                tracks,
            };
            let decision = driver.clone().decide(instant(step), &observation, 0.0);
            decision.plan.is_some()
        };
        let mut tracks = self.tracks(cars);
        let had = has_plan(&tracks);
        tracks.extend(
            cars[newcomer]
                .first()
                .map(|first| track(&cars[newcomer], number, first)),
        );
        !had || has_plan(&tracks)
    }

    /// Everybody who is there, by the number of its path.
    fn tracks(&self, cars: &[Car<'_>]) -> Vec<Track> {
        let others = self.crossing.others.iter().map(|&index| &cars[index]);
        let there = others.zip(1..).filter(|(car, _)| car.is_there());
        there
            .map(|(car, number)| track(car, number, car.state()))
            .collect()
    }

    /// Who has left is forgotten.
    fn forget_all_but(&mut self, tracks: &[Track]) {
        for (seen, number) in self.seen.iter_mut().zip(1..) {
            let is = tracks.iter().any(|track| track.number == number);
            if *seen
                && !is
                && let Some(driver) = &mut self.driver
            {
                driver.forget(number);
            }
            *seen = is;
        }
    }
}

/// `car` as others see it, at this place.
fn track(car: &Car<'_>, number: u16, state: State) -> Track {
    let vehicle = sensed(&car.vehicle.route, state);
    Track::on(number, PathId::new(number as u8), vehicle)
}
