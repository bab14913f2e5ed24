//! Findings that the interface refuses now.

use crate::stage::{car_way, crossing, sensed, site};
use cede_attack::motion::State;
use cede_attack::plane::separation;
use cede_attack::rng::Rng;
use cede_attack::site::{Refusal, Site};
use cede_controller::policy::embedded;
use cede_controller::{
    Contract, Fault, Field, Instant, JunctionError, NotReady, Observation, PathId, Policy, Shield,
    Subject, Track, Weights, WeightsError,
};

fn shield(site: &Site) -> Shield<'_> {
    Shield::enter(Contract::WORST_CASE, &*site.junctions[0], PathId::new(0)).unwrap()
}

/// The tracker takes each of two vehicles for the other: every track's pose contradicts its arc length.
#[test]
fn e04_a_pose_that_contradicts_the_arc_length_is_refused_and_nobody_is_hit() {
    let east = car_way(&[[-60.0, 0.0], [80.0, 0.0]]);
    let north = car_way(&[[0.0, -80.0], [0.0, 80.0]]);
    let south = car_way(&[[30.0, 80.0], [30.0, -80.0]]);
    let site = site(&[east, north, south], None);
    let (mut verified, mut refused) = (0, 0);
    for seed in 0..1500 {
        let mut rng = Rng::new(seed);
        let mut shield = shield(&site);
        let mut states =
            [(0.0, 30.0, 10.0), (0.0, 60.0, 12.0), (0.0, 60.0, 12.0)].map(|(from, to, fast)| {
                State {
                    s: rng.within(from, to),
                    v: rng.within(0.0, fast),
                }
            });
        for period in 0..120 {
            let [ego, a, b] = states;
            let wrong = |number: u16, lane: usize, other: usize, state: State| {
                let there = sensed(&site, other, state.s, state.v);
                Track::on(number, PathId::new(lane as u8), there)
            };
            let tracks = [wrong(1, 1, 2, b), wrong(2, 2, 1, a)];
            let observation = Observation {
                ego: sensed(&site, 0, ego.s, ego.v),
                tracks: &tracks,
            };
            let decision = shield.filter(Instant::from_millis(100 * period), &observation, 3.0);
            let fault = decision.fault;
            assert!(
                matches!(fault, Some(Fault::Input(input)) if matches!(input.field, Field::Offset | Field::ArcLength | Field::Heading)),
                "{decision:?}"
            );
            refused += 1;
            if period == 0 && decision.plan.is_none() {
                break;
            }
            verified += u64::from(period == 0);
            states[0] = ego.after(decision.acceleration.into(), 0.1, 15.0);
            for state in &mut states[1..] {
                *state = state.after(0.0, 0.1, 15.0);
            }
            let places = [0, 1, 2].map(|lane| site.lanes[lane].line.place(states[lane].s));
            let size = site.lanes[0].size;
            for other in [1, 2] {
                assert!(
                    separation(places[0], size, places[other], size) > 0.0,
                    "seed {seed}"
                );
            }
            if states.iter().any(|state| state.s > 134.0) {
                break;
            }
        }
    }
    assert!(
        verified > 800 && refused > 10_000,
        "vacuous: {verified}, {refused}"
    );
}

/// Beyond the route's end nobody knows what is there.
#[test]
fn e08_arc_lengths_beyond_the_route_are_refused() {
    let site = crossing(None);
    let at = |s: f64| sensed(&site, 0, s, 5.0);
    let refused = |fault: Option<Fault>, subject: Subject| matches!(fault, Some(Fault::Input(input)) if input.subject == subject && input.field == Field::ArcLength);
    for s in [-1.0, 181.0, 300.0] {
        let observation = Observation {
            ego: at(s),
            tracks: &[],
        };
        let ready = shield(&site).ready(Instant::from_millis(0), &observation);
        let Err(NotReady::Fault(fault)) = ready else {
            panic!("{ready:?}")
        };
        assert!(refused(Some(fault), Subject::Ego), "{fault}");
        let track = Track::on(4, PathId::new(1), sensed(&site, 1, s, 5.0));
        let observation = Observation {
            ego: at(20.0),
            tracks: &[track],
        };
        let decision = shield(&site).filter(Instant::from_millis(0), &observation, 3.0);
        assert!(refused(decision.fault, Subject::Track(4)), "{decision}");
    }
}

/// An f32 does not resolve millimetres there.
#[test]
fn e10_long_arc_lengths_are_refused() {
    let long = car_way(&[[-6000.0, 0.0], [60.0, 0.0]]);
    let across = car_way(&[[0.0, -60.0], [0.0, 60.0]]);
    let built = Site::new(&[long, across], 0.1, None);
    assert!(matches!(
        built,
        Err(Refusal::Junction(JunctionError::TooLong { .. }))
    ));
}

/// Contracts for which the theorem says nothing.
#[test]
fn e11_contracts_outside_of_the_theorem_are_refused() {
    let worst = Contract::builder;
    let refused = [
        ("ego.acceleration", worst().other_acceleration(2.0).build()),
        (
            "ego.acceleration",
            worst()
                .ego_acceleration(4.5)
                .other_acceleration(5.0)
                .build(),
        ),
        ("ego.max_speed", worst().ego_max_speed(16.0).build()),
        ("ego.max_speed", worst().ego_max_speed(30.0).build()),
        ("slack", worst().slack(0.0).build()),
        ("latency", worst().latency(1.01).build()),
        ("latency", worst().latency(0.95).jitter(0.01).build()),
        ("jitter", worst().latency(0.0).jitter(0.04).build()),
        (
            "jitter",
            Contract::ALL_WAY_STOP
                .to_builder()
                .latency(0.0)
                .jitter(0.02)
                .build(),
        ),
    ];
    for (field, built) in refused {
        let said = built.unwrap_err().to_string();
        assert!(said.starts_with(field), "{said}");
    }
}

/// What was validated cannot be changed: the fields are private (see the crate's front page), and a changed file is refused.
#[test]
fn e17_weights_cannot_be_changed_after_validation() {
    let words = embedded::words();
    assert!(Policy::new(words).is_ok());
    for word in [2, 3, 20, words.len() - 2] {
        let mut changed = words.to_vec();
        changed[word] ^= 1;
        let refused = Weights::parse(&changed).unwrap_err();
        assert_eq!(refused, WeightsError::Checksum, "word {word}");
    }
}
