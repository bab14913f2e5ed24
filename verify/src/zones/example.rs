//! Junctions to check: some that are drawn here, and those of paths that somebody else has drawn.

use super::Site;
use cede_controller::geometry::length;
use cede_controller::{
    Class, Footprint, Junction, JunctionError, Point, Route, RouteError, Vector,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f32::consts::PI;
use thiserror::Error;

/// Paths of a junction, at most.
const PATHS: usize = 32;

/// Points of a path, at most.
const POINTS: usize = 512;

/// Points of a junction, at most.
const ALL_POINTS: usize = 8192;

/// Why paths are no junction.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoJunction {
    /// A path is no route.
    #[error("paths[{path}]: {error}")]
    Route {
        /// Which path.
        path: usize,
        /// What is wrong with it.
        error: RouteError,
    },
    /// The routes are no paths of a junction.
    #[error(transparent)]
    Junction(#[from] JunctionError),
}

/// A route, and the footprint on it.
type Way = (Vec<Point>, Footprint);

const LORRY: Footprint = Footprint {
    length: 12.0,
    width: 2.55,
};

/// The paths and the tolerance of `site`, with the zones that the controller makes. Arc lengths are the controller's.
///
/// # Errors
/// See [`NoJunction`].
pub fn with_zones(site: &Site) -> Result<Site, NoJunction> {
    let ways = site.paths.iter().map(|path| {
        let point = |&[x, y]: &[f64; 2]| Point::new(x as f32, y as f32);
        let [length, width] = [path.length, path.width].map(|size| size as f32);
        (
            path.points.iter().map(point).collect(),
            Footprint { length, width },
        )
    });
    made(&ways.collect::<Vec<_>>(), site.tolerance as f32)
}

/// Two straight roads at a right angle.
#[must_use]
pub fn crossing() -> Option<Site> {
    let east = vec![Point::new(-30.0, 0.0), Point::new(30.0, 0.0)];
    let north = vec![Point::new(0.0, -40.0), Point::new(0.0, 40.0)];
    made(&[east, north].map(|points| (points, Footprint::PAPER)), 0.1).ok()
}

/// Every way between `arms` roads at right angles, long before and behind the junction, each for cars and for lorries:
/// as in a SUMO network. With a `jitter` (m) the points are as dense and as uneven as recorded ones.
#[must_use]
pub fn roads(arms: u8, jitter: f32) -> Option<Site> {
    let mut random = Pcg64::seed_from_u64(u64::from(arms));
    let mut ways = Vec::new();
    for from in 0..arms {
        for to in (0..arms).filter(|&to| to != from) {
            let mut points = way(from, to, if jitter > 0.0 { 1.0 } else { 300.0 });
            for point in &mut points {
                let mut by = || jitter * random.random_range(-1.0..=1.0);
                *point += Vector::new(by(), by());
            }
            ways.extend([Footprint::PAPER, LORRY].map(|footprint| (points.clone(), footprint)));
        }
    }
    made(&ways, 0.1).ok()
}

/// Nine ways in from one side, with bends in the middle, out to another; as in the file of golden decisions.
#[must_use]
pub fn bends(seed: u64) -> Option<Site> {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut ways: Vec<Way> = Vec::new();
    while ways.len() < 9 {
        let mut arm = || {
            let angle = random.random_range(-PI..PI);
            Vector::new(angle.cos(), angle.sin()) * 45.0
        };
        let (from, to) = (arm(), arm());
        let middle = (from + to) * (0.15 * 0.35);
        let points = [from, from * 0.15, middle, to * 0.15, to].map(Point::from);
        let way = (points.to_vec(), Footprint::PAPER);
        // Some bends are too sharp.
        if made(std::slice::from_ref(&way), 0.0).is_ok() {
            ways.push(way);
        }
    }
    made(&ways, 0.1).ok()
}

/// From arm to arm, counted in quarter turns: straight in, a curve, straight out; the pieces of the straight ones are
/// `step` m long at most.
fn way(from: u8, to: u8, step: f32) -> Vec<Point> {
    const LANE: f32 = 1.75;
    const MOUTH: f32 = 12.0;
    let turned = |p: Vector, quarters: u8| (0..quarters).fold(p, |p, _| Vector::new(-p.y, p.x));
    let inbound = |out: f32| turned(Vector::new(out, LANE), from);
    let outbound = |out: f32| turned(Vector::new(out, -LANE), to);
    let far = if step > 100.0 {
        [300.0, 100.0]
    } else {
        [50.0, 50.0]
    };
    let along = |from: f32, to: f32| {
        let count = ((to - from).abs() / step).ceil() as u16;
        (0..count).map(move |i| from + (to - from) * f32::from(i) / f32::from(count))
    };
    let [a, b] = [inbound(MOUTH), outbound(MOUTH)];
    let handle = 0.39 * length(&(b - a));
    let c = a - turned(Vector::new(handle, 0.0), from);
    let d = b - turned(Vector::new(handle, 0.0), to);
    let curve = (0..=24_u8).map(|i| {
        let t = f32::from(i) / 24.0;
        let r = 1.0 - t;
        a * (r * r * r) + c * (3.0 * r * r * t) + d * (3.0 * r * t * t) + b * (t * t * t)
    });
    let way_in = along(far[0], MOUTH).map(inbound);
    let way_out = along(far[1], MOUTH).map(outbound).collect::<Vec<_>>();
    let all = way_in.chain(curve).chain(way_out.into_iter().rev());
    all.map(Point::from).collect()
}

/// What the junction of these ways publishes.
fn made(ways: &[Way], tolerance: f32) -> Result<Site, NoJunction> {
    let mut builder = Box::new(Junction::<PATHS, ALL_POINTS>::builder());
    builder.tolerance(tolerance);
    for (path, (points, footprint)) in ways.iter().enumerate() {
        let route = Route::<POINTS>::new(points.iter().copied());
        let route = route.map_err(|error| NoJunction::Route { path, error })?;
        builder.path(&route, Class::Car, *footprint)?;
    }
    Ok(Site::of(builder.build_in_place()?))
}
