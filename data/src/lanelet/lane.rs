//! A lanelet: a piece of a lane, in the direction in which it is driven.

use super::MapPoint;

/// Points of a centreline; the lanelets of a junction are some metres long.
const CENTRES: usize = 13;

/// A piece of a lane.
#[derive(Clone, Debug)]
pub struct Lanelet {
    /// Its left bound, in the direction of driving.
    pub left: Vec<MapPoint>,
    /// Its right bound, in the direction of driving.
    pub right: Vec<MapPoint>,
    /// Its middle, in the direction of driving.
    pub centre: Vec<MapPoint>,
    /// The lanelets that it leads into, as indices in the map's list.
    pub successors: Vec<usize>,
    /// Its speed limit (m/s), if the map has one.
    pub limit: Option<f64>,
}

impl Lanelet {
    /// The lanelet between two bounds, either of which may be drawn in the wrong direction.
    pub(crate) fn new(left: &[MapPoint], right: &[MapPoint], limit: Option<f64>) -> Self {
        let (mut left, mut right) = (left.to_vec(), right.to_vec());
        if !side_by_side(&left, &right) {
            right.reverse();
        }
        // Along the left bound and back along the right one is clockwise, if the left bound is on the left.
        let outline = || left.iter().chain(right.iter().rev());
        let turns = outline().zip(outline().cycle().skip(1));
        let area: f64 = turns.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
        if area > 0.0 {
            left.reverse();
            right.reverse();
        }
        let middle = |i: usize| {
            let share = i as f64 / (CENTRES - 1) as f64;
            let (a, b) = (along(&left, share), along(&right, share));
            [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]
        };
        Self {
            centre: (0..CENTRES).map(middle).collect(),
            left,
            right,
            successors: Vec::new(),
            limit,
        }
    }

    /// Its outline, closed by joining the last point to the first.
    #[must_use]
    pub fn outline(&self) -> Vec<MapPoint> {
        self.left
            .iter()
            .chain(self.right.iter().rev())
            .copied()
            .collect()
    }

    /// The point in the middle of it.
    #[must_use]
    pub fn middle(&self) -> MapPoint {
        self.centre[CENTRES / 2]
    }

    /// The ends of both bounds, where the lanelet is left.
    fn exit(&self) -> Option<[MapPoint; 2]> {
        Some([*self.left.last()?, *self.right.last()?])
    }

    /// The beginnings of both bounds, where it is entered.
    fn entry(&self) -> Option<[MapPoint; 2]> {
        Some([*self.left.first()?, *self.right.first()?])
    }
}

/// Finds the successors of all `lanelets`: those that begin in the two points where a lanelet ends.
pub(super) fn join(lanelets: &mut [Lanelet]) {
    let entries: Vec<_> = lanelets.iter().map(Lanelet::entry).collect();
    for lanelet in lanelets {
        let exit = lanelet.exit();
        let follows = |(index, entry): (usize, &Option<_>)| (*entry == exit).then_some(index);
        lanelet.successors = entries.iter().enumerate().filter_map(follows).collect();
    }
}

/// Whether two bounds are drawn in the same direction.
fn side_by_side(left: &[MapPoint], right: &[MapPoint]) -> bool {
    match (left.first(), left.last(), right.first(), right.last()) {
        (Some(a), Some(b), Some(c), Some(d)) => {
            apart(a, c) + apart(b, d) <= apart(a, d) + apart(b, c)
        }
        _ => true,
    }
}

/// The point at this share of the length of a polyline; the origin if it has no points.
fn along(points: &[MapPoint], share: f64) -> MapPoint {
    let lengths = points.windows(2).map(|w| apart(&w[0], &w[1]));
    let mut left = share * lengths.sum::<f64>();
    for w in points.windows(2) {
        let length = apart(&w[0], &w[1]);
        if left <= length && length > 0.0 {
            let f = left / length;
            return [0, 1].map(|i| w[0][i] + (w[1][i] - w[0][i]) * f);
        }
        left -= length;
    }
    points.last().copied().unwrap_or_default()
}

/// Metres between two points.
pub(super) fn apart(a: &MapPoint, b: &MapPoint) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOUTH: [MapPoint; 2] = [[0.0, 0.0], [10.0, 0.0]];
    const NORTH: [MapPoint; 2] = [[0.0, 4.0], [10.0, 4.0]];

    #[test]
    fn the_left_bound_is_on_the_left_however_the_bounds_are_drawn() {
        for flip in 0..4 {
            let (mut left, mut right) = (NORTH.to_vec(), SOUTH.to_vec());
            if flip & 1 == 1 {
                left.reverse();
            }
            if flip & 2 == 2 {
                right.reverse();
            }
            let lanelet = Lanelet::new(&left, &right, None);
            assert_eq!(
                (lanelet.left, lanelet.right),
                (NORTH.to_vec(), SOUTH.to_vec())
            );
            assert_eq!(
                (lanelet.centre[0], lanelet.centre[12]),
                ([0.0, 2.0], [10.0, 2.0])
            );
        }
        let west = Lanelet::new(&SOUTH, &NORTH, None);
        assert_eq!(west.centre[0], [10.0, 2.0]);
    }

    #[test]
    fn a_lanelet_leads_into_those_that_begin_where_it_ends() {
        let on = |from: f64| {
            let shift = |line: [MapPoint; 2]| line.map(|[x, y]| [x + from, y]);
            Lanelet::new(&shift(NORTH), &shift(SOUTH), None)
        };
        let mut lanelets = [on(0.0), on(10.0), on(10.0), on(30.0)];
        join(&mut lanelets);
        assert_eq!(lanelets[0].successors, [1, 2]);
        assert!(lanelets[1..].iter().all(|l| l.successors.is_empty()));
    }
}
