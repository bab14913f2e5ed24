//! What is claimed of the embedded policy, and that the verifier finds fault with worse ones.

use cede_controller::policy::embedded;
use cede_controller::policy::weights::Draft;
use cede_controller::{Policy, Weights};
use cede_data::Dataset;
use cede_formats::property::{Claim, Place, Properties, Setting, StateProperty};
use cede_sim::ObservationModel;
use cede_train::run::{Algorithm, Lessons, Run};
use cede_verify::policy::{Finding, Subject};
use std::time::{Duration, Instant};

fn properties() -> Vec<StateProperty> {
    let text = include_str!("../../docs/safety/policy.toml");
    Properties::read(text).unwrap().property
}

/// The embedded policy with each layer's biases and weights (input by input) changed.
fn changed(change: impl Fn(usize, &mut [f32], &mut [f32])) -> Vec<u32> {
    let weights = Weights::parse(embedded::words()).unwrap();
    let mut parameters = Vec::new();
    let mut width = 0;
    for (number, layer) in weights
        .network()
        .as_f32()
        .unwrap()
        .layers()
        .iter()
        .enumerate()
    {
        let mut biases: Vec<f32> = layer.biases().collect();
        let mut columns: Vec<f32> = layer.weights().collect();
        change(number, &mut biases, &mut columns);
        width = width.max(biases.len());
        parameters.extend(biases);
        parameters.extend(columns);
    }
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
    draft.encode(&mut words).unwrap();
    words
}

/// A policy that has learned to drive a little, but nothing of what is claimed.
fn unclaimed(seed: u64) -> Vec<u32> {
    let dataset = Dataset::synthetic(40, seed);
    let models: Vec<ObservationModel<'_>> = dataset
        .encounters
        .iter()
        .map(ObservationModel::new)
        .collect();
    let lessons = Lessons {
        courses: Vec::new(),
        own: models.len(),
        models,
        claims: Vec::new(),
    };
    let short = "updates = 60\nbatch = 32\nwidth = 32\nhorizon = 10\nlast_horizon = 10";
    let settings = Algorithm::Apg.settings();
    let settings = settings
        .with(&short.parse::<toml::Table>().unwrap())
        .unwrap();
    let mut run = Run::new(settings, &lessons, seed);
    while run.advance().is_some() {}
    run.view().weights([0; 32]).unwrap()
}

/// Whether the controller breaks the claim at the witness, when it is run there.
fn breaks(words: &[u32], claim: Claim, setting: &Setting, place: Place) -> bool {
    let policy = Policy::new(words).unwrap();
    let a = |place: Place| f64::from(policy.act(&setting.pair(place))[0]);
    let slope = |variable: cede_formats::property::Variable| {
        let mut moved = place;
        moved[variable.index()] += 0.05;
        (a(moved) - a(place)) / 0.05
    };
    match claim {
        Claim::AccelerationAtMost(most) => a(place) > most,
        Claim::AccelerationAtLeast(least) => a(place) < least,
        Claim::RisesAtLeast { with, slope: least } => slope(with) < least,
        Claim::ChangesAtMost { with, slope: most } => slope(with).abs() > most,
    }
}

/// The identifiers of the properties that are refuted, each by a witness that holds.
fn refuted(words: &[u32]) -> Vec<String> {
    let subject = Subject::new(Weights::parse(words).unwrap()).unwrap();
    let mut ids = Vec::new();
    for property in properties() {
        let deadline = Instant::now() + Duration::from_secs(1);
        let settled = subject.settle(&property, deadline, false);
        if let Finding::Refuted { state, setting, .. } = settled.finding {
            assert!(
                breaks(words, property.claim, &setting, state),
                "{}: {state:?}",
                property.id
            );
            ids.push(property.id);
        }
    }
    ids
}

#[test]
fn every_property_of_the_embedded_policy_is_proved() {
    let subject = Subject::new(Weights::parse(embedded::words()).unwrap()).unwrap();
    for property in properties() {
        let deadline = Instant::now() + Duration::from_secs(300);
        let settled = subject.settle(&property, deadline, false);
        assert_eq!(settled.finding, Finding::Proved, "{}", property.id);
    }
}

#[test]
fn worse_policies_are_refuted_by_witnesses_that_hold_when_they_are_run() {
    let flipped = changed(|layer, biases, columns| {
        if layer == 3 {
            biases.iter_mut().chain(columns).for_each(|x| *x = -*x);
        }
    });
    let mirrored = changed(|layer, _, columns| {
        if layer == 0 {
            columns.iter_mut().for_each(|x| *x = -*x);
        }
    });
    let steep = changed(|layer, _, columns| {
        if layer == 3 {
            columns.iter_mut().for_each(|x| *x *= 4.0);
        }
    });
    for (name, words) in [
        ("sign of the last layer", flipped),
        ("sign of the inputs", mirrored),
        ("four times as steep", steep),
        ("seed 1 without claims", unclaimed(1)),
        ("seed 2 without claims", unclaimed(2)),
        ("seed 3 without claims", unclaimed(3)),
    ] {
        let ids = refuted(&words);
        println!("{name}: {ids:?}");
        assert!(!ids.is_empty(), "{name}");
    }
}
