//! What a vehicle does that finds the ego ahead of it in its lane: it keeps its distance, as the contract says.

use super::motion::State;
use cede_controller::{Contract, Zone};

/// For how long (s) the gap has been too small.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Follower {
    short: f64,
}

/// Whether the ego is ahead of the other in the lane of `zone`.
pub(crate) fn is_ahead(zone: &Zone, ego: f64, other: f64) -> bool {
    zone.is_lane()
        && ego >= f64::from(zone.ego.from)
        && ego < f64::from(zone.ego.to)
        && other < f64::from(zone.other.to)
        && ego - other > f64::from(zone.lead.from)
}

/// Metres from the other to the ego ahead of it.
pub(crate) fn gap(zone: &Zone, ego: f64, other: f64) -> f64 {
    ego - other - f64::from(zone.lead.to)
}

/// The gap (m) that an other at `other` m/s needs behind an ego at `ego` m/s.
pub(crate) fn safe_gap(contract: &Contract, ego: f64, other: f64) -> f64 {
    let (follower, limits) = (contract.follower(), contract.other());
    let (reaction, braking) = (f64::from(follower.reaction), f64::from(follower.braking));
    let reacted = State { s: 0.0, v: other }.after(
        limits.acceleration.into(),
        reaction,
        limits.max_speed.into(),
    );
    let stopped = reacted.s + reacted.v * reacted.v / (2.0 * braking);
    let ahead = f64::from(contract.ego().braking).max(braking);
    (stopped - ego * ego / (2.0 * ahead)).max(0.0)
}

impl Follower {
    /// What it does instead of `wanted` (m/s²) for the next `time` (s), given the lanes in which the ego is ahead of it.
    pub(crate) fn keep_distance<'z>(
        &mut self,
        contract: &Contract,
        lanes: impl Iterator<Item = &'z Zone>,
        (ego, other): (State, State),
        (wanted, time): (f64, f64),
    ) -> f64 {
        let needed = safe_gap(contract, ego.v, other.v) + 2.0 * time * other.v;
        let mut lanes = lanes.filter(|zone| is_ahead(zone, ego.s, other.s));
        if !lanes.any(|zone| gap(zone, ego.s, other.s) < needed) {
            self.short = 0.0;
            return wanted;
        }
        self.short += time;
        let follower = contract.follower();
        if self.short + time < f64::from(follower.reaction) {
            return wanted;
        }
        wanted.min(-f64::from(follower.braking))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::{Place, Right, Road, Shape};
    use cede_controller::Footprint;

    /// The ego brakes as hard as it can; whoever starts with the safe gap does not run into it.
    #[test]
    fn the_safe_gap_is_enough() {
        let contract = Contract::WORST_CASE;
        let place = Place {
            shape: Shape::Following,
            arm: 80,
            tolerance: 0,
            right: Right::Nobody,
        };
        let junction = place.junction(Footprint::PAPER).unwrap();
        let conflict = junction
            .conflict(Road::Own.path(), Road::First.path())
            .unwrap();
        let zone = conflict.zones().next().unwrap();
        for (ego_speed, speed) in [(0.0, 10.0), (10.0, 15.0), (14.0, 3.0)] {
            let needs = safe_gap(&contract, ego_speed, speed) + 0.05 * speed;
            let mut ego = State {
                s: 100.0,
                v: ego_speed,
            };
            let mut other = State {
                s: 100.0 - needs - f64::from(zone.lead.to),
                v: speed,
            };
            let mut follower = Follower::default();
            for _ in 0..2000 {
                let pair = (ego, other);
                let a = follower.keep_distance(&contract, conflict.zones(), pair, (3.0, 0.02));
                ego = ego.after(-3.0, 0.02, 15.0);
                other = other.after(a, 0.02, 15.0);
                assert!(gap(zone, ego.s, other.s) > 0.0, "{ego_speed} {speed}");
            }
        }
    }
}
