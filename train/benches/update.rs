//! One update of soft actor-critic at the paper's size, compared with the machine's matrix products.
//!
//! Throughput is in floating-point operations per CPU-second. It counts the operations of the update's
//! matrix products only, so that it is comparable with the peak.

#[path = "../../sim/benches/processor/mod.rs"]
mod processor;

use cede_train::algorithm::sac::Rates;
use cede_train::algorithm::sac::learner::Learner;
use cede_train::driving::replay::Batch;
use cede_train::nn::matmul::{Into, Matrix, multiply};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use processor::CpuTime;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const BATCH: usize = 512;
const FEATURES: usize = 8;
const ACTIONS: usize = 2;
/// Size of the square matrices whose product measures the machine's peak.
const SIDE: usize = 768;

/// Operations of an update with hidden layers of `width`. A forward pass takes two operations per sample
/// and weight, and so do the derivatives with respect to the inputs and those with respect to the weights.
fn operations(width: usize) -> u64 {
    let weights = |inputs, outputs| inputs * width + 2 * width * width + width * outputs;
    let actor = weights(FEATURES, 2 * ACTIONS);
    let critic = weights(FEATURES + ACTIONS, 1);
    // Actor: for the targets of the critics; for its loss with both derivatives. Each of two critics: the
    // target network; the critic's loss with both derivatives; the actor's loss with one derivative.
    let passes = 4 * actor + 2 * 6 * critic;
    (2 * BATCH * passes) as u64
}

fn batch(random: &mut Pcg64) -> Batch {
    let mut draw =
        |n: usize| -> Vec<f32> { (0..n).map(|_| random.random_range(-1.0..1.0)).collect() };
    Batch {
        observations: draw(BATCH * FEATURES),
        actions: draw(BATCH * ACTIONS),
        rewards: draw(BATCH),
        next: draw(BATCH * FEATURES),
        continues: vec![1.0; BATCH],
    }
}

fn update(c: &mut Criterion<CpuTime>) {
    let mut group = c.benchmark_group("update");
    for width in [128, 256] {
        let mut random = Pcg64::seed_from_u64(1);
        let (rates, batch) = (Rates::default(), batch(&mut random));
        let mut learner = Learner::new(FEATURES, ACTIONS, width, &rates, &mut random);
        group.throughput(Throughput::Elements(operations(width)));
        group.bench_function(BenchmarkId::from_parameter(width), |b| {
            b.iter(|| learner.update(&batch, &rates, &mut random));
        });
    }
    group.finish();
}

fn product(c: &mut Criterion<CpuTime>) {
    let mut group = c.benchmark_group("product");
    let mut random = Pcg64::seed_from_u64(2);
    // The machine's peak, then the products of an update.
    for (rows, inner, columns) in [(SIDE, SIDE, SIDE), (BATCH, 128, 128), (BATCH, 256, 256)] {
        let mut draw =
            |n: usize| -> Vec<f32> { (0..n).map(|_| random.random_range(-1.0..1.0)).collect() };
        let (left, right) = (draw(rows * inner), draw(inner * columns));
        let mut out = vec![0.0; rows * columns];
        group.throughput(Throughput::Elements((2 * rows * inner * columns) as u64));
        group.bench_function(
            BenchmarkId::from_parameter(format!("{rows}x{inner}x{columns}")),
            |b| {
                b.iter(|| {
                    let (left, right) = (
                        Matrix::new(&left, rows, inner),
                        Matrix::new(&right, inner, columns),
                    );
                    multiply(&mut out, left, right, Into::Replace);
                });
            },
        );
    }
    group.finish();
}

criterion_group!(
    name = benches;
    config = Criterion::default().with_measurement(CpuTime);
    targets = update, product
);
criterion_main!(benches);
