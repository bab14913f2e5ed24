//! Sites, vehicles and observations for scenarios made by hand.

use cede_attack::actuator::Takeover;
use cede_attack::human::Manner;
use cede_attack::motion::State;
use cede_attack::plane::Size;
use cede_attack::proposer::Proposer;
use cede_attack::rng::Rng;
use cede_attack::setup::{Car, Driver, Outside, Setup};
use cede_attack::sight::Sensing;
use cede_attack::site::Site;
use cede_attack::sketch::{Kind, Way};
use cede_attack::sway::Sway;
use cede_attack::tally::Tally;
use cede_attack::world::play;
use cede_controller::dangerous::Sound;
use cede_controller::geometry::unit;
use cede_controller::{Contract, Point, Pose, Vehicle};
use rayon::prelude::*;

/// A way for cars of 5 m × 2 m.
pub(crate) fn car_way(points: &[[f32; 2]]) -> Way {
    way(points, 5.0, 2.0)
}

/// A way for vehicles of any size.
pub(crate) fn way(points: &[[f32; 2]], length: f64, width: f64) -> Way {
    Way::whole(points.to_vec(), Kind::Car, Size { length, width }, 0)
}

/// The site of `ways`, with the tolerance that a junction has unless it is told another.
pub(crate) fn site(ways: &[Way], order: Option<Vec<usize>>) -> Site {
    Site::new(ways, 0.1, order).expect("the controller takes this site")
}

/// A right-angle crossing: east on the first lane, north on the second one.
pub(crate) fn crossing(order: Option<Vec<usize>>) -> Site {
    let east = car_way(&[[-90.0, 0.0], [90.0, 0.0]]);
    let north = car_way(&[[0.0, -90.0], [0.0, 90.0]]);
    site(&[east, north], order)
}

/// A vehicle at `s` (m) with `v` (m/s), commands in effect as late as allowed.
pub(crate) fn car(lane: usize, s: f64, v: f64, driver: Driver) -> Car {
    Car {
        lane,
        start: State { s, v },
        acceleration: 0.0,
        driver,
        cap: 15.0,
        takeover: Takeover::Random,
        sway: Sway::default(),
    }
}

/// A driver behind the shield, from the start.
pub(crate) fn shielded(proposer: Proposer) -> Driver {
    Driver::Shielded {
        proposer,
        from: 0,
        before: Manner::Coast,
    }
}

/// A scenario of `seconds`.
pub(crate) fn setup<'s>(
    site: &'s Site,
    contract: Contract,
    cars: Vec<Car>,
    seconds: f64,
    seed: u64,
) -> Setup<'s> {
    Setup {
        site,
        contract,
        cars,
        ticks: (seconds / cede_attack::motion::TICK) as u64,
        sensing: Sensing::PLAIN,
        outside: Outside::NOT,
        seed,
    }
}

/// Plays `count` scenarios.
pub(crate) fn search<'s>(count: u64, make: impl Fn(u64, &mut Rng) -> Setup<'s> + Sync) -> Tally {
    let one = |seed| {
        let setup = make(seed, &mut Rng::new(seed));
        Tally::of(seed, &play::<Sound>(&setup, false))
    };
    let seeds = (0..count).into_par_iter();
    seeds.map(one).reduce(Tally::default, Tally::plus)
}

/// Asserts that nothing was wrong, in at least so many scenarios that began with verified plans.
pub(crate) fn assert_held(tally: &Tally, scenarios: u64) {
    assert!(tally.case.is_none(), "{tally:?}");
    assert!(tally.scenarios >= scenarios, "vacuous: {tally:?}");
}

/// A vehicle as exact sensors see it.
pub(crate) fn sensed(site: &Site, lane: usize, s: f64, v: f64) -> Vehicle {
    let place = site.lanes[lane].line.place(s);
    Vehicle {
        s: s as f32,
        speed: v as f32,
        pose: Pose {
            position: Point::new(place.at[0] as f32, place.at[1] as f32),
            direction: unit(place.to[0] as f32, place.to[1] as f32),
        },
    }
}
