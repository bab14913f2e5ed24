//! In traffic: a share of the vehicles of a recording is driven, from where each appears until its record ends; the others
//! repeat their record, and mind who is in their way because he is not where he was.
//!
//! Nobody is taken out of the way: who meets whom, and whose delay is whose, is counted as it comes. Only those are left out
//! whose way is no path of a junction: it comes back to itself, or has a kink sharper than a right angle.

mod car;
mod collision;
mod human;
mod look;
mod obstacle;
mod ride;
mod seat;
mod summary;

pub use collision::Collision;
pub use ride::Ride;
pub use seat::Kind;
pub use summary::Summary;

use car::Car;
use cede_controller::{Contract, Policy};
use cede_data::Traffic;
use human::Human;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use seat::{Crossing, Seat};

/// A vehicle that stands for more than so many seconds is stuck, and is taken away.
pub const PATIENCE: f32 = 60.0;

/// Who is driven, and by whom.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'w> {
    /// The share of the vehicles that are driven, in [0, 1].
    pub share: f64,
    /// Chooses them.
    pub seed: u64,
    /// What drives them.
    pub kind: Kind,
    /// The policy of [`Kind::Cede`].
    pub policy: Policy<'w>,
    /// The contract of their shields.
    pub contract: Contract,
}

/// What became of a recording's traffic.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The recording's number.
    pub file: u16,
    /// One for each vehicle; empty for those that were left out.
    pub rides: Vec<Ride>,
    /// Who touched whom, of pairs in which one at least was driven.
    pub collisions: Vec<Collision>,
    /// Pairs of others that touched.
    pub others_touched: usize,
    /// Vehicles that were left out.
    pub left_out: usize,
}

/// Lets the traffic run until everybody has left.
///
/// The same bits for the same settings, on any number of threads. Cost: for each vehicle that is driven about 0.1 ms for each
/// other one, and some microseconds a step.
#[must_use]
pub fn run(traffic: &Traffic, settings: &Settings<'_>) -> Outcome {
    let driven = chosen(traffic, settings);
    let there: Vec<bool> = traffic.vehicles.par_iter().map(seat::is_path).collect();
    let crossings: Vec<Option<Box<Crossing>>> = (0..traffic.vehicles.len())
        .into_par_iter()
        .map(|index| {
            let driven = driven[index] && there[index];
            driven.then(|| Crossing::new(traffic, index, &there).map(Box::new))
        })
        .map(Option::flatten)
        .collect();
    let seats = crossings.iter().map(|crossing| {
        let crossing = crossing.as_deref()?;
        Some(Seat::new(crossing, settings))
    });
    let cars = traffic.vehicles.iter().zip(driven).zip(&there);
    let cars = cars.map(|((vehicle, chosen), &there)| {
        let mut car = Car::new(vehicle, chosen);
        if !there {
            car.leave();
        }
        car
    });
    World {
        cars: cars.collect(),
        seats: seats.collect(),
        step: 0,
    }
    .run(traffic.file)
}

fn chosen(traffic: &Traffic, settings: &Settings<'_>) -> Vec<bool> {
    let mut rng = Pcg64::seed_from_u64(settings.seed ^ (u64::from(traffic.file) << 32));
    let vehicles = traffic.vehicles.iter();
    vehicles
        .map(|_| rng.random::<f64>() < settings.share)
        .collect()
}

/// Everybody, at one time.
struct World<'t> {
    cars: Vec<Car<'t>>,
    /// Who drives each of them, if not its record.
    seats: Vec<Option<Seat<'t>>>,
    step: u32,
}

impl World<'_> {
    fn run(mut self, file: u16) -> Outcome {
        let mut outcome = Outcome {
            file,
            rides: Vec::new(),
            collisions: Vec::new(),
            others_touched: 0,
            left_out: self.cars.iter().filter(|car| car.is_gone()).count(),
        };
        let mut touching: Vec<[usize; 2]> = Vec::new();
        while self.cars.iter().any(|car| !car.is_gone()) {
            self.appear();
            let there: Vec<usize> = (0..self.cars.len())
                .filter(|&index| self.cars[index].is_there())
                .collect();
            for pair in look::touching(&self.cars, &there) {
                if touching.contains(&pair) {
                    continue;
                }
                touching.push(pair);
                match Collision::of(&self.cars, pair, self.step) {
                    Some(collision) => outcome.collisions.push(collision),
                    None => outcome.others_touched += 1,
                }
            }
            let commands: Vec<f32> = there
                .iter()
                .map(|&index| self.decide(index, &there))
                .collect();
            for (&index, command) in there.iter().zip(commands) {
                self.cars[index].advance(command, self.step);
            }
            self.step += 1;
        }
        outcome.rides = self.cars.into_iter().map(Car::into_ride).collect();
        outcome
    }

    /// Whoever is due enters, as soon as there is room for it, and nobody's plan counts on that it does not.
    fn appear(&mut self) {
        let step = self.step;
        for index in 0..self.cars.len() {
            if self.cars[index].is_due(step)
                && look::has_room(&self.cars, index, step)
                && self.is_borne(index)
            {
                self.cars[index].appear();
            }
        }
    }

    /// Whether all who are driven have a safe plan, too, if car `newcomer` enters.
    fn is_borne(&self, newcomer: usize) -> bool {
        (0..self.seats.len())
            .filter(|&ego| self.cars[ego].driven && self.cars[ego].is_there())
            .all(|ego| {
                let seat = self.seats[ego].as_ref();
                seat.is_none_or(|seat| seat.bears(&self.cars, [ego, newcomer], self.step))
            })
    }

    /// The acceleration (m/s²) of `index` for the step that begins.
    fn decide(&mut self, index: usize, there: &[usize]) -> f32 {
        let ahead = look::ahead(&self.cars, there, index, self.step);
        let decision = self.seats[index]
            .as_mut()
            .and_then(|seat| seat.decide(&self.cars, index, self.step, ahead.leader));
        let car = &mut self.cars[index];
        car.driven = decision.is_some();
        match decision {
            Some(decision) => {
                car.ride.decided(&decision);
                decision.acceleration
            }
            None => Human::acceleration(car.state().v, car.is_late(self.step), ahead.obstacle),
        }
    }
}
