//! The C interface decides what the Rust interface decides, bit for bit, on the golden scenes of `firmware/cortex-m`.

mod common;
#[path = "../../cortex-m/golden/src/random.rs"]
mod random;
#[path = "../../cortex-m/golden/src/traffic.rs"]
mod traffic;

use cede::*;
use cede_controller::{Contract, Policy};
use cede_golden::{ANSWER, Golden, HEADER, QUESTION, Question, ROUTE, VEHICLE, answer};
use common::{OK, World, no_decision};
use random::Random;
use std::ptr::null_mut;
use traffic::Traffic;

/// Scenes with 1 to 8 others in turn and every third one under the worst-case contract, and their steps of 0.1 s.
const SCENES: usize = 192;
const STEPS: usize = 60;

#[test]
fn both_interfaces_decide_the_same() {
    let policy = Policy::new(cede_controller::policy::embedded::words()).unwrap();
    let mut kinds = std::collections::BTreeSet::new();
    for scene in 0..SCENES {
        let mut random = Random::new(1 + scene as u64);
        let mut traffic = Traffic::new(&mut random, 1 + scene % 8);
        let routes: Vec<u32> = traffic.routes().collect();
        let header: [u32; HEADER] = [
            (scene % 8 + 1) as u32,
            0,
            u32::from(!scene.is_multiple_of(3)),
        ];
        let words = [&header, routes.as_slice()].concat();
        let golden = Golden::next(&mut words.as_slice()).unwrap();
        let junction = golden.junction().unwrap();
        let mut rust = golden.approach(&policy, &junction).unwrap();
        let contract = match scene % 3 {
            0 => Contract::WORST_CASE,
            _ => Contract::ALL_WAY_STOP,
        };
        let mut c = world(routes.as_chunks().0, &contract);
        for step in 0..STEPS {
            let asked = traffic.observe(&mut random);
            let question = Question::new(&asked);
            // A driver of its own, now and then.
            let most = (step % 4 == 3).then(|| random.within(3.0));
            let by_rust = match most {
                None => rust.decide(question.now, &question.observation()),
                Some(most) => rust.decide_up_to(question.now, &question.observation(), most),
            };
            let (ego, tracks) = observed(&asked);
            let seen = cede_observation {
                ego,
                tracks: tracks.as_ptr(),
                track_count: tracks.len() as u32,
            };
            let (status, by_c) = match most {
                None => c.decide(question.now.micros(), &seen),
                Some(most) => up_to(&mut c, question.now.micros(), most, &seen),
            };
            assert_eq!(status, OK);
            assert_eq!(
                words_of(&by_c),
                answer(&by_rust),
                "scene {scene}, step {step}"
            );
            kinds.insert((
                by_c.cause as u8,
                by_c.reason.kind as u8,
                by_c.fallback.kind as u8,
            ));
            traffic.advance(&mut random, by_c.acceleration);
        }
    }
    // Policy, shield and fallback, each in several ways: the comparison is of something.
    assert!(kinds.len() >= 6, "{kinds:?}");
}

/// The golden junction, by C.
fn world(routes: &[[u32; ROUTE]], contract: &Contract) -> Box<World> {
    let mut world = World::empty();
    // SAFETY: as the header says.
    unsafe {
        assert_eq!(cede_junction_init(&mut world.junction), OK);
        for [length, width, right, priority, line, count, points @ ..] in routes {
            let [length, width, line] = [length, width, line].map(|&word| f32::from_bits(word));
            let points = points.as_chunks().0.iter();
            let points: Vec<cede_point> = points
                .take(*count as usize)
                .map(|&[x, y]| point(x, y))
                .collect();
            let mut path = 0;
            let status = cede_junction_add_path(
                &mut world.junction,
                points.as_ptr(),
                points.len() as u32,
                CEDE_CLASS_CAR,
                &cede_footprint { length, width },
                &mut path,
                null_mut(),
            );
            assert_eq!(status, OK);
            let (junction, priority) = (&raw mut world.junction, *priority as u8);
            let _of_itself_is_refused = match right {
                1 => cede_junction_set_priority(junction, 0, path, priority, null_mut()),
                2 => cede_junction_set_priority(junction, path, 0, priority, null_mut()),
                _ => OK,
            };
            let _none_is_refused = cede_junction_set_line(junction, path, line, null_mut());
        }
        assert_eq!(cede_junction_build(&mut world.junction, null_mut()), OK);
    }
    assert_eq!(world.drive(&plain(contract)), OK);
    assert_eq!(world.enter(0), OK);
    world
}

