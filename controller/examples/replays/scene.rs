//! The junction, who drives there, and what the ego decides.

use cede_controller::kinematics::{State, advance};
use cede_controller::policy::embedded;
use cede_controller::{
    Cause, Class, Contract, Drive, Footprint, Instant, Junction, Observation, Part, PathId, Point,
    Policy, Pose, Route, Sight, Track, Vehicle,
};
use std::error::Error;

/// Points of a route, at most.
const POINTS: usize = 24;
/// Steps of 0.1 s.
const STEPS: u64 = 260;

pub(crate) type Place = Junction<3, { 3 * POINTS }>;

pub(crate) const CAR: Footprint = Footprint {
    length: 4.6,
    width: 1.9,
};
pub(crate) const LORRY: Footprint = Footprint {
    length: 10.0,
    width: 2.5,
};

/// Somebody on foot.
pub(crate) const WALKER: Footprint = Footprint {
    length: 0.6,
    width: 0.6,
};

const EGO: PathId = PathId::new(0);
const ONCOMING: PathId = PathId::new(1);
pub(crate) const CROSSING: PathId = PathId::new(2);

/// What happens beside the ego.
pub(crate) struct Scene {
    /// Of the file.
    pub(crate) name: &'static str,
    /// What it shows.
    pub(crate) title: &'static str,
    /// The ego's arc length (m) and speed (m/s) at first.
    start: State,
    /// The other's path, arc length and speed at first.
    other: Option<(PathId, State)>,
    /// The other's acceleration (m/s²) at a time (s).
    drives: fn(f32) -> f32,
    /// The arc length (m) of one on foot at a time (s), on the crossing.
    walks: Option<fn(f32) -> f32>,
    /// Where a lorry stands that hides the other until it is past it.
    pub(crate) lorry: Option<Pose>,
    /// Arc length (m) from which the oncoming path is in sight at a time (s).
    sight: Option<fn(f32) -> f32>,
}

/// All of them.
pub(crate) const ALL: &[Scene] = &[
    Scene {
        name: "empty",
        title: "An empty junction: a limit of 8 m/s from 20 m on, and 2 m/s² in the bend",
        start: State { s: 0.0, v: 11.0 },
        other: None,
        drives: |_| 0.0,
        walks: None,
        lorry: None,
        sight: None,
    },
    Scene {
        name: "leader",
        title: "A leader that brakes to rest, and goes on",
        start: State { s: 0.0, v: 8.0 },
        other: Some((EGO, State { s: 22.0, v: 7.0 })),
        drives: |time| match time {
            ..3.0 => 0.0,
            3.0..8.0 => -2.0,
            _ => 1.5,
        },
        walks: None,
        lorry: None,
        sight: None,
    },
    Scene {
        name: "pedestrian",
        title: "A pedestrian who steps onto the crossing, and turns back at 9 s",
        start: State { s: 0.0, v: 8.0 },
        other: None,
        drives: |_| 0.0,
        walks: Some(|time| match time {
            ..5.0 => 1.0,
            5.0..9.0 => 1.0 + 1.4 * (time - 5.0),
            9.0..13.0 => 6.6 - 1.4 * (time - 9.0),
            _ => 1.0,
        }),
        lorry: None,
        sight: None,
    },
    Scene {
        name: "hidden",
        title: "A lorry that hides an oncoming car, and drives off at 14 s",
        start: State { s: 0.0, v: 8.0 },
        other: Some((ONCOMING, State { s: 2.0, v: 0.0 })),
        drives: |time| if (3.0..8.0).contains(&time) { 2.0 } else { 0.0 },
        walks: None,
        lorry: Some(Pose {
            position: Point::new(20.0, -2.0),
            direction: cede_controller::geometry::unit(-1.0, 0.0),
        }),
        // It drives off.
        sight: Some(|time| if time < 14.0 { 38.0 } else { 0.0 }),
    },
];

/// What happened.
pub(crate) struct Replay {
    pub(crate) junction: Place,
    /// Each step's ego, other, allowed speed and command.
    pub(crate) steps: Vec<Step>,
    /// When the ego turned to what it did, and the words of that decision.
    pub(crate) turning_point: String,
}

#[derive(Clone, Copy)]
pub(crate) struct Step {
    pub(crate) time: f32,
    pub(crate) ego: State,
    pub(crate) other: Option<(PathId, State)>,
    /// Whether the other is in the observation.
    pub(crate) seen: bool,
    /// What limits and bends allow, m/s.
    pub(crate) allowed: f32,
    pub(crate) shielded: bool,
}

