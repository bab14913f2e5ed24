//! Where the lanes of two vehicles overlap.

use super::{Lanelet, Map, Trace};
use cede_controller::separation::OrientedBox;
use geo::{Area, BooleanOps, BoundingRect, Coord, Intersects, LineString, MultiPolygon, Polygon};

/// A smaller overlap (m²) is inexact drawing, not a place where ways meet.
const SMALLEST: f64 = 1.0;

/// The area in which the lanes of two vehicles overlap.
#[derive(Clone, Debug)]
pub struct ConflictArea(MultiPolygon);

impl ConflictArea {
    /// Whether a vehicle's `body` reaches into it.
    #[must_use]
    pub fn meets(&self, body: &OrientedBox) -> bool {
        self.0.intersects(&rectangle(body))
    }

    /// Its size in m².
    #[must_use]
    pub fn size(&self) -> f64 {
        self.0.unsigned_area()
    }
}

/// What a vehicle covers, in the precision of the map.
#[must_use]
pub fn rectangle(body: &OrientedBox) -> Polygon {
    let along = body.direction * body.half_length;
    let beside =
        cede_controller::Vector::new(-body.direction.y, body.direction.x) * body.half_width;
    let corner = |a: f32, b: f32| {
        let corner = body.centre + along * a + beside * b;
        Coord::from((f64::from(corner.x), f64::from(corner.y)))
    };
    let corners = vec![
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
    ];
    Polygon::new(LineString::new(corners), Vec::new())
}

impl Map {
    /// Where the lanelets of two ways overlap, but for lanelets that both ways have: those are not crossed but shared.
    /// `None` if they overlap nowhere.
    #[must_use]
    pub fn conflict_area(&self, ways: [&Trace; 2]) -> Option<ConflictArea> {
        let [one, other] = ways.map(|way| way.0.iter().map(|on| on.lanelet).collect::<Vec<_>>());
        let alone = |way: &[usize], from: &[usize]| {
            let alone = way.iter().filter(|lanelet| !from.contains(lanelet));
            let shapes = alone.map(|&lanelet| self.lanelets[lanelet].shape());
            shapes.collect::<Vec<_>>()
        };
        let (ones, others) = (alone(&one, &other), alone(&other, &one));
        let pairs = ones.iter().flat_map(|a| others.iter().map(move |b| (a, b)));
        let near = pairs.filter(|(a, b)| match (a.bounding_rect(), b.bounding_rect()) {
            (Some(a), Some(b)) => a.intersects(&b),
            _ => false,
        });
        let overlaps = near.map(|(a, b)| a.intersection(b));
        let areas = overlaps.filter(|overlap| overlap.unsigned_area() >= SMALLEST);
        areas.reduce(|all, area| all.union(&area)).map(ConflictArea)
    }
}

impl Lanelet {
    fn shape(&self) -> Polygon {
        Polygon::new(LineString::from(self.outline()), Vec::new())
    }
}
