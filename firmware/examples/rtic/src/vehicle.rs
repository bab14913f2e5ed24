//! A left turn across an oncoming vehicle, simulated.

use cede_controller::geometry::unit;
use cede_controller::policy::embedded;
use cede_controller::{
    Approach, Class, Contract, Drive, Footprint, Junction, JunctionBuilder, Part, PathId, Point,
    Policy, Pose, Route, Track, Vehicle,
};

/// Two paths, of 8 points at most each, of which the ego can enter one.
pub(crate) type Site = Junction<2, 16, 1>;

const CAR: Footprint = Footprint {
    length: 4.6,
    width: 1.9,
};
const LEFT: [[f32; 2]; 5] = [
    [-40.0, -2.0],
    [-6.0, -2.0],
    [0.0, 0.0],
    [2.0, 6.0],
    [2.0, 40.0],
];
const ONCOMING: [[f32; 2]; 2] = [[40.0, 2.0], [-40.0, 2.0]];
/// Seconds from one look of the sensors to the next.
const STEP: f32 = 0.01;

/// Builds the junction in its place and begins to approach it.
pub(crate) fn enter(place: &'static mut Option<Site>) -> Option<Approach<'static, 'static>> {
    let mut builder = JunctionBuilder::new();
    for points in [&LEFT[..], &ONCOMING] {
        let points = points.iter().map(|&[x, y]| Point::new(x, y));
        let route = Route::<8>::new(points).ok()?;
        builder.path(&route, Class::Car, CAR).ok()?;
    }
    let (left, oncoming) = (PathId::new(0), PathId::new(1));
    builder.right_of_way(oncoming, left).ok()?;
    let site = place.insert(builder.build().ok()?);
    let policy = Policy::new(embedded::words()).ok()?;
    let contract = contract()?;
    Drive::new(policy, contract, Part::Left)
        .enter(site, left)
        .ok()
}

fn contract() -> Option<Contract> {
    Contract::builder()
        .latency(0.08)
        .jitter(0.005)
        .position_error(0.5)
        .speed_error(0.2)
        .build()
        .ok()
}

/// Where the two are, and what the ego was told last.
#[allow(unreachable_pub, reason = "RTIC's resources are public to its tasks")]
pub struct Vehicles {
    /// Metres along its path, and m/s.
    ego: [f32; 2],
    other: [f32; 2],
    /// In m/s².
    pub(crate) command: f32,
}

impl Vehicles {
    pub(crate) const START: Self = Self {
        ego: [15.0, 6.0],
        other: [0.0, 6.0],
        command: 0.0,
    };

    /// A look later.
    pub(crate) fn advance(&mut self) {
        let [s, speed] = self.ego;
        let later = (speed + self.command * STEP).max(0.0);
        self.ego = [s + 0.5 * (speed + later) * STEP, later];
        self.other[0] += self.other[1] * STEP;
    }

    /// The ego and the other, on the straight parts of their paths.
    pub(crate) fn seen(&self) -> (Vehicle, [Track; 1]) {
        let ([s, speed], [its, its_speed]) = (self.ego, self.other);
        let ego = on(s, speed, [s - 40.0, -2.0], 1.0);
        let other = on(its, its_speed, [40.0 - its, 2.0], -1.0);
        (ego, [Track::on(17, PathId::new(1), other)])
    }
}

fn on(s: f32, speed: f32, [x, y]: [f32; 2], east: f32) -> Vehicle {
    Vehicle {
        s,
        speed,
        pose: Pose {
            position: Point::new(x, y),
            direction: unit(east, 0.0),
        },
    }
}
