//! How far a vehicle gets: the bounds on motion from which the margins are made.
//!
//! Every function is one expression without branches, generic over [`Real`], and total: finite
//! for finite speeds and times that are not negative and accelerations above 0.

use crate::real::Real;

/// A distance travelled (m) and the speed (m/s) at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach<R> {
    /// Metres.
    pub distance: R,
    /// Metres per second; below 0 only in [`Reach::sinking`].
    pub speed: R,
}

impl<R: Real> Reach<R> {
    /// Nowhere yet, at `speed`.
    pub fn start(speed: R) -> Self {
        let (distance, zero) = (R::of(0.0), R::of(0.0));
        Self {
            distance,
            speed: speed.max(zero),
        }
    }

    /// At most as far and as fast as this after `time` more at `acceleration`, of either sign.
    ///
    /// Exact, but for a vehicle that comes to rest on the way: that one stops no later.
    #[inline(always)]
    #[must_use]
    pub fn at_most(self, acceleration: R, time: R) -> Self {
        let speed = (self.speed + acceleration * time).max(R::of(0.0));
        Self {
            distance: self.distance + (self.speed + speed) * time * R::of(0.5),
            speed,
        }
    }

    /// At least as far and as fast as this after `time` more at `acceleration`, of either sign, by a vehicle
    /// that is perhaps not accelerated beyond the speed `cap`; one that is faster already keeps its speed.
    ///
    /// Exact, but for a vehicle that reaches the cap or comes to rest on the way: that one gets no less far.
    #[must_use]
    pub fn at_least(self, acceleration: R, cap: R, time: R) -> Self {
        self.sinking(acceleration, cap, time, R::of(0.0))
    }

    /// [`Reach::at_least`], but the speed counts down to `floor` ≤ 0 (m/s): from there it must come up to 0 before the
    /// vehicle moves.
    #[must_use]
    pub fn sinking(self, acceleration: R, cap: R, time: R, floor: R) -> Self {
        let speed = (self.speed + acceleration * time).min(cap.max(self.speed));
        let step = (self.speed + speed) * time * R::of(0.5);
        Self {
            distance: self.distance + step.max(R::of(0.0)),
            speed: speed.max(floor),
        }
    }

    /// As fast as that after it has lost `loss` (m/s), but not below `cap`.
    #[inline(always)]
    #[must_use]
    pub fn fading(self, cap: R, loss: R) -> Self {
        let speed = self.speed.min(cap.max(self.speed - loss));
        Self { speed, ..self }
    }

    /// After `time` more at `acceleration` > 0 up to the speed `cap`, which is then kept;
    /// a vehicle that is faster already keeps its speed.
    #[inline(always)]
    #[must_use]
    pub fn rushing(self, acceleration: R, cap: R, time: R) -> Self {
        let cap = cap.max(self.speed);
        let limit = (cap - self.speed) / acceleration;
        let ramp = time.min(limit);
        let gained = (self.speed + acceleration * ramp * R::of(0.5)) * ramp;
        // Not `time - ramp`, which is the same but would count the error of `time` twice.
        let steady = (time - limit).max(R::of(0.0));
        Self {
            distance: self.distance + gained + cap * steady,
            speed: cap.min(self.speed + acceleration * time),
        }
    }

    /// Where a vehicle that brakes at `braking` > 0 from here comes to rest.
    #[inline(always)]
    #[must_use]
    pub fn rest(self, braking: R) -> R {
        self.distance + self.speed * self.speed / (braking + braking)
    }

    /// The time (s) that it takes from here at `acceleration` > 0, up to the speed `cap` > 0, until the
    /// distance is `target`, and the speed then. No time if it is there already.
    #[inline(always)]
    #[must_use]
    pub fn until(self, target: R, acceleration: R, cap: R) -> (R, R) {
        let left = (target - self.distance).max(R::of(0.0));
        let cap = cap.max(self.speed);
        let twice = acceleration + acceleration;
        let limit = (cap - self.speed) * (cap + self.speed) / twice;
        let ramp = left.min(limit);
        let speed = (self.speed * self.speed + twice * ramp).sqrt();
        // Not `left - ramp`, which is the same but would count the error of `left` twice.
        let steady = (left - limit).max(R::of(0.0));
        let time = (speed - self.speed).max(R::of(0.0)) / acceleration + steady / cap;
        (time, speed)
    }

    /// For how long (s) a vehicle whose speed may be below 0 ([`Reach::sinking`]) stands at `acceleration`, until its speed is 0,
    /// and what it does from then on.
    #[must_use]
    pub fn setting_off(self, acceleration: R) -> (R, Self) {
        let zero = R::of(0.0);
        let stands = zero.max(-self.speed) / acceleration;
        let moving = Self {
            speed: self.speed.max(zero),
            ..self
        };
        (stands, moving)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Integrates in 10,000 steps.
    fn integrate(mut v: f64, a: f64, cap: f64, time: f64) -> (f64, f64) {
        let (mut s, step) = (0.0, time / 10_000.0);
        for _ in 0..10_000 {
            let next = (v + a * step).clamp(0.0, cap.max(v));
            s += 0.5 * (v + next) * step;
            v = next;
        }
        (s, v)
    }

    proptest! {
        #[test]
        fn bounds_hold_the_motion(
            v in 0.0_f32..20.0, a in -8.0_f32..4.0, cap in 0.0_f32..25.0, time in 0.0_f32..2.0,
        ) {
            let (s, end) = integrate(v.into(), a.into(), 100.0, time.into());
            let (limited, slower) = integrate(v.into(), a.into(), cap.into(), time.into());
            let low = Reach::start(v).at_least(a, cap, time);
            let high = Reach::start(v).at_most(a, time);
            prop_assert!(f64::from(low.distance) <= limited + 1e-3 && s - 1e-3 <= f64::from(high.distance));
            prop_assert!((f64::from(low.speed) - slower).abs() < 1e-3);
            prop_assert!((f64::from(high.speed) - end).abs() < 1e-3);
            if (0.0..=cap).contains(&(v + a * time)) {
                prop_assert!((low.distance - high.distance).abs() < 1e-4);
            }
        }

        #[test]
        fn rushing_is_the_motion_and_until_its_inverse(
            v in 0.0_f32..20.0, a in 0.5_f32..4.0, cap in 1.0_f32..18.0, time in 0.0_f32..8.0,
        ) {
            let reach = Reach::start(v).rushing(a, cap, time);
            let (s, end) = integrate(v.into(), a.into(), cap.into(), time.into());
            prop_assert!((f64::from(reach.distance) - s).abs() < 2e-2);
            prop_assert!((f64::from(reach.speed) - end).abs() < 1e-3);
            let (back, speed) = Reach::start(v).until(reach.distance, a, cap);
            prop_assert!((back - time).abs() < 1e-3 || reach.distance < 1e-2);
            prop_assert!((speed - reach.speed).abs() < 2e-2);
        }

        #[test]
        fn rest_is_where_braking_ends(v in 0.0_f32..20.0, b in 0.5_f32..8.0) {
            let (s, _) = integrate(v.into(), (-b).into(), 100.0, 41.0);
            prop_assert!((f64::from(Reach::start(v).rest(b)) - s).abs() < 5e-2);
        }
    }
}
