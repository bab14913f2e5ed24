//! The safety predicate: margins in metres, safe if they are not negative.
//!
//! Each is a composition of +, −, ×, ÷, √, min and max, generic over [`Real`]: what is proved over
//! intervals is what the vehicle executes in `f32`.

use super::actuation::{Inherited, hold, strongest, weakest};
use super::contract::Contract;
use super::reach::Reach;
use crate::real::Real;

/// Bounds on the ego until the first command of a plan is certainly followed: the *response*, after the first period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure<R> {
    /// At most this far and fast when braking is certainly followed, if the plan brakes at once.
    pub braking: Reach<R>,
    /// At most this far and fast one period and the response from now, if the plan goes.
    pub most: Reach<R>,
    /// At least this far and fast one period and the response from now, if the plan goes. A speed below 0 is the time,
    /// times `go`, for which the ego may still stand.
    pub least: Reach<R>,
}

/// The speed (m/s) up to which the ego certainly goes as hard as it plans: neither its limiter, which errs by the
/// speed error at most, nor [`super::choice::most`] holds it back. `go` may be reduced while the ego is faster, and it
/// may then brake until the command is followed. A contract demands that this is at least 0.01 m/s.
#[inline(never)] // Once in flash.
pub fn unlimited<R: Real>(contract: &Contract) -> R {
    let ego = &contract.ego;
    let error = R::of(contract.speed_error);
    let switched =
        strongest(contract, R::of(ego.acceleration)) + strongest(contract, R::of(ego.emergency));
    let late = switched * R::of(contract.response());
    let gain = strongest(contract, R::of(ego.go)) * R::of(contract.period);
    let limit = R::of(ego.max_speed) - error - error - late - gain;
    if contract.is_exact() {
        return limit;
    }
    limit - fade::<R>(contract) * R::of(contract.period)
}

/// By how much (m/s²) a reduced `go` may slow the ego: it holds the speed against what nobody commands, or gives way to it.
pub(super) fn fade<R: Real>(contract: &Contract) -> R {
    let ego = &contract.ego;
    let disturbance = R::of(ego.disturbance);
    (disturbance + disturbance) / (R::of(1.0) - R::of(ego.gain))
}

/// Bounds on the ego after `command` (m/s²) for one period, given now at `speed` (m/s, as sensed) while what is `inherited`
/// still acts.
#[inline(never)] // Once in flash.
pub fn departure<R: Real>(
    contract: &Contract,
    speed: R,
    inherited: &Inherited<R>,
    command: R,
) -> Departure<R> {
    let error = R::of(contract.speed_error);
    let (go, cap) = (R::of(contract.ego.go), unlimited(contract));
    let (strong, weak) = (strongest(contract, command), weakest(contract, command));
    let (strong_go, weak_go) = (strongest(contract, go), weakest(contract, go));
    let [below, _] = inherited.bounds();
    let floor = hold(contract, below.min(weak), weak.max(weak_go));
    let slower = |from: Reach<R>, low, time| {
        let from = if contract.is_exact() {
            from
        } else {
            from.fading(cap, fade::<R>(contract) * time)
        };
        from.sinking(low, cap, time, floor)
    };
    let mut braking = Reach::start(speed + error);
    let mut most = braking;
    let mut least = Reach::start(speed - error);
    let mut rest = R::of(contract.shortest_period());
    for part in inherited.parts(contract) {
        let time = R::of(part.time);
        rest = rest - time;
        let [low, high] = part.bounds;
        let (high, low) = (high.max(strong), low.min(weak));
        braking = braking.at_most(high, time);
        let (high, low) = if part.later {
            (high.max(strong_go), low.min(weak_go))
        } else {
            (high, low)
        };
        most = most.at_most(high, time);
        least = slower(least, low, time);
    }
    let mut late = R::of(contract.response());
    if contract.responds_late() {
        late = R::of(contract.shortest_period());
    } else {
        braking = braking.at_most(strong, rest);
        most = most.at_most(strong, rest);
        least = slower(least, weak, rest);
    }
    Departure {
        braking: braking.at_most(strong, late),
        most: most.at_most(strong.max(strong_go), late),
        least: slower(least, weak.min(weak_go), late),
    }
}

