//! Verifier, checker and readers against exact arithmetic, on small networks of extreme scales.
//!
//! `CEDE_NETWORKS=100000 cargo test --release -p cede-nnv differential -- --nocapture` tries so
//! many; `CEDE_SEED` is the first seed.

use super::cases::Case;
use crate::propagation::Prepared;
use crate::relaxation::Lines;
use crate::{Answer, Branching, SearchOptions, verify, verify_prepared};
use cede_nnv_check::proof::{Cell, Proof, Refutation, Tightening};
use cede_nnv_check::{
    Activation, Certificate, Halfspace, InputBox, Layer, Matrix, Network, Property, Query, Source,
    check, onnx, vnnlib,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use std::path::Path;
use std::time::{Duration, Instant};

/// What a run over many networks has come to.
#[derive(Debug, Default)]
struct Tally {
    sat: u32,
    unsat: u32,
    /// Neither, as an answer: no mistake.
    open: u32,
    /// Seeds, and what is wrong.
    wrong: Vec<(u64, String)>,
}

impl Tally {
    fn add(mut self, other: Self) -> Self {
        self.sat += other.sat;
        self.unsat += other.unsat;
        self.open += other.open;
        self.wrong.extend(other.wrong);
        self
    }
}

/// A fault to plant.
#[derive(Clone, Copy)]
struct Fault {
    /// In the bounds.
    bounds: fn(&mut Prepared),
    /// In the text of the property, before it is read.
    text: fn(&str) -> String,
}

const SOUND: Fault = Fault {
    bounds: |_| (),
    text: str::to_owned,
};

fn tried(seeds: std::ops::Range<u64>, fault: Fault) -> Tally {
    let all = seeds.into_par_iter().map(|seed| one(seed, fault));
    all.reduce(Tally::default, Tally::add)
}

/// One network: the answer and its evidence against the truth.
fn one(seed: u64, fault: Fault) -> Tally {
    let case = Case::new(seed);
    let mut tally = Tally::default();
    let mut wrong = |what: String| tally.wrong.push((seed, what));
    let network = onnx::read(&case.onnx).expect("a supported network");
    let property = match vnnlib::read(&(fault.text)(&case.vnnlib)) {
        Ok(property) => property,
        Err(error) => {
            wrong(format!("the property is refused: {error}"));
            return tally;
        }
    };
    let truth = case.problem.has_solution();
    let ways = [Branching::Auto, Branching::Inputs, Branching::Phases];
    let options = SearchOptions::default()
        .seed(seed)
        .branching(ways[(seed % 3) as usize]);
    let mut prepared = Prepared::new(&network, &[]);
    prepared.wide = seed % 2 == 1;
    (fault.bounds)(&mut prepared);
    let report = |options| {
        let deadline = Instant::now() + Duration::from_millis(40);
        verify_prepared(&network, &prepared, &property, options, deadline)
    };
    // A prover that records asks the checker, which would hide its own mistakes.
    let alone = report(options);
    match alone.answer {
        Answer::Sat(witness) => {
            tally.sat += 1;
            if !truth || !case.problem.is_solved_by(witness.point()) {
                wrong(format!("sat by {:?}, truly {truth}", witness.decimals()));
            }
        }
        Answer::Unsat => {
            tally.unsat += 1;
            if truth {
                wrong("unsat, but there is a solution".to_owned());
            }
            let recorded = report(options.record(true));
            if recorded.answer == Answer::Unsat {
                let nothing = Source::new(Path::new("n"), &[]);
                let certificate = Certificate::new("p", nothing.clone(), nothing, recorded.proofs);
                let read = Certificate::from_text(&certificate.to_text()).expect("its own text");
                if let Err(error) = read.check_proofs(&network, &property) {
                    wrong(format!("its own certificate is refused: {error}"));
                }
            }
        }
        _ => tally.open += 1,
    }
    if truth && is_believed(&network, &property, seed) {
        wrong("the checker believes a made-up proof".to_owned());
    }
    tally
}

/// Whether made-up claims convince the checker that the property holds.
fn is_believed(network: &Network, property: &Property, seed: u64) -> bool {
    let mut random = Pcg64::seed_from_u64(seed);
    let sizes = [0.0, 5e-324, 1e-300, 1e-30, 0.1, 1.0, 3.0, 1e20, 1e300];
    let mut size = || sizes[random.random_range(0..sizes.len())];
    (0..4).any(|_| {
        property.queries.iter().all(|query| {
            let claim = |(conjunction, atoms): (usize, &Vec<_>)| Refutation {
                conjunction: conjunction as u32,
                weights: atoms.iter().map(|_| size()).collect(),
                multipliers: vec![(0, size())],
                slopes: vec![(0, size().min(1.0)), (1, size().min(1.0))],
                bound: 1.0,
            };
            let refuted = query.unsafe_set.iter().enumerate().map(claim).collect();
            let tightening = |neuron| Tightening {
                neuron,
                upper: seed.is_multiple_of(2),
                multipliers: vec![(0, size())],
                slopes: vec![(0, size().min(1.0)), (1, size().min(1.0))],
            };
            let cell = Cell {
                refuted,
                tightened: (0..4).map(tightening).collect(),
                ..Cell::default()
            };
            let proof = Proof { cells: vec![cell] };
            check::check(network, query, &proof).is_ok()
        })
    })
}

fn from_environment(name: &str, otherwise: u64) -> u64 {
    let value = std::env::var(name).ok().and_then(|v| v.parse().ok());
    value.unwrap_or(otherwise)
}

#[test]
fn differential() {
    let first = from_environment("CEDE_SEED", 0);
    let count = from_environment("CEDE_NETWORKS", 1000);
    let tally = tried(first..first + count, SOUND);
    let Tally {
        sat, unsat, open, ..
    } = tally;
    println!(
        "{count} networks: {sat} sat, {unsat} unsat, {open} open, {} wrong",
        tally.wrong.len()
    );
    assert!(tally.wrong.is_empty(), "{:#?}", tally.wrong);
    let settled = f64::from(sat + unsat) / count as f64;
    assert!(settled > 0.9, "only {settled} of the networks are settled");
}

/// Networks too wide for the oracle, with weights of very different sizes; thresholds are near what
/// sampling finds, so that proofs have many regions.
#[test]
fn the_provers_own_certificates_are_never_refused() {
    let count = from_environment("CEDE_NETWORKS", 1000).div_ceil(10);
    let all: Vec<(u32, Option<String>)> = (0..count).into_par_iter().map(refused).collect();
    let checked: u32 = all.iter().map(|(checked, _)| checked).sum();
    let refused: Vec<_> = all.iter().filter_map(|(_, what)| what.as_ref()).collect();
    println!(
        "{checked} certificates of {count} networks, {} refused",
        refused.len()
    );
    assert!(refused.is_empty(), "{refused:#?}");
}

/// How many certificates for a network were checked, and why one was refused.
fn refused(seed: u64) -> (u32, Option<String>) {
    let mut random = Pcg64::seed_from_u64(seed);
    let widths = [3, 7, 7, 1];
    let exponents = [0, 6, 30, 90][random.random_range(0..4)];
    let mut number = || {
        let exponent = random.random_range(-exponents..=exponents);
        (2.0 * random.random::<f64>() - 1.0) * 10_f64.powi(exponent)
    };
    let mut layers = Vec::new();
    for (index, pair) in widths.windows(2).enumerate() {
        let weights = (0..pair[0] * pair[1]).map(|_| number()).collect();
        layers.push(Layer {
            weights: Matrix::from_rows(pair[1], pair[0], weights).expect("sizes fit"),
            bias: (0..pair[1]).map(|_| number()).collect(),
            activation: if index + 2 < widths.len() {
                Activation::Relu
            } else {
                Activation::Identity
            },
            uncertainty: 0.0,
        });
    }
    let network = Network::new(3, layers).expect("layers fit");
    let region = InputBox {
        lower: vec![-1.0; 3],
        upper: vec![1.0; 3],
    };
    let mut point = || -> Vec<f64> { (0..3).map(|_| 2.0 * random.random::<f64>() - 1.0).collect() };
    let sampled = (0..200).map(|_| network.run(&point()).values[0]);
    let most = sampled.fold(f64::NEG_INFINITY, f64::max);
    let mut checked = 0;
    for (way, above) in [
        (Branching::Inputs, 0.3),
        (Branching::Phases, 0.3),
        (Branching::Auto, 0.01),
    ] {
        let options = SearchOptions::default()
            .timeout(Duration::from_millis(100))
            .branching(way)
            .record(true);
        let atom = Halfspace::new(vec![-1.0], -(most + above * most.abs()));
        let property = Property {
            inputs: 3,
            outputs: 1,
            queries: vec![Query::new(region.clone(), vec![vec![atom]])],
        };
        let report = verify(&network, &property, options).expect("they fit");
        if report.answer != Answer::Unsat {
            continue;
        }
        checked += 1;
        if let Err(error) = check::check(&network, &property.queries[0], &report.proofs[0]) {
            return (checked, Some(format!("seed {seed}, {way:?}: {error}")));
        }
    }
    (checked, None)
}

#[test]
fn planted_faults_are_found() {
    let found = |name: &str, fault: Fault| {
        let chunks = (0..4000).step_by(100);
        let is_found = |first| !tried(first..first + 100, fault).wrong.is_empty();
        let tried = chunks.map(is_found).position(|found| found);
        println!("{name}: {:?} hundred networks", tried.map(|n| n + 1));
        assert!(tried.is_some(), "{name} is not found");
    };
    let with = |bounds| Fault { bounds, ..SOUND };
    found(
        "an upper line of the mirrored slope",
        with(|p| {
            p.enclose = |l, u| Lines {
                upper_slope: -l / (u - l),
                upper_offset: 0.0,
                ..Lines::relu(l, u)
            }
        }),
    );
    found(
        "a lower line that is too high",
        with(|p| {
            p.enclose = |l, u| Lines {
                lower_offset: Lines::relu(l, u).upper_offset,
                ..Lines::relu(l, u)
            }
        }),
    );
    found(
        "an upper line without its offset",
        with(|p| {
            p.enclose = |l, u| Lines {
                upper_offset: 0.0,
                ..Lines::relu(l, u)
            }
        }),
    );
    let text = |text| Fault { text, ..SOUND };
    found(
        "strict read as closed",
        text(|t| t.replace("(< ", "(<= ").replace("(> ", "(>= ")),
    );
    found(
        "closed read as strict",
        text(|t| t.replace("(<= ", "(< ").replace("(>= ", "(> ")),
    );
    found(
        "decimals rounded to floats",
        text(|t| {
            let rounded = |word: &str| match word.trim_end_matches(')').parse::<f64>() {
                Ok(value) if value.is_finite() && value.abs() < 1e18 => {
                    let closing = &word[word.trim_end_matches(')').len()..];
                    format!("{value:e}{closing}")
                }
                _ => word.to_owned(),
            };
            let lines = t.lines().map(|line| {
                let words: Vec<String> = line.split(' ').map(rounded).collect();
                words.join(" ")
            });
            lines.collect::<Vec<_>>().join("\n")
        }),
    );
}
