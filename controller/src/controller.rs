//! The controller: from an observation, through policy and shield, to a decision.

use crate::decision::{Decision, Prediction};
use crate::geometry::{Footprint, UnitVector};
use crate::junction::conflict::ConflictKind;
use crate::junction::conflict::RouteConflict;
use crate::junction::scene::Scene;
use crate::observation::{Fault, Observation, Vehicle};
use crate::policy::Policy;
use crate::policy::pair::{Pair, Part, VehicleState};
use crate::policy::svo;
use crate::policy::traffic::{NearbyVehicle, TrafficContext};
use crate::shield::{Contract, Shield};

/// Acceleration (m/s²) that is proposed when there is nobody left to meet.
pub const FREE: f32 = 1.0;

/// Drives one vehicle among up to `N` others; `'w` is the life of the policy's weights.
///
/// ```
/// use cede_controller::*;
///
/// /// Once for every intersection: where the ego goes, and where another vehicle may come from.
/// fn scene(mine: &Route<64>, theirs: &Route<64>) -> Result<Scene<8>, SceneError> {
///     let path = |route| ScenePath { route, footprint: Footprint::PAPER };
///     Scene::new(path(mine), &[path(theirs)])
/// }
///
/// /// At start-up, from weights in flash.
/// fn controller(weights: &'static [u32]) -> Option<Controller<'static, 8>> {
///     let policy = Policy::new(weights).ok()?;
///     Some(Controller::new(policy, Contract::WORST_CASE, Part::Left))
/// }
///
/// /// Every 100 ms: the acceleration to command, in m/s².
/// fn step(controller: &mut Controller<'_, 8>, scene: &Scene<8>, sensed: &Observation<8>) -> f32 {
///     controller.decide(scene, sensed).acceleration
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Controller<'w, const N: usize> {
    policy: Policy<'w>,
    shield: Shield<N>,
    part: Part,
    /// The ego's SVO towards each other at the last step.
    orientations: [f32; N],
    /// See [`Controller::set_traffic`].
    around: TrafficContext,
}

impl<'w, const N: usize> Controller<'w, N> {
    /// A controller that has seen nothing yet; `part` is the one that a joint policy gives it.
    #[must_use]
    pub fn new(policy: Policy<'w>, contract: Contract, part: Part) -> Self {
        Self {
            policy,
            shield: Shield::new(contract),
            part,
            orientations: [svo::FIRST; N],
            around: TrafficContext::default(),
        }
    }

    /// The shield.
    #[must_use]
    pub const fn shield(&self) -> &Shield<N> {
        &self.shield
    }

    /// Tells the policy of traffic that is not in the scene, for the decisions to come; the shield
    /// considers the scene alone.
    pub const fn set_traffic(&mut self, around: TrafficContext) {
        self.around = around;
    }

    /// The ego's acceleration for the period that begins.
    ///
    /// The policy is asked about every other that the ego has yet to meet, the most restrictive of its
    /// proposals passes to the shield, and the shield considers all others at once. With nobody left to
    /// meet, the ego accelerates gently up to the contract's speed. To be called once a period.
    ///
    /// Cost: a pass through the network for each other, and the shield's. The
    /// acceleration is finite and within the contract's, whatever the bits of the observation.
    pub fn decide(&mut self, scene: &Scene<N>, observation: &Observation<N>) -> Decision {
        // The shield finds a fault again and carries on with its plan.
        let (acceleration, prediction) = self.ask(scene, observation).unwrap_or((0.0, None));
        Decision {
            prediction,
            ..self.shield.filter(scene, observation, acceleration)
        }
    }

    /// What the policy proposes. Not inlined, because its stack is free again when the shield needs its own.
    #[inline(never)]
    fn ask(
        &mut self,
        scene: &Scene<N>,
        observation: &Observation<N>,
    ) -> Result<(f32, Option<Prediction>), Fault> {
        let seen = observation.checked(scene.conflicts().len());
        let seen = seen.as_ref().map_err(|&fault| fault)?;
        Ok(self.propose(scene, seen))
    }

    /// What the policy alone would do (m/s², within ± 3): to measure what the shield costs, never to drive.
    ///
    /// To be called once a period instead of [`Controller::decide`]; 0 if the observation has a fault.
    ///
    /// Cost: a pass through the network for each other. Finite and within ± 3.
    pub fn proposal(&mut self, scene: &Scene<N>, observation: &Observation<N>) -> f32 {
        self.ask(scene, observation)
            .map_or(0.0, |(acceleration, _)| acceleration)
    }

    fn propose(&mut self, scene: &Scene<N>, seen: &Observation<N>) -> (f32, Option<Prediction>) {
        let mut proposal = (FREE, None);
        let around = self.around;
        let others = scene.conflicts().iter().zip(scene.others());
        let others = others.zip(seen.others.iter());
        for ((number, last_svo), ((conflict, &(exit, footprint)), other)) in
            (0_u8..).zip(self.orientations.iter_mut()).zip(others)
        {
            let Some(other) = other else { continue };
            if !ahead(conflict, &seen.ego, other) {
                continue;
            }
            let traffic = traffic(scene, seen, number).nearest(around);
            let pair = Pair {
                ego: VehicleState {
                    leader: traffic.leader,
                    crosser: traffic.crosser,
                    ..vehicle_state(
                        &seen.ego,
                        scene.exit(),
                        conflict.ego_conflict,
                        scene.footprint(),
                    )
                },
                other: vehicle_state(other, exit, conflict.other_conflict, footprint),
                kind: conflict.kind,
                right_of_way: conflict.right_of_way,
                part: self.part,
                last_svo: *last_svo,
            };
            *last_svo = pair.svo();
            let [acceleration, expected] = self.policy.act(&pair);
            if acceleration < proposal.0 || proposal.1.is_none() {
                let prediction = Prediction {
                    other: number,
                    svo: *last_svo,
                    acceleration: expected,
                };
                proposal = (acceleration, Some(prediction));
            }
        }
        proposal
    }
}