/// How an ego goes at least, by its contract: the same for every target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Going<R> {
    /// The acceleration (m/s²) that is certain.
    acceleration: R,
    /// Up to this speed (m/s): [`unlimited`].
    cap: R,
    /// By how much (m/s²) a faster one may slow down to it; none, if nothing is inexact.
    fade: Option<R>,
    /// A speed below 0 is the time, times `acceleration`, for which it may still stand.
    lags: bool,
    /// The first period and the response (s), before which it may not go.
    late: [R; 2],
}

impl<R: Real> Going<R> {
    /// How an ego of this contract goes.
    #[inline(never)] // Once in flash.
    #[must_use]
    pub fn of(contract: &Contract) -> Self {
        Self {
            acceleration: weakest(contract, R::of(contract.ego.go)),
            cap: unlimited(contract),
            fade: (!contract.is_exact()).then(|| fade(contract)),
            lags: contract.ego.lag != 0.0,
            late: [contract.shortest_period(), contract.response()].map(R::of),
        }
    }

    /// The time (s) from now at which the ego has certainly gone `target` metres, if it goes from
    /// `least` on, and the least speed (m/s) that it then has.
    #[inline(always)]
    #[must_use]
    pub fn clearing(&self, least: Reach<R>, target: R) -> (R, R) {
        let (cap, [period, response]) = (self.cap, self.late);
        let least = self.fade.map_or(least, |fade| {
            // It is no slower than `cap` on the way, which therefore takes no longer.
            let longest = (target - least.distance).max(R::of(0.0)) / cap;
            least.fading(cap, fade * longest)
        });
        let (stands, moving) = least.setting_off(self.acceleration);
        let least = if self.lags { moving } else { least };
        let (time, speed) = least.until(target, self.acceleration, cap);
        let time = if self.lags { stands + time } else { time };
        (time + period + response, speed)
    }
}

/// [`Going::clearing`] of a single target.
#[must_use]
pub fn clearing<R: Real>(contract: &Contract, least: Reach<R>, target: R) -> (R, R) {
    Going::of(contract).clearing(least, target)
}

/// The least number of going periods after the first one with which the ego has gone for long enough
/// at `clears` (s from now) even if the last command takes effect at once and the first one late.
#[must_use]
pub fn periods(contract: &Contract, clears: f32) -> u16 {
    let count = (clears - contract.shortest_period()) / contract.period;
    // Truncates towards zero and saturates; bounded by the horizon in any case. By way of 32 bits, for which cores have an instruction.
    let whole = (count as u32).min(u16::MAX.into()) as u16;
    if f32::from(whole) < count {
        whole.saturating_add(1)
    } else {
        whole
    }
}

/// The braking (m/s²) that a plan certainly achieves.
pub fn braking<R: Real>(contract: &Contract) -> R {
    weakest(contract, R::of(contract.ego.braking))
}

/// The distance (m) from here at which the ego is at rest at the latest, if it goes for `time` more and then brakes.
#[inline(always)]
pub fn rest<R: Real>(contract: &Contract, most: Reach<R>, time: R) -> R {
    let go = strongest(contract, R::of(contract.ego.go));
    most.at_most(go, time).rest(braking(contract))
}

/// Metres to spare if the ego is at rest after at most `rest` metres and must not go beyond `limit`.
pub fn stops_short<R: Real>(contract: &Contract, limit: R, rest: R) -> R {
    limit - rest - R::of(contract.slack)
}

/// The farthest that an other at `speed` (m/s, at most) gets in `time` (s).
pub fn rush<R: Real>(contract: &Contract, speed: R, time: R) -> Reach<R> {
    Reach::start(speed).rushing(
        R::of(contract.other.acceleration),
        R::of(contract.other.max_speed),
        time,
    )
}

/// The least that an other at `speed` (m/s, at least) gets in `time` (s), however hard it brakes.
pub fn dawdle<R: Real>(contract: &Contract, speed: R, time: R) -> Reach<R> {
    Reach::start(speed).at_least(-R::of(contract.other.braking), R::of(0.0), time)
}

