//! Being in the zone at the wrong time.

use super::Prey;
use crate::motion::{State, soonest};
use crate::numbers::{Means, Numbers};
use crate::site::Area;

/// When the ego is in the zone if it goes for it from now on: from and to, in s.
fn stay(numbers: &Numbers, prey: Prey<'_>, area: Area) -> [f64; 2] {
    let until = |at: f64| {
        soonest(
            at - prey.state.s,
            prey.state.v,
            numbers.go,
            numbers.ego.speed,
        )
    };
    // What it was commanded stays in effect for about a period.
    let late = if prey.command < 0.0 {
        numbers.period
    } else {
        0.0
    };
    [until(area.ego[0]) + late, until(area.ego[1]) + late]
}

/// The time at which `me` is at the zone if it chooses `acceleration` now and full throttle ever after.
fn arrival(means: &Means, me: State, acceleration: f64, area: Area) -> f64 {
    let next = me.after(acceleration, super::CHOICE, means.speed);
    super::CHOICE
        + soonest(
            area.other[0] - next.s,
            next.v,
            means.acceleration,
            means.speed,
        )
}

/// Waits as long as it can still be in the zone just before the ego has left it.
pub(super) fn aim(numbers: &Numbers, means: &Means, me: State, prey: Prey<'_>, area: Area) -> f64 {
    let [from, to] = stay(numbers, prey, area);
    let best = if to - from > 0.4 {
        to - 0.2
    } else {
        0.5 * (from + to)
    };
    let choices = [1.0, 0.3, 0.0, -0.15, -0.4, -1.0].map(|share: f64| {
        if share < 0.0 {
            -share * -means.braking
        } else {
            share * means.acceleration
        }
    });
    let miss = |a: f64| (arrival(means, me, a, area) - best).abs();
    let nearest = |a: &f64, b: &f64| miss(*a).total_cmp(&miss(*b));
    choices
        .into_iter()
        .min_by(nearest)
        .unwrap_or(means.acceleration)
}

/// Stops just before the zone and goes when the ego can no longer stop before it.
pub(super) fn lurk(numbers: &Numbers, means: &Means, me: State, prey: Prey<'_>, area: Area) -> f64 {
    let left = area.ego[0] - prey.state.s;
    let rest = prey.state.v * prey.state.v / (2.0 * numbers.ego.braking);
    let committed = left < 0.3 || (prey.go > 0 && left < rest);
    let room = area.other[0] - me.s;
    let way = me.rest(means.braking) - me.s + me.v * 0.15 + 0.05;
    if committed || room < 0.0 {
        means.acceleration
    } else if way > room {
        -means.braking
    } else if me.v < 8.0 {
        means.acceleration
    } else {
        0.0
    }
}
