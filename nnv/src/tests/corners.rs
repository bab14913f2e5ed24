//! Corners of floating-point arithmetic, one by one: networks and properties that an answer by
//! rounded numbers gets wrong, or never comes to.

use super::cases;
use super::oracle::{Dense, Problem};
use crate::{Answer, Branching, SearchOptions, Witness, verify};
use cede_nnv_check::proof::{Cell, Proof, Refutation};
use cede_nnv_check::{Certificate, Network, Property, Source, check, onnx, vnnlib};
use std::path::Path;
use std::time::{Duration, Instant};

/// A network of layers (weights by output, biases), with ReLUs between them.
fn network(inputs: usize, layers: &[(&[&[f64]], &[f64])]) -> Network {
    let layer = |(index, (weights, bias)): (usize, &(&[&[f64]], &[f64]))| Dense {
        weights: weights.iter().map(|row| row.to_vec()).collect(),
        bias: bias.to_vec(),
        relu: index + 1 < layers.len(),
    };
    let problem = Problem {
        inputs,
        layers: layers.iter().enumerate().map(layer).collect(),
        clauses: Vec::new(),
    };
    onnx::read(&cases::onnx(&problem, false, &[])).expect("a supported network")
}

/// y = x.
fn identity() -> Network {
    network(1, &[(&[&[1.0]], &[0.0])])
}

/// y = relu(x).
fn relu() -> Network {
    network(1, &[(&[&[1.0]], &[0.0]), (&[&[1.0]], &[0.0])])
}

/// Declarations for a network, and these assertions.
fn property(network: &Network, assertions: &[&str]) -> Property {
    let declared = |name: char, count: usize| -> String {
        (0..count)
            .map(|i| format!("(declare-const {name}_{i} Real)"))
            .collect()
    };
    let asserted: String = assertions.iter().map(|a| format!("(assert {a})")).collect();
    let text = declared('X', network.inputs()) + &declared('Y', network.outputs()) + &asserted;
    vnnlib::read(&text).expect("a supported property")
}

fn answer(network: &Network, assertions: &[&str]) -> Answer {
    let property = property(network, assertions);
    let options = SearchOptions::default()
        .timeout(Duration::from_secs(10))
        .record(true);
    let report = verify(network, &property, options).expect("they fit");
    if report.answer == Answer::Unsat {
        let nothing = Source::new(Path::new("n"), &[]);
        let certificate = Certificate::new("p", nothing.clone(), nothing, report.proofs);
        let checked = certificate.check_proofs(network, &property);
        assert!(checked.is_ok(), "{checked:?}");
    }
    if let Answer::Sat(witness) = &report.answer {
        assert!(property.is_violated(network, witness.point()));
    }
    report.answer
}

fn is_unsat(network: &Network, assertions: &[&str]) -> bool {
    answer(network, assertions) == Answer::Unsat
}

fn is_sat(network: &Network, assertions: &[&str]) -> bool {
    matches!(answer(network, assertions), Answer::Sat(_))
}

#[test]
fn sums_of_constants_are_exact() {
    let y = identity();
    // 1e16 + 1 − 1e16 is 1, and not 0: x ≤ 1, and x ≤ 0 and x ≥ ½ at once otherwise.
    assert!(is_sat(
        &y,
        &[
            "(>= X_0 0.5)",
            "(<= (+ X_0 1e16 -1 -1e16) 0)",
            "(>= Y_0 0.875)"
        ]
    ));
    assert!(is_sat(
        &y,
        &["(>= X_0 0.5)", "(<= X_0 1)", "(<= (+ Y_0 1e30 -1 -1e30) 0)"]
    ));
    assert!(is_unsat(
        &y,
        &["(>= X_0 2)", "(<= X_0 3)", "(<= (+ Y_0 1e30 -1 -1e30) 0)"]
    ));
    // The coefficient of Y_0 is 1, and not 0.
    let twice = "(<= (+ (* 1e20 Y_0) Y_0 (* -1e20 Y_0)) 1)";
    assert!(is_unsat(&y, &["(>= X_0 2)", "(<= X_0 3)", twice]));
}

#[test]
fn decimals_are_not_rounded() {
    let y = identity();
    let tenth = ["(>= X_0 0.1)", "(<= X_0 0.1)"];
    assert!(is_sat(&y, &[tenth[0], tenth[1], "(= Y_0 0.1)"]));
    assert!(is_unsat(&y, &[tenth[0], tenth[1], "(> Y_0 0.1)"]));
    assert!(is_unsat(&y, &[tenth[0], tenth[1], "(< Y_0 0.1)"]));
    // The float next to 0.1 is above it.
    let float = "0.1000000000000000055511151231257827";
    assert!(is_unsat(
        &y,
        &[tenth[0], tenth[1], &format!("(>= Y_0 {float})")]
    ));
    assert!(is_sat(
        &y,
        &["(>= X_0 0.1)", &format!("(<= X_0 {float})"), "(> Y_0 0.1)"]
    ));
    let third = "(>= (* 3 X_0) 1)";
    assert!(is_unsat(&y, &[third, "(<= X_0 1)", "(< (* 3 Y_0) 1)"]));
    assert!(is_sat(&y, &[third, "(<= X_0 1)", "(<= (* 3 Y_0) 1)"]));
}