/// Metres that are left between an other and its zone, `distance` ahead of it, after its `rush`
/// until the ego has cleared its own zone.
pub fn clears_before<R: Real>(contract: &Contract, distance: R, rush: Reach<R>) -> R {
    distance - rush.distance - R::of(contract.slack)
}

/// Metres that are left between a pedestrian of at most `speed` (m/s) and its zone, `distance` away from it, after `time` (s).
pub fn walks_clear<R: Real>(contract: &Contract, distance: R, speed: R, time: R) -> R {
    distance - speed * time - R::of(contract.slack)
}

/// The gap (m) that an other at `speed` needs to stop behind an ego at `ego_speed`, however hard it
/// accelerates before it reacts, and however hard the ego brakes within its means.
#[inline(always)]
pub fn safe_gap<R: Real>(contract: &Contract, speed: R, ego_speed: R) -> R {
    let follower = contract.follower;
    let stopped = rush(contract, speed, R::of(follower.reaction)).rest(R::of(follower.braking));
    // The gap is smallest at the end only if the one ahead brakes at least as hard.
    let hardest = strongest(contract, R::of(contract.ego.braking));
    let ahead = hardest.max(R::of(follower.braking));
    (stopped - Reach::start(ego_speed).rest(ahead)).max(R::of(0.0))
}

/// Metres to spare beyond the gap that the other needs, when the ego enters a lane `gap` ahead of where
/// the other is now, and the other comes nearer by its `rush` until then.
pub fn enters_ahead<R: Real>(contract: &Contract, gap: R, rush: Reach<R>, needed: R) -> R {
    gap - rush.distance - needed - R::of(contract.slack)
}

/// Where an other at `speed` (m/s, at least) is at rest at the earliest, in metres from where it is.
pub fn earliest_rest<R: Real>(contract: &Contract, speed: R) -> R {
    Reach::start(speed).rest(R::of(contract.other.braking))
}