fn route(points: &[(f32, f32)]) -> Result<Route<POINTS>, Box<dyn Error>> {
    Ok(Route::new(points.iter().map(|&(x, y)| Point::new(x, y)))?)
}

/// East into the junction, a left turn in bends of 6°, and north out of it; and the oncoming lane.
fn junction() -> Result<Place, Box<dyn Error>> {
    let bend = |i: u8| {
        let angle = f32::from(i) * 6.0_f32.to_radians();
        (-8.0 + 10.0 * angle.sin(), 8.0 - 10.0 * angle.cos())
    };
    let mut points = vec![(-60.0, -2.0)];
    points.extend((0..=15).map(bend));
    points.push((2.0, 60.0));
    let mut builder = Place::builder();
    builder.lateral(2.0);
    let left = builder.path(&route(&points)?, Class::Car, CAR)?;
    let oncoming = builder.path(&route(&[(60.0, 2.0), (-60.0, 2.0)])?, Class::Car, CAR)?;
    let over = route(&[(-6.0, 14.0), (10.0, 14.0)])?;
    let crossing = builder.path(&over, Class::Pedestrian, WALKER)?;
    builder.pace(crossing, 2.0)?;
    builder.right_of_way(oncoming, left)?;
    builder.speed_limit(left, 0.0, 13.9)?;
    builder.speed_limit(left, 20.0, 8.0)?;
    Ok(builder.build()?)
}

/// A vehicle exactly on its path.
fn on(junction: &Place, path: PathId, state: State) -> Option<Vehicle> {
    Some(Vehicle {
        s: state.s,
        speed: state.v,
        pose: junction.polyline(path)?.pose(state.s),
    })
}

impl Scene {
    pub(crate) fn play(&self) -> Result<Replay, Box<dyn Error>> {
        let junction = junction()?;
        let contract = Contract::builder().ego_braking(4.0).build()?;
        let policy = Policy::new(embedded::words())?;
        let mut approach = Drive::new(policy, contract, Part::Left).enter(&junction, EGO)?;
        let (mut ego, mut other) = (self.start, self.other);
        let (mut steps, mut turning_point) = (Vec::new(), None);
        let length = junction.polyline(EGO).map_or(0.0, |line| line.length());
        let profile = junction.way(EGO).ok_or("no way")?.profile();
        for step in 0..STEPS {
            let (now, time) = (Instant::from_millis(100 * step), 0.1 * step as f32);
            if let Some(walks) = self.walks {
                let (s, last) = (walks(time), walks(time - 0.1));
                let v = (s - last).abs() / 0.1;
                other = Some((CROSSING, State { s, v }));
            }
            let seen =
                other.is_some_and(|(_, at)| self.sight.is_none_or(|from| at.s >= from(time)));
            let vehicle = other.and_then(|(path, at)| Some((path, on(&junction, path, at)?)));
            let tracks: Vec<Track> = vehicle
                .filter(|_| seen)
                .map(|(path, vehicle)| match path {
                    CROSSING => Track::on(1, path, vehicle).class(Class::Pedestrian),
                    _ => Track::on(1, path, vehicle),
                })
                .into_iter()
                .collect();
            if let Some(from) = self.sight {
                let (path, from) = (ONCOMING, from(time));
                approach.set_sight(
                    now,
                    &[Sight {
                        path,
                        from,
                        speed: 15.0,
                    }],
                )?;
            }
            let decision = approach.decide(
                now,
                &Observation {
                    ego: on(&junction, EGO, ego).ok_or("no path")?,
                    tracks: &tracks,
                },
            );
            let shielded = decision.cause != Cause::Policy;
            if shielded && turning_point.is_none() {
                let plan = decision
                    .plan
                    .map_or("no plan".to_owned(), |plan| match plan.go {
                        0 => "plan: brake to rest".to_owned(),
                        go => format!("plan: go for {:.1} s, then brake", 0.1 * f32::from(go)),
                    });
                turning_point = Some(format!("{time:.1} s: {decision}; {plan}"));
            }
            steps.push(Step {
                time,
                ego,
                other,
                seen,
                allowed: profile.speed(ego.s),
                shielded,
            });
            ego = advance(ego, decision.acceleration);
            let gone = |path| junction.polyline(path).map_or(0.0, |line| line.length()) - 4.0;
            other = other
                .map(|(path, at)| (path, advance(at, (self.drives)(time))))
                .filter(|&(path, at)| at.s < gone(path));
            if ego.s > length - 25.0 {
                break;
            }
        }
        let turning_point =
            turning_point.unwrap_or("the policy's proposals, up to the profile".to_owned());
        Ok(Replay {
            junction,
            steps,
            turning_point,
        })
    }
}
