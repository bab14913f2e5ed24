//! A policy that does not drive is caught, and the message says what to change.

use cede_controller::policy::weights::Draft;
use cede_controller::{Contract, FeatureSet, Mlp, Perspective, Policy};
use cede_testing::{Report, Suite};

/// A policy that always proposes `3 tanh(output)` m/s²: all weights are 0, and all biases but the last layer's.
fn constant(output: f32) -> Vec<u32> {
    let features = FeatureSet::Raw;
    let (inputs, width) = (features.count(), 16);
    let count = Mlp::words(inputs, width);
    let mut parameters = vec![0.0; count];
    // The last layer: four biases, then its weights.
    let last = count - (4 + 4 * width);
    parameters[last..last + 2].fill(output);
    let draft = Draft {
        features,
        perspective: Perspective::Ego,
        width,
        provenance: [0; 32],
        centres: &vec![0.0; inputs],
        scales: &vec![0.1; inputs],
        parameters: &parameters,
    };
    let mut words = vec![0; draft.words()];
    draft.encode(&mut words).unwrap();
    words
}

fn report(output: f32, ids: &[&str]) -> Report {
    let words = constant(output);
    let suite = Suite::new(Policy::new(&words).unwrap(), Contract::WORST_CASE).cases(40);
    ids.iter().fold(suite, |suite, id| suite.only(id)).run()
}

#[test]
fn one_that_never_moves_is_caught_by_liveness() {
    let report = report(
        -5.0,
        &["policy-answers", "gets-through-courteous", "no-overlap"],
    );
    let stands = report
        .outcome("gets-through-courteous")
        .unwrap()
        .failure()
        .unwrap();
    assert!(stands.message.contains("not through"), "{report}");
    assert!(
        stands
            .mend
            .as_ref()
            .unwrap()
            .contains("train it on more of these, or replace it")
    );
    let same = report.outcome("policy-answers").unwrap().failure().unwrap();
    assert!(
        same.message
            .contains("-3.00 to -3.00 m/s², whatever it sees"),
        "{}",
        same.message
    );
    assert!(
        same.mend
            .as_ref()
            .unwrap()
            .contains("replace the policy file")
    );
    // The shield does not need it.
    assert!(report.outcome("no-overlap").unwrap().failure().is_none());
}

#[test]
fn one_that_always_goes_is_caught_by_its_interventions() {
    let report = report(5.0, &["policy-answers", "comfort", "no-overlap"]);
    assert!(
        report
            .outcome("policy-answers")
            .unwrap()
            .failure()
            .is_some()
    );
    let comfort = report.outcome("comfort").unwrap();
    let (name, share) = &comfort.numbers[0];
    assert_eq!(name, "share of shielded steps");
    assert!(*share > 0.3, "{share}");
    assert!(
        report.outcome("no-overlap").unwrap().failure().is_none(),
        "{report}"
    );
}