/// The earliest time (s) at which an other at `speed` (m/s, at most) has gone `distance` (m).
pub fn arrival<R: Real>(contract: &Contract, distance: R, speed: R) -> R {
    let (acceleration, cap) = (contract.other.acceleration, contract.other.max_speed);
    let (time, _) = Reach::start(speed).until(distance, R::of(acceleration), R::of(cap));
    time
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shield::contract::tests::INEXACT;

    const WORST: Contract = Contract::WORST_CASE;

    #[track_caller]
    fn near(a: f32, b: f32) {
        assert!((a - b).abs() < 1e-4 * (1.0 + b.abs()), "{a}, {b}");
    }

    #[track_caller]
    fn reaches(reach: Reach<f32>, distance: f32, speed: f32) {
        near(reach.distance, distance);
        near(reach.speed, speed);
    }

    fn departs(latency: f32) -> Departure<f32> {
        let contract = WORST.to_builder().latency(latency).speed_error(0.2);
        let contract = contract.build().unwrap();
        let inherited = Inherited::all(&contract, [-1.0, 2.0]);
        departure(&contract, 10.0, &inherited, 0.5)
    }

    /// What is inherited for the latency; then the command, or going, until the next one is followed.
    #[test]
    fn a_departure_is_what_is_inherited_and_then_what_is_commanded() {
        let now = departs(0.1);
        reaches(now.braking, 1.03 + 1.0425, 10.45);
        reaches(now.most, 1.03 + 1.055, 10.7);
        reaches(now.least, 0.975 + 0.9725, 9.75);
        // In half a period, what is commanded acts from then on.
        let soon = departs(0.05);
        reaches(soon.braking, 0.5125 + 0.515_625 + 0.516_875, 10.35);
        reaches(soon.most, 0.5125 + 0.515_625 + 0.520, 10.475);
        reaches(soon.least, 0.488_75 + 0.488_125 + 0.489_375, 9.8);
        // After a period, going may act as well as what is inherited.
        let late = departs(0.25);
        reaches(late.braking, 1.03 + 1.5825 + 1.0725, 10.75);
        reaches(late.most, 1.03 + 1.593_75 + 1.1, 11.15);
        reaches(late.least, 0.975 + 1.443_75 + 0.9575, 9.6);
    }

    /// 4/3 m/s² less than what acts: −1 m/s² for 0.54 s, then the command, −0.125 m/s² at least, for a period of 0.08 s.
    #[test]
    fn a_fast_ego_gives_way_to_what_nobody_commands_until_it_goes() {
        let inherited = Inherited::all(&INEXACT, [-1.0, 2.0]);
        let least = departure(&INEXACT, 12.0, &inherited, 0.5).least;
        reaches(least, 0.940_267 + 5.000_2 + 0.842_267, 10.523_333);
    }

    #[test]
    fn the_slowest_inexact_ego_gives_way_to_what_nobody_commands() {
        near(fade(&INEXACT), 1.0 / 0.75);
        near(unlimited(&INEXACT), 15.0 - 6.448_333);
        near(unlimited(&WORST), 14.1);
    }

    #[test]
    fn a_target_is_cleared_by_going_from_the_least_on() {
        let least = |distance, speed| Reach { distance, speed };
        let (time, speed) = clearing(&WORST, least(2.0, 10.0), 12.0);
        near(time, 0.883_04 + 0.2);
        near(speed, 160.0_f32.sqrt());
        // A faster one gives way by 4/3 m/s² for the 1.17 s that it takes at most, after 0.62 s.
        let (time, speed) = clearing(&INEXACT, least(2.0, 12.0), 12.0);
        near(time, 10.0 / 10.440_85 + 0.62);
        near(speed, 10.440_85);
        // As fast as its limiter lets it be, after 0.62 s; from below 0 after 2 s at rest.
        let (time, speed) = clearing(&INEXACT, least(2.0, 9.0), 12.0);
        near(time, 10.0 / 8.551_667 + 0.62);
        near(speed, 8.551_667);
        let (time, speed) = clearing(&INEXACT, least(2.0, -0.5), 12.0);
        near(time, 2.0 + 8.944_27 + 0.62);
        near(speed, 5.0_f32.sqrt());
    }

    #[test]
    fn a_plan_goes_for_whole_periods_that_are_enough() {
        let of = |clears| periods(&WORST, clears);
        assert_eq!([0.1, 0.11, 0.25, 0.35, 5.05].map(of), [0, 1, 2, 3, 50]);
        assert_eq!(periods(&WORST, 0.1 + 0.1), 1);
    }

    #[test]
    fn margins_are_what_is_left_of_a_distance() {
        let contract = WORST.to_builder().slack(0.05).build().unwrap();
        near(stops_short(&contract, 10.0, 4.0), 5.95);
        let rush = rush(&contract, 10.0, 0.5);
        reaches(rush, 5.375, 11.5);
        near(clears_before(&contract, 10.0, rush), 4.575);
        near(enters_ahead(&contract, 20.0, rush, 3.0), 11.575);
        near(walks_clear(&contract, 10.0, 2.0, 3.0), 3.95);
        reaches(dawdle(&contract, 10.0, 0.5), 4.0, 6.0);
        near(earliest_rest(&contract, 8.0), 4.0);
        near(arrival(&contract, 10.0, 5.0), 1.406_51);
        let from = Reach {
            distance: 1.0,
            speed: 4.0,
        };
        near(super::rest(&contract, from, 2.0), 1.0 + 14.0 + 100.0 / 6.0);
    }

    #[test]
    fn a_safe_gap_is_what_a_follower_needs_to_stop_behind_the_ego() {
        near(safe_gap(&WORST, 10.0, 4.0), 5.375 + 132.25 / 8.0 - 2.0);
        assert_eq!(safe_gap(&WORST, 1.0, 14.0), 0.0);
        // An ego that brakes harder than its follower, and perhaps harder than it says.
        near(
            safe_gap(&INEXACT, 10.0, 4.0),
            5.5 + 144.0 / 8.0 - 16.0 / 13.5,
        );
    }
}
