//! What a policy sees of an encounter: the controller's own features, each brought to the order of 1.

use cede_controller::kinematics::State;
use cede_controller::policy::features::normalised;
use cede_controller::{
    ConflictKind, Control, FeatureSet, Footprint, Pair, Part, Pose, RightOfWay, UnitVector,
    VehicleState,
};
use cede_data::Encounter;
use cede_sim::ObservationModel;
use core::f32::consts::FRAC_PI_2;

/// Numbers in an observation.
pub(crate) const FEATURES: usize = FeatureSet::Route.count();

/// What each feature is multiplied by: metres by 1/20, m/s and s by 1/10.
pub(crate) const SCALES: [f32; FEATURES] = [
    0.05, 0.1, 0.05, 0.1, 0.1, 0.1, 1.0, 0.05, 0.05, 1.0, 1.0, 1.0, 1.0, 1.0,
];

/// What is the same in every observation of one encounter.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    kind: ConflictKind,
    conflicts: [f32; 2],
    exits: [UnitVector; 2],
}

impl Look {
    /// Of an encounter as the controller sees it. Cost: about 0.2 ms a participant.
    pub(crate) fn of(encounter: &Encounter) -> Self {
        let nowhere = State { s: 0.0, v: 0.0 };
        let model = ObservationModel::new(encounter);
        let [left, _] = model.pairs(0, [nowhere; 2], ObservationModel::FIRST_SVO);
        Self {
            kind: left.kind,
            conflicts: [left.ego.distance, left.other.distance],
            exits: [left.ego.exit, left.other.exit],
        }
    }

    /// Metres that judged vehicle `index` has still to go to its conflict point.
    pub(crate) fn distance(&self, index: usize, state: State) -> f32 {
        self.conflicts[index] - state.s
    }

    /// What judged vehicle `ego` sees, if the left-turner's SVO was `svo` at the last step.
    #[inline]
    pub(crate) fn pair(&self, ego: usize, states: [State; 2], poses: [Pose; 2], svo: f32) -> Pair {
        let vehicle = |i: usize| VehicleState {
            pose: poses[i],
            exit: self.exits[i],
            speed: states[i].v,
            distance: self.distance(i, states[i]),
            footprint: Footprint::PAPER,
            leader: None,
            crosser: None,
            control: Control::Unknown,
        };
        Pair {
            ego: vehicle(ego),
            other: vehicle(1 - ego),
            kind: self.kind,
            right_of_way: RightOfWay::Unsettled,
            part: [Part::Left, Part::Other][ego],
            last_svo: [svo, FRAC_PI_2 - svo][ego],
        }
    }
}

/// Writes the observation of `pair`, each number within ± 8.
#[inline]
pub(crate) fn write(pair: &Pair, into: &mut [f32]) {
    let features = FeatureSet::Route.of(pair);
    for ((place, feature), scale) in into.iter_mut().zip(features).zip(SCALES) {
        *place = normalised(feature, 0.0, scale);
    }
}
