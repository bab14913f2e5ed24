//! What the shield may make of a range of proposals, on a set of states.
//!
//! Its margins are the controller's own functions, over intervals. Which command it chooses is
//! decided by their signs: where a sign is not certain, every command that may be chosen counts.

use super::states::States;
use crate::interval::Interval;
use cede_controller::Real;
use cede_controller::shield::actuation::Inherited;
use cede_controller::shield::choice::{self, GRID, grid};
use cede_controller::shield::reach::Reach;
use cede_controller::shield::{Contract, margin};

/// The conflict zone, as metres beyond the conflict points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Zone {
    /// The ego's.
    pub(super) ego: Interval,
    /// The other's.
    pub(super) other: Interval,
}

/// The commands (m/s²) that may come out, and why.
#[derive(Clone, Copy, Debug)]
pub(super) struct Commands {
    pub(super) range: Interval,
    /// Each of them leaves the ego able to stop short of the zone, or is that braking itself.
    pub(super) stops_short: bool,
}

/// What `f32` rounding may do to the margin of stopping (m): twice what [`crate::margin::bound`] shows.
pub(super) const STOPPING: f64 = 1e-4;
/// What it may do to the margin of clearing the zone (m): more than is shown there, again.
const CLEARING: f64 = 4e-3;
/// What it may do to a difference of arc lengths (m), with room to spare.
const PLACE: f64 = 1e-3;
/// What it may do to the hardest command (m/s²): it is a difference of speeds over a period.
const COMMAND: f64 = 1e-4;
/// The shield of a crossing with one other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shield {
    pub(super) contract: Contract,
    pub(super) zone: Zone,
}

/// The margin of a command as the shield may compute it: by stopping short of the zone, and by clearing it before the other.
struct Margins {
    stop: Interval,
    go: Interval,
}

impl Margins {
    fn best(&self) -> Interval {
        Real::max(self.stop, self.go)
    }

    fn may_be_accepted(&self) -> bool {
        self.best().hi >= 0.0
    }
}

impl Shield {
    /// Every command that may come out for a proposal in `wanted`, while one in `previous` is in
    /// effect.
    pub(super) fn commands(
        &self,
        states: &States,
        previous: Interval,
        wanted: Interval,
    ) -> Commands {
        let ego = self.contract.ego();
        let braking = f64::from(ego.braking);
        let most = choice::most(&self.contract, states.speed, previous);
        let most = most.wider(COMMAND).clamp(0.0, f64::from(ego.acceleration));
        let allowed = |a: Interval| Real::min(a, most);
        let wanted = allowed(wanted.clamp(-braking, f64::INFINITY));
        let verdict = self.margins(states, previous, wanted);
        let mut stops_short = verdict.go.hi < 0.0;
        if verdict.best().lo >= 0.0 {
            return Commands {
                range: wanted,
                stops_short,
            };
        }
        let command = |i: u8| {
            // The controller's own is rounded to `f32`.
            let a = allowed(grid::<Interval>(&ego, i).wider(1e-6));
            (a, self.margins(states, previous, a))
        };
        let grid: Vec<(Interval, Margins)> = (0..GRID).map(command).collect();
        let safe = |(_, margins): &&(Interval, Margins)| margins.best().lo >= 0.0;
        // The shield takes the nearest that is safe: nothing is farther than the one that certainly is.
        let nearest = grid.iter().filter(safe);
        let nearest = nearest.map(|(a, _)| farthest(*a, wanted)).reduce(f64::min);
        let possible = grid.iter().filter(|(a, margins)| {
            let near = nearest.is_none_or(|most| closest(*a, wanted) <= most);
            margins.may_be_accepted() && near
        });
        let mut range: Option<Interval> = None;
        let mut add = |a: Interval| range = Some(range.map_or(a, |all| all.hull(a)));
        for (a, margins) in possible {
            stops_short &= margins.go.hi < 0.0;
            add(*a);
        }
        if verdict.may_be_accepted() {
            add(wanted);
        }
        if nearest.is_none() {
            // The plan that was verified last brakes, or goes if it was one to clear the zone.
            add(Interval::point(-braking));
            if !stops_short {
                add(allowed(Interval::of(ego.go)));
            }
        }
        Commands {
            range: range.unwrap_or(Interval::new(-braking, most.hi)),
            stops_short,
        }
    }

