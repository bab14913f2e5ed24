use super::search::region;
use super::*;
use cede_controller::policy::weights::Draft;
use cede_controller::{ConflictKind, Control, Mlp, Policy, RightOfWay};
use cede_formats::property::{Claim, Kind, Right, StateProperty, Variable};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::time::{Duration, Instant};

const WIDTH: usize = 16;

/// The words of a weights file with these parameters, normalised as a trained one might be.
fn file(features: FeatureSet, parameters: &[f32]) -> Vec<u32> {
    drafted(features, parameters, |draft, words| {
        draft.encode(words).expect("a draft that fits");
    })
}

/// The same in integers.
fn file_i16(features: FeatureSet, parameters: &[f32]) -> Vec<u32> {
    drafted(features, parameters, |draft, words| {
        draft
            .encode_i16([12, 10, 8, 7], words)
            .expect("a draft that fits");
    })
}

fn drafted(
    features: FeatureSet,
    parameters: &[f32],
    encode: impl FnOnce(&Draft<'_>, &mut [u32]),
) -> Vec<u32> {
    let count = features.count();
    let all_scales = [
        0.05, 0.1, 0.05, 0.1, 0.2, 0.2, 0.6, 0.05, 0.05, 1.0, 1.0, 1.0, 1.0, 1.0, 0.1, 0.1, 0.1,
        0.1, 0.1, 1.0, 1.0, 1.0,
    ];
    let all_centres = [
        20.0, 5.0, 20.0, 5.0, 4.0, 4.0, 0.8, 15.0, 15.0, 0.5, 0.5, 0.0, 0.0, 0.0, 20.0, 5.0, 20.0,
        5.0, 5.0, 0.0, 0.0, 0.0,
    ];
    let draft = Draft {
        features,
        perspective: Perspective::Ego,
        width: WIDTH,
        provenance: [0; 32],
        centres: &all_centres[..count],
        scales: &all_scales[..count],
        parameters,
    };
    let mut words = vec![0; 4000];
    let length = {
        encode(&draft, &mut words);
        words.iter().rposition(|&w| w != 0).map_or(0, |i| i + 1)
    };
    words.truncate(length);
    words
}

fn random_file(features: FeatureSet, seed: u64) -> Vec<u32> {
    file(features, &random_parameters(features, seed))
}

fn random_parameters(features: FeatureSet, seed: u64) -> Vec<f32> {
    let mut random = Pcg64::seed_from_u64(seed);
    (0..Mlp::words(features.count(), WIDTH))
        .map(|_| 0.7 * (2.0 * random.random::<f32>() - 1.0))
        .collect()
}

/// A policy whose mean is gain·(1 + the normalised other's distance) − 1.
fn yielding(gain: f32) -> Vec<u32> {
    let inputs = FeatureSet::Route.count();
    let mut parameters = vec![0.0; Mlp::words(inputs, WIDTH)];
    let (first, hidden) = ((inputs + 1) * WIDTH, (WIDTH + 1) * WIDTH);
    parameters[0] = 1.0;
    parameters[WIDTH + 2 * WIDTH] = 1.0;
    parameters[first + WIDTH] = 1.0;
    parameters[first + hidden + WIDTH] = 1.0;
    parameters[first + 2 * hidden] = -1.0;
    parameters[first + 2 * hidden + 4] = gain;
    file(FeatureSet::Route, &parameters)
}

fn property(claim: Claim) -> StateProperty {
    StateProperty {
        id: "SR-00".to_owned(),
        title: "for the test".to_owned(),
        ego_distance: [5.0, 25.0],
        ego_speed: [0.0, 8.0],
        other_distance: [4.0, 12.0],
        other_speed: [3.0, 9.0],
        conflicts: vec![Kind::Crossing],
        right_of_way: vec![Right::Other, Right::Unsettled],
        turns: vec![[0.5, 0.0]],
        controls: vec![[Control::Unknown; 2]],
        claim,
    }
}

fn settle(file: &[u32], claim: Claim) -> Settled {
    let weights = Weights::parse(file).expect("a sound file");
    let subject = Subject::new(weights).expect("route features");
    subject.settle(
        &property(claim),
        Instant::now() + Duration::from_secs(60),
        true,
    )
}

/// Least and most acceleration over random states of the test's region.
fn sampled(file: &[u32]) -> (f64, f64) {
    let policy = Policy::new(file).expect("a sound file");
    let mut random = Pcg64::seed_from_u64(9);
    let property = property(Claim::AccelerationAtMost(0.0));
    let region = region(&property);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for setting in property.settings() {
        for _ in 0..20_000 {
            let state = std::array::from_fn(|i| {
                region.lower[i] + random.random::<f64>() * (region.upper[i] - region.lower[i])
            });
            let a = f64::from(policy.act(&setting.pair(state))[0]);
            (least, most) = (least.min(a), most.max(a));
        }
    }
    (least, most)
}

#[test]
fn bounds_on_the_acceleration_are_proved_and_refuted() {
    for (seed, features) in [
        (1, FeatureSet::Route),
        (2, FeatureSet::Traffic),
        (3, FeatureSet::Route),
    ] {
        let file = random_file(features, seed);
        let (least, most) = sampled(&file);
        for (claim, holds) in [
            (Claim::AccelerationAtMost(most + 0.5), true),
            (Claim::AccelerationAtMost(most - 0.05), false),
            (Claim::AccelerationAtLeast(least - 0.5), true),
            (Claim::AccelerationAtLeast(least + 0.05), false),
            (Claim::AccelerationAtMost(3.0), true),
        ] {
            let settled = settle(&file, claim);
            match settled.finding {
                Finding::Proved => {
                    assert!(holds, "{claim:?}, sampled {least} to {most}");
                    assert!(settled.checked > 0, "the checker went over it");
                }
                Finding::Refuted { acceleration, .. } => {
                    assert!(!holds, "{claim:?}, {acceleration}");
                }
                Finding::Unsettled => panic!("{claim:?}, sampled {least} to {most}: {settled:?}"),
            }
        }
    }
}

#[test]
fn a_policy_that_yields_is_told_from_one_with_a_flipped_sign() {
    let with = Variable::OtherDistance;
    // Normalised, 4 to 12 m are −0.8 to −0.4: the mean is −0.8 to −0.4.
    let (good, bad) = (yielding(1.0), yielding(-1.0));
    for claim in [
        Claim::AccelerationAtMost(-1.1),
        Claim::RisesAtLeast { with, slope: 0.0 },
        Claim::ChangesAtMost { with, slope: 0.16 },
        Claim::ChangesAtMost {
            with: Variable::EgoSpeed,
            slope: 1e-6,
        },
    ] {
        assert_eq!(settle(&good, claim).finding, Finding::Proved, "{claim:?}");
    }
    let refuted =
        |file: &[u32], claim| matches!(settle(file, claim).finding, Finding::Refuted { .. });
    assert!(refuted(&bad, Claim::RisesAtLeast { with, slope: 0.0 }));
    assert!(refuted(&good, Claim::AccelerationAtMost(-1.3)));
    assert!(refuted(&good, Claim::ChangesAtMost { with, slope: 0.05 }));
}

#[test]
fn a_policy_of_integers_stays_within_its_departure() {
    let limit = Duration::from_millis(800);
    for seed in 1..=2 {
        let parameters = random_parameters(FeatureSet::Rights, seed);
        let floats = file(FeatureSet::Rights, &parameters);
        let integers = file_i16(FeatureSet::Rights, &parameters);
        let weights = |file| Weights::parse(file).expect("a sound file");
        let subject = Subject::new(weights(&floats)).expect("features of the state");
        let property = property(Claim::AccelerationAtMost(0.0));
        let properties = std::slice::from_ref(&property);
        let found = subject.departure(weights(&integers), properties, 0.01, limit);
        let found = found.expect("its own");
        assert!(
            found.sampled > 0.0 && found.sampled <= found.bound,
            "{found:?}"
        );
        let mut random = Pcg64::seed_from_u64(seed);
        let region = region(&property);
        for setting in property.settings() {
            for _ in 0..5_000 {
                let state = std::array::from_fn(|i| {
                    region.lower[i] + random.random::<f64>() * (region.upper[i] - region.lower[i])
                });
                let pair = setting.pair(state);
                let of = |file| f64::from(Policy::from(weights(file)).act(&pair)[0]);
                let apart = (of(&floats) - of(&integers)).abs();
                assert!(apart <= found.bound, "{apart} at {state:?}, {found:?}");
            }
        }
        // Of another policy nothing small is proved, and one in f32 is none of integers.
        let mut others = parameters.clone();
        // The bias of the first output.
        let bias = others.len() - (WIDTH + 1) * 4;
        others[bias] += 0.5;
        let others = file_i16(FeatureSet::Rights, &others);
        let far = subject.departure(weights(&others), properties, 0.01, limit);
        assert!(far.expect("of the same shape").bound > found.bound);
        let none = subject.departure(weights(&floats), properties, 0.01, limit);
        assert_eq!(none, Err(NotItsOwn::NotIntegers));
        assert_eq!(
            Subject::new(weights(&integers)).err(),
            Some(Unsupported::Integers)
        );
    }
}

#[test]
fn the_papers_raw_features_are_refused() {
    let file = random_file(FeatureSet::Raw, 1);
    assert!(Subject::new(Weights::parse(&file).expect("a sound file")).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Whatever the box, the features that the controller computes lie within their enclosure.
    #[test]
    fn the_controllers_features_lie_within_their_enclosure(
        low in [-20.0..40.0, 0.0..10.0, -20.0..40.0, 0.0..10.0],
        width in [0.0..10.0, 0.0..3.0, 0.0..10.0, 0.0..3.0],
        at in prop::collection::vec([0.0..=1.0, 0.0..=1.0, 0.0..=1.0, 0.0..=1.0], 8),
        set in prop::sample::select(vec![FeatureSet::Route, FeatureSet::Traffic, FeatureSet::Rights]), stopped in any::<bool>(), fine in any::<bool>(),
    ) {
        let file = random_file(set, 5);
        let weights = Weights::parse(&file).expect("a sound file");
        let subject = Subject::new(weights).expect("route features");
        let setting = Setting { kind: ConflictKind::Merging, right_of_way: RightOfWay::Ego, turns: [0.25, -0.5], controls: [Control::Yield, Control::Stop] };
        let single = |x: f64| f64::from(x as f32);
        let factor = if fine { 0.01 } else { 1.0 };
        let lower: Vec<f64> = (0..4).map(|i| if stopped && i % 2 == 1 { 0.0 } else { single(low[i]) }).collect();
        let upper: Vec<f64> = (0..4).map(|i| single(lower[i] + factor * width[i]).max(lower[i])).collect();
        let region = InputBox { lower, upper };
        let features = subject.features(&region, &setting);
        for share in at {
            let state: [f64; 4] = std::array::from_fn(|i| {
                single(region.lower[i] + share[i] * (region.upper[i] - region.lower[i])).clamp(region.lower[i], region.upper[i])
            });
            let inputs = Policy::from(weights).inputs(&setting.pair(state));
            for (k, (enclosed, input)) in features.iter().zip(inputs).enumerate() {
                let feature = &enclosed.feature;
                let linear: f64 = feature.constant + feature.slopes.iter().zip(&state).map(|(s, x)| s * x).sum::<f64>();
                let off = (f64::from(input) - linear).abs();
                prop_assert!(off <= feature.radius + 1e-12, "feature {k}: {input} is {off} off, radius {}", feature.radius);
            }
        }
    }
}