#[test]
fn strict_inequalities_are_not_closed() {
    let y = relu();
    let unit = ["(>= X_0 0)", "(<= X_0 1)"];
    assert!(is_sat(&y, &[unit[0], unit[1], "(<= Y_0 0)"]));
    assert!(is_unsat(&y, &[unit[0], unit[1], "(< Y_0 0)"]));
    assert!(is_sat(&y, &[unit[0], unit[1], "(>= Y_0 1)"]));
    assert!(is_unsat(&y, &[unit[0], unit[1], "(> Y_0 1)"]));
    assert!(is_unsat(&y, &["(> X_0 0)", unit[1], "(<= Y_0 0)"]));
    assert!(is_unsat(&y, &[unit[0], "(< X_0 1)", "(>= Y_0 1)"]));
    assert!(is_sat(&y, &[unit[0], "(< X_0 1)", "(>= Y_0 0.999999)"]));
    assert!(is_unsat(
        &y,
        &["(> X_0 0.25)", "(< X_0 0.25)", "(<= Y_0 9)"]
    ));
    assert!(is_unsat(
        &y,
        &["(>= X_0 0.25)", "(< X_0 0.25)", "(<= Y_0 9)"]
    ));
    assert!(is_sat(&y, &["(> X_0 0)", "(< X_0 1e-320)", "(> Y_0 0)"]));
}

#[test]
fn products_that_underflow_are_accounted_for() {
    // y = x₀·1e-200·1e-200·x₁-free: the product of the weights is lost, the input is huge.
    let tiny = network(
        2,
        &[
            (&[&[1e-180, 1.0], &[0.0, 1.0]], &[0.0, 0.0]),
            (&[&[1e-150, -1e-150]], &[0.0]),
        ],
    );
    let wide = ["(>= X_0 0)", "(<= X_0 1e305)", "(>= X_1 0)", "(<= X_1 1)"];
    let with = |last: &str| -> Vec<String> {
        wide.iter()
            .copied()
            .chain([last])
            .map(str::to_owned)
            .collect()
    };
    let ask = |last: &str| {
        let all = with(last);
        answer(&tiny, &all.iter().map(String::as_str).collect::<Vec<_>>())
    };
    // At most 1e305·1e-330 = 1e-25.
    assert!(matches!(ask("(>= Y_0 9e-26)"), Answer::Sat(_)));
    assert_eq!(ask("(>= Y_0 2e-25)"), Answer::Unsat);
}

#[test]
fn coefficients_may_have_any_size() {
    let y = identity();
    for size in ["1e-300", "1e-330", "1e-1000", "1e300", "1e1000"] {
        let half = |bound: &str| format!("(<= (* {size} Y_0) (* {size} {bound}))");
        let unit = ["(>= X_0 1)", "(<= X_0 2)"];
        assert!(is_unsat(&y, &[unit[0], unit[1], &half("0.5")]), "{size}");
        assert!(is_sat(&y, &[unit[0], unit[1], &half("1")]), "{size}");
        let mixed = format!("(<= (+ (* {size} Y_0) (* -1 Y_0)) 0)");
        let holds = !size.starts_with("1e-");
        assert_eq!(is_unsat(&y, &[unit[0], unit[1], &mixed]), holds, "{size}");
    }
}

#[test]
fn the_checker_is_not_taken_in_by_weights_that_underflow() {
    // y = −x/16 on [0, 1e38] reaches −1e36; in floats 5e-324 times the weights is 0.
    let y = network(1, &[(&[&[0.25]], &[0.0]), (&[&[-0.25]], &[0.0])]);
    let property = property(&y, &["(>= X_0 0)", "(<= X_0 1e38)", "(<= Y_0 -1e36)"]);
    for weight in [5e-324, 1e-310, 1e-160, 1.0, 1e160, 1e308] {
        let cell = Cell {
            refuted: vec![Refutation {
                conjunction: 0,
                weights: vec![weight],
                multipliers: Vec::new(),
                slopes: Vec::new(),
                bound: 5e-324,
            }],
            ..Cell::default()
        };
        let proof = Proof { cells: vec![cell] };
        assert!(
            check::check(&y, &property.queries[0], &proof).is_err(),
            "{weight}"
        );
    }
    assert!(is_sat(
        &y,
        &["(>= X_0 0)", "(<= X_0 1e38)", "(<= Y_0 -1e36)"]
    ));
}

#[test]
fn values_that_overflow_prove_nothing() {
    let huge = network(
        2,
        &[
            (&[&[1e300, 0.0], &[0.0, 1e300]], &[0.0, 0.0]),
            (&[&[1e300, -1e300]], &[0.0]),
        ],
    );
    let unit = ["(>= X_0 1)", "(<= X_0 2)", "(>= X_1 1)", "(<= X_1 2)"];
    let ask = |last: &str| answer(&huge, &[unit[0], unit[1], unit[2], unit[3], last]);
    assert!(matches!(ask("(>= Y_0 1e300)"), Answer::Sat(_)));
    assert_eq!(ask("(> Y_0 1e601)"), Answer::Unsat);
}

