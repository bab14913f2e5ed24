//! One observation, as a vehicle's sensors make it of the world.

use crate::body::Body;
use crate::lane::Leg;
use crate::plane::{Place, dot, minus, norm};
use crate::rng::Rng;
use crate::setup::Setup;
use crate::sight::{Shown, Sight};
use crate::site::{Area, Site};
use cede_controller::geometry::unit;
use cede_controller::{MAX_CANDIDATES, PathId, Point, Pose, Track, Vehicle};

/// Two places that are so near (m) to each other are one, as a tracker sees it.
const SAME: f64 = 0.015;

/// What is handed to the shield.
#[derive(Clone, Debug)]
pub struct Look {
    /// The ego.
    pub ego: Vehicle,
    /// The others.
    pub tracks: Vec<Track>,
    /// Something in it is not a number.
    pub faulty: bool,
}

/// Bounds of the errors of place and speed.
#[derive(Clone, Copy, Debug)]
pub struct Bounds(pub [f64; 2]);

impl Look {
    /// What vehicle `me` sees in `junction` with its `sights`, for the `first` time or not; those that are hidden are not
    /// seen.
    pub fn new(
        setup: &Setup<'_>,
        bodies: &[Body],
        (me, junction, first): (usize, usize, bool),
        sights: &mut [Sight],
        rng: &mut Rng,
    ) -> Option<Self> {
        let contract = &setup.contract;
        let bounds = Bounds([contract.position_error(), contract.speed_error()].map(f64::from));
        let site = setup.site;
        let leg = bodies[me].leg(site, junction)?;
        let mut faulty = false;
        let mut state = |j: usize, leg: Leg, sights: &mut [Sight], rng: &mut Rng| {
            let shown = sights[j].shown(&setup.sensing, first, rng);
            let mut vehicle = vehicle(setup, &bodies[j], leg, &mut sights[j], bounds);
            if shown == Shown::Broken {
                vehicle.s = f32::NAN;
                faulty = true;
            }
            (shown, vehicle)
        };
        // The ego's own state may be broken, but it is there.
        let (_, ego) = state(me, leg, sights, rng);
        let mut tracks = Vec::with_capacity(bodies.len());
        for (j, body) in bodies.iter().enumerate() {
            let Some(leg) = body.leg(site, junction).filter(|_| j != me) else {
                continue;
            };
            if sights[j].hidden {
                continue;
            }
            let areas = site.areas(bodies[me].lane, body.lane);
            let (shown, vehicle) = state(j, leg, sights, rng);
            // One that is undecided may meet the ego on a path that is not its own.
            let bystander = areas.is_empty() && !setup.sensing.undecided;
            let blinks = setup.sensing.blinking && bystander && rng.chance(0.5);
            // Who may have left is as good as new: of one whose state is not a number, nothing is known then.
            let lost = shown == Shown::Broken && !matters(areas, [&bodies[me], body], bounds.0[0]);
            if shown == Shown::Missing || blinks || lost {
                continue;
            }
            let mut paths = vec![leg.path];
            if setup.sensing.undecided {
                paths.extend(alternatives(site, body, leg, vehicle.s, &mut sights[j]));
                rng.shuffle(&mut paths);
            }
            tracks.push(track(sights[j].number, body, site, &paths, vehicle));
        }
        rng.shuffle(&mut tracks);
        Some(Self {
            ego,
            tracks,
            faulty,
        })
    }
}

/// Whether an ego and another surely have a zone ahead, whatever the `error` (m) of their places.
fn matters(areas: &[Area], [ego, other]: [&Body; 2], error: f64) -> bool {
    areas.iter().any(|area| {
        ego.state.s + 4.0 * error < area.ego[1] && other.state.s + 4.0 * error < area.other[1]
    })
}

fn vehicle(setup: &Setup<'_>, body: &Body, leg: Leg, sight: &mut Sight, bounds: Bounds) -> Vehicle {
    let [place, speed] = sight.errors();
    let scale = setup.sensing.scale;
    let Place { at, to } = body.place(setup.site);
    Vehicle {
        s: (body.state.s - leg.offset + scale * place * bounds.0[0]) as f32,
        speed: (body.state.v + scale * speed * bounds.0[1]) as f32,
        pose: Pose {
            position: Point::new(at[0] as f32, at[1] as f32),
            direction: unit(to[0] as f32, to[1] as f32),
        },
    }
}

/// Other paths on which the vehicle may be as well, as far as its place has ever told; `s` is its arc length as it is
/// sensed.
fn alternatives(site: &Site, body: &Body, leg: Leg, s: f32, sight: &mut Sight) -> Vec<PathId> {
    let mine = &site.lanes[body.lane];
    let places = [body.state.s, f64::from(s) + leg.offset];
    let mut found = Vec::new();
    for lane in site
        .lanes
        .iter()
        .filter(|lane| lane.entry == mine.entry && lane.class == mine.class)
    {
        let there = lane
            .legs
            .iter()
            .find(|there| there.junction == leg.junction);
        let Some(there) = there.filter(|there| there.path != leg.path) else {
            continue;
        };
        let alike = |s: f64| {
            let (a, b) = (mine.line.place(s), lane.line.place(s));
            norm(minus(a.at, b.at)) < SAME && dot(a.to, b.to) > 0.99
        };
        let known = sight.excluded.contains(&there.path);
        // A track has room for so many, its own among them; whoever is left out once stays out.
        if !known && found.len() + 1 < MAX_CANDIDATES && places.into_iter().all(alike) {
            found.push(there.path);
        } else if !known {
            sight.excluded.push(there.path);
        }
    }
    found
}

fn track(number: u16, body: &Body, site: &Site, paths: &[PathId], vehicle: Vehicle) -> Track {
    let mut track = Track::on(number, paths[0], vehicle).class(site.lanes[body.lane].class);
    for &path in &paths[1..] {
        track = track.or(path, vehicle.s).unwrap_or(track);
    }
    track
}
