//! The way of a vehicle: a polyline addressed by arc length.

use crate::plane::{Place, V2, along, direction, dot, minus, norm};

/// A polyline in f64, through the very f32 points that the controller is given.
#[derive(Clone, Debug)]
pub struct Polyline {
    points: Vec<V2>,
    arc: Vec<f64>,
    /// Direction of each segment.
    directions: Vec<V2>,
}

impl Polyline {
    /// Through `points`, at least two and apart from each other.
    ///
    /// # Panics
    /// If there are fewer than two.
    #[must_use]
    pub fn new(points: &[[f32; 2]]) -> Self {
        assert!(points.len() >= 2, "a polyline needs two points");
        let points: Vec<V2> = points.iter().map(|p| p.map(f64::from)).collect();
        let steps = || points.windows(2).map(|pair| minus(pair[1], pair[0]));
        let mut arc = vec![0.0];
        let mut length = 0.0;
        for step in steps() {
            length += norm(step);
            arc.push(length);
        }
        let directions = steps().map(direction).collect();
        Self {
            points,
            arc,
            directions,
        }
    }

    /// Length in metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.arc.last().copied().unwrap_or(0.0)
    }

    /// Its points.
    #[must_use]
    pub fn points(&self) -> &[V2] {
        &self.points
    }

    /// The arc length at each point.
    #[must_use]
    pub fn arc(&self) -> &[f64] {
        &self.arc
    }

    /// The direction of each segment.
    #[must_use]
    pub fn directions(&self) -> &[V2] {
        &self.directions
    }

    fn segment(&self, s: f64) -> usize {
        self.arc
            .partition_point(|&a| a <= s)
            .clamp(1, self.directions.len())
            - 1
    }

    /// How far (m) the nearest kink is from `s`.
    #[must_use]
    pub fn from_kink(&self, s: f64) -> f64 {
        let i = self.segment(s);
        let kink = |at: usize| (1..self.directions.len()).contains(&at);
        let away = |at: usize| (s - self.arc[at]).abs();
        let beside = [i, i + 1].into_iter().filter(|&at| kink(at));
        beside.map(away).fold(f64::INFINITY, f64::min)
    }

    /// The place at arc length `s`, the heading that of the segment; straight on beyond both ends.
    #[must_use]
    pub fn place(&self, s: f64) -> Place {
        let i = self.segment(s);
        Place {
            at: along(self.points[i], self.directions[i], s - self.arc[i]),
            to: self.directions[i],
        }
    }

    /// The place at `s` of a vehicle that turns through a kink on its way from `reach` metres before it to as many after
    /// it, on either side at most to the middle of the segment. At the kink it has turned by half; with an `ease` of 1 it
    /// turns steadily, with a smaller one most of it where it begins and ends.
    #[must_use]
    pub fn turning_place(&self, s: f64, reach: f64, ease: f64) -> Place {
        let i = self.segment(s);
        let here = Place {
            at: along(self.points[i], self.directions[i], s - self.arc[i]),
            to: self.directions[i],
        };
        let half = 0.5 * (self.arc[i + 1] - self.arc[i]);
        let into = s - self.arc[i];
        let (towards, away) = if into < half {
            (i.checked_sub(1), into)
        } else {
            (Some(i + 1), 2.0 * half - into)
        };
        let away = away / reach.min(half);
        match towards.and_then(|other| self.directions.get(other)) {
            Some(&other) if (0.0..1.0).contains(&away) => {
                let share = if ease == 1.0 {
                    1.0 - away
                } else {
                    (1.0 - away).powf(ease)
                };
                // Of two unit vectors, 1 to 1 is halfway.
                let mixed = along(here.to, other, share / (2.0 - share));
                Place {
                    to: direction(mixed),
                    ..here
                }
            }
            _ => here,
        }
    }

    /// Arc length of the point of the polyline nearest to `p`, in [0, length].
    #[must_use]
    pub fn project(&self, p: V2) -> f64 {
        let mut best = (f64::INFINITY, 0.0);
        for (i, &to) in self.directions.iter().enumerate() {
            let ahead = dot(minus(p, self.points[i]), to).clamp(0.0, self.arc[i + 1] - self.arc[i]);
            let away = norm(minus(along(self.points[i], to, ahead), p));
            if away < best.0 {
                best = (away, self.arc[i] + ahead);
            }
        }
        best.1
    }

    /// The largest bend in one point, in rad.
    #[must_use]
    pub fn sharpest(&self) -> f64 {
        let bends = self.directions.windows(2).map(|pair| dot(pair[0], pair[1]));
        bends.fold(1.0, f64::min).clamp(-1.0, 1.0).acos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_follow_the_points_and_the_heading_turns_through_a_kink() {
        let line = Polyline::new(&[[0.0, 0.0], [10.0, 0.0], [10.0, 5.0]]);
        assert_eq!(line.length(), 15.0);
        assert_eq!(line.place(12.0).at, [10.0, 2.0]);
        assert_eq!(line.place(-1.0).at, [-1.0, 0.0]);
        assert_eq!(line.place(17.0).at, [10.0, 7.0]);
        let angle = |s: f64, ease: f64| {
            let to = line.turning_place(s, 0.25, ease).to;
            to[1].atan2(to[0]).to_degrees()
        };
        for ease in [1.0, 0.2] {
            assert!((angle(10.0 - 1e-9, ease) - 45.0).abs() < 1e-3);
            assert!((angle(10.0, ease) - 45.0).abs() < 1e-3);
            assert!(angle(9.5, ease) == 0.0 && angle(10.5, ease) == 90.0);
            assert!(angle(9.9, ease) > 0.0 && angle(10.1, ease) < 90.0);
        }
        assert!(angle(9.8, 0.2) > 2.0 * angle(9.8, 1.0));
        assert!((line.project([9.0, 2.5]) - 12.5).abs() < 1e-12);
        assert!((line.sharpest().to_degrees() - 90.0).abs() < 1e-9);
    }
}
