//! The verifier against oracles that share nothing with it: enumeration of all activation
//! patterns by linear programmes, and dense sampling.

mod cases;
mod corners;
mod differential;
mod oracle;

use super::propagation::{Prepared, Workspace};
use super::relaxation::Lines;
use super::*;
use cede_nnv_check::check::{CheckError, check};
use cede_nnv_check::proof::{Split, Tightening};
use cede_nnv_check::{Activation, Halfspace, InputBox, Layer, Matrix, Query};
use microlp::{ComparisonOp, LinearExpr, OptimizationDirection, Problem, SolveOutcome};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn number(random: &mut Pcg64) -> f64 {
    2.0 * random.random::<f64>() - 1.0
}

fn network(random: &mut Pcg64, widths: &[usize], last: Activation) -> Network {
    let mut layers = Vec::new();
    for (k, pair) in widths.windows(2).enumerate() {
        let weights = (0..pair[0] * pair[1])
            .map(|_| 1.5 * number(random))
            .collect();
        layers.push(Layer {
            weights: Matrix::from_rows(pair[1], pair[0], weights).expect("sizes fit"),
            bias: (0..pair[1]).map(|_| 0.5 * number(random)).collect(),
            activation: if k + 2 == widths.len() {
                last
            } else {
                Activation::Relu
            },
            uncertainty: 0.0,
        });
    }
    Network::new(widths[0], layers).expect("layers fit")
}

fn region(random: &mut Pcg64, inputs: usize) -> InputBox {
    let centre: Vec<f64> = (0..inputs).map(|_| number(random)).collect();
    let radius: Vec<f64> = (0..inputs).map(|_| 0.1 + random.random::<f64>()).collect();
    InputBox {
        lower: centre.iter().zip(&radius).map(|(c, r)| c - r).collect(),
        upper: centre.iter().zip(&radius).map(|(c, r)| c + r).collect(),
    }
}

/// The least t such that some input has coefficients · y ≤ bound + t for all atoms: the smallest
/// over all activation patterns, a linear programme each.
fn least_violation(network: &Network, region: &InputBox, atoms: &[Halfspace]) -> f64 {
    let relus: usize = network
        .layers()
        .iter()
        .filter(|l| l.activation == Activation::Relu)
        .map(Layer::outputs)
        .sum();
    let mut least = f64::INFINITY;
    for pattern in 0_u32..1 << relus {
        let mut lp = Problem::new(OptimizationDirection::Minimize);
        let t = lp.add_var(1.0, (-1e6, 1e6));
        let x: Vec<_> = region
            .lower
            .iter()
            .zip(&region.upper)
            .map(|(&l, &u)| lp.add_var(0.0, (l, u)))
            .collect();
        // Every neuron as an affine form of x.
        let mut forms: Vec<(Vec<f64>, f64)> = (0..x.len())
            .map(|i| {
                (
                    (0..x.len()).map(|j| f64::from(u8::from(i == j))).collect(),
                    0.0,
                )
            })
            .collect();
        let mut relu = 0;
        for layer in network.layers() {
            let affine = |row: &[f64], bias: f64| {
                let sum = |j: usize| row.iter().zip(&forms).map(|(w, f)| w * f.0[j]).sum();
                (
                    (0..x.len()).map(sum).collect::<Vec<f64>>(),
                    bias + row.iter().zip(&forms).map(|(w, f)| w * f.1).sum::<f64>(),
                )
            };
            forms = (0..layer.outputs())
                .map(|i| affine(layer.weights.row(i), layer.bias[i]))
                .collect();
            if layer.activation != Activation::Relu {
                continue;
            }
            for form in &mut forms {
                let on = pattern >> relu & 1 == 1;
                let mut z = LinearExpr::empty();
                x.iter().zip(&form.0).for_each(|(x, c)| z.add(*x, *c));
                lp.add_constraint(
                    z,
                    if on {
                        ComparisonOp::Ge
                    } else {
                        ComparisonOp::Le
                    },
                    -form.1,
                );
                if !on {
                    *form = (vec![0.0; x.len()], 0.0);
                }
                relu += 1;
            }
        }
        for atom in atoms {
            let mut excess = LinearExpr::empty();
            for (j, x) in x.iter().enumerate() {
                excess.add(
                    *x,
                    atom.coefficients()
                        .iter()
                        .zip(&forms)
                        .map(|(a, f)| a * f.0[j])
                        .sum(),
                );
            }
            excess.add(t, -1.0);
            let constant: f64 = atom
                .coefficients()
                .iter()
                .zip(&forms)
                .map(|(a, f)| a * f.1)
                .sum();
            lp.add_constraint(excess, ComparisonOp::Le, atom.bound() - constant);
        }
        if let Ok(SolveOutcome::Solution(solution)) = lp.solve() {
            least = least.min(solution.objective());
        }
    }
    least
}

