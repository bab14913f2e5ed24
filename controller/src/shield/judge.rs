//! What is seen becomes a scene, and the remembered plan must be safe in it.

use super::Shield;
use super::choice::most;
use super::clock::Tick;
use super::findings::Findings;
use super::hazards::Hazards;
use super::own::Own;
use super::rules::Rules;
use super::scene::Scene;
use crate::decision::{Breach, Cause, Decision};
use crate::fault::Fault;
use crate::headroom::{Headroom, Room};
use crate::instant::Instant;
use crate::observation::{Observation, Vehicle};

impl<const N: usize, R: Rules> Shield<'_, N, R> {
    /// Decides about `proposal` (m/s²) at what is seen; the remembered plan is verified anew against everybody for `recheck`.
    pub(super) fn judge(
        &mut self,
        when: (Instant, Tick),
        ego: &Vehicle,
        observation: &Observation<'_>,
        (proposal, recheck): (f32, bool),
    ) -> Decision {
        let (now, _) = when;
        let (ego, moved) = self.memory.note(&self.contract, ego, now);
        let (ego, deviated) = (&ego, moved.is_some_and(|rooms| !Room::hold(rooms)));
        if deviated {
            self.tracks.count_on_nothing();
        }
        let mut findings = self.look(when, ego, observation);
        if let Some(rooms) = moved {
            findings.headroom.note_ego(rooms);
        }
        let inherited = &self.memory.inherited(&self.contract, now);
        let acts = (inherited, inherited.bounds()[1]);
        let (context, known) = ((&self.contract, self.way), (ego, &self.tracks));
        let mut hazards = Hazards::new();
        let mut scene = Scene::new::<N, R>(context, known, findings.closed, acts, &mut hazards);
        let goes = self.verify_again(&scene, now, deviated || recheck);
        scene.wait_at_line::<R>(&self.contract, self.way, goes);
        let breach = if deviated {
            Some(Breach::Ego)
        } else {
            findings.breach.map(Breach::Other)
        };
        Decision {
            breach,
            fault: findings.fault,
            unwatched: findings.closed.map(|closed| closed.number),
            headroom: findings.headroom,
            ..self.decide(&mut scene, now, proposal)
        }
    }

    /// The ego's own state cannot be trusted: it carries on with the plan, if its commands were given in time and the
    /// contract is the one for which it was verified.
    pub(super) fn blind(
        &mut self,
        (now, tick): (Instant, Tick),
        fault: Fault,
        on_time: bool,
    ) -> Decision {
        self.tracks.coast::<R>(&self.contract, now);
        self.wait((now, tick), None);
        if !on_time || self.replaced {
            self.void();
        }
        let [_, in_effect] = self.memory.inherited(&self.contract, now).bounds();
        let speed = self.memory.least_speed(&self.contract, now);
        let acceleration = self.carry_on(most(&self.contract, speed, in_effect));
        let plan = self.memory.plan();
        let mut headroom = Headroom::NONE;
        headroom.note_fault(fault);
        Decision {
            cause: Cause::Fallback(if plan.is_some() { fault } else { Fault::NoPlan }),
            plan,
            fault: Some(fault),
            headroom,
            ..Decision::none(acceleration)
        }
    }

    /// Notes what is seen and who goes first.
    pub(super) fn look(
        &mut self,
        when: (Instant, Tick),
        ego: &Own,
        observation: &Observation<'_>,
    ) -> Findings {
        let (now, _) = when;
        let findings = self
            .tracks
            .note::<R>(&self.contract, self.way, now, ego, observation);
        self.wait(when, Some(ego));
        self.tracks.settle::<R>(&self.contract, self.way, ego);
        findings
    }

    /// Voids the remembered plan unless it is safe against whoever it was not verified against, or against `all`. Whether it
    /// does not brake yet, and holds against everybody.
    pub(super) fn verify_again(&mut self, scene: &Scene<'_>, now: Instant, all: bool) -> bool {
        let Some(plan) = self.memory.plan() else {
            return false;
        };
        let (mut kept, mut goes) = (true, plan.go > 0);
        {
            let holds = scene.holds::<R>(&self.contract, plan);
            for hazard in scene.hazards.iter() {
                let new = (all || hazard.suspect) && !hazard.is_closed();
                if kept && new || goes {
                    let safe = holds(hazard);
                    kept &= safe || !new;
                    goes &= safe;
                }
            }
            let (context, ego) = ((&self.contract, self.way), scene.ego);
            kept &= (self.tracks)
                .unwatched_hold::<R>(context, ego, all, |hazards| hazards.iter().all(&holds));
        }
        if kept {
            self.tracks.hidden.holds = true;
            if all {
                self.memory.confirmed(now);
            }
        } else {
            self.void();
        }
        kept && goes
    }

    pub(super) fn void(&mut self) {
        self.memory.void();
        self.tracks.count_on_nothing();
    }
}
