//! Public instances with published verdicts (VNN-COMP). They are not part of the project: without
//! `CEDE_CONFORMANCE_DIR` or `../shared/conformance`, these tests say so and pass.

use cede_nnv::{Answer, Branching, SearchOptions, verify};
use cede_nnv_check::{Certificate, Network, Property, Source, onnx, vnnlib};
use cede_tests::conformance;
use proptest::prelude::*;
use std::path::Path;
use std::time::Duration;

struct Instance {
    name: String,
    network: Network,
    property: Property,
    verdict: String,
}

fn instances(folder: &Path, wanted: impl Fn(&str) -> bool) -> Vec<Instance> {
    let list =
        std::fs::read_to_string(folder.join("instances.csv")).expect("the list of instances");
    let rows = list.lines().skip(1).filter(|line| wanted(line));
    rows.map(|line| {
        let [network, property, verdict, ..] = line.split(',').collect::<Vec<_>>()[..] else {
            panic!("a row of instances.csv: {line}");
        };
        let bytes = std::fs::read(folder.join(network)).expect("the network");
        let text = std::fs::read_to_string(folder.join(property)).expect("the property");
        Instance {
            name: format!("{network} {property}"),
            network: onnx::read(&bytes).expect("a supported network"),
            property: vnnlib::read(&text).expect("a supported property"),
            verdict: verdict.to_owned(),
        }
    })
    .collect()
}

/// Every answer is the published verdict, every witness is in the box and unsafe, and every
/// `wanted` proof convinces the checker.
fn agree(instances: &[Instance], checked: bool) {
    for instance in instances {
        let options = SearchOptions::default().record(checked);
        let report = verify(&instance.network, &instance.property, options).expect("they fit");
        let word = match &report.answer {
            Answer::Unsat => "unsat",
            Answer::Sat(witness) => {
                let violated = |point| instance.property.is_violated(&instance.network, point);
                assert!(violated(witness.point()), "{}", instance.name);
                "sat"
            }
            _ => "unsolved",
        };
        assert_eq!(word, instance.verdict, "{}", instance.name);
        if checked && word == "unsat" {
            let nothing = Source::new(Path::new("n"), &[]);
            let certificate = Certificate::new("p", nothing.clone(), nothing, report.proofs);
            let read = Certificate::from_text(&certificate.to_text()).expect("its own text");
            let regions = read.check_proofs(&instance.network, &instance.property);
            assert!(regions.is_ok(), "{}: {regions:?}", instance.name);
        }
    }
}

#[test]
fn reinforcement_learning_benchmarks_agree_and_their_proofs_are_checked() {
    if let Some(folder) = conformance("rl_benchmarks") {
        agree(&instances(&folder, |_| true), true);
    }
}

/// Two of the eighty take longer than anybody waits when the phases of ReLUs are all that is cut;
/// what matters is that an answer is never the wrong one.
#[test]
fn cutting_across_phases_alone_is_slow_at_times_but_never_wrong() {
    let Some(folder) = conformance("rl_benchmarks") else {
        return;
    };
    for instance in instances(&folder, |_| true) {
        let options = SearchOptions::default()
            .branching(Branching::Phases)
            .timeout(Duration::from_secs(1));
        let report = verify(&instance.network, &instance.property, options).expect("they fit");
        let wrong = match report.answer {
            Answer::Unsat => instance.verdict != "unsat",
            Answer::Sat(_) => instance.verdict != "sat",
            _ => false,
        };
        assert!(!wrong, "{}", instance.name);
    }
}

#[test]
fn collision_avoidance_networks_agree() {
    if let Some(folder) = conformance("acasxu") {
        agree(&instances(&folder, |_| true), false);
    }
}

/// The checker's passes are dense, so this takes minutes even with optimisation:
/// `cargo test --release -p cede-nnv --test conformance -- --ignored`
#[test]
#[ignore = "minutes"]
fn proofs_of_collision_avoidance_networks_are_checked() {
    if let Some(folder) = conformance("acasxu") {
        let easy = |line: &str| {
            line.contains("prop_3") || line.contains("prop_4") || line.contains("run2a_1_1_")
        };
        agree(&instances(&folder, easy), true);
    }
}

#[test]
fn damaged_real_files_are_read_or_refused() {
    let Some(folder) = conformance("rl_benchmarks") else {
        return;
    };
    let network = std::fs::read(folder.join("cartpole.onnx")).expect("the network");
    let property =
        std::fs::read(folder.join("cartpole_case_safe_14.vnnlib")).expect("the property");
    let damage = prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6);
    proptest!(ProptestConfig::with_cases(100), |(damage in damage)| {
        let (mut bytes, mut text) = (network.clone(), property.clone());
        for (at, byte) in damage {
            // The structure is at both ends of the file; the middle is weights.
            let place = at.index(2000);
            let place = if place < 1000 { place } else { bytes.len() - 1 - (place - 1000) };
            bytes[place] = byte;
            let place = at.index(text.len());
            text[place] = byte;
        }
        let _ = onnx::read(&bytes);
        let _ = vnnlib::read(&String::from_utf8_lossy(&text));
    });
}
