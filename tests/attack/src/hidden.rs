//! Somebody who has not been seen yet, because it is still too far away to matter.

use crate::motion::{State, soonest};
use crate::numbers::Numbers;
use crate::site::Area;

/// Metres to spare for what the shield allows for beyond the motion itself.
const SPARE: f64 = 1.0;

/// Seconds to spare.
const TIME: f64 = 0.3;

/// What an ego does next.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// The hardest acceleration (m/s²) of what was commanded before and may still act.
    pub acts: f64,
    /// What is commanded for one period, in m/s².
    pub command: f64,
    /// For how many more periods it goes, before it brakes.
    pub go: u16,
}

/// Whether an ego at `ego` on this course keeps clear of another at `other`, whatever that does.
#[must_use]
pub fn fits(numbers: &Numbers, ego: State, course: Course, other: State, areas: &[Area]) -> bool {
    let late = numbers.period + numbers.response();
    let plan = f64::from(course.go) * numbers.period;
    let spare = SPARE + 6.0 * numbers.position_error;
    let error = 2.0 * numbers.speed_error;
    // The farthest and the nearest that the ego gets.
    let fast = State {
        v: ego.v + error,
        ..ego
    };
    let strong = |command: f64| command.max(0.0) + numbers.drivetrain.off(command);
    let commanded = if course.go > 0 {
        numbers.ego.acceleration
    } else {
        strong(course.command)
    };
    let farthest = fast
        .after(
            strong(course.acts).max(commanded),
            numbers.response(),
            f64::INFINITY,
        )
        .after(commanded, numbers.period, f64::INFINITY)
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
