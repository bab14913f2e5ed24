//! Steps of the stepper a second, eight encounters at a time and one at a time, with the embedded policy and
//! with none; and one box-against-box test beside parry2d's.
//!
//! What runs on one thread is measured in CPU time, which other programs on the machine do not
//! stretch; the scaling with threads needs the wall clock and a quiet machine.

mod processor;

#[path = "../tests/scenes/mod.rs"]
mod scenes;

use cede_controller::geometry::unit;
use cede_controller::kinematics::State;
use cede_controller::policy::embedded;
use cede_controller::separation::OrientedBox;
use cede_controller::{Footprint, Point, Policy, Pose};
use cede_sim::ObservationModel;
use cede_sim::batch::{Batch, Block, LANES, Library};
use cede_sim::stepper::Stepper;
use criterion::measurement::Measurement;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use processor::CpuTime;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rapier2d::parry::query::details::intersection_test_cuboid_cuboid;
use rapier2d::parry::query::intersection_test;
use rapier2d::parry::shape::Cuboid;
use std::hint::black_box;

/// A policy that costs next to nothing, and lets episodes end in every way.
fn drive<const N: usize>(library: &Library, block: &mut Block<N>) {
    let mut accelerations = [[0.0; LANES]; N];
    for (asked, motion) in accelerations.iter_mut().zip(block.vehicles()) {
        *asked = motion.v.map(|v| 0.5 * (8.0 - v));
    }
    block.advance(library, &accelerations);
    block.restart(library);
}

fn steps<const N: usize>(
    group: &mut BenchmarkGroup<'_, impl Measurement<Value: Send> + Sync>,
    encounters: usize,
    threads: usize,
) {
    let recorded = scenes::encounters(400, u32::try_from(N).unwrap(), 1);
    let library = Library::new(&recorded, Footprint::PAPER).unwrap();
    let mut batch = Batch::<N>::new(&library, encounters, 2);
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = builder.build().unwrap();
    group.throughput(Throughput::Elements(encounters as u64));
    let name = format!("{N} vehicles, {encounters} encounters, {threads} threads");
    group.bench_function(name, |bencher| {
        pool.install(|| bencher.iter(|| batch.for_each(drive)));
    });
}

fn batch(criterion: &mut Criterion<CpuTime>) {
    let mut group = criterion.benchmark_group("batch");
    for encounters in [64, 512, 4096, 32_768] {
        steps::<2>(&mut group, encounters, 1);
    }
    // Against one thread: what handing out the work costs.
    steps::<2>(&mut group, 32_768, 2);
    steps::<4>(&mut group, 4096, 1);
    steps::<8>(&mut group, 4096, 1);
    group.finish();
}

/// The embedded policy drives the two judged vehicles of every encounter, each as it sees the other.
fn policy_drives(policy: &Policy<'_>, models: &[ObservationModel<'_>], batch: &mut Batch<'_, 2>) {
    batch.for_each(|library, block| {
        let mut accelerations = [[0.0; LANES]; 2];
        for lane in 0..LANES {
            let states = block.vehicles().each_ref().map(|motion| motion.state(lane));
            let taken = block.length(lane).steps as usize;
            let model = &models[block.encounter(lane)];
            let pairs = model.pairs(taken, states, block.svo()[lane]);
            for (asked, pair) in accelerations.iter_mut().zip(&pairs) {
                asked[lane] = policy.act(pair)[0];
            }
        }
        block.advance(library, &accelerations);
        block.restart(library);
    });
}

fn batch_with_policy(criterion: &mut Criterion<CpuTime>) {
    let recorded = scenes::encounters(400, 2, 1);
    let models: Vec<_> = recorded.iter().map(ObservationModel::new).collect();
    let library = Library::new(&recorded, Footprint::PAPER).unwrap();
    let policy = Policy::new(embedded::words()).unwrap();
    let mut batch = Batch::<2>::new(&library, 512, 2);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    let pool = pool.build().unwrap();
    let mut group = criterion.benchmark_group("batch, embedded policy");
    group.throughput(Throughput::Elements(512));
    group.bench_function("2 vehicles, 512 encounters, 1 threads", |bencher| {
        pool.install(|| bencher.iter(|| policy_drives(&policy, &models, &mut batch)));
    });
    group.finish();
}