fn vehicle_state(
    vehicle: &Vehicle,
    exit: UnitVector,
    conflict: f32,
    footprint: Footprint,
) -> VehicleState {
    VehicleState {
        pose: vehicle.pose,
        exit,
        speed: vehicle.speed,
        distance: conflict - vehicle.s,
        footprint,
        leader: None,
        crosser: None,
    }
}

/// Whether the two have yet to meet: in some zone neither has passed it. One that is ahead in a
/// lane that they share from the start has been met once either has entered that lane: it leads.
fn ahead(conflict: &RouteConflict, ego: &Vehicle, other: &Vehicle) -> bool {
    conflict.zones().any(|zone| {
        let (ego_end, other_end) = match zone.kind {
            ConflictKind::Following => (conflict.ego_conflict, conflict.other_conflict),
            _ => (zone.ego.to, zone.other.to),
        };
        ego.s < ego_end && other.s < other_end
    })
}

/// What all the others but number `except` are to the ego.
fn traffic<const N: usize>(scene: &Scene<N>, seen: &Observation<N>, except: u8) -> TrafficContext {
    let others = scene.conflicts().iter().zip(seen.others.iter());
    let around = (0_u8..).zip(others).filter(|&(number, _)| number != except);
    let there = around.filter_map(|(_, (conflict, other))| {
        let Vehicle { s, speed, .. } = (*other)?;
        Some(NearbyVehicle { conflict, s, speed })
    });
    TrafficContext::new(seen.ego.s, there)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Point;
    use crate::decision::Cause;
    use crate::junction::route::Route;
    use crate::junction::scene::Path;
    use crate::observation::Fault;
    use crate::policy::features::FeatureSet;
    use crate::policy::weights::Perspective;
    use crate::policy::weights::testing::file;

    fn route(points: &[(f32, f32)]) -> Route<4> {
        Route::new(points.iter().map(|&(x, y)| Point::new(x, y))).unwrap()
    }

    /// The ego goes east; the others cross from the south, follow it, and come from the south further on.
    fn scene() -> Scene<3> {
        let routes = [
            route(&[(-60.0, 0.0), (120.0, 0.0)]),
            route(&[(0.0, -60.0), (0.0, 60.0)]),
            route(&[(-60.0, 0.0), (120.0, 0.0)]),
            route(&[(30.0, -60.0), (30.0, 60.0)]),
        ];
        let path = |route| Path {
            route,
            footprint: Footprint::PAPER,
        };
        let [ego, a, b, c] = routes.each_ref().map(path);
        Scene::new(ego, &[a, b, c]).unwrap()
    }

    fn vehicle(s: f32, speed: f32) -> Vehicle {
        let pose = route(&[(-60.0, 0.0), (120.0, 0.0)]).pose(s);
        Vehicle { s, speed, pose }
    }

    #[test]
    fn the_most_restrictive_proposal_is_the_one_that_counts() {
        let file = file(FeatureSet::Route, Perspective::Ego, 16);
        let policy = Policy::new(&file).unwrap();
        let decide = |others| {
            let mut controller = Controller::new(policy, Contract::WORST_CASE, Part::Left);
            controller.propose(
                &scene(),
                &Observation {
                    ego: vehicle(0.0, 5.0),
                    others,
                },
            )
        };
        let (a, c) = (vehicle(5.0, 4.0), vehicle(20.0, 9.0));
        let first = decide([Some(a), None, None]);
        let third = decide([None, None, Some(c)]);
        let both = decide([Some(a), None, Some(c)]);
        let least = if first.0 < third.0 { first } else { third };
        assert_eq!(both, least);
        assert_eq!(first.1.unwrap().other, 0);
        assert_eq!(third.1.unwrap().other, 2);
    }

    #[test]
    fn one_ahead_in_the_lane_is_a_leader_and_nobody_to_meet() {
        let seen = Observation {
            ego: vehicle(0.0, 5.0),
            others: [None, Some(vehicle(20.0, 4.0)), None],
        };
        let leader = traffic(&scene(), &seen, 0).leader.unwrap();
        assert_eq!(leader.speed, 4.0);
        assert!((leader.gap - 15.0).abs() < 0.1, "{leader:?}");
        assert!(!super::ahead(
            &scene().conflicts()[1],
            &seen.ego,
            &vehicle(20.0, 4.0)
        ));
    }

    #[test]
    fn with_nobody_to_meet_the_ego_drives_on_and_with_bad_senses_it_brakes() {
        let file = file(FeatureSet::Route, Perspective::Ego, 16);
        let policy = Policy::new(&file).unwrap();
        let mut controller = Controller::new(policy, Contract::WORST_CASE, Part::Left);
        let alone = Observation {
            ego: vehicle(0.0, 5.0),
            others: [None; 3],
        };
        let decision = controller.decide(&scene(), &alone);
        assert_eq!(
            (decision.acceleration, decision.cause),
            (FREE, Cause::Policy)
        );
        assert_eq!(decision.prediction, None);
        let blind = Observation {
            ego: vehicle(f32::NAN, 5.0),
            ..alone
        };
        let decision = controller.decide(&scene(), &blind);
        assert_eq!(decision.cause, Cause::Fallback(Fault::Ego));
        assert_eq!(decision.acceleration, -3.0);
    }

    #[test]
    fn a_controller_with_its_scene_fits_its_share_of_the_memory() {
        let size = size_of::<Controller<'_, 8>>() + size_of::<Scene<8>>();
        assert!(size <= 3072, "{size}");
    }
}
