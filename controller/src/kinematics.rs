//! Motion along a route over one step: constant acceleration, no going backwards.

use crate::real::Elementary;

/// Time step of recordings, simulation and decisions in seconds (10 Hz).
pub const STEP: f32 = 0.1;

/// Accelerations are clamped to ± this (m/s²), as in the paper.
pub const MAX_ACCELERATION: f32 = 3.0;

/// State of a vehicle along its route.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State<R = f32> {
    /// Arc length in metres.
    pub s: R,
    /// Speed in m/s, never negative.
    pub v: R,
}

/// `acceleration` (m/s²) within ±[`MAX_ACCELERATION`]; NaN becomes full braking.
#[must_use]
#[inline]
pub fn clamp_acceleration<R: Elementary>(acceleration: R) -> R {
    acceleration.within(MAX_ACCELERATION)
}

/// The state one [`STEP`] after `state` under a constant `acceleration` in m/s²
/// (zero-order hold): s + vΔt + ½aΔt², v + aΔt.
///
/// A vehicle that would come to rest within the step does so where it would,
/// v²/2|a| further on, and stays; it never rolls backwards. The acceleration is
/// taken as it is: recorded ones may exceed what drivers may ask for
/// ([`clamp_acceleration`]). Finite for finite input with `v` ≥ 0.
#[must_use]
#[inline]
pub fn advance<R: Elementary>(state: State<R>, acceleration: R) -> State<R> {
    let State { s, v } = state;
    let end = v + acceleration * R::of(STEP);
    // Both cases are computed and one is selected, so that a loop over vehicles vectorises.
    let driven = (v + end) * R::of(0.5 * STEP);
    let stopped = v * v / (acceleration * R::of(-2.0));
    State {
        s: s + end.not_negative(driven, stopped),
        v: end.not_negative(end, R::of(0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_vehicle_brakes_to_rest_in_its_stopping_distance() {
        // 10 m/s at −3 m/s² stops after 16.67 m and 3.33 s, in the middle of a step.
        let mut state = State { s: 0.0, v: 10.0 };
        for _ in 0..40 {
            state = advance(state, -3.0);
        }
        assert!((state.s - 100.0 / 6.0).abs() < 1e-4, "{state:?}");
        assert_eq!(state.v, 0.0);
    }

    #[test]
    fn a_vehicle_at_rest_stays_at_rest() {
        let rest = State { s: 3.0, v: 0.0 };
        for acceleration in [-3.0, -0.0, 0.0] {
            assert_eq!(advance(rest, acceleration), rest);
        }
    }

    #[test]
    fn no_request_leaves_the_range_of_accelerations() {
        for (asked, given) in [
            (f32::NAN, -3.0),
            (f32::INFINITY, 3.0),
            (f32::NEG_INFINITY, -3.0),
            (1.5, 1.5),
        ] {
            assert_eq!(clamp_acceleration(asked), given);
        }
    }

    /// Whether `step` agrees with the closed form in `f64`, which integrates to the moment of rest.
    fn is_exact(step: fn(State, f32) -> State, state: State, acceleration: f32) -> bool {
        let (dt, v, a) = (f64::from(STEP), f64::from(state.v), f64::from(acceleration));
        let moving = if v + a * dt < 0.0 { -v / a } else { dt };
        let exact_s = f64::from(state.s) + v * moving + 0.5 * a * moving * moving;
        let exact_v = v + a * moving;
        let next = step(state, acceleration);
        (f64::from(next.s) - exact_s).abs() < 5e-5
            && (f64::from(next.v) - exact_v).abs() < 5e-6
            && next.v >= 0.0
            && next.s >= state.s
    }

    /// The property below is no truism: each of these is wrong in some of a few states.
    #[test]
    fn wrong_integrators_are_found_out() {
        let euler: fn(State, f32) -> State = |State { s, v }: State, a: f32| State {
            s: s + v * STEP,
            v: (v + a * STEP).max(0.0),
        };
        let rolls_back = |State { s, v }: State, a: f32| State {
            s: s + v * STEP + 0.5 * a * STEP * STEP,
            v: v + a * STEP,
        };
        let stops_on_the_spot = |state: State, a: f32| match advance(state, a) {
            State { v: 0.0, .. } => State { v: 0.0, ..state },
            next => next,
        };
        let states = [(8.0, 3.0), (0.25, -3.0), (0.0, -1.0), (0.2, -8.0)];
        for wrong in [euler, rolls_back, stops_on_the_spot] {
            let passes = |&(v, a): &(f32, f32)| is_exact(wrong, State { s: 1.0, v }, a);
            assert!(!states.iter().all(passes));
        }
        assert!(
            states
                .iter()
                .all(|&(v, a)| is_exact(advance, State { s: 1.0, v }, a))
        );
    }

    proptest! {
        #[test]
        fn one_step_is_the_exact_integral(
            s in -200.0_f32..200.0, v in 0.0_f32..30.0, a in -8.0_f32..8.0,
        ) {
            let state = State { s, v };
            prop_assert!(is_exact(advance, state, a));
        }

        #[test]
        fn vehicles_about_to_stop_are_stepped_exactly(v in 0.0_f32..0.8, a in -8.0_f32..0.0) {
            let state = State { s: 0.0, v };
            prop_assert!(is_exact(advance, state, a));
        }
    }
}
