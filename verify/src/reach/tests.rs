use super::*;
use crate::policy::Subject;
use cede_controller::geometry::{UnitVector, unit};
use cede_controller::kinematics::{State, advance};
use cede_controller::policy::embedded;
use cede_controller::policy::weights::Draft;
use cede_controller::{
    Contract, Drive, Instant, Observation, Part, Point, Policy, Pose, Track, Vehicle, Weights,
};
use cede_formats::property::Right;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn scenario() -> Scenario {
    Scenario {
        id: "SR-00".to_owned(),
        title: "for the test".to_owned(),
        ego_distance: [5.0, 7.0],
        ego_speed: [3.0, 4.0],
        other_distance: [12.0, 16.0],
        other_speed: [3.0, 5.0],
        other_acceleration: [-1.0, 1.0],
        right_of_way: Right::Unsettled,
        controls: Default::default(),
        policy: true,
        shield: true,
        claim: Claim::NeverBoth { during: 6.0 },
    }
}

fn subject(words: &[u32]) -> Subject<'_> {
    Subject::new(Weights::parse(words).expect("a sound file")).expect("features of the state")
}

/// States of the two (distance, speed) as the real controller drives them.
fn drive(scenario: &Scenario, from: [f32; 4], random: &mut Pcg64, steps: usize) -> Vec<[f64; 4]> {
    let junction = geometry(&scenario.setting());
    let conflict = junction.conflict(EGO, OTHER).expect("two paths");
    let policy = Policy::new(embedded::words()).expect("a sound file");
    let drive = Drive::new(policy, Contract::WORST_CASE, Part::Left);
    let mut approach = drive.enter_with_room::<1, _, _, _>(&junction, EGO);
    let approach = approach.as_mut().expect("a path to enter by");
    let mut ego = State {
        s: conflict.ego_conflict - from[0],
        v: from[1],
    };
    let mut other = State {
        s: conflict.other_conflict - from[2],
        v: from[3],
    };
    let seen = |state: State, direction: UnitVector| Vehicle {
        s: state.s,
        speed: state.v,
        pose: Pose {
            position: Point::from(direction.into_inner() * (state.s - super::scenario::HALF)),
            direction,
        },
    };
    let mut states = Vec::new();
    let [least, most] = scenario.other_acceleration;
    let mut push = random.random_range(least..=most);
    for step in 0..=steps {
        let place = |state: State, conflict: f32| f64::from(conflict) - f64::from(state.s);
        states.push([
            place(ego, conflict.ego_conflict),
            f64::from(ego.v),
            place(other, conflict.other_conflict),
            f64::from(other.v),
        ]);
        let observation = Observation {
            ego: seen(ego, unit(1.0, 0.0)),
            tracks: &[Track::on(7, OTHER, seen(other, unit(0.0, 1.0)))],
        };
        let now = Instant::from_millis(100 * step as u64);
        let command = approach.decide(now, &observation).acceleration;
        ego = advance(ego, command);
        // Now random, now one extreme for a while.
        if random.random::<f32>() < 0.2 {
            let choice = random.random_range(0..3);
            push = [least, most, random.random_range(least..=most)][choice];
        }
        other = advance(other, push as f32);
    }
    states
}

/// The largest amount by which driven states leave the tubes of small boxes around their beginnings.
fn worst_escape(words: &[u32], seen: &Scenario, driven: &Scenario) -> f64 {
    let subject = subject(words);
    let closed = Loop::new(&subject, seen);
    let mut random = Pcg64::seed_from_u64(1);
    let mut worst = f64::NEG_INFINITY;
    for _ in 0..12 {
        let half = [0.2, 0.05, 0.2, 0.05].map(|h| h * random.random::<f64>());
        let centre = seen
            .region()
            .map(|[lo, hi]| lo + (hi - lo) * random.random::<f64>());
        let region = std::array::from_fn(|i| [centre[i] - half[i], centre[i] + half[i]]);
        let tube = closed.tube(region, 45);
        for _ in 0..20 {
            let from: [f32; 4] = std::array::from_fn(|i| {
                let [lo, hi] = region[i];
                (lo + (hi - lo) * random.random::<f64>()).clamp(lo + 1e-5, hi - 1e-5) as f32
            });
            let states = drive(driven, from, &mut random, 45);
            for (state, moment) in states.iter().zip(&tube.moments) {
                for (x, [lo, hi]) in state.iter().zip(moment) {
                    worst = worst.max(lo - x).max(x - hi);
                }
            }
        }
    }
    worst
}

#[test]
fn the_controller_stays_within_its_tubes() {
    for (right_of_way, distance) in [
        (Right::Unsettled, [5.0, 7.0]),
        (Right::Other, [10.0, 20.0]),
        (Right::Ego, [0.0, 9.0]),
    ] {
        let scenario = Scenario {
            right_of_way,
            ego_distance: distance,
            ..scenario()
        };
        let worst = worst_escape(embedded::words(), &scenario, &scenario);
        assert!(worst <= 1e-4, "{right_of_way:?}: {worst} m or m/s");
    }
}

#[test]
fn planted_unsound_tubes_are_caught() {
    let honest = scenario();
    // The other is taken to keep its speed.
    let constant = Scenario {
        other_acceleration: [0.0, 0.0],
        ..honest.clone()
    };
    assert!(worst_escape(embedded::words(), &constant, &honest) > 0.1);
    // The last bias of the network is taken to be larger by 0.05.
    let weights = Weights::parse(embedded::words()).expect("a sound file");
    let mut parameters = Vec::new();
    let (mut width, mut last) = (0, 0);
    for layer in weights.network().as_f32().expect("f32").layers() {
        width = width.max(layer.biases().len());
        last = parameters.len();
        parameters.extend(layer.biases().chain(layer.weights()));
    }
    parameters[last] += 0.05;
    let (centres, scales): (Vec<f32>, Vec<f32>) = weights.normalisation().unzip();
    let draft = Draft {
        features: weights.features(),
        perspective: weights.perspective(),
        width,
        provenance: [0; 32],
        centres: &centres,
        scales: &scales,
        parameters: &parameters,
    };
    let mut words = vec![0; draft.words()];
    draft.encode(&mut words).expect("it fits");
    assert!(worst_escape(&words, &honest, &honest) > 0.01);
}

#[test]
fn files_of_scenarios_are_read_or_refused_with_a_reason() {
    let text = include_str!("../../../docs/safety/reach.toml");
    assert!(Scenarios::read(text).is_ok());
    for (from, to) in [
        ("[38, 60]", "[60, 38]"),
        ("[0, 15]", "[0, 99]"),
        ("during = 30", "during = 3000"),
        ("never_both", "never_three"),
        ("[-0.5, 0.5]", "[-0.5, 5]"),
        ("at_least = 1", "at_least = nan"),
    ] {
        assert!(Scenarios::read(&text.replace(from, to)).is_err(), "{to}");
    }
}
