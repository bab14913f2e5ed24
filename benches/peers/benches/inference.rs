//! One inference in Cede and in each peer, after a check that they agree. Processor time, so that a loaded machine matters less.

#[path = "../../../sim/benches/processor/mod.rs"]
mod processor;

use cede_peers::burn::burn;
use cede_peers::candle::candle;
use cede_peers::cede::cede;
use cede_peers::onnx::onnx;
use cede_peers::onnxruntime::onnxruntime;
use cede_peers::tract::tract;
use cede_peers::{Failure, Run, layers};
use criterion::{Criterion, criterion_group, criterion_main};
use processor::CpuTime;
use std::hint::black_box;

const X: [f32; 8] = [0.3, -0.7, 0.1, 0.9, -0.2, 0.5, -0.4, 0.8];

fn runs(width: usize) -> Result<Vec<(&'static str, Run)>, Failure> {
    let layers = layers(width);
    let model = onnx(&layers);
    let mut runs = vec![
        ("cede", cede(&layers)),
        ("tract", tract(&model)?),
        ("candle", candle(&layers)?),
        ("burn", burn(&layers)?),
    ];
    match onnxruntime(&model)? {
        Some(run) => runs.push(("onnxruntime", run)),
        None => println!("onnxruntime is left out: set ORT_DYLIB_PATH to its library"),
    }
    Ok(runs)
}

fn inference(c: &mut Criterion<CpuTime>) {
    // Without it candle counts the machine's cores before each product, at twenty times the cost.
    assert!(
        std::env::var_os("RAYON_NUM_THREADS").is_some_and(|n| n == "1"),
        "set RAYON_NUM_THREADS=1, for a comparison on one thread"
    );
    for width in [64, 128] {
        let mut runs = runs(width).expect("every peer builds the network");
        let expected = runs[0].1(&X).expect("Cede runs");
        let mut group = c.benchmark_group(format!("8-{width}-{width}-{width}-4"));
        for (name, run) in &mut runs {
            let outputs = run(&X).expect("the peer runs");
            let close = outputs
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(close, "{name} gives {outputs:?}, Cede {expected:?}");
            group.bench_function(*name, |b| b.iter(|| run(black_box(&X))));
        }
    }
}

criterion_group!(
    name = benches;
    config = Criterion::default().with_measurement(CpuTime);
    targets = inference
);
criterion_main!(benches);
