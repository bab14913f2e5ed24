//! Observations of every bit pattern.

use crate::place::{Place, ROADS, Road, TestJunction};
use cede_controller::geometry::unit;
use cede_controller::{
    Class, Footprint, Instant, Observation, PathId, Point, Pose, Track, Vehicle,
};
use proptest::prelude::*;
use std::fmt;
use std::sync::Arc;

/// An observation that owns its tracks.
#[derive(Clone, Debug, PartialEq)]
pub struct AnyObservation {
    /// The ego.
    pub ego: Vehicle,
    /// The others.
    pub tracks: Vec<Track>,
}

/// One call of a controller.
#[derive(Clone, Debug, PartialEq)]
pub struct AnyCall {
    /// When.
    pub now: Instant,
    /// What is sensed.
    pub seen: AnyObservation,
    /// What is proposed in m/s², if the policy is not asked; any bits.
    pub proposal: Option<f32>,
}

/// Calls of a controller, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct AnyCalls {
    /// The junction.
    pub place: Place,
    /// The calls.
    pub calls: Vec<AnyCall>,
}

impl AnyObservation {
    /// As the controller is told it.
    #[must_use]
    pub fn observation(&self) -> Observation<'_> {
        Observation {
            ego: self.ego,
            tracks: &self.tracks,
        }
    }
}

/// A number as sensors may report it.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => any::<u32>().prop_map(f32::from_bits),
        2 => -20.0_f32..300.0,
        1 => prop::sample::select(vec![0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN_POSITIVE, 1e-45]),
    ]
}

/// A vehicle of which nothing can be believed.
fn wild() -> impl Strategy<Value = Vehicle> {
    prop::array::uniform6(number()).prop_map(|[s, speed, x, y, dx, dy]| Vehicle {
        s,
        speed,
        pose: Pose {
            position: Point::new(x, y),
            direction: unit(dx, dy),
        },
    })
}

/// A vehicle on a road of `junction`.
fn good(junction: Arc<TestJunction>, road: Road) -> impl Strategy<Value = Vehicle> {
    (0_u16..2000, 0_u16..200).prop_map(move |(s, speed)| {
        let (s, speed) = (f32::from(s) / 10.0, f32::from(speed) / 10.0);
        let line = junction.polyline(road.path());
        let pose = line.map_or_else(no_pose, |line| line.pose(s.min(line.length())));
        Vehicle { s, speed, pose }
    })
}

fn no_pose() -> Pose {
    Pose {
        position: Point::origin(),
        direction: unit(1.0, 0.0),
    }
}

/// A good vehicle with one number replaced by anything.
fn spoilt(junction: Arc<TestJunction>, road: Road) -> impl Strategy<Value = Vehicle> {
    (good(junction, road), 0_u8..6, number()).prop_map(|(mut vehicle, which, value)| {
        let Pose {
            position,
            direction,
        } = vehicle.pose;
        match which {
            0 => vehicle.s = value,
            1 => vehicle.speed = value,
            2 => vehicle.pose.position.x = value,
            3 => vehicle.pose.position = Point::new(position.x, value),
            4 => vehicle.pose.direction = unit(value, direction.y),
            _ => vehicle.pose.direction = unit(direction.x, value),
        }
        vehicle
    })
}

fn vehicle(junction: &Arc<TestJunction>, road: Road) -> impl Strategy<Value = Vehicle> + use<> {
    let junction = Arc::clone(junction);
    prop_oneof![
        6 => good(Arc::clone(&junction), road),
        2 => spoilt(junction, road),
        2 => wild(),
    ]
}

