//! Vehicles on straight and bent routes through one junction.

use crate::random::Random;
use cede_controller::kinematics::STEP;
use cede_controller::{Class, Contract, Footprint, Junction, Point, Route};
use cede_golden::{POINTS, QUESTION, ROUTE, VEHICLE};

/// What the others may do by the worst-case contract, in m/s² and m/s.
const ACCELERATION: f32 = Contract::WORST_CASE.other().acceleration;
const SPEED: f32 = Contract::WORST_CASE.other().max_speed;

/// The ego and the others.
pub(crate) struct Traffic {
    vehicles: Vec<Vehicle>,
    millis: u32,
}

struct Vehicle {
    points: Vec<Point>,
    route: Route<POINTS>,
    right_of_way: u32,
    priority: u32,
    line: f32,
    there: bool,
    s: f32,
    speed: f32,
    acceleration: f32,
}

impl Traffic {
    pub(crate) fn new(random: &mut Random, others: usize) -> Self {
        Self {
            vehicles: (0..=others).map(|_| Vehicle::new(random)).collect(),
            millis: 1_000,
        }
    }

    pub(crate) fn routes(&self) -> impl Iterator<Item = u32> + '_ {
        self.vehicles.iter().flat_map(Vehicle::words)
    }

    /// What is seen; now and then something that cannot be.
    pub(crate) fn observe(&self, random: &mut Random) -> [u32; QUESTION] {
        let mut question = [0; QUESTION];
        question[0] = self.millis;
        for (words, vehicle) in question[1..]
            .as_chunks_mut::<VEHICLE>()
            .0
            .iter_mut()
            .zip(&self.vehicles)
        {
            *words = vehicle.seen();
            if random.once_in(100) {
                let place = 1 + random.word() as usize % (VEHICLE - 1);
                words[place] = random.word();
            }
        }
        question
    }

    /// The ego does as it is told, the others as they please.
    pub(crate) fn advance(&mut self, random: &mut Random, acceleration: f32) {
        self.millis += if random.once_in(50) { 230 } else { 100 };
        for (i, vehicle) in self.vehicles.iter_mut().enumerate() {
            if i == 0 {
                vehicle.acceleration = acceleration;
            } else {
                vehicle.choose(random);
            }
            vehicle.advance();
        }
    }
}

impl Vehicle {
    /// In from one side, a bend in the middle, out to another.
    fn new(random: &mut Random) -> Self {
        let points = loop {
            let points = points(random);
            if drivable(&points) {
                break points;
            }
        };
        let route = Route::new(points.iter().copied()).expect("the points are apart");
        Self {
            points,
            route,
            right_of_way: random.word() % 3,
            priority: random.word() % 3,
            line: if random.once_in(2) {
                30.0 + random.within(6.0)
            } else {
                f32::NAN
            },
            there: !random.once_in(6),
            s: 20.0 + random.within(20.0),
            speed: 5.0 + random.within(5.0),
            acceleration: 0.0,
        }
    }

    fn words(&self) -> [u32; ROUTE] {
        let mut words = [0; ROUTE];
        words[0] = 5.0_f32.to_bits();
        words[1] = 2.0_f32.to_bits();
        words[2] = self.right_of_way;
        words[3] = self.priority;
        words[4] = self.line.to_bits();
        words[5] = self.points.len() as u32;
        for (place, point) in words[6..].as_chunks_mut().0.iter_mut().zip(&self.points) {
            *place = [point.x.to_bits(), point.y.to_bits()];
        }
        words
    }

    fn seen(&self) -> [u32; VEHICLE] {
        let pose = self.route.pose(self.s);
        let numbers = [
            self.s,
            self.speed,
            pose.position.x,
            pose.position.y,
            pose.direction.x,
            pose.direction.y,
        ];
        let mut words = [u32::from(self.there); VEHICLE];
        for (place, number) in words[1..].iter_mut().zip(numbers) {
            *place = number.to_bits();
        }
        words
    }

    fn choose(&mut self, random: &mut Random) {
        if random.once_in(8) {
            self.acceleration = random.within(ACCELERATION);
        }
        if random.once_in(80) {
            self.there = !self.there;
        }
        if random.once_in(200) {
            self.s += random.within(10.0);
        }
    }

    fn advance(&mut self) {
        let speed = (self.speed + self.acceleration * STEP).clamp(0.0, SPEED);
        self.s += 0.5 * (self.speed + speed) * STEP;
        self.speed = speed;
    }
}

/// In from one side, a bend in the middle, out to another.
fn points(random: &mut Random) -> Vec<Point> {
    let mut arm = |radius: f32| {
        let angle = random.within(std::f32::consts::PI);
        Point::new(radius * angle.cos(), radius * angle.sin())
    };
    let (from, to) = (arm(45.0), arm(45.0));
    let (entry, exit) = (from * 0.15, to * 0.15);
    let middle = Point::from((entry.coords + exit.coords) * 0.35);
    vec![from, entry, middle, exit, to]
}

/// Whether no bend is too sharp for a junction, and the route does not come back to itself.
fn drivable(points: &[Point]) -> bool {
    let route = Route::<POINTS>::new(points.iter().copied());
    route.is_ok_and(|route| {
        let mut builder = Junction::<1, POINTS>::builder();
        let path = builder.path(&route, Class::Car, Footprint::PAPER);
        path.is_ok() && builder.build().is_ok()
    })
}
