//! The conflict zones ahead, as distances from where the ego is now.

use super::contract::Contract;
use super::precedence::Claims;
use super::reach::Reach;
use super::rules::Rules;
use crate::junction::conflict::RightOfWay;
use crate::junction::scene::{MAX_OTHERS, Scene};
use crate::junction::zone::{FAR, MAX_ZONES, Zone};
use crate::observation::{Observation, Vehicle};
use crate::real::Real;
use heapless::Vec;

const CAPACITY: usize = MAX_OTHERS * MAX_ZONES;

/// A zone that the ego has not cleared and the other has not left.
///
/// All distances are metres from where the ego is, sensing errors included on the safe side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hazard {
    /// Number of the other.
    pub other: u8,
    /// Having gone so far, the ego has certainly cleared the zone, and sees it.
    pub target: f32,
    /// The ego must come to rest within this distance unless it clears the zone in time.
    pub limit: f32,
    /// The least limit of the hazards whose targets are farther.
    pub limit_beyond: f32,
    /// What clearing in time means.
    pub passage: Passage,
}

/// When the ego may clear a hazard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Passage {
    /// Before the other arrives at its zone.
    Before {
        /// Metres, at least, from the other to its zone; negative if it is in it.
        distance: f32,
        /// The other's speed, at most, in m/s.
        speed: f32,
    },
    /// Ahead of the other, with the safe gap, into the lane that they share from there on.
    Ahead {
        /// The gap (m), at least, if the other stayed where it is.
        gap: f32,
        /// The other's speed, at most, in m/s.
        speed: f32,
    },
    /// Not as long as the other is where it is: the ego is behind it in one lane, or meets it head-on.
    Never,
}

/// The hazards, sorted by [`Hazard::target`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hazards {
    sorted: Vec<Hazard, CAPACITY>,
}

impl Hazards {
    /// No hazards.
    pub(crate) const fn new() -> Self {
        Self { sorted: Vec::new() }
    }

    /// Adds the hazards of what is seen, but for those that the rule of precedence takes away. In place,
    /// because they are the largest thing on the stack.
    ///
    /// Cost: O(zones²) for the sorting, at most 24².
    pub(crate) fn add<const N: usize, R: Rules>(
        &mut self,
        contract: &Contract,
        scene: &Scene<N>,
        seen: &Observation<N>,
        claims: Claims,
    ) {
        // From where the first zone that precedence opens begins to where the last one ends.
        let mut open = [FAR, -FAR];
        let pairs = scene.conflicts().iter().zip(seen.others.iter());
        for (number, (conflict, other)) in (0_u8..).zip(pairs) {
            let Some(other) = other else { continue };
            for (index, zone) in (0_u8..).zip(conflict.zones()) {
                if let Some(hazard) = hazard::<R>(contract, zone, &seen.ego, other) {
                    let vehicles = (&seen.ego, other);
                    if claims.has(number, index)
                        && granted(contract, hazard.passage, zone, vehicles)
                    {
                        let entry = zone.ego.from - seen.ego.s - contract.position_error;
                        open = [Real::min(open[0], entry), Real::max(open[1], hazard.target)];
                        continue;
                    }
                    self.insert::<R>(Hazard {
                        other: number,
                        ..hazard
                    });
                }
            }
        }
        if open[0] >= 0.0 {
            self.keep_clear(scene, open);
        }
        self.look_beyond();
    }