fn shifted(region: &InputBox, atoms: &[Halfspace], by: f64) -> Property {
    let atoms: Vec<_> = atoms
        .iter()
        .map(|a| Halfspace::new(a.coefficients().to_vec(), a.bound() + by))
        .collect();
    let outputs = atoms[0].coefficients().len();
    let query = Query::new(region.clone(), vec![atoms]);
    Property {
        inputs: region.lower.len(),
        outputs,
        queries: vec![query],
    }
}

#[test]
fn agrees_with_the_enumeration_of_all_patterns() {
    let mut random = Pcg64::seed_from_u64(1);
    for round in 0..24 {
        let widths: &[usize] = if round % 2 == 0 {
            &[2, 4, 3, 2]
        } else {
            &[3, 3, 2, 2, 2]
        };
        let network = network(&mut random, widths, Activation::Identity);
        let region = region(&mut random, widths[0]);
        let atom = |random: &mut Pcg64| {
            Halfspace::new(vec![number(random), number(random)], number(random))
        };
        let atoms: Vec<_> = (0..1 + round % 3).map(|_| atom(&mut random)).collect();
        let least = least_violation(&network, &region, &atoms);
        for branching in [Branching::Inputs, Branching::Phases] {
            let options = SearchOptions {
                branching,
                record: true,
                seed: round as u64,
                ..SearchOptions::default()
            };
            let verdict = |by: f64| {
                verify(&network, &shifted(&region, &atoms, by), options).expect("shapes fit")
            };
            let proved = verdict(least - 1e-4);
            assert_eq!(
                proved.answer,
                Answer::Unsat,
                "round {round}, {branching:?}, least violation {least}"
            );
            let query = &shifted(&region, &atoms, least - 1e-4).queries[0];
            assert!(
                check(&network, query, &proved.proofs[0]).is_ok(),
                "round {round}, {branching:?}"
            );
            let refuted = verdict(least + 1e-4).answer;
            assert!(
                matches!(refuted, Answer::Sat(_)),
                "round {round}, {branching:?}, {refuted:?}, least violation {least}"
            );
        }
    }
}

/// The largest amount by which a sampled neuron or atom leaves its bounds on random boxes.
fn worst_escape(spoil: impl Fn(&mut Network), enclose: Option<fn(f64, f64) -> Lines>) -> f64 {
    let mut random = Pcg64::seed_from_u64(2);
    let mut worst = f64::NEG_INFINITY;
    for last in [Activation::Identity, Activation::Tanh, Activation::Relu] {
        for _ in 0..20 {
            let network = network(&mut random, &[3, 8, 8, 6, 2], last);
            let region = region(&mut random, 3);
            let mut seen_by_prover = network.clone();
            spoil(&mut seen_by_prover);
            let mut prepared = Prepared::new(&seen_by_prover, &[]);
            prepared.enclose = enclose.unwrap_or(prepared.enclose);
            let mut bounds = vec![(f64::NEG_INFINITY, f64::INFINITY); prepared.neurons];
            if Workspace::default()
                .bound(&prepared, &region, &[], &mut bounds, &[], &[], None)
                .is_err()
            {
                return f64::INFINITY;
            }
            for _ in 0..500 {
                let x: Vec<f64> = (0..3)
                    .map(|i| {
                        region.lower[i]
                            + random.random::<f64>() * (region.upper[i] - region.lower[i])
                    })
                    .collect();
                let (mut values, mut neuron) = (x, 0);
                for layer in network.layers() {
                    let z = |i: usize| {
                        layer.bias[i]
                            + layer
                                .weights
                                .row(i)
                                .iter()
                                .zip(&values)
                                .map(|(w, v)| w * v)
                                .sum::<f64>()
                    };
                    let pre: Vec<f64> = (0..layer.outputs()).map(z).collect();
                    if layer.activation != Activation::Identity {
                        for z in &pre {
                            worst = worst.max(bounds[neuron].0 - z).max(z - bounds[neuron].1);
                            neuron += 1;
                        }
                    }
                    values = pre.into_iter().map(|z| layer.activation.apply(z)).collect();
                }
            }
        }
    }
    worst
}

#[test]
fn sampled_neurons_lie_within_their_bounds() {
    assert!(worst_escape(|_| (), None) <= 1e-12);
}

