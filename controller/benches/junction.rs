//! Building a junction of four arms: 12 routes of 64 points, of which all or one can be entered.

use cede_controller::{Class, Footprint, Junction, Point, Route};
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

/// Where lanes end at the junction (m from its centre).
const MOUTH: f32 = 10.0;

/// Where they begin (m from its centre).
const FAR: f32 = 70.0;

/// From the centre line of the road to that of the lane (m).
const LANE: f32 = 1.75;

/// `point` after `quarters` quarter turns to the left.
fn turned(point: Point, quarters: usize) -> Point {
    (0..quarters).fold(point, |p, _| Point::new(-p.y, p.x))
}

/// In from the south and out, `exit` quarter turns away from where it came from: 1 is to the right.
fn route(entry: usize, exit: usize) -> Route<64> {
    let way_in = |y: f32| Point::new(LANE, -y);
    let way_out = |y: f32| turned(Point::new(-LANE, -y), exit);
    let between = |from: Point, to: Point, t: f32| from + (to - from) * t;
    let corner = match exit {
        1 => Point::new(LANE, -LANE),
        2 => Point::new(LANE, 0.0),
        _ => Point::new(LANE, LANE),
    };
    let points = (0..64_u8).map(|i| {
        let share = |from: u8, count: u8| f32::from(i - from) / f32::from(count);
        match i {
            0..20 => between(way_in(FAR), way_in(MOUTH), share(0, 20)),
            20..44 => {
                let t = share(20, 24);
                let [a, b] = [way_in(MOUTH), way_out(MOUTH)];
                between(between(a, corner, t), between(corner, b, t), t)
            }
            _ => between(way_out(MOUTH), way_out(FAR), share(44, 19)),
        }
    });
    Route::new(points.map(|p| turned(p, entry))).expect("a route")
}

fn build<const E: usize>(routes: &[Route<64>]) -> Junction<12, 768, E> {
    let mut builder = Junction::<12, 768, E>::builder();
    for route in routes {
        builder
            .path(route, Class::Car, Footprint::PAPER)
            .expect("a path");
    }
    builder.build().expect("a junction")
}

fn junctions(c: &mut Criterion) {
    let routes: Vec<_> = (0..12).map(|i| route(i / 3, 1 + i % 3)).collect();
    c.bench_function("junction/12 entered", |b| {
        b.iter(|| build::<12>(black_box(&routes)));
    });
    c.bench_function("junction/1 entered", |b| {
        b.iter(|| build::<1>(black_box(&routes)));
    });
}

criterion_group!(benches, junctions);
criterion_main!(benches);
