//! A first drive: the ego turns left, an oncoming vehicle goes straight on. A closed loop, step by step.
//!
//! `cargo run -p cede-controller --example first_drive`

use cede_controller::kinematics::{STEP, State, advance};
use cede_controller::policy::embedded;
use cede_controller::{
    Class, Contract, Drive, Footprint, Instant, Junction, Observation, Part, Point, Policy, Route,
    Track, Vehicle,
};
use std::error::Error;

/// Points of a route, at most.
const POINTS: usize = 16;
/// Milliseconds from one decision to the next.
const PERIOD: u64 = 100;

/// A route through points in metres, as they come from the map.
fn route(points: &[(f32, f32)]) -> Result<Route<POINTS>, Box<dyn Error>> {
    Ok(Route::new(points.iter().map(|&(x, y)| Point::new(x, y)))?)
}

/// East into the junction, a left turn in bends of 10°, and north out of it.
fn left_turn() -> Result<Route<POINTS>, Box<dyn Error>> {
    let bend = |i: u8| {
        let angle = f32::from(i) * 10.0_f32.to_radians();
        (-6.0 + 8.0 * angle.sin(), 6.0 - 8.0 * angle.cos())
    };
    let mut points = vec![(-40.0, -2.0)];
    points.extend((0..=9).map(bend));
    points.push((2.0, 60.0));
    route(&points)
}

/// What localisation and tracking report. Here they are exact.
fn sensed(route: &Route<POINTS>, state: State) -> Vehicle {
    Vehicle {
        s: state.s,
        speed: state.v,
        pose: route.pose(state.s),
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    // Once for this intersection: where the two go, and where they can touch.
    let (mine, theirs) = (left_turn()?, route(&[(60.0, 2.0), (-90.0, 2.0)])?);
    let car = Footprint {
        length: 4.6,
        width: 1.9,
    };
    let mut builder = Junction::<2, { 2 * POINTS }>::builder();
    let left = builder.path(&mine, Class::Car, car)?;
    let oncoming = builder.path(&theirs, Class::Car, car)?;
    builder.right_of_way(oncoming, left)?;
    let junction = builder.build()?;

    // Once at start-up: the policy that ships, and what this vehicle and the others can do.
    let policy = Policy::new(embedded::words())?;
    let contract = Contract::builder().ego_braking(4.0).build()?;
    let drive = Drive::new(policy, contract, Part::Left);

    // From here until the ego has left the junction.
    let mut approach = drive.enter(&junction, left)?;
    let mut ego = State { s: 0.0, v: 7.0 };
    let mut other = State { s: 10.0, v: 8.0 };
    println!("time, s     s, m  v, m/s  command, m/s²  cause");
    for step in 0_u16..200 {
        // Tracking reports whoever is there by its own number; a vehicle that has left the path is there no more.
        let tracks = [Track::on(17, oncoming, sensed(&theirs, other))];
        let there = other.s <= theirs.length();
        let seen = Observation {
            ego: sensed(&mine, ego),
            tracks: if there { &tracks } else { &[] },
        };
        let now = Instant::from_millis(PERIOD * u64::from(step));
        let decision = approach.decide(now, &seen);
        if step % 5 == 0 {
            let (time, State { s, v }) = (f32::from(step) * STEP, ego);
            let command = decision.acceleration;
            println!("{time:7.1}  {s:7.1}  {v:6.1}  {command:13.2}  {decision}");
        }
        // The world moves on: the ego does what is commanded, the other keeps its speed.
        ego = advance(ego, decision.acceleration);
        other = advance(other, 0.0);
        if ego.s > mine.length() - 30.0 {
            break;
        }
    }
    Ok(())
}
