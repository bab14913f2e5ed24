//! The safety predicate: margins in metres, safe if they are not negative.
//!
//! Each is a composition of +, −, ×, ÷, √, min and max, generic over [`Real`]: what is proved over
//! intervals is what the vehicle executes in `f32`.

use super::contract::Contract;
use super::reach::Reach;
use crate::real::Real;

/// Bounds on the ego until the first command of a plan is certainly in effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure<R> {
    /// At most this far and fast when braking is certainly in effect, if the plan brakes at once.
    pub braking: Reach<R>,
    /// At most this far and fast one period and the latency from now, if the plan goes.
    pub most: Reach<R>,
    /// At least this far and fast one period and the latency from now, if the plan goes.
    pub least: Reach<R>,
}

/// The speed (m/s) up to which the ego certainly goes as hard as it plans: neither its limiter, which errs by the
/// speed error at most, nor [`super::choice::most`] holds it back. `go` may be reduced while the ego is faster, and it
/// may then brake until the command takes effect. A contract demands that this is at least 0.01 m/s.
pub fn unlimited<R: Real>(contract: &Contract) -> R {
    let error = R::of(contract.speed_error);
    let switched = R::of(contract.ego.acceleration) + R::of(contract.ego.braking);
    let late = switched * R::of(contract.switching());
    let gain = R::of(contract.ego.go) * R::of(contract.period);
    R::of(contract.ego.max_speed) - error - error - late - gain
}

/// Bounds on the ego after `command` (m/s²) for one period, given now at `speed` (m/s, as sensed) while
/// one between the two `previous` (m/s²) is still in effect for at most the latency.
pub fn departure<R: Real>(
    contract: &Contract,
    speed: R,
    [previous_least, previous_most]: [R; 2],
    command: R,
) -> Departure<R> {
    let error = R::of(contract.speed_error);
    let latency = R::of(contract.switching());
    let rest = R::of(contract.shortest_period()) - latency;
    let (go, cap) = (R::of(contract.ego.go), unlimited(contract));
    let most = Reach::start(speed + error)
        .at_most(previous_most.max(command), latency)
        .at_most(command, rest);
    let least = Reach::start(speed - error)
        .at_least(previous_least.min(command), cap, latency)
        .at_least(command, cap, rest);
    Departure {
        braking: most.at_most(command, latency),
        most: most.at_most(command.max(go), latency),
        least: least.at_least(command.min(go), cap, latency),
    }
}

/// The time (s) from now at which the ego has certainly gone `target` metres, if it goes from
/// `least` on, and the least speed (m/s) that it then has.
pub fn clearing<R: Real>(contract: &Contract, least: Reach<R>, target: R) -> (R, R) {
    let (time, speed) = least.until(target, R::of(contract.ego.go), unlimited(contract));
    (
        time + R::of(contract.shortest_period()) + R::of(contract.switching()),
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

/// The distance (m) from here at which the ego is at rest at the latest, if it goes for `time` more and then brakes.
pub fn rest<R: Real>(contract: &Contract, most: Reach<R>, time: R) -> R {
    most.at_most(R::of(contract.ego.go), time)
        .rest(R::of(contract.ego.braking))
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

/// The gap (m) that an other at `speed` needs to stop behind an ego at `ego_speed`, however hard it
/// accelerates before it reacts, and however hard the ego brakes within its means.
pub fn safe_gap<R: Real>(contract: &Contract, speed: R, ego_speed: R) -> R {
    let follower = contract.follower;
    let stopped = rush(contract, speed, R::of(follower.reaction)).rest(R::of(follower.braking));
    // The gap is smallest at the end only if the one ahead brakes at least as hard.
    let ahead = R::of(contract.ego.braking).max(R::of(follower.braking));
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
