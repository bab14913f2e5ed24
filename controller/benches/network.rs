//! One pass through the network alone, for the two widths in use.

#[path = "../../sim/benches/processor/mod.rs"]
mod processor;

use cede_controller::Mlp;
use cede_controller::policy::weights::Aligned;
use criterion::{Criterion, criterion_group, criterion_main};
use processor::CpuTime;
use std::hint::black_box;

fn forward(c: &mut Criterion<CpuTime>) {
    let mut group = c.benchmark_group("network");
    for width in [64, 128] {
        let count = Mlp::words(8, width);
        let weight = |i: usize| ((i * 7919 % 1000) as f32 / 2500.0 - 0.2).to_bits();
        let aligned = Box::new(Aligned::<{ Mlp::words(8, 128) }>(std::array::from_fn(
            weight,
        )));
        let mlp = Mlp::new(&aligned.0[..count], 8, width).expect("the shape fits");
        let inputs = [0.3f32, -0.7, 0.1, 0.9, -0.2, 0.5, -0.4, 0.8];
        group.bench_function(format!("8-{width}-{width}-{width}-4"), |b| {
            b.iter(|| mlp.forward(black_box(&inputs)));
        });
        // No pass can take less: the wide network's do not fit the first-level cache.
        group.bench_function(format!("the weights of {width} read once"), |b| {
            b.iter(|| read(black_box(&aligned.0[..count])));
        });
    }
}

fn read(words: &[u32]) -> u32 {
    let mut sums = [0_u32; 64];
    for row in words.as_chunks::<64>().0 {
        for (sum, word) in sums.iter_mut().zip(row) {
            *sum ^= word;
        }
    }
    sums.iter().fold(0, |all, sum| all ^ sum)
}

criterion_group!(
    name = benches;
    config = Criterion::default().with_measurement(CpuTime);
    targets = forward
);
criterion_main!(benches);