fn up_to(
    world: &mut World,
    now_us: u64,
    most: f32,
    seen: &cede_observation,
) -> (cede_status, cede_decision) {
    let mut decision = no_decision();
    // SAFETY: as the header says.
    let status = unsafe {
        cede_approach_decide_up_to(&mut world.approach, now_us, most, seen, &mut decision)
    };
    (status, decision)
}

/// What the golden words say.
fn observed([_, vehicles @ ..]: &[u32; QUESTION]) -> (cede_vehicle, Vec<cede_track>) {
    let (ego, others) = vehicles.as_chunks::<VEHICLE>().0.split_first().unwrap();
    let others = (1_u8..).zip(others).filter(|(_, words)| words[0] != 0);
    let tracks = others.map(|(number, words)| {
        let vehicle = vehicle(words);
        let mut track = cede_track {
            number: 1000 - 7 * u16::from(number),
            candidate_count: 1,
            speed: vehicle.speed,
            pose: vehicle.pose,
            ..cede_track::default()
        };
        track.candidates[0].s = vehicle.s;
        track.candidates[0].path = number;
        track
    });
    (vehicle(ego), tracks.collect())
}

fn vehicle(&[_, s, speed, x, y, dx, dy]: &[u32; VEHICLE]) -> cede_vehicle {
    cede_vehicle {
        s: f32::from_bits(s),
        speed: f32::from_bits(speed),
        pose: cede_pose {
            position: point(x, y),
            direction: point(dx, dy),
        },
    }
}

fn point(x: u32, y: u32) -> cede_point {
    let [x, y] = [x, y].map(f32::from_bits);
    cede_point { x, y }
}

/// The words of `cede_golden::answer`, from C's numbers.
fn words_of(decision: &cede_decision) -> [u32; ANSWER] {
    let mut words = vec![decision.acceleration.to_bits(), decision.margin.to_bits()];
    words.extend(cause(decision));
    words.extend(fault(&decision.fault));
    words.push(decision.has_plan.into());
    *words.last_mut().unwrap() += u32::from(decision.plan_go);
    words.push(match decision.has_unwatched {
        0 => 0,
        _ => 1 + u32::from(decision.unwatched),
    });
    words.extend([decision.breach as u32, decision.breach_track.into()]);
    let prediction = &decision.prediction;
    words.extend(match decision.has_prediction {
        0 => [0; 3],
        _ => [
            1 + u32::from(prediction.other),
            prediction.svo.to_bits(),
            prediction.acceleration.to_bits(),
        ],
    });
    words.try_into().unwrap()
}

fn cause(decision: &cede_decision) -> [u32; 5] {
    let reason = &decision.reason;
    match decision.cause {
        cede_cause::Policy => [0; 5],
        cede_cause::Shielded => [
            [0, 1, 4][decision.action as usize] + reason.kind as u32 - 1,
            reason.other.into(),
            reason.available.to_bits(),
            reason.needed.to_bits(),
            0,
        ],
        cede_cause::Fallback => {
            let [kind, subject, field, value] = fault(&decision.fallback);
            [10 + kind, subject, field, value, 0]
        }
        other => panic!("{other:?}"),
    }
}

fn fault(fault: &cede_fault) -> [u32; 4] {
    match fault.kind {
        cede_fault_kind::None => [0; 4],
        cede_fault_kind::NoPlan => [1, 0, 0, 0],
        cede_fault_kind::Proposal => [2, 0, 0, 0],
        cede_fault_kind::Backwards => [3, 0, 0, 0],
        cede_fault_kind::OffPeriod => [4, fault.value.to_bits(), fault.high.to_bits(), 0],
        cede_fault_kind::Input => {
            let subject = match fault.subject {
                cede_subject::Ego => 0,
                _ => 1 + u32::from(fault.track),
            };
            let value = if fault.value.is_nan() {
                f32::NAN
            } else {
                fault.value
            };
            [5, subject, fault.field as u32 - 1, value.to_bits()]
        }
        cede_fault_kind::Other => panic!("{fault:?}"),
    }
}
