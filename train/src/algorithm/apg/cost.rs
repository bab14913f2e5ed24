//! The cost of deviating from the recorded drivers, and its derivatives.

use cede_controller::Footprint;
use cede_controller::geometry::distance;
use cede_controller::kinematics::State;
use cede_controller::separation::OrientedBox;
use cede_data::{Encounter, Role};
use serde::{Deserialize, Serialize};

/// The cost per step of deviating from the recorded drivers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Cost {
    /// Error in position (m) up to which the cost is half its square; beyond it the cost is linear.
    pub huber: f32,
    /// Weight of the squared error in speed, in s².
    pub speed: f32,
    /// Weight of the squared error of each vehicle's prediction of the other's acceleration, in s⁴.
    pub expectation: f32,
    /// Weight of a wrong order of arrival: the distance (m) that the recorded first vehicle has left to
    /// its conflict point, times the distance (m) by which the second is too close to its own.
    pub order: f32,
    /// Weight of a late first arrival: from the recorded end on, the distance (m) that the recorded first
    /// vehicle has left to its conflict point.
    #[serde(skip_serializing_if = "is_zero")]
    pub late: f32,
    /// Weight of the squared shortfall of the distance between the footprints.
    pub contact: f32,
    /// Distance (m) between the footprints below which it counts as too short.
    pub gap: f32,
}

impl Default for Cost {
    fn default() -> Self {
        Self {
            huber: 1.0,
            speed: 0.3,
            expectation: 0.02,
            order: 10.0,
            late: 0.0,
            contact: 20.0,
            gap: 0.5,
        }
    }
}

fn is_zero(weight: &f32) -> bool {
    *weight == 0.0
}

/// Distance (m) that the second vehicle should keep to its conflict point until the first arrives, and
/// the upper limit of the first one's remaining distance in the cost.
const ORDER_MARGIN: f32 = 2.0;
/// Steps past the recorded end up to which the order counts.
const ORDER_OVERTIME: usize = 20;
/// The distance between footprints is not computed if their centres are farther apart than this (m).
const OUT_OF_REACH: f32 = 7.0;

/// Derivatives of a cost with respect to the states (s, v) of both vehicles.
pub(crate) type ByStates = [[f32; 2]; 2];

impl Cost {
    /// The cost of being in `states` at `step` of `encounter`; adds its derivatives times `share` to `by`.
    pub(crate) fn of(
        &self,
        encounter: &Encounter,
        step: usize,
        states: [State; 2],
        share: f32,
        by: &mut ByStates,
    ) -> f32 {
        let mut own = ByStates::default();
        let total = self.imitation(encounter, step, states, &mut own)
            + self.disorder(encounter, step, states, &mut own)
            + self.lateness(encounter, step, states, &mut own)
            + self.closeness(encounter, states, &mut own);
        for (by, own) in by.iter_mut().flatten().zip(own.iter().flatten()) {
            *by += share * own;
        }
        total
    }

    /// The deviation from the record in position and speed, as far as there is a record.
    fn imitation(
        &self,
        encounter: &Encounter,
        step: usize,
        states: [State; 2],
        by: &mut ByStates,
    ) -> f32 {
        let mut total = 0.0;
        for i in 0..2 {
            let Some(record) = encounter.participants[i].record.get(step) else {
                continue;
            };
            let (ahead, faster) = (states[i].s - record.s, states[i].v - record.v);
            let clamped = ahead.clamp(-self.huber, self.huber);
            total += clamped * (ahead - 0.5 * clamped) + self.speed * faster * faster;
            by[i][0] += clamped;
            by[i][1] += 2.0 * self.speed * faster;
        }
        total
    }

    /// The order of arrival: the vehicle that was first in the record has not arrived, and the other is
    /// close to its conflict point.
    fn disorder(
        &self,
        encounter: &Encounter,
        step: usize,
        states: [State; 2],
        by: &mut ByStates,
    ) -> f32 {
        if self.order == 0.0 || step > encounter.steps as usize + ORDER_OVERTIME {
            return 0.0;
        }
        let (first, second) = match encounter.first {
            Role::Left => (0, 1),
            Role::Other => (1, 0),
        };
        let distance = |i: usize| encounter.participants[i].conflict_s - states[i].s;
        let (late, near) = (distance(first), ORDER_MARGIN - distance(second));
        if late <= 0.0 || near <= 0.0 {
            return 0.0;
        }
        let counted = late.min(ORDER_MARGIN);
        by[second][0] += self.order * counted;
        if late < ORDER_MARGIN {
            by[first][0] -= self.order * near;
        }
        self.order * counted * near
    }

    /// The distance that the vehicle that was first in the record still has to go after the recorded end.
    fn lateness(
        &self,
        encounter: &Encounter,
        step: usize,
        states: [State; 2],
        by: &mut ByStates,
    ) -> f32 {
        let end = encounter.steps as usize;
        let first = encounter.first as usize;
        let late = encounter.participants[first].conflict_s - states[first].s;
        if self.late == 0.0 || !(end..=end + ORDER_OVERTIME).contains(&step) || late <= 0.0 {
            return 0.0;
        }
        by[first][0] -= self.late;
        self.late * late
    }

    /// The distance between the footprints, where it is too short.
    fn closeness(&self, encounter: &Encounter, states: [State; 2], by: &mut ByStates) -> f32 {
        let area = |i: usize, ds: f32| {
            let pose = encounter.participants[i].route.pose(states[i].s + ds);
            OrientedBox::new(pose, Footprint::PAPER)
        };
        let (a, b) = (area(0, 0.0), area(1, 0.0));
        let near = distance(&a.centre, &b.centre) < OUT_OF_REACH;
        let short = self.gap - a.separation(&b);
        if self.contact == 0.0 || !near || short <= 0.0 {
            return 0.0;
        }
        let h = 0.05;
        let slopes = [
            area(0, h).separation(&b) - area(0, -h).separation(&b),
            a.separation(&area(1, h)) - a.separation(&area(1, -h)),
        ];
        for i in 0..2 {
            by[i][0] -= self.contact * 2.0 * short * slopes[i] / (2.0 * h);
        }
        self.contact * short * short
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_data::Dataset;

    #[test]
    fn after_the_recorded_end_what_the_first_has_left_costs() {
        let dataset = Dataset::synthetic(3, 1);
        let encounter = &dataset.encounters[0];
        let (end, first) = (encounter.steps as usize, encounter.first as usize);
        let states = [0, 1].map(|i| State {
            s: encounter.participants[i].conflict_s - 4.0,
            v: 1.0,
        });
        let more = |step: usize| {
            let [without, with] = [0.0, 3.0].map(|late| {
                let cost = Cost {
                    late,
                    ..Cost::default()
                };
                let mut by = ByStates::default();
                (cost.of(encounter, step, states, 0.5, &mut by), by)
            });
            (with.0 - without.0, with.1[first][0] - without.1[first][0])
        };
        let close = |(cost, slope): (f32, f32), expected: (f32, f32)| {
            (cost - expected.0).abs() < 1e-3 && (slope - expected.1).abs() < 1e-3
        };
        assert!(close(more(end - 1), (0.0, 0.0)));
        assert!(close(more(end), (12.0, -1.5)), "{:?}", more(end));
        assert!(close(more(end + ORDER_OVERTIME + 1), (0.0, 0.0)));
    }
}
