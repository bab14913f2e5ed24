//! The shield alone and the whole decision, among 1, 4 and 8 others; at the end, the worst of 10⁶ random observations.

use cede_controller::policy::weights::Draft;
use cede_controller::{
    Contract, Controller, FeatureSet, Footprint, Mlp, Observation, Part, Perspective, Point,
    Policy, Route, Scene, ScenePath as Path, Shield, Vehicle,
};
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::{Duration, Instant};

const CROWDS: [usize; 3] = [1, 4, 8];

/// The ego goes east; others come from the south side by side, and every third merges.
fn routes(others: usize) -> (Route<8>, Vec<Route<8>>) {
    let route = |points: &[(f32, f32)]| {
        Route::new(points.iter().map(|&(x, y)| Point::new(x, y))).expect("a route")
    };
    let other = |i: usize| {
        let x = 10.0 * i as f32;
        if i % 3 == 2 {
            route(&[(x - 40.0, -40.0), (x, 0.0), (180.0, 0.0)])
        } else {
            route(&[(x, -60.0), (x, 60.0)])
        }
    };
    (
        route(&[(-60.0, 0.0), (180.0, 0.0)]),
        (0..others).map(other).collect(),
    )
}

fn scene(others: usize) -> Scene<8> {
    let (ego, others) = routes(others);
    let path = |route| Path {
        route,
        footprint: Footprint::PAPER,
    };
    let others: Vec<_> = others.iter().map(path).collect();
    Scene::new(path(&ego), &others).expect("a scene")
}

/// Numbers in [0, 1), the same every time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 40) as f32 / (1_u64 << 24) as f32
    }

    fn vehicle(&mut self) -> Vehicle {
        let (ego, _) = routes(1);
        let s = 80.0 * self.next();
        Vehicle {
            s,
            speed: 15.0 * self.next(),
            pose: ego.pose(s),
        }
    }

    fn observation(&mut self, others: usize) -> Observation<8> {
        Observation {
            ego: self.vehicle(),
            others: std::array::from_fn(|i| (i < others).then(|| self.vehicle())),
        }
    }
}

/// A weights file with a 64-wide network that sees the `Route` features.
fn weights() -> Vec<u32> {
    let inputs = FeatureSet::Route.count();
    let parameters: Vec<f32> = (0..Mlp::words(inputs, 64))
        .map(|i| (i * 7919 % 1000) as f32 / 2500.0 - 0.2)
        .collect();
    let draft = Draft {
        features: FeatureSet::Route,
        perspective: Perspective::Ego,
        width: 64,
        provenance: [0; 32],
        centres: &vec![0.0; inputs],
        scales: &vec![0.1; inputs],
        parameters: &parameters,
    };
    let mut words = vec![0; draft.words()];
    draft.encode(&mut words).expect("a weights file");
    words
}

fn decisions(c: &mut Criterion) {
    let words = weights();
    let policy = Policy::new(&words).expect("a policy");
    for others in CROWDS {
        let scene = scene(others);
        let mut numbers = Numbers(1);
        let seen: Vec<_> = (0..1024).map(|_| numbers.observation(others)).collect();
        let mut i = 0;
        let mut next = || {
            i = (i + 1) % seen.len();
            black_box(&seen[i])
        };
        let mut shield = Shield::<8>::new(Contract::WORST_CASE);
        c.bench_function(&format!("shield/{others}"), |b| {
            b.iter(|| shield.filter(&scene, next(), black_box(1.0)));
        });
        let mut controller = Controller::new(policy, Contract::WORST_CASE, Part::Left);
        c.bench_function(&format!("decide/{others}"), |b| {
            b.iter(|| controller.decide(&scene, next()));
        });
    }
}

/// The longest of 10⁶ decisions, and the 99.9th percentile: the machine's interruptions are in the former.
fn worst(_: &mut Criterion) {
    let words = weights();
    let policy = Policy::new(&words).expect("a policy");
    for others in CROWDS {
        let scene = scene(others);
        let mut numbers = Numbers(2);
        let mut controller = Controller::new(policy, Contract::WORST_CASE, Part::Left);
        let mut times: Vec<Duration> = (0..1_000_000)
            .map(|_| {
                let seen = numbers.observation(others);
                let start = Instant::now();
                black_box(controller.decide(&scene, black_box(&seen)));
                start.elapsed()
            })
            .collect();
        times.sort_unstable();
        let (high, longest) = (times[times.len() * 999 / 1000], times[times.len() - 1]);
        println!("decide/{others}: 99.9 % within {high:?}, longest of 10⁶ {longest:?}");
    }
}

criterion_group!(benches, decisions, worst);
criterion_main!(benches);
