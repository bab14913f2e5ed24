//! Whether a shield has a plan when control is handed over at 50 km/h.

use cede_controller::{
    Class, Contract, Footprint, Junction, Observation, PathId, Point, Pose, Route, Shield, Track,
    Vehicle,
};
use cede_sim::meeting::instant;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f32::consts::FRAC_PI_2;

/// 50 km/h, in m/s.
const SPEED: f32 = 13.9;
/// Metres from the beginning of a route to the middle of the junction.
const APPROACH: f32 = 110.0;

/// A four-arm junction of 12 routes, 3 of each arm: straight on, left, right.
struct Site {
    routes: Vec<Route<64>>,
    junction: Box<Junction<12, 768>>,
}

impl Site {
    fn new() -> Self {
        let routes: Vec<_> = (0..12).map(|i| route(i / 3, i % 3)).collect();
        let mut builder = Junction::builder();
        for route in &routes {
            builder.path(route, Class::Car, Footprint::PAPER).unwrap();
        }
        Self {
            routes,
            junction: Box::new(builder.build().unwrap()),
        }
    }

    /// A vehicle on route `i`, `ahead` metres before the place at which it first meets another route.
    fn before_its_zones(&self, i: usize, ahead: f32, speed: f32) -> Vehicle {
        let line = self.junction.path(PathId::new(i as u8)).unwrap().line();
        let s = (line - ahead).max(0.0);
        let pose: Pose = self.routes[i].pose(s);
        Vehicle { s, speed, pose }
    }
}

/// In by arm `arm`, on the right at 2 m from the middle, and straight on, left or right.
fn route(arm: usize, turn: usize) -> Route<64> {
    let mut points = vec![(-APPROACH, -2.0)];
    let mut arc = |centre: (f32, f32), radius: f32, from: f32, to: f32| {
        for step in 0..=24_u8 {
            let angle = from + (to - from) * f32::from(step) / 24.0;
            points.push((
                centre.0 + radius * angle.cos(),
                centre.1 + radius * angle.sin(),
            ));
        }
    };
    match turn {
        1 => arc((-8.0, 8.0), 10.0, -FRAC_PI_2, 0.0),
        2 => arc((-8.0, -8.0), 6.0, FRAC_PI_2, 0.0),
        _ => {}
    }
    points.push(match turn {
        1 => (2.0, APPROACH),
        2 => (-2.0, -APPROACH),
        _ => (APPROACH, -2.0),
    });
    let turned = points.into_iter().map(|(x, y)| match arm {
        0 => Point::new(x, y),
        1 => Point::new(-y, x),
        2 => Point::new(-x, -y),
        _ => Point::new(y, -x),
    });
    Route::new(turned).unwrap()
}

/// Shares of 2,000 situations in which a plan is safe at hand-over: the ego `ahead` m before its zones, up to seven others
/// anywhere on their approaches, and with a `headway` (s) one that the ego follows.
fn planned(contract: Contract, ahead: [f32; 2], headway: Option<[f32; 2]>) -> f64 {
    let site = Site::new();
    let mut rng = Pcg64::seed_from_u64(5);
    let situations = 2_000;
    let safe = (0..situations).filter(|_| {
        let mine = rng.random_range(0..12_usize);
        let ahead = rng.random_range(ahead[0]..ahead[1]);
        let ego = site.before_its_zones(mine, ahead, SPEED);
        let mut tracks = Vec::new();
        for number in 0..rng.random_range(0..8_u16) {
            let i = rng.random_range(0..12_usize);
            // In other arms, so that nobody begins inside of the ego.
            if i / 3 != mine / 3 {
                let away = rng.random_range(0.0..80.0);
                let seen = site.before_its_zones(i, away, rng.random_range(0.0..SPEED));
                tracks.push(Track::on(number, PathId::new(i as u8), seen));
            }
        }
        if let Some([least, most]) = headway {
            let gap = Footprint::PAPER.length + SPEED * rng.random_range(least..most);
            let leader = site.before_its_zones(mine, ahead - gap, SPEED);
            tracks.push(Track::on(99, PathId::new(mine as u8), leader));
        }
        let seen = Observation {
            ego,
            tracks: &tracks,
        };
        let path = PathId::new(mine as u8);
        let shield = Shield::<8>::enter(contract, &site.junction, path).unwrap();
        shield.ready(instant(0), &seen).is_ok()
    });
    safe.count() as f64 / f64::from(situations)
}

/// `contracts/passenger-car.toml`, but for plans that brake at 6 m/s².
fn passenger_car() -> Contract {
    let drivetrain = Contract::builder()
        .latency(0.2)
        .jitter(0.003)
        .position_error(0.3)
        .speed_error(0.3)
        .ego_acceleration(2.4)
        .ego_go(1.5)
        .ego_braking(6.0)
        .ego_emergency(7.0)
        .ego_lag(0.2)
        .ego_gain(0.1)
        .ego_disturbance(0.3);
    let others = drivetrain
        .ego_max_speed(15.0)
        .other_max_speed(16.0)
        .other_acceleration(3.0)
        .other_braking(9.0)
        .follower_reaction(1.0)
        .follower_braking(4.0);
    others.build().unwrap()
}

#[test]
fn at_50_km_h_a_plan_is_safe_at_hand_over() {
    let car = passenger_car();
    let alone = planned(car, [32.0, 80.0], None);
    let follows = |headway| planned(car, [45.0, 80.0], Some(headway));
    let [usual, near] = [[1.8, 3.0], [1.0, 1.8]].map(follows);
    println!("from 32 m on: {alone}; behind one at 1.8 to 3 s: {usual}, at 1 to 1.8 s: {near}");
    assert!(alone >= 0.99, "{alone}");
    assert!(usual >= 0.99, "{usual}");
    assert!(near < 0.99, "{near}");
}