    fn margins(&self, states: &States, previous: Interval, command: Interval) -> Margins {
        let (contract, zone) = (&self.contract, &self.zone);
        let departure = margin::departure(
            contract,
            states.speed,
            &Inherited::all(contract, [previous, previous]),
            command,
        );
        let limit = states.distance.add(zone.ego.low());
        let rest = departure.braking.rest(margin::braking(contract));
        let stop = margin::stops_short(contract, limit, rest);
        let stop = stop.and(self.stop_by_spare(states, previous, command));
        let target = states.distance.add(zone.ego.high());
        let clears = clears(contract, departure.least, target);
        let way = |speed, time| margin::rush(contract, speed, time).distance;
        let v = states.other_speed;
        let rush = Reach {
            distance: Interval::new(
                way(v.low(), clears.low()).lo,
                way(v.high(), clears.high()).hi,
            ),
            speed: v,
        };
        let arrives = states.other_distance.add(zone.other.low());
        let go = margin::clears_before(contract, arrives, rush);
        // A vehicle that has passed its zone leaves no conflict.
        let far = Interval::point(1e6);
        let passed = |end: Interval| (end.hi <= -PLACE, end.lo <= PLACE);
        let ego = passed(target);
        let other = passed(states.other_distance.add(zone.other.high()));
        let go = if ego.0 || other.0 {
            far
        } else if ego.1 || other.1 {
            go.hull(far)
        } else {
            go
        };
        Margins {
            stop: stop.wider(STOPPING),
            go: go.wider(CLEARING),
        }
    }

    /// The same margin of stopping from what there is to spare already, which does not lose how
    /// distance and speed correlate: with a latency of a whole period, the previous command
    /// acts for a period, then this one, then the brakes.
    fn stop_by_spare(&self, states: &States, previous: Interval, command: Interval) -> Interval {
        let ego = self.contract.ego();
        let period = Interval::of(self.contract.period());
        let gone = |v: Interval, a: Interval| {
            let after = Real::max(v.add(a.mul(period)), Interval::ZERO);
            (spent(v, after, period, Interval::of(ego.braking)), after)
        };
        let (first, then) = gone(states.speed, Real::max(previous, command));
        let (second, _) = gone(then, command);
        let slack = Interval::of(self.contract.slack());
        states.spare.sub(first).sub(second).sub(slack)
    }
}

/// When the ego has gone as far as `target`. The sooner, the faster and the farther it is already:
/// so the ends come from the corners, and no correlation of the numbers is lost.
fn clears(contract: &Contract, least: Reach<Interval>, target: Interval) -> Interval {
    let at = |end: fn(Interval) -> Interval, target| {
        let from = Reach {
            distance: end(least.distance),
            speed: end(least.speed),
        };
        margin::clearing(contract, from, target).0
    };
    let (soonest, latest) = (
        at(Interval::high, target.low()).lo,
        at(Interval::low, target.high()).hi,
    );
    Interval::new(soonest.max(0.0), latest)
}

/// Metres less to spare for braking after `period` in which the speed goes from `from` to `to`:
/// the way, and the braking distance gained.
pub(super) fn spent(from: Interval, to: Interval, period: Interval, braking: Interval) -> Interval {
    let brisker = to.sub(from).div(braking);
    from.add(to).scale(0.5).mul(period.add(brisker))
}

fn farthest(a: Interval, wanted: Interval) -> f64 {
    a.sub(wanted).magnitude()
}

fn closest(a: Interval, wanted: Interval) -> f64 {
    (a.lo - wanted.hi).max(wanted.lo - a.hi).max(0.0)
}
