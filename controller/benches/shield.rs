//! The shield alone and the whole decision, among 1, 4 and 8 others; at the end, the worst of 10⁶ random observations.

use cede_controller::policy::weights::Draft;
use cede_controller::{
    Class, Contract, Drive, FeatureSet, Footprint, Instant, Junction, Mlp, Observation, Part,
    PathId, Perspective, Point, Policy, Route, Shield, Track, Vehicle,
};
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::{self, Duration};

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

/// Eight others, and the ego's path.
type Crossing = Junction<9, 32, 1>;

const EGO: PathId = PathId::new(0);

fn junction(others: usize) -> Crossing {
    let (ego, others) = routes(others);
    let mut builder = Crossing::builder();
    for route in std::iter::once(&ego).chain(&others) {
        let path = builder.path(route, Class::Car, Footprint::PAPER);
        path.expect("room for the path");
    }
    builder.build().expect("a junction")
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

    fn vehicle(&mut self, route: &Route<8>) -> Vehicle {
        let s = 80.0 * self.next();
        Vehicle {
            s,
            speed: 15.0 * self.next(),
            pose: route.pose(s),
        }
    }

    fn seen(&mut self, (ego, others): &(Route<8>, Vec<Route<8>>)) -> Seen {
        let tracks = (1_u8..).zip(others);
        Seen {
            ego: self.vehicle(ego),
            tracks: tracks
                .map(|(i, route)| Track::on(i.into(), PathId::new(i), self.vehicle(route)))
                .collect(),
        }
    }
}

/// What an observation borrows.
struct Seen {
    ego: Vehicle,
    tracks: Vec<Track>,
}

impl Seen {
    fn observation(&self) -> Observation<'_> {
        Observation {
            ego: self.ego,
            tracks: &self.tracks,
        }
    }
}

/// A clock that goes on by a period at each look.
#[derive(Default)]
struct Clock(u64);

impl Clock {
    fn now(&mut self) -> Instant {
        self.0 += 100;
        Instant::from_millis(self.0)
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
        let (routes, junction) = (routes(others), junction(others));
        let mut numbers = Numbers(1);
        let seen: Vec<_> = (0..1024).map(|_| numbers.seen(&routes)).collect();
        let (mut clock, mut i) = (Clock::default(), 0);
        let mut next = || {
            i = (i + 1) % seen.len();
            (clock.now(), black_box(seen[i].observation()))
        };
        let mut shield =
            Shield::<8>::enter(Contract::WORST_CASE, &junction, EGO).expect("a way in");
        c.bench_function(&format!("shield/{others}"), |b| {
            b.iter(|| {
                let (now, seen) = next();
                shield.filter(now, &seen, black_box(1.0))
            });
        });
        let drive = Drive::new(policy, Contract::WORST_CASE, Part::Left);
        let mut approach = drive.enter(&junction, EGO).expect("a way in");
        c.bench_function(&format!("decide/{others}"), |b| {
            b.iter(|| {
                let (now, seen) = next();
                approach.decide(now, &seen)
            });
        });
    }
}

/// The longest of 10⁶ decisions, and the 99.9th percentile: the machine's interruptions are in the former.
fn worst(_: &mut Criterion) {
    let words = weights();
    let policy = Policy::new(&words).expect("a policy");
    let drive = Drive::new(policy, Contract::WORST_CASE, Part::Left);
    for others in CROWDS {
        let (routes, junction) = (routes(others), junction(others));
        let mut numbers = Numbers(2);
        let mut approach = drive.enter(&junction, EGO).expect("a way in");
        let mut clock = Clock::default();
        let mut times: Vec<Duration> = (0..1_000_000)
            .map(|_| {
                let (now, seen) = (clock.now(), numbers.seen(&routes));
                let start = time::Instant::now();
                black_box(approach.decide(now, black_box(&seen.observation())));
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
