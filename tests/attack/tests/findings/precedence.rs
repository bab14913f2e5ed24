//! Findings about who goes first.

use crate::stage::{assert_held, car, crossing, search, sensed, setup, shielded};
use cede_attack::error::Shape;
use cede_attack::human::Manner;
use cede_attack::motion::State;
use cede_attack::proposer::Proposer;
use cede_attack::rng::Rng;
use cede_attack::scenario::Family;
use cede_attack::setup::{Car, Driver};
use cede_attack::sight::Sensing;
use cede_attack::site::Site;
use cede_controller::dangerous::Sound;
use cede_controller::{Cause, Contract, Instant, Observation, PathId, Shield, Track};

fn erring(error: f32) -> Contract {
    let builder = Contract::ALL_WAY_STOP.to_builder().position_error(error);
    builder.build().unwrap()
}

/// One comes to its line slowly or fast, the other rests at its own and goes after a while.
fn at_the_lines(site: &Site, rng: &mut Rng) -> Vec<Car> {
    let arrives = site.line(0) - 12.0;
    let slowly = Proposer::Speed {
        wanted: rng.within(0.5, 8.0),
    };
    let waits = Proposer::Waits {
        periods: rng.below(60) as u32,
    };
    let near = rng.within(0.5, 13.0);
    vec![
        car(
            0,
            arrives - rng.within(0.5, 13.0),
            rng.within(2.0, 8.0),
            shielded(slowly),
        ),
        car(
            1,
            arrives - near + 1.0,
            rng.within(0.0, 0.3 * near),
            shielded(waits),
        ),
    ]
}

/// A controller that comes from another intersection, and one that has been at this one for a while. A shield borrows its
/// junction, so that none can be kept: see the crate's front page.
#[test]
fn e03_each_intersection_has_an_approach_of_its_own() {
    let row = Family::named("row").unwrap();
    let tally = row.campaign::<Sound>(0, 192);
    assert_held(&tally, 120);
    assert!(tally.through > tally.shielded / 2, "{tally:?}");
}

/// The two see each other differently at their lines, by 2 cm or more, always or by turns.
#[test]
fn e05_two_shields_that_see_different_things_never_both_go() {
    for error in [0.0, 0.02, 0.3] {
        for order in [None, Some(vec![1, 0]), Some(vec![0, 1])] {
            let site = crossing(order);
            let tally = search(500, |seed, rng| {
                let cars = at_the_lines(&site, rng);
                let mut setup = setup(&site, erring(error), cars, 22.0, seed);
                setup.sensing.shape =
                    Some(rng.pick(&[Shape::Constant, Shape::Alternating, Shape::Held]));
                setup
            });
            assert_held(&tally, 300);
        }
    }
}

/// One shield is switched on while its vehicle coasts or stands.
#[test]
fn e06_a_shield_that_starts_late_takes_nothing() {
    let site = crossing(Some(vec![1, 0]));
    let tally = search(2000, |seed, rng| {
        let mut cars = at_the_lines(&site, rng);
        cars[1].driver = Driver::Shielded {
            proposer: Proposer::Full,
            from: 100 + rng.below(600) as u64,
            before: rng.pick(&[&Manner::Coast, &Manner::Stand]).clone(),
        };
        setup(&site, Contract::ALL_WAY_STOP, cars, 22.0, seed)
    });
    assert_held(&tally, 1200);
}

/// A track is missing from single observations.
#[test]
fn e07_a_missing_track_gives_nothing_away() {
    let site = crossing(Some(vec![1, 0]));
    for gaps in [0.01, 0.2] {
        let tally = search(1000, |seed, rng| {
            let cars = at_the_lines(&site, rng);
            let mut setup = setup(&site, Contract::ALL_WAY_STOP, cars, 22.0, seed);
            setup.sensing = Sensing {
                gaps,
                ..Sensing::PLAIN
            };
            setup
        });
        assert_held(&tally, 600);
    }
}

/// The ego has waited for five seconds at its line; somebody appears `away` m from its own, at 6 m/s.
fn goes_first(away: f64) -> bool {
    let site = crossing(None);
    let mut shield =
        Shield::<8>::enter(Contract::ALL_WAY_STOP, &*site.junctions[0], PathId::new(0)).unwrap();
    let (line, other_line) = (site.line(0), site.line(1));
    let mut ego = State {
        s: line - 14.0,
        v: 3.0,
    };
    for period in 0..80 {
        let wants = if ego.s < line - 3.0 { 0.0 } else { -2.0 };
        let observation = Observation {
            ego: sensed(&site, 0, ego.s, ego.v),
            tracks: &[],
        };
        let decision = shield.filter(Instant::from_millis(period * 100), &observation, wants);
        ego = ego.after(decision.acceleration.into(), 0.1, 15.0);
    }
    assert!(ego.v == 0.0 && ego.s < line, "it does not wait: {ego:?}");
    let track = Track::on(7, PathId::new(1), sensed(&site, 1, other_line - away, 6.0));
    let observation = Observation {
        ego: sensed(&site, 0, ego.s, ego.v),
        tracks: &[track],
    };
    let decision = shield.filter(Instant::from_millis(8000), &observation, 3.0);
    decision.cause == Cause::Policy && decision.acceleration == 3.0
}

#[test]
fn e15_a_newcomer_takes_no_precedence_away() {
    for away in [14.0, 15.0, 16.0, 20.0, 30.0] {
        assert!(goes_first(away), "somebody {away} m away");
    }
}
