//! Exported policies do elsewhere what they do in the controller.

use cede_controller::policy::weights::Draft;
use cede_controller::{FeatureSet, Mlp, Pair, Part, Perspective, Policy, Weights};
use cede_data::Dataset;
use cede_formats::onnx;
use cede_sim::ObservationModel;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The bar: accelerations agree to this, in m/s².
const CLOSE: f64 = 1e-5;

/// What left-turners of synthetic encounters see, every third time with distances and speeds far beyond
/// what the policy's normalisation reaches.
fn pairs() -> Vec<Pair> {
    let dataset = Dataset::synthetic(20, 3);
    let mut random = Pcg64::seed_from_u64(4);
    let models: Vec<_> = dataset
        .encounters
        .iter()
        .map(ObservationModel::new)
        .collect();
    let seen = models
        .iter()
        .flat_map(ObservationModel::recorded)
        .step_by(2);
    let changed = seen.step_by(7).enumerate().map(|(i, mut pair)| {
        assert_eq!(pair.part, Part::Left);
        if i % 3 == 0 {
            for vehicle_state in [&mut pair.ego, &mut pair.other] {
                vehicle_state.distance *= random.random_range(1.0..100.0);
                vehicle_state.speed *= random.random_range(1.0..20.0);
            }
        }
        pair
    });
    changed.take(1000).collect()
}

/// The embedded policy, and one with random numbers for each set of features.
fn policies() -> Vec<Vec<u32>> {
    let mut policies = vec![cede_controller::policy::embedded::words().to_vec()];
    let mut random = Pcg64::seed_from_u64(5);
    for (features, width) in FeatureSet::ALL.into_iter().zip([16, 64, 80, 128]) {
        let inputs = features.count();
        let mut draw = |n: usize, range: std::ops::Range<f32>| -> Vec<f32> {
            (0..n).map(|_| random.random_range(range.clone())).collect()
        };
        let draft = Draft {
            features,
            perspective: Perspective::Joint,
            width,
            provenance: [1; 32],
            centres: &draw(inputs, -5.0..5.0),
            scales: &draw(inputs, 0.05..0.3),
            parameters: &draw(Mlp::words(inputs, width), -0.2..0.2),
        };
        let mut words = vec![0; draft.words()];
        draft.encode(&mut words).unwrap();
        policies.push(words);
    }
    policies
}

/// The features that the policy is told, raw.
fn features(weights: &Weights<'_>, pair: &Pair) -> Vec<f32> {
    weights.features().of(pair)[..weights.features().count()].to_vec()
}

fn assert_close(policy: &Policy<'_>, pair: &Pair, elsewhere: [f64; 2]) {
    for (here, there) in policy.act(pair).into_iter().zip(elsewhere) {
        let features = policy.weights().features();
        let difference = (f64::from(here) - there).abs();
        assert!(difference < CLOSE, "{features:?}: {here} and {there}");
    }
}

#[test]
fn the_verifier_reads_the_export_as_the_controller_drives_it() {
    let pairs = pairs();
    for words in policies() {
        let policy = Policy::new(&words).unwrap();
        let bytes = onnx::export(policy.weights()).unwrap();
        let network = cede_nnv_check::onnx::read(&bytes).unwrap();
        for pair in pairs.iter().step_by(10) {
            let raw = features(policy.weights(), pair);
            let raw: Vec<f64> = raw.into_iter().map(f64::from).collect();
            let given = network.run(&raw).values;
            assert_close(&policy, pair, [given[0], given[1]]);
        }
    }
}

/// A Python that has onnxruntime: `CEDE_PYTHON`, or `.build/python` in the repository, or `python3`.
fn python() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.build/python/bin/python");
    let named = std::env::var_os("CEDE_PYTHON").map(PathBuf::from);
    let mut candidates = named.into_iter().chain([beside, "python3".into()]);
    candidates.find(|python| {
        let asked = Command::new(python)
            .args(["-c", "import numpy, onnxruntime"])
            .output();
        asked.is_ok_and(|answer| answer.status.success())
    })
}

#[test]
fn onnxruntime_gives_the_controllers_accelerations() {
    let Some(python) = python() else {
        cede_tests::skip("onnxruntime (CEDE_PYTHON)");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let [model, told, given] = ["model.onnx", "told", "given"].map(|name| folder.path().join(name));
    let pairs = pairs();
    for words in policies() {
        let policy = Policy::new(&words).unwrap();
        let rows = pairs.iter().flat_map(|p| features(policy.weights(), p));
        let rows: Vec<u8> = rows.flat_map(f32::to_le_bytes).collect();
        std::fs::write(&model, onnx::export(policy.weights()).unwrap()).unwrap();
        std::fs::write(&told, rows).unwrap();
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/run_policy.py");
        let mut run = Command::new(&python);
        let status = run.arg(script).args([&model, &told, &given]).status();
        assert!(status.unwrap().success());
        let bytes = std::fs::read(&given).unwrap();
        let actions = bytes.as_chunks::<4>().0.as_chunks::<2>().0;
        assert_eq!(actions.len(), pairs.len());
        for (pair, action) in pairs.iter().zip(actions) {
            let action = action.map(|bytes| f64::from(f32::from_le_bytes(bytes)));
            assert_close(&policy, pair, action);
        }
    }
}
