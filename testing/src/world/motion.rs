//! Motion along a road under constant acceleration: never backwards, and no faster than a cap.

/// Where a vehicle is, in metres, and how fast, in m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct State {
    pub(crate) s: f64,
    pub(crate) v: f64,
}

impl State {
    /// The state after `time` (s) at `acceleration` (m/s²). One that reaches `cap` (m/s) keeps it; one that is faster
    /// keeps its speed at most; one at rest stays there unless it accelerates.
    pub(crate) fn after(self, acceleration: f64, time: f64, cap: f64) -> Self {
        let Self { s, v } = self;
        let end = v + acceleration * time;
        let limit = cap.max(v);
        if end < 0.0 {
            let s = s + v * v / (-2.0 * acceleration);
            return Self { s, v: 0.0 };
        }
        if end > limit {
            let ramp = (limit - v) / acceleration;
            let s = s + 0.5 * (v + limit) * ramp + limit * (time - ramp);
            return Self { s, v: limit };
        }
        let s = s + 0.5 * (v + end) * time;
        Self { s, v: end }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_stops_for_good_and_keeps_the_cap() {
        let start = State { s: 0.0, v: 10.0 };
        let near = |a: State, s: f64, v: f64| (a.s - s).abs() < 1e-9 && (a.v - v).abs() < 1e-9;
        assert!(near(start.after(-2.5, 10.0, 20.0), 20.0, 0.0));
        assert!(near(start.after(2.0, 1.0, 20.0), 11.0, 12.0));
        assert!(near(start.after(2.0, 2.0, 12.0), 11.0 + 12.0, 12.0));
        assert!(near(start.after(2.0, 1.0, 5.0), 10.0, 10.0));
    }
}