fn track(junction: &Arc<TestJunction>) -> impl Strategy<Value = Track> + use<> {
    let junction = Arc::clone(junction);
    let road = prop::sample::select(Road::ALL.to_vec());
    let believed = road.prop_flat_map(move |road| (Just(road), vehicle(&junction, road)));
    let class = prop::sample::select(vec![Class::Car, Class::Lorry, Class::Bicycle]);
    let path = prop_oneof![4 => 0..ROADS as u8, 1 => any::<u8>()];
    let number_of = prop_oneof![4 => 0_u16..6, 1 => any::<u16>()];
    let others = prop::collection::vec((path, number()), 0..5);
    let odd = prop_oneof![3 => Just(None), 1 => class.prop_map(Some)];
    (number_of, believed, odd, others).prop_map(|(number, (road, vehicle), odd, others)| {
        let class = odd.unwrap_or(road.class());
        let mut track = Track::on(number, road.path(), vehicle).class(class);
        for (path, s) in others {
            track = track.or(PathId::new(path), s).unwrap_or(track);
        }
        track
    })
}

/// Observations of vehicles at a junction: good ones, spoilt ones and any bits; up to 12 tracks in any order, with any
/// numbers, paths and candidates, doubles among them.
///
/// # Panics
/// If the place's numbers are out of range.
pub fn observation(place: Place) -> impl Strategy<Value = AnyObservation> {
    let junction = place.junction(Footprint::PAPER).expect("a place in range");
    observed(&Arc::new(junction))
}

fn observed(junction: &Arc<TestJunction>) -> impl Strategy<Value = AnyObservation> + use<> {
    let tracks = prop::collection::vec(track(junction), 0..12);
    (vehicle(junction, Road::Own), tracks).prop_map(|(ego, tracks)| AnyObservation { ego, tracks })
}

/// Up to six calls at any times: on time, late, repeated, backwards, centuries apart.
pub fn calls() -> impl Strategy<Value = AnyCalls> {
    super::place(80).prop_flat_map(|place| {
        let junction = Arc::new(place.junction(Footprint::PAPER).expect("a place in range"));
        let step = prop_oneof![
            6 => Just(Some(100_000_u64)),
            1 => Just(Some(0)),
            1 => (0_u64..2_000_000).prop_map(Some),
            1 => Just(None),
        ];
        let proposal = prop_oneof![Just(None), number().prop_map(Some)];
        let call = (step, any::<u64>(), observed(&junction), proposal);
        prop::collection::vec(call, 1..=6).prop_map(move |calls| AnyCalls {
            place,
            calls: timed(calls),
        })
    })
}

/// The calls with their times: so long after the one before, or at any time.
fn timed(calls: Vec<(Option<u64>, u64, AnyObservation, Option<f32>)>) -> Vec<AnyCall> {
    let mut now = 5_000_000_u64;
    let timed = calls.into_iter().map(|(step, anywhere, seen, proposal)| {
        now = step.map_or(anywhere, |step| now.saturating_add(step));
        AnyCall {
            now: Instant::from_micros(now),
            seen,
            proposal,
        }
    });
    timed.collect()
}

/// A vehicle in words.
struct InWords<'a>(&'a Vehicle);

impl fmt::Display for InWords<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Vehicle { s, speed, pose } = self.0;
        let (at, to) = (pose.position, pose.direction);
        write!(
            f,
            "s {s} m, {speed} m/s, at ({}, {}), towards ({}, {})",
            at.x, at.y, to.x, to.y
        )
    }
}

impl fmt::Display for AnyObservation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ego: {}", InWords(&self.ego))?;
        for track in &self.tracks {
            let Track {
                number,
                class,
                speed,
                pose,
                ..
            } = *track;
            write!(f, "\n  track {number}, {class:?}:")?;
            for candidate in track.candidates() {
                let vehicle = Vehicle {
                    s: candidate.s,
                    speed,
                    pose,
                };
                write!(f, " on {}: {};", candidate.path, InWords(&vehicle))?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for AnyCalls {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Place: {}.", self.place)?;
        for AnyCall {
            now,
            seen,
            proposal,
        } in &self.calls
        {
            write!(f, "\nAt {} µs, ", now.micros())?;
            match proposal {
                Some(proposal) => write!(f, "{proposal} m/s² is proposed")?,
                None => f.write_str("the policy proposes")?,
            }
            write!(f, "; {seen}")?;
        }
        Ok(())
    }
}