/// Steps one encounter after the other to its end under `drive`; gives the steps that it took.
fn run_all(
    models: &[ObservationModel<'_>],
    drive: impl Fn(&ObservationModel<'_>, usize, [State; 2]) -> [f32; 2],
) -> u64 {
    let mut steps = 0;
    for model in models {
        let stepper = Stepper::new(model.encounter, None);
        let mut states = stepper.start();
        for taken in 0.. {
            let step = stepper.step(taken, states, drive(model, taken, states));
            states = step.states;
            steps += 1;
            if step.end().is_some() {
                break;
            }
        }
    }
    steps
}

fn one_at_a_time(criterion: &mut Criterion<CpuTime>) {
    let recorded = scenes::encounters(100, 2, 1);
    let models: Vec<_> = recorded.iter().map(ObservationModel::new).collect();
    let policy = Policy::new(embedded::words()).unwrap();
    let none =
        |_: &ObservationModel<'_>, _, states: [State; 2]| states.map(|state| 0.5 * (8.0 - state.v));
    let embedded = |model: &ObservationModel<'_>, taken, states| {
        let pairs = model.pairs(taken, states, ObservationModel::FIRST_SVO);
        pairs.map(|pair| policy.act(&pair)[0])
    };
    let mut group = criterion.benchmark_group("one encounter at a time");
    group.throughput(Throughput::Elements(run_all(&models, none)));
    group.bench_function("no policy", |bencher| {
        bencher.iter(|| run_all(black_box(&models), none));
    });
    group.throughput(Throughput::Elements(run_all(&models, embedded)));
    group.bench_function("embedded policy", |bencher| {
        bencher.iter(|| run_all(black_box(&models), embedded));
    });
    group.finish();
}

fn threads(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("batch, wall clock");
    for threads in [1, 2] {
        steps::<2>(&mut group, 32_768, threads);
    }
    group.finish();
}

/// Pairs of vehicles in all attitudes, about half of them in contact.
fn pairs() -> Vec<[Pose; 2]> {
    let mut random = Pcg64::seed_from_u64(3);
    let mut pose = || {
        let heading: f32 = random.random_range(-3.2..3.2);
        Pose {
            position: Point::new(random.random_range(0.0..5.0), random.random_range(0.0..5.0)),
            direction: unit(heading.cos(), heading.sin()),
        }
    };
    (0..1024).map(|_| [pose(), pose()]).collect()
}

fn boxes(criterion: &mut Criterion<CpuTime>) {
    let poses = pairs();
    let mut group = criterion.benchmark_group("box against box");
    group.throughput(Throughput::Elements(poses.len() as u64));
    let ours: Vec<_> = poses
        .iter()
        .map(|pair| pair.map(|pose| OrientedBox::new(pose, Footprint::PAPER)))
        .collect();
    group.bench_function("ours", |bencher| {
        bencher.iter(|| {
            black_box(&ours)
                .iter()
                .filter(|[a, b]| black_box(a.overlaps(b)))
                .count()
        });
    });
    use rapier2d::math::{Pose as Placement, Rotation, Vector};
    let placement = |pose: Pose| {
        let (position, direction) = (pose.position, pose.direction);
        Placement::from_parts(
            Vector::new(position.x, position.y),
            Rotation::from_cos_sin_unchecked(direction.x, direction.y),
        )
    };
    let theirs: Vec<_> = poses.iter().map(|pair| pair.map(placement)).collect();
    let vehicle = Cuboid::new(Vector::new(2.5, 1.0));
    group.bench_function("parry2d", |bencher| {
        bencher.iter(|| {
            let touch = |[a, b]: &&[Placement; 2]| {
                let verdict = intersection_test(a, &vehicle, b, &vehicle);
                black_box(verdict.is_ok_and(|found| found.intersecting))
            };
            black_box(&theirs).iter().filter(touch).count()
        });
    });
    group.bench_function("parry2d, without dispatch", |bencher| {
        bencher.iter(|| {
            let touch = |[a, b]: &&[Placement; 2]| {
                let relative = a.inv_mul(b);
                black_box(intersection_test_cuboid_cuboid(
                    &relative, &vehicle, &vehicle,
                ))
            };
            black_box(&theirs).iter().filter(touch).count()
        });
    });
    group.finish();
}

criterion_group!(
    name = single;
    config = Criterion::default().with_measurement(CpuTime);
    targets = batch, batch_with_policy, one_at_a_time, boxes
);
criterion_group!(wall, threads);
criterion_main!(single, wall);
