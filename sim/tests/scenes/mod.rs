//! Random encounters for tests and benches: a left turn against oncoming traffic, 1 km from the
//! origin as recorded sites are, with queues behind both vehicles.

use cede_controller::kinematics::{STEP, State, advance};
use cede_controller::{ConflictKind, Footprint, Point};
use cede_data::{
    Encounter, EncounterId, Entry, Manoeuvre, Participant, Rights, Role, Sample, SimRoute,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f32::consts::FRAC_PI_2;

const ORIGIN: Point = Point::new(1000.0, 1000.0);
const RECORD_STEPS: usize = 400;

/// `count` encounters of `vehicles` each; the same for the same seed.
pub(crate) fn encounters(count: u32, vehicles: u32, seed: u64) -> Vec<Encounter> {
    let mut random = Pcg64::seed_from_u64(seed);
    (0..count)
        .map(|number| encounter(&mut random, number, vehicles))
        .collect()
}

fn encounter(random: &mut Pcg64, number: u32, vehicles: u32) -> Encounter {
    let radius = random.random_range(6.0..16.0);
    let left = route(left_turn(radius));
    let merges = random.random_bool(0.3);
    let offset = random.random_range(2.5..5.0);
    let other = route(if merges {
        right_turn(radius, offset)
    } else {
        oncoming(offset)
    });
    let crossing = crossing(&left, &other);
    let conflict = |route: &SimRoute| route.project(crossing) - 5.0;
    let mut participants = vec![
        participant(random, 0, &left, conflict(&left), 0.0),
        participant(random, 1, &other, conflict(&other), 0.0),
    ];
    for track in 2..vehicles {
        let leader = if track % 2 == 0 { &left } else { &other };
        let behind = 7.0 * (track / 2) as f32;
        participants.push(participant(random, track, leader, f32::INFINITY, behind));
    }
    let arrival = |p: &Participant| p.record.iter().position(|r| r.s >= p.conflict_s);
    let arrivals = [0, 1].map(|i| arrival(&participants[i]).unwrap_or(RECORD_STEPS));
    Encounter {
        id: EncounterId {
            site: "TEST".to_owned(),
            file: 0,
            left: number,
            other: number + 1,
        },
        kind: if merges {
            ConflictKind::Merging
        } else {
            ConflictKind::Crossing
        },
        start_ms: 0,
        steps: u32::try_from(arrivals[0].min(arrivals[1])).unwrap().max(1),
        conflict_point: crossing,
        first: if arrivals[0] <= arrivals[1] {
            Role::Left
        } else {
            Role::Other
        },
        rights: Rights::default(),
        pet: arrivals[0].abs_diff(arrivals[1]) as f32 * STEP,
        participants,
    }
}

/// Somewhere on the approach, with a record of randomly changing accelerations.
fn participant(
    random: &mut Pcg64,
    track: u32,
    route: &SimRoute,
    conflict_s: f32,
    behind: f32,
) -> Participant {
    let start = random.random_range(0.0..15.0);
    let mut state = State {
        s: start + 40.0 - behind - 40.0_f32.min(start + 40.0 - behind - 0.5).max(0.0) * 0.9,
        v: if random.random_bool(0.2) {
            0.0
        } else {
            random.random_range(0.0..11.0)
        },
    };
    let mut a = 0.0_f32;
    let record = (0..RECORD_STEPS)
        .map(|step| {
            if step % 8 == 0 {
                let towards = random.random_range(0.0..11.0) - state.v;
                a = (0.5 * towards).clamp(-3.0, 3.0);
            }
            let now = Sample {
                s: state.s,
                v: state.v,
                a,
            };
            state = advance(state, a);
            now
        })
        .collect();
    Participant {
        track,
        manoeuvre: Manoeuvre::Left,
        entry: Entry::default(),
        route: route.clone(),
        footprint: Footprint::PAPER,
        conflict_s,
        appears: if track < 2 {
            0
        } else {
            random.random_range(0..30)
        },
        record,
    }
}

/// From the west, then north: straight, a quarter of a circle, straight.
fn left_turn(radius: f32) -> Vec<Point> {
    let mut points = vec![Point::new(-60.0, 0.0), Point::new(-radius, 0.0)];
    points.extend((1..=16_u8).map(|i| {
        let angle = FRAC_PI_2 * f32::from(i) / 16.0;
        Point::new(radius * (angle.sin() - 1.0), radius * (1.0 - angle.cos()))
    }));
    points.push(Point::new(0.0, 90.0));
    points
}

/// From the east, straight on, with a slight bend so that it has more than one segment.
fn oncoming(offset: f32) -> Vec<Point> {
    let mut points: Vec<_> = (0..24_u8)
        .map(|i| Point::new(60.0 - 5.0 * f32::from(i), offset + 0.02 * f32::from(i)))
        .collect();
    points.push(Point::new(-90.0, offset));
    points
}

/// From the east, then north into the exit that the left-turner takes, crossing its path at the end.
fn right_turn(radius: f32, offset: f32) -> Vec<Point> {
    let mut points = vec![Point::new(60.0, offset), Point::new(radius, offset)];
    points.extend((1..=16_u8).map(|i| {
        let angle = FRAC_PI_2 * f32::from(i) / 16.0;
        let (sin, cos) = angle.sin_cos();
        Point::new(radius * (1.0 - sin) + 0.5, offset + radius * (1.0 - cos))
    }));
    points.push(Point::new(-0.5, offset + radius + 15.0));
    points.push(Point::new(-0.5, 90.0));
    points
}

fn route(points: Vec<Point>) -> SimRoute {
    SimRoute::new(points.into_iter().map(|p| ORIGIN + p.coords)).unwrap()
}

/// First point of `a` that lies on `b`.
fn crossing(a: &SimRoute, b: &SimRoute) -> Point {
    for ends in a.points().windows(2) {
        for others in b.points().windows(2) {
            let (along, other) = (ends[1] - ends[0], others[1] - others[0]);
            let area = along.perp(&other);
            let t = (others[0] - ends[0]).perp(&other) / area;
            let u = (others[0] - ends[0]).perp(&along) / area;
            if (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u) {
                return ends[0] + along * t;
            }
        }
    }
    panic!("the routes do not cross");
}