#[test]
fn planted_unsound_bounds_are_caught() {
    // The slope of the upper line is the mirrored one.
    let swapped: fn(f64, f64) -> Lines = |l, u| Lines {
        upper_slope: -l / (u - l),
        upper_offset: 0.0,
        ..Lines::relu(l, u)
    };
    assert!(worst_escape(|_| (), Some(swapped)) > 0.01);
    // The lower line is the upper one.
    let raised: fn(f64, f64) -> Lines = |l, u| Lines {
        lower_offset: Lines::relu(l, u).upper_offset,
        ..Lines::relu(l, u)
    };
    assert!(worst_escape(|_| (), Some(raised)) > 0.01);
    // One bias is dropped.
    let drop = |network: &mut Network| {
        let mut layers = network.layers().to_vec();
        layers[1].bias[0] = 0.0;
        *network = Network::new(3, layers).expect("still fits");
    };
    assert!(worst_escape(drop, None) > 0.01);
}

#[test]
fn the_same_seed_gives_the_same_answer_on_any_number_of_threads() {
    let mut random = Pcg64::seed_from_u64(3);
    let network = network(&mut random, &[4, 12, 12, 2], Activation::Identity);
    let region = region(&mut random, 4);
    let atoms = [Halfspace::new(vec![1.0, -1.0], -2.0)];
    for by in [-1.0, 0.0, 1.0, 2.0] {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            let options = SearchOptions {
                record: true,
                ..SearchOptions::default()
            };
            pool.install(|| verify(&network, &shifted(&region, &atoms, by), options))
        };
        assert_eq!(on(1), on(3));
    }
}

#[test]
fn the_checker_refuses_what_is_not_a_proof() {
    let mut random = Pcg64::seed_from_u64(4);
    let network = network(&mut random, &[3, 8, 8, 2], Activation::Identity);
    let region = region(&mut random, 3);
    let atoms = [Halfspace::new(vec![1.0, 0.5], 0.0)];
    // Bisection for a property that only just holds, so that the proof has many regions.
    let (mut holds, mut fails) = (-100.0, 100.0);
    let options = SearchOptions {
        record: true,
        ..SearchOptions::default()
    };
    let verdict =
        |by| verify(&network, &shifted(&region, &atoms, by), options).expect("shapes fit");
    while fails - holds > 1e-4 {
        let middle = 0.5 * (holds + fails);
        *(if verdict(middle).answer == Answer::Unsat {
            &mut holds
        } else {
            &mut fails
        }) = middle;
    }
    let query = |by| shifted(&region, &atoms, by).queries.remove(0);
    let proof = verdict(holds).proofs.remove(0);
    assert!(proof.cells.len() > 10, "{} regions", proof.cells.len());
    assert_eq!(
        check(&network, &query(holds), &proof),
        Ok(proof.cells.len())
    );
    assert!(
        check(&network, &query(fails + 1e-3), &proof).is_err(),
        "a property that does not hold"
    );

    let leaf = proof
        .cells
        .iter()
        .rposition(|c| c.split.is_none())
        .expect("a leaf");
    let mut forgotten = proof.clone();
    forgotten.cells[leaf].refuted.clear();
    assert!(matches!(
        check(&network, &query(holds), &forgotten),
        Err(CheckError::Unproved { .. })
    ));
    let mut empty = proof.clone();
    empty.cells[leaf].empty = true;
    assert!(matches!(
        check(&network, &query(holds), &empty),
        Err(CheckError::Malformed { .. })
    ));
    let mut negative = proof.clone();
    negative.cells[leaf].refuted[0].weights[0] = -1.0;
    assert!(matches!(
        check(&network, &query(holds), &negative),
        Err(CheckError::Malformed { .. })
    ));
    let mut steep = proof.clone();
    steep.cells[0].tightened.push(Tightening {
        neuron: 8,
        upper: false,
        multipliers: Vec::new(),
        slopes: vec![(0, 1.5)],
    });
    assert!(matches!(
        check(&network, &query(holds), &steep),
        Err(CheckError::Malformed { .. })
    ));
    let mut forgotten = proof.clone();
    forgotten.cells[leaf].split = Some((Split::Conjunction { index: 0 }, 1 << 20));
    forgotten.cells[leaf].refuted.clear();
    assert!(
        check(&network, &query(holds), &forgotten).is_err(),
        "the children are missing"
    );
    let mut circular = proof.clone();
    let inner = circular
        .cells
        .iter()
        .position(|c| c.split.is_some())
        .expect("a split");
    circular.cells[inner].split = circular.cells[inner].split.map(|(split, _)| (split, 0));
    assert!(matches!(
        check(&network, &query(holds), &circular),
        Err(CheckError::Malformed { .. })
    ));
    let mut other_bias = network.layers().to_vec();
    other_bias[0].bias[0] += 1.0;
    let other = Network::new(3, other_bias).expect("still fits");
    assert!(
        check(&other, &query(holds), &proof).is_err(),
        "another network"
    );
}
