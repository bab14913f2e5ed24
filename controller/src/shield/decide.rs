//! Where the shield says yes or no to a proposal, and what it does instead.

use super::Shield;
use super::choice::{allowed, nearest, next};
use super::hazard::{Passage, Who};
use super::hazards::Hazards;
use super::rules::Rules;
use super::scene::Scene;
use super::verified::Verified;
use crate::decision::{Action, Cause, Decision, Intervention};
use crate::fault::Fault;
use crate::instant::Instant;

impl<const N: usize, R: Rules> Shield<'_, N, R> {
    /// Yes to `proposal` (m/s²) if some plan is safe after it. Otherwise the nearest acceleration after which one is; otherwise
    /// the remembered plan; without one, braking, or leaving the zones in which the ego stands.
    pub(super) fn decide(
        &mut self,
        scene: &mut Scene<'_>,
        now: Instant,
        proposal: f32,
    ) -> Decision {
        let contract = self.contract;
        let wanted = allowed(&contract.ego, scene.most, proposal);
        let verdict = scene.check::<R>(&contract, wanted);
        let accepted = |a| Some(scene.check::<R>(&contract, a)).filter(|v| v.margin >= 0.0);
        let found = if verdict.margin >= 0.0 {
            Some((wanted, verdict))
        } else {
            let nearest = nearest(&contract.ego, scene.most, wanted, accepted);
            nearest.filter(|&(found, _)| self.is_nearer(scene, wanted, found))
        };
        let (acceleration, action) = match found {
            Some((acceleration, verified)) => {
                self.memory.verified(verified.plan, now);
                self.tracks.unwatched_avoided();
                self.count_on(&*scene.hazards, verified);
                (acceleration, Some(Action::Nearest))
            }
            None if self.memory.plan().is_some() => {
                (self.carry_on(scene.most), Some(Action::Remembered))
            }
            None if scene.leaves::<R>(&contract) => {
                let go = allowed(&contract.ego, scene.most, contract.ego.go);
                (go, None)
            }
            None => (self.carry_on(scene.most), None),
        };
        let cause = match action {
            None => Cause::Fallback(Fault::NoPlan),
            Some(_) if !proposal.is_finite() => Cause::Fallback(Fault::Proposal),
            Some(_) if verdict.margin >= 0.0 => Cause::Policy,
            Some(action) => Cause::Shielded(Intervention {
                action,
                reason: scene.reason::<R>(&contract, wanted),
            }),
        };
        Decision {
            cause,
            margin: found.map_or(verdict.margin, |(_, verified)| verified.margin),
            plan: self.memory.plan(),
            ..Decision::none(acceleration)
        }
    }

    /// Whether `found` (m/s²) is nearer to what is `wanted` than the next command of the remembered plan. With sensing
    /// errors a plan that is carried on may go where a fresh one, of the same commands, would have to stop.
    pub(super) fn is_nearer(&self, scene: &Scene<'_>, wanted: f32, found: f32) -> bool {
        self.memory.plan().is_none_or(|plan| {
            let next = allowed(&self.contract.ego, scene.most, next(&self.contract, plan));
            (found - wanted).abs() <= (next - wanted).abs()
        })
    }

    /// Notes which lanes the plan enters ahead of somebody.
    pub(super) fn count_on(&mut self, hazards: &Hazards, verified: Verified) {
        self.tracks.iter_mut().for_each(|other| other.counted = 0);
        for hazard in hazards
            .iter()
            .filter(|hazard| hazard.target <= verified.passes)
        {
            let (Passage::Ahead { .. }, Who::Watched { place, .. }) = (hazard.passage, hazard.who)
            else {
                continue;
            };
            if let Some(other) = self.tracks.iter_mut().nth(place.into()) {
                other.counted |= 1 << hazard.zone;
            }
        }
    }

    /// The next command of the remembered plan, which is then one command shorter; without one, all the braking there is.
    pub(super) fn carry_on(&mut self, most: f32) -> f32 {
        let contract = &self.contract;
        let Some(plan) = self.memory.plan() else {
            return -contract.ego.emergency;
        };
        self.memory.shorten(R::tail);
        allowed(&contract.ego, most, next(contract, plan))
    }
}
