//! The controller: from an observation, through policy and shield, to a decision.

use crate::conflict::ConflictKind;
use crate::decision::{Decision, Outlook};
use crate::geometry::{Footprint, Point};
use crate::observation::{Fault, Observation, Vehicle};
use crate::pair::{Pair, Part, Party};
use crate::policy::Policy;
use crate::scene::{Meeting, Scene};
use crate::shield::{Contract, ContractError, Shield};
use crate::surroundings::{Around, Surroundings};
use core::f32::consts::FRAC_PI_4;

/// Acceleration (m/s²) that is proposed when there is nobody left to meet.
const FREE: f32 = 1.0;

/// Drives one vehicle among up to `N` others; `'w` is the life of the policy's weights.
///
/// ```
/// use cede_controller::*;
/// # fn weights() -> Policy<'static> { unimplemented!() }
/// # fn sense() -> Observation<8> { unimplemented!() }
/// # fn actuate(_: f32) {}
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// # if false {
/// // Once, for the intersection ahead:
/// let mine = Route::<64>::new([Point::new(-60.0, 0.0), Point::new(60.0, 0.0)])?;
/// let theirs = Route::<64>::new([Point::new(0.0, -60.0), Point::new(0.0, 60.0)])?;
/// let path = |route| Path { route, footprint: Footprint::PAPER };
/// let scene = Scene::<8>::new(path(&mine), &[path(&theirs)])?;
/// let mut controller = Controller::<8>::new(weights(), Contract::WORST_CASE, Part::Other)?;
/// // Every 100 ms:
/// let decision = controller.decide(&scene, &sense());
/// actuate(decision.acceleration);
/// # }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Controller<'w, const N: usize> {
    policy: Policy<'w>,
    shield: Shield<N>,
    part: Part,
    /// The ego's SVO towards each other at the last step.
    orientations: [f32; N],
    /// See [`Controller::set_surroundings`].
    around: Surroundings,
}

impl<'w, const N: usize> Controller<'w, N> {
    /// A controller that has seen nothing yet; `part` is the one that a joint policy gives it.
    ///
    /// # Errors
    /// The first number of `contract` that is out of its range. Never panics.
    pub fn new(policy: Policy<'w>, contract: Contract, part: Part) -> Result<Self, ContractError> {
        Ok(Self {
            policy,
            shield: Shield::new(contract)?,
            part,
            orientations: [FRAC_PI_4; N],
            around: Surroundings::default(),
        })
    }

    /// The shield.
    #[must_use]
    pub const fn shield(&self) -> &Shield<N> {
        &self.shield
    }

    /// Tells the policy of traffic that is not in the scene, for the decisions to come; the shield
    /// considers the scene alone.
    pub const fn set_surroundings(&mut self, around: Surroundings) {
        self.around = around;
    }

    /// The ego's acceleration for the period that begins.
    ///
    /// The policy is asked about every other that the ego has yet to meet, the most restrictive of its
    /// proposals passes to the shield, and the shield considers all others at once. With nobody left to
    /// meet, the ego accelerates gently up to the contract's speed. To be called once a period.
    ///
    /// Cost: a pass through the network for each other, and the shield's. Never panics; the
    /// acceleration is finite and within the contract's, whatever the bits of the observation.
    pub fn decide(&mut self, scene: &Scene<N>, observation: &Observation<N>) -> Decision {
        // The shield finds a fault again and carries on with its plan.
        let (acceleration, outlook) = self.ask(scene, observation).unwrap_or((0.0, None));
        Decision {
            outlook,
            ..self.shield.filter(scene, observation, acceleration)
        }
    }

    /// What the policy proposes. Not inlined, because its stack is free again when the shield needs its own.
    #[inline(never)]
    fn ask(
        &mut self,
        scene: &Scene<N>,
        observation: &Observation<N>,
    ) -> Result<(f32, Option<Outlook>), Fault> {
        let seen = observation.checked(scene.meetings().len());
        let seen = seen.as_ref().map_err(|&fault| fault)?;
        Ok(self.propose(scene, seen))
    }

    /// What the policy alone would do (m/s², within ± 3): to measure what the shield costs, never to drive.
    ///
    /// To be called once a period instead of [`Controller::decide`]; 0 if the observation has a fault.
    pub fn proposal(&mut self, scene: &Scene<N>, observation: &Observation<N>) -> f32 {
        self.ask(scene, observation)
            .map_or(0.0, |(acceleration, _)| acceleration)
    }

    fn propose(&mut self, scene: &Scene<N>, seen: &Observation<N>) -> (f32, Option<Outlook>) {
        let mut proposal = (FREE, None);
        let around = self.around;
        let others = scene.meetings().iter().zip(seen.others.iter());
        for ((number, last_svo), (meeting, other)) in
            (0_u8..).zip(self.orientations.iter_mut()).zip(others)
        {
            let Some(other) = other else { continue };
            if !ahead(meeting, &seen.ego, other) {
                continue;
            }
            let surroundings = surroundings(scene, seen, number).nearest(around);
            let pair = Pair {
                ego: Party {
                    leader: surroundings.leader,
                    crosser: surroundings.crosser,
                    ..party(
                        &seen.ego,
                        scene.exit(),
                        meeting.ego_conflict,
                        scene.footprint(),
                    )
                },
                other: party(
                    other,
                    meeting.other_exit,
                    meeting.other_conflict,
                    meeting.other_footprint,
                ),
                kind: meeting.kind,
                right_of_way: meeting.right_of_way,
                part: self.part,
                last_svo: *last_svo,
            };
            *last_svo = pair.svo();
            let [acceleration, expected] = self.policy.act(&pair);
            if acceleration < proposal.0 || proposal.1.is_none() {
                let outlook = Outlook {
                    other: number,
                    svo: *last_svo,
                    acceleration: expected,
                };
                proposal = (acceleration, Some(outlook));
            }
        }
        proposal
    }
}

fn party(vehicle: &Vehicle, exit: Point, conflict: f32, footprint: Footprint) -> Party {
    Party {
        pose: vehicle.pose,
        exit,
        speed: vehicle.speed,
        distance: conflict - vehicle.s,
        footprint,
        leader: None,
        crosser: None,
    }
}

/// Whether the two have yet to meet: in some zone where they cross or merge, neither has done with it.
fn ahead(meeting: &Meeting, ego: &Vehicle, other: &Vehicle) -> bool {
    let meets = |kind| matches!(kind, ConflictKind::Crossing | ConflictKind::Merging);
    meeting
        .zones()
        .any(|zone| meets(zone.kind) && ego.s < zone.ego.to && other.s < zone.other.to)
}

/// What all the others but number `except` are to the ego.
fn surroundings<const N: usize>(
    scene: &Scene<N>,
    seen: &Observation<N>,
    except: u8,
) -> Surroundings {
    let others = scene.meetings().iter().zip(seen.others.iter());
    let around = (0_u8..).zip(others).filter(|&(number, _)| number != except);
    let there = around.filter_map(|(_, (meeting, other))| {
        let Vehicle { s, speed, .. } = (*other)?;
        Some(Around { meeting, s, speed })
    });
    Surroundings::new(seen.ego.s, there)
}