#[test]
fn a_property_may_ask_nothing_of_the_outputs() {
    let y = network(2, &[(&[&[1.0, 0.0], &[0.0, 1.0]], &[0.0, 0.0])]);
    let wide = [
        "(>= X_0 1.5e308)",
        "(<= X_0 1.7e308)",
        "(>= X_1 -1.7e308)",
        "(<= X_1 1.7e308)",
    ];
    assert!(is_sat(&y, &wide));
    assert!(is_sat(
        &y,
        &[wide[0], wide[1], "(> X_1 0.1)", "(< X_1 0.2)"]
    ));
    assert!(is_unsat(
        &y,
        &[wide[0], wide[1], "(> X_1 0.2)", "(< X_1 0.1)"]
    ));
    // Comparisons of constants hold or do not.
    assert!(is_unsat(
        &y,
        &[wide[0], wide[1], wide[2], wide[3], "(< 1 1)"]
    ));
    assert!(is_sat(
        &y,
        &[wide[0], wide[1], wide[2], wide[3], "(<= Y_0 Y_0)"]
    ));
    assert!(is_unsat(&y, &[wide[0], wide[1], wide[2], wide[3], "(or)"]));
}

#[test]
fn a_witness_is_written_as_what_was_evaluated() {
    let Answer::Sat(witness) = answer(&identity(), &["(= X_0 0.3)", "(>= Y_0 0)"]) else {
        panic!("0.3 is a solution");
    };
    assert_eq!(witness.decimals(), ["0.3"]);
    let text = Answer::Sat(witness).text();
    assert_eq!(text, "sat\n((X_0 0.3)\n(Y_0 0.3))");
    let halves = Witness::near(
        &identity(),
        &property(&identity(), &["(>= X_0 0)", "(<= X_0 1)", "(>= Y_0 0.5)"]).queries[0],
        &[0.75],
    );
    assert_eq!(halves.map(|w| w.decimals()), Some(vec!["0.75".to_owned()]));
}

/// A network on which cutting across the inputs pays and cutting across phases does not: many
/// neurons that bend, and one of fourteen inputs that matters.
fn bent(neurons: usize) -> Network {
    let inputs = 14;
    let first: Vec<Vec<f64>> = (0..neurons)
        .map(|_| (0..inputs).map(|j| f64::from(u8::from(j == 3))).collect())
        .collect();
    let bends: Vec<f64> = (0..neurons)
        .map(|i| -((i as f64 + 0.5) / neurons as f64))
        .collect();
    // The slopes go up and down, so that the sum is a saw.
    let second: Vec<f64> = (0..neurons)
        .map(|i| if i == 0 { 1.0 } else { [2.0, -2.0][i % 2] })
        .collect();
    let first: Vec<&[f64]> = first.iter().map(Vec::as_slice).collect();
    network(inputs, &[(&first, &bends), (&[&second], &[0.0])])
}

#[test]
fn branching_is_chosen_by_what_pays() {
    let saw = bent(60);
    let mut assertions: Vec<String> = (0..14)
        .flat_map(|i| [format!("(>= X_{i} 0)"), format!("(<= X_{i} 1)")])
        .collect();
    assertions.push("(>= Y_0 0.02)".to_owned());
    let assertions: Vec<&str> = assertions.iter().map(String::as_str).collect();
    let property = property(&saw, &assertions);
    let report = |branching| {
        let options = SearchOptions::default()
            .timeout(Duration::from_secs(2))
            .branching(branching);
        verify(&saw, &property, options).expect("they fit")
    };
    assert_eq!(report(Branching::Auto).answer, Answer::Unsat);
    assert_eq!(report(Branching::Auto).branching, Branching::Inputs);
}

#[test]
fn the_timeout_is_kept() {
    // Thousands of boxes, and a threshold so near that each takes a while.
    let saw = bent(200);
    let sides: String = (0..14)
        .filter(|&i| i != 3)
        .map(|i| format!("(>= X_{i} 0)(<= X_{i} 1)"))
        .collect();
    let boxes: String = (0..5000)
        .map(|i| {
            format!(
                "(and {sides}(>= X_3 0.{i:04})(<= X_3 1.{i:04})(>= Y_0 0.0050001)(<= Y_0 0.0051))"
            )
        })
        .collect();
    let property = property(&saw, &[&format!("(or {boxes})")]);
    for millis in [0, 50, 300] {
        let timeout = Duration::from_millis(millis);
        let start = Instant::now();
        let report = verify(&saw, &property, SearchOptions::default().timeout(timeout));
        let taken = start.elapsed();
        assert!(
            taken < timeout + Duration::from_secs(1),
            "{taken:?}, {report:?}"
        );
    }
}
