//! Reading recordings and extracting their encounters: all files of a site.
//!
//! On the recorded sites if they are there (`CEDE_INTERACTION_DIR`, or
//! `../shared/interaction` beside the repository), else on nothing.

use cede_data::{Dataset, extract};
use cede_tests::interaction;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

fn all_files(criterion: &mut Criterion) {
    let Some(dir) = interaction() else { return };
    let mut group = criterion.benchmark_group("all files of a site");
    group.sample_size(10);
    for site in ["EP0", "MA"] {
        let dataset = Dataset::load(&dir, site).unwrap();
        let tracks = dataset.recordings.iter().flat_map(|r| &r.tracks);
        let rows: usize = tracks.map(|track| track.states.len()).sum();
        group.throughput(Throughput::Elements(rows as u64));
        group.bench_function(BenchmarkId::new("read and extract", site), |bencher| {
            bencher.iter(|| Dataset::load(&dir, site).unwrap());
        });
        group.bench_function(BenchmarkId::new("extract, one thread", site), |bencher| {
            bencher.iter(|| {
                let recordings = dataset.recordings.iter();
                recordings
                    .map(|r| black_box(extract(&dataset.site, dataset.map.as_ref(), r)).len())
                    .sum::<usize>()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, all_files);
criterion_main!(benches);
