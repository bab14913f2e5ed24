//! Motion in pieces of constant acceleration, integrated exactly.

/// A sub-step in s: overlaps are looked for after each.
pub const TICK: f64 = 0.005;

/// Where a vehicle is along its polyline, and how fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Arc length in m.
    pub s: f64,
    /// Speed in m/s, never negative.
    pub v: f64,
}

impl State {
    /// `time` later at a constant `acceleration`: it stays at rest once it has stopped, and does not accelerate
    /// beyond `cap`. One above `cap` keeps its speed unless it brakes.
    #[must_use]
    pub fn after(self, acceleration: f64, time: f64, cap: f64) -> Self {
        let Self { s, v } = self;
        let end = v + acceleration * time;
        if acceleration < 0.0 {
            if end >= 0.0 {
                Self {
                    s: s + 0.5 * (v + end) * time,
                    v: end,
                }
            } else {
                Self {
                    s: s - 0.5 * v * v / acceleration,
                    v: 0.0,
                }
            }
        } else if v >= cap {
            Self { s: s + v * time, v }
        } else if end <= cap {
            Self {
                s: s + 0.5 * (v + end) * time,
                v: end,
            }
        } else {
            let ramp = (cap - v) / acceleration;
            Self {
                s: s + 0.5 * (v + cap) * ramp + cap * (time - ramp),
                v: cap,
            }
        }
    }

    /// Where it is at rest if it brakes at `braking` from now on.
    #[must_use]
    pub fn rest(self, braking: f64) -> f64 {
        self.s + self.v * self.v / (2.0 * braking)
    }
}

/// The time until a vehicle at `v` has gone `distance` at full `acceleration` up to `cap`; 0 if it is there.
#[must_use]
pub fn soonest(distance: f64, v: f64, acceleration: f64, cap: f64) -> f64 {
    if distance <= 0.0 {
        return 0.0;
    }
    let cap = cap.max(v);
    let ramp = ((cap * cap - v * v) / (2.0 * acceleration)).min(distance);
    let fast = (v * v + 2.0 * acceleration * ramp).sqrt();
    (fast - v) / acceleration + (distance - ramp) / cap
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_the_sum_of_small_steps() {
        for v in [0.0, 0.4, 7.0, 15.0, 16.0] {
            for a in [-8.0, -1.0, 0.0, 0.5, 3.0] {
                let whole = State { s: 0.0, v }.after(a, 1.0, 15.0);
                let parts =
                    (0..1000).fold(State { s: 0.0, v }, |state, _| state.after(a, 0.001, 15.0));
                assert!((whole.s - parts.s).abs() < 1e-9 && (whole.v - parts.v).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_soonest_arrival_is_that_of_full_acceleration() {
        for (distance, v) in [(1.0, 0.0), (30.0, 4.0), (200.0, 14.0), (9.0, 20.0)] {
            let time = soonest(distance, v, 3.0, 15.0);
            let there = State { s: 0.0, v }.after(3.0, time, 15.0);
            assert!((there.s - distance).abs() < 1e-9);
        }
    }
}