    /// In zones that precedence opens, the ego waits only for those who have the right of way. Whoever it holds up there
    /// may hold up others: if all waited so, each in the way of the next, their rights would go round in a circle.
    ///
    /// It may still come to rest there behind those who share its lane.
    fn keep_clear<const N: usize>(&mut self, scene: &Scene<N>, [from, to]: [f32; 2]) {
        for hazard in &mut self.sorted {
            let conflict = scene.conflicts().get(usize::from(hazard.other));
            let yields = conflict.is_some_and(|m| m.right_of_way == RightOfWay::Other);
            let crosses = matches!(hazard.passage, Passage::Before { .. });
            if crosses && !yields && (from..to).contains(&hazard.limit) {
                hazard.limit = from;
            }
        }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Hazard> {
        self.sorted.iter()
    }

    /// The least limit of all.
    pub(crate) fn nearest_limit(&self) -> f32 {
        self.sorted
            .first()
            .map_or(FAR, |first| Real::min(first.limit, first.limit_beyond))
    }

    fn insert<R: Rules>(&mut self, hazard: Hazard) {
        // 8 others of 3 zones: `Scene` and `MAX_ZONES` see to it that there are no more.
        let _ = self.sorted.push(hazard);
        for i in (1..self.sorted.len()).rev() {
            if let Some([before, after]) = self.sorted.get_mut(i - 1..=i)
                && R::sooner(after.target, before.target)
            {
                core::mem::swap(before, after);
            }
        }
    }

    fn look_beyond(&mut self) {
        let mut least = FAR;
        for hazard in self.sorted.iter_mut().rev() {
            hazard.limit_beyond = least;
            least = Real::min(least, hazard.limit);
        }
    }
}

/// The hazard of one zone, if it is one.
fn hazard<R: Rules>(
    contract: &Contract,
    zone: &Zone,
    ego: &Vehicle,
    other: &Vehicle,
) -> Option<Hazard> {
    let error = contract.position_error;
    if ego.s - error >= zone.ego.to || R::left(zone, other.s - error) {
        return None;
    }
    let stop = zone.ego.from - ego.s - error;
    let crossing = Hazard {
        other: 0,
        // The ego is then past the zone by twice the error, so that it will be seen to be.
        target: R::cleared_at(zone) - ego.s + 3.0 * error,
        limit: stop,
        limit_beyond: FAR,
        passage: Passage::Before {
            distance: zone.other.from - other.s - error,
            speed: other.speed + contract.speed_error,
        },
    };
    if !zone.is_lane() {
        return Some(crossing);
    }
    let lead = ego.s - other.s;
    if ego.s - error >= zone.ego.from && lead >= zone.middle() {
        // The ego is ahead in the lane: the other is the one who has to keep its distance.
        return None;
    }
    let behind = behind::<R>(contract, zone.lead.from - lead - 2.0 * error, other);
    Some(if behind > stop {
        Hazard {
            target: FAR,
            limit: behind,
            passage: Passage::Never,
            ..crossing
        }
    } else {
        Hazard {
            target: zone.ego.from - ego.s + 3.0 * error,
            passage: Passage::Ahead {
                gap: zone.ego.from - other.s - error - zone.lead.to,
                speed: other.speed + contract.speed_error,
            },
            ..crossing
        }
    })
}

/// How far the ego may go and still be at rest behind an other that is `gap` ahead and brakes as hard as it can.
fn behind<R: Rules>(contract: &Contract, gap: f32, other: &Vehicle) -> f32 {
    if gap < 0.0 {
        // Not behind it at all.
        return gap;
    }
    let speed = other.speed - contract.speed_error;
    gap + R::earliest_rest(contract, if speed > 0.0 { speed } else { 0.0 })
}

/// Whether a zone in which the ego has precedence is no hazard: the other can still stop before it, and
/// stays out of it for as long as the ego likes. The ego may even wait in it.
///
/// Into a lane only if the ego is too near for the other to enter ahead of it: one that has
/// planned to do so, with a safe gap, need not stop, and the ego must then be able to.
pub(super) fn granted(
    contract: &Contract,
    passage: Passage,
    zone: &Zone,
    (ego, other): (&Vehicle, &Vehicle),
) -> bool {
    let Some(rule) = contract.precedence else {
        return false;
    };
    let error = contract.position_error;
    let settled = match passage {
        Passage::Before { .. } => true,
        Passage::Ahead { .. } => ego.s - error - zone.other.from > zone.lead.from,
        Passage::Never => false,
    };
    let speed = other.speed + contract.speed_error;
    let seen = Reach {
        distance: other.s + error,
        speed,
    };
    settled && zone.other.from >= seen.rest(rule.braking)
}
