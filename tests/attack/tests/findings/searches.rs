//! Findings that a search has to fail to repeat.

use crate::stage::{assert_held, car, car_way, search, setup, shielded, site, way};
use cede_attack::audit::{Heading, uncovered};
use cede_attack::error::Shape;
use cede_attack::human::Manner;
use cede_attack::proposer::Proposer;
use cede_attack::rng::Rng;
use cede_attack::setup::{Driver, Setup};
use cede_attack::sight::Sensing;
use cede_attack::site::Site;
use cede_controller::{Contract, EnterError, PathId, Shield};

fn erring(place: f32, speed: f32) -> Contract {
    let builder = Contract::builder().position_error(place).speed_error(speed);
    builder.build().unwrap()
}

/// A vehicle whose route has no zone with the ego's comes and goes in the observation, sensors err.
#[test]
fn e01_a_bystander_that_blinks_voids_no_plan() {
    let east = car_way(&[[-60.0, 0.0], [80.0, 0.0]]);
    let north = car_way(&[[0.0, -80.0], [0.0, 80.0]]);
    let aside = car_way(&[[-80.0, 30.0], [80.0, 30.0]]);
    let site = site(&[east, north, aside], None);
    assert!(site.areas(0, 2).is_empty());
    for error in [0.0, 0.1, 0.3, 0.6] {
        let tally = search(1200, |seed, rng| {
            let manner = rng
                .pick(&[&Manner::Aim, &Manner::Lurk, &Manner::Rush])
                .clone();
            let cars = vec![
                car(
                    0,
                    rng.within(0.0, 45.0),
                    rng.within(0.0, 12.0),
                    shielded(Proposer::Full),
                ),
                car(
                    1,
                    rng.within(0.0, 70.0),
                    rng.within(0.0, 12.0),
                    Driver::Human(manner),
                ),
                car(2, 40.0, 0.0, Driver::Human(Manner::Stand)),
            ];
            let mut setup = setup(&site, erring(error, error), cars, 15.0, seed);
            setup.sensing = Sensing {
                blinking: true,
                shape: Some(rng.pick(&[Shape::Extreme, Shape::Held])),
                ..Sensing::PLAIN
            };
            setup
        });
        assert_held(&tally, 800);
    }
}

/// The leader brakes hard, and sensors show both nearer to and farther from each other than they are.
fn behind<'s>(
    site: &'s Site,
    length: f64,
    contract: Contract,
) -> impl Fn(u64, &mut Rng) -> Setup<'s> {
    move |seed, rng| {
        let error = f64::from(contract.position_error());
        let gap = length + 0.3 + rng.within(0.0, 20.0) + 4.0 * error;
        let leader = rng
            .pick(&[&Manner::Bang, &Manner::BrakeCheck, &Manner::Random])
            .clone();
        let cars = vec![
            car(0, 20.0, rng.within(0.0, 6.0), shielded(Proposer::Full)),
            car(0, 20.0 + gap, rng.within(0.0, 8.0), Driver::Human(leader)),
        ];
        let mut setup = setup(site, contract, cars, 20.0, seed);
        setup.sensing.shape = Some(rng.pick(&[Shape::Held, Shape::Constant, Shape::Extreme]));
        setup
    }
}

/// Behind a leader, short vehicles, errors as large as the contract allows: either refused or safe.
#[test]
fn e02_behind_a_leader_errors_of_position_are_refused_or_safe() {
    for (length, error) in [(2.1, 0.3), (2.1, 0.9), (4.2, 2.0), (5.0, 2.4)] {
        let lane = site(&[way(&[[0.0, 0.0], [200.0, 0.0]], length, 0.8)], None);
        let tally = search(600, behind(&lane, length, erring(error, 0.0)));
        assert_held(&tally, 400);
    }
    for (length, error) in [(2.1, 1.2), (5.0, 3.0)] {
        let lane = site(&[way(&[[0.0, 0.0], [200.0, 0.0]], length, 0.8)], None);
        let entered = Shield::<8>::enter(erring(error, 0.0), &*lane.junctions[0], PathId::new(0));
        assert!(matches!(entered, Err(EnterError::PositionError { value, .. }) if value == error));
    }
}

/// A vehicle turns at a kink as vehicles do: its heading is that of a chord. Either the kink is refused, or the zones
/// cover that, too.
#[test]
fn e09_kinks_are_refused_or_covered() {
    let front_page = [
        [-40.0, -2.0],
        [-6.0, -2.0],
        [0.0, 0.0],
        [2.0, 6.0],
        [2.0, 40.0],
    ];
    let corner = [[-40.0, 0.0], [0.0, 0.0], [0.0, 40.0]];
    let beside = |x: f32| [[x, 40.0], [x, -40.0]];
    let mut cases = vec![(front_page.to_vec(), [[40.0, 2.0], [-40.0, 2.0]], 4.6)];
    for x in [1.9, 2.3, 2.8, 3.2] {
        cases.push((corner.to_vec(), beside(x), 5.0));
    }
    for x in [3.4, 4.0, 5.0] {
        cases.push((corner.to_vec(), beside(x), 12.0));
    }
    let mut rng = Rng::new(9);
    for (turning, straight, length) in cases {
        let ways = [way(&turning, length, 2.0), way(&straight, length, 2.0)];
        let Ok(site) = Site::new(&ways, 0.1, None) else {
            continue;
        };
        for heading in [
            Heading::Lane,
            Heading::Chord(0.5),
            Heading::Chord(1.5),
            Heading::Chord(3.0),
        ] {
            let gap = uncovered(&site, (0, 1), heading, 3000, &mut rng);
            assert!(
                gap.is_none(),
                "{turning:?} {straight:?} {heading:?}: {gap:?}"
            );
        }
    }
}

/// Two shielded vehicles that want to go as fast as they can, and have no limiter.
#[test]
fn e12_without_limiters_nobody_is_accused_and_no_plan_is_lost() {
    let site = crate::stage::crossing(None);
    let tally = search(1200, |seed, rng| {
        let mut cars: Vec<_> = (0..2)
            .map(|lane| {
                let proposer = rng.pick(&[Proposer::Full, Proposer::Random]);
                car(
                    lane,
                    rng.within(5.0, 70.0),
                    rng.within(8.0, 15.0),
                    shielded(proposer),
                )
            })
            .collect();
        for car in &mut cars {
            car.cap = f64::INFINITY;
        }
        setup(&site, Contract::WORST_CASE, cars, 15.0, seed)
    });
    assert_held(&tally, 600);
}
