//! Somebody who has not been seen yet, because it is still too far away to matter.

use crate::motion::{State, soonest};
use crate::numbers::Numbers;
use crate::site::Area;

/// Metres to spare for what the shield allows for beyond the motion itself.
const SPARE: f64 = 1.0;

/// Seconds to spare.
const TIME: f64 = 0.3;

/// Whether an ego at `ego` that carries out `command` for a period, goes for `go` more and then brakes keeps clear of
/// another at `other`, whatever that does.
#[must_use]
pub fn fits(
    numbers: &Numbers,
    ego: State,
    (command, go): (f64, u16),
    other: State,
    areas: &[Area],
) -> bool {
    let late = numbers.period + numbers.response();
    let plan = f64::from(go) * numbers.period;
    let spare = SPARE + 6.0 * numbers.position_error;
    let error = 2.0 * numbers.speed_error;
    // The farthest and the nearest that the ego gets.
    let fast = State {
        v: ego.v + error,
        ..ego
    };
    let most = if go > 0 {
        numbers.ego.acceleration
    } else {
        command.max(0.0) + numbers.drivetrain.off(command)
    };
    let farthest = fast
        .after(most, late, f64::INFINITY)
        .after(numbers.ego.acceleration, plan, f64::INFINITY)
        .rest(numbers.brakes);
    let slow = State {
        v: (ego.v - error).max(0.0),
        ..ego
    };
    let slow = slow.after(-numbers.ego.braking, late, f64::INFINITY);
    let switched = numbers.ego.acceleration + numbers.ego.braking;
    let cap = numbers.ego.speed - error - switched * late;
    // One that stands while its brakes let go starts later.
    let late = late + numbers.drivetrain.lag * numbers.ego.braking / numbers.go;
    areas.iter().all(|area| {
        let over = ego.s >= area.ego[1] + spare || other.s >= area.other[1] + spare;
        let stops = farthest + spare < area.ego[0];
        let clears = late
            + soonest(
                area.ego[1] + spare - slow.s,
                slow.v,
                numbers.go,
                cap.max(0.5),
            );
        let arrives = soonest(
            area.other[0] - spare - other.s,
            other.v + error,
            numbers.other.acceleration,
            numbers.other.speed,
        );
        over || stops || (!area.lane && clears <= plan && clears + TIME < arrives)
    })
}
