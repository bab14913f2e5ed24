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

/// The time (s) from now at which the ego has certainly gone `target` metres, if it goes from
/// `least` on, and the least speed (m/s) that it then has.
#[inline(never)] // Once in flash.
pub fn clearing<R: Real>(contract: &Contract, least: Reach<R>, target: R) -> (R, R) {
    let go = weakest(contract, R::of(contract.ego.go));
    let cap = unlimited(contract);
    let least = if contract.is_exact() {
        least
    } else {
        // It is no slower than `cap` on the way, which therefore takes no longer.
        let longest = (target - least.distance).max(R::of(0.0)) / cap;
        least.fading(cap, fade::<R>(contract) * longest)
    };
    let (time, speed) = if contract.ego.lag == 0.0 {
        least.until(target, go, cap)
    } else {
        least.until_from_rest(target, go, cap)
    };
    (
        time + R::of(contract.shortest_period()) + R::of(contract.response()),
        speed,
    )
}

/// The least number of going periods after the first one with which the ego has gone for long enough
/// at `clears` (s from now) even if the last command takes effect at once and the first one late.
#[must_use]
pub fn periods(contract: &Contract, clears: f32) -> u16 {
    let count = (clears - contract.shortest_period()) / contract.period;
    // Truncates towards zero and saturates; bounded by the horizon in any case.
    let whole = count as u16;
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
#[inline(never)] // Once in flash.
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
