//! Where two recorded polylines cross.

/// A point in metres, in the precision of the file.
pub(crate) type Point = [f64; 2];

/// Segments in a block; whole blocks are passed over by their bounding boxes.
const BLOCK: usize = 16;

/// The first proper crossing of polyline `a` with polyline `b`, first along `a`.
///
/// Proper: the segments' interiors cross, so neither a touch at an end nor a
/// shared stretch counts, and points that repeat do no harm.
pub(crate) fn first_crossing(a: &[Point], b: &[Point]) -> Option<Point> {
    let blocks: Vec<(Bounds, &[Point])> = (0..b.len().saturating_sub(1))
        .step_by(BLOCK)
        .map(|i| &b[i..b.len().min(i + BLOCK + 1)])
        .map(|points| (Bounds::of(points), points))
        .collect();
    let all = Bounds::of(b);
    a.windows(2).find_map(|segment| {
        let bounds = Bounds::of(segment);
        if !bounds.meets(&all) {
            return None;
        }
        let (from, to) = (segment[0], segment[1]);
        let share = blocks
            .iter()
            .filter(|(block, _)| bounds.meets(block))
            .flat_map(|(_, points)| points.windows(2))
            .filter_map(|other| crossing(from, to, other[0], other[1]))
            .min_by(f64::total_cmp)?;
        Some([
            from[0] + (to[0] - from[0]) * share,
            from[1] + (to[1] - from[1]) * share,
        ])
    })
}

/// Whether the segments `a`–`b` and `c`–`d` cross properly.
pub(crate) fn crosses(a: Point, b: Point, c: Point, d: Point) -> bool {
    crossing(a, b, c, d).is_some()
}

/// The share of the way from `a` to `b` at which the segment `c`–`d` crosses properly.
fn crossing(a: Point, b: Point, c: Point, d: Point) -> Option<f64> {
    let side = |from: Point, to: Point, p: Point| {
        (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0])
    };
    let (a_side, b_side) = (side(c, d, a), side(c, d, b));
    let apart = a_side * b_side < 0.0 && side(a, b, c) * side(a, b, d) < 0.0;
    apart.then(|| a_side / (a_side - b_side))
}

#[derive(Clone, Copy)]
struct Bounds {
    low: Point,
    high: Point,
}

impl Bounds {
    fn of(points: &[Point]) -> Self {
        let everywhere = Self {
            low: [f64::INFINITY; 2],
            high: [f64::NEG_INFINITY; 2],
        };
        points.iter().fold(everywhere, |bounds, p| Self {
            low: [bounds.low[0].min(p[0]), bounds.low[1].min(p[1])],
            high: [bounds.high[0].max(p[0]), bounds.high[1].max(p[1])],
        })
    }

    fn meets(&self, other: &Self) -> bool {
        (0..2).all(|i| self.low[i] <= other.high[i] && other.low[i] <= self.high[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_two_crossings_along_the_first_polyline_counts() {
        let a = [[0.0, 0.0], [0.0, 0.0], [10.0, 0.0]];
        let b = [[8.0, -1.0], [8.0, 1.0], [2.0, 1.0], [2.0, -1.0]];
        assert_eq!(first_crossing(&a, &b), Some([2.0, 0.0]));
        assert_eq!(first_crossing(&b, &a), Some([8.0, 0.0]));
    }

    #[test]
    fn touching_and_overlapping_do_not_count() {
        let a = [[0.0, 0.0], [10.0, 0.0]];
        assert_eq!(first_crossing(&a, &[[5.0, 0.0], [5.0, 4.0]]), None);
        assert_eq!(first_crossing(&a, &[[2.0, 0.0], [20.0, 0.0]]), None);
        assert_eq!(first_crossing(&a, &[[5.0, 1.0]]), None);
    }

    #[test]
    fn blocks_hide_no_crossing() {
        let wave = |i: i32| [f64::from(i), if i % 2 == 0 { 1.0 } else { -1.0 }];
        let b: Vec<Point> = (0..100).map(wave).collect();
        for i in 0..99 {
            let x = f64::from(i) + 0.5;
            let found = first_crossing(&[[x, -0.5], [x, 0.5]], &b);
            assert_eq!(found, Some([x, 0.0]), "segment {i}");
        }
    }
}
