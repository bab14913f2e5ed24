//! Hand-made encounters for unit tests.

use cede_controller::kinematics::STEP;
use cede_controller::{ConflictKind, Footprint, Point, Vector};
use cede_data::encounter::{
    Encounter, EncounterId, Manoeuvre, Participant, Role, Sample, SimRoute,
};
use cede_data::{Entry, Rights};

/// The left-turner drives east, the other north; their routes cross at the origin, at right angles.
/// Each starts `distance` m before its conflict point (5 m before the crossing) and is recorded at
/// constant `speed` m/s for 20 s.
pub(crate) fn crossing(left: [f32; 2], other: [f32; 2]) -> Encounter {
    let east = participant(1, Manoeuvre::Left, Vector::new(1.0, 0.0), left);
    let north = participant(2, Manoeuvre::Straight, Vector::new(0.0, 1.0), other);
    let arrival = |[distance, speed]: [f32; 2]| (distance / speed / STEP).ceil();
    let (left, other) = (arrival(left), arrival(other));
    Encounter {
        id: EncounterId {
            site: "fixture".to_owned(),
            file: 0,
            left: 1,
            other: 2,
        },
        kind: ConflictKind::Crossing,
        start_ms: 0,
        steps: left.min(other) as u32,
        conflict_point: Point::origin(),
        first: if left <= other {
            Role::Left
        } else {
            Role::Other
        },
        rights: Rights::default(),
        pet: (left - other).abs() * STEP,
        participants: vec![east, north],
    }
}

fn participant(
    track: u32,
    manoeuvre: Manoeuvre,
    direction: Vector,
    [distance, speed]: [f32; 2],
) -> Participant {
    let route = SimRoute::new([-100.0, 100.0].map(|s| Point::from(direction * s)))
        .expect("a straight line");
    let conflict_s = 95.0;
    let record = (0..200_u8)
        .map(|step| Sample {
            s: conflict_s - distance + speed * f32::from(step) * STEP,
            v: speed,
            a: 0.0,
        })
        .collect();
    Participant {
        track,
        manoeuvre,
        entry: Entry::default(),
        route,
        footprint: Footprint::PAPER,
        conflict_s,
        appears: 0,
        record,
    }
}
