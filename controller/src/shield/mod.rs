//! The safety shield: no proposal passes that could lead to a collision within the contract.
//!
//! A proposed acceleration is accepted if, after one period of it, some fail-safe [`Plan`] is
//! verified against everything that the others can do from now. Otherwise the nearest accepted
//! acceleration of a fixed grid is taken; otherwise the next command of the plan that was verified last;
//! and if there is none, the ego brakes and says so. `docs/theorem.md` has the theorem.

pub mod choice;
mod contract;
mod hazard;
pub mod margin;
mod memory;
mod plan;
mod precedence;
pub mod reach;
pub(crate) mod rules;
#[cfg(test)]
mod tests;
mod verified;
mod waiting;

pub use contract::{Contract, ContractBuilder, ContractError, Ego, Follower, Other, Precedence};
pub use plan::Plan;
use rules::{Rules, Sound};

use crate::decision::{Action, Cause, Decision, Intervention, Reason};
use crate::junction::scene::Scene;
use crate::observation::{Fault, Observation};
use choice::{allowed, nearest};
use core::marker::PhantomData;
use hazard::{Hazards, Passage};
use memory::Memory;
use precedence::{Claims, Precedences};
use verified::{Verified, best, passage_margin};

/// An ego without a safe plan that is less than this (m) in a zone stays there.
const NOSE: f32 = 0.5;

/// The shield of one vehicle among up to `N` others; it remembers, so there is one for each.
///
/// Filters the proposals of any driver. Its size is that of two observations.
#[derive(Clone, Debug)]
pub struct Shield<const N: usize, R: Rules = Sound> {
    contract: Contract,
    memory: Memory<N>,
    precedences: Precedences<N>,
    rules: PhantomData<R>,
}

impl<const N: usize> Shield<N> {
    /// A shield that has seen nothing yet.
    #[must_use]
    pub fn new(contract: Contract) -> Self {
        Self::with_rules(contract)
    }
}

impl<const N: usize, R: Rules> Shield<N, R> {
    /// A shield with rules of its own, which are not proved: see [`Rules`].
    #[must_use]
    pub fn with_rules(contract: Contract) -> Self {
        Self {
            contract,
            memory: Memory::new(),
            precedences: Precedences::new(),
            rules: PhantomData,
        }
    }

    /// What it assumes.
    #[must_use]
    pub const fn contract(&self) -> &Contract {
        &self.contract
    }

    /// The plan that it falls back on; none if nothing has been verified, or if the contract was broken since.
    #[must_use]
    pub const fn plan(&self) -> Option<Plan> {
        self.memory.plan
    }

    /// The acceleration for the period that begins: `proposal` (m/s²) if it is safe.
    ///
    /// To be called once a period, with one and the same `scene`.
    ///
    /// Cost: at most 14 candidates × one clearing time for each zone. The acceleration is
    /// finite and within the contract's, whatever the bits of the observation and the proposal.
    // Not inlined, so that its stack is not on top of the policy's.
    #[inline(never)]
    pub fn filter(
        &mut self,
        scene: &Scene<N>,
        observation: &Observation<N>,
        proposal: f32,
    ) -> Decision {
        self.memory.tick();
        let decision = match &observation.checked(scene.conflicts().len()) {
            Ok(seen) => self.judge(scene, seen, proposal),
            Err(fault) => self.blind(*fault),
        };
        self.memory.command(decision.acceleration);
        decision
    }

    /// Metres to spare of the best plan after one period at `acceleration` (m/s²), given now while `previous`
    /// (m/s²) is in effect; not negative exactly if the shield would accept it. Remembers nothing, and
    /// assumes no precedence.
    ///
    /// # Errors
    /// The fault of the observation, or of an acceleration that is not a number.
    pub fn margin(
        &self,
        scene: &Scene<N>,
        observation: &Observation<N>,
        previous: f32,
        acceleration: f32,
    ) -> Result<f32, Fault> {
        if !(previous.is_finite() && acceleration.is_finite()) {
            return Err(Fault::Proposal);
        }
        let seen = observation.checked(scene.conflicts().len())?;
        let mut hazards = Hazards::new();
        hazards.add::<N, R>(&self.contract, scene, &seen, Claims::default());
        let speed = seen.ego.speed;
        let acceleration = allowed(&self.contract.ego, speed, acceleration);
        let verdict = check::<R>(&self.contract, &hazards, speed, [previous; 2], acceleration);
        Ok(verdict.margin)
    }

    fn blind(&mut self, fault: Fault) -> Decision {
        if let Some(rule) = self.contract.precedence {
            self.precedences.blind::<R>(&self.contract, rule);
        }
        Decision {
            acceleration: self.carry_on(),
            cause: Cause::Fallback(fault),
            margin: 0.0,
            breach: None,
            prediction: None,
        }
    }

    fn judge(&mut self, scene: &Scene<N>, seen: &Observation<N>, proposal: f32) -> Decision {
        let breach = self.memory.note(&self.contract, seen);
        let claims = match self.contract.precedence {
            Some(rule) => self
                .precedences
                .note::<R>(&self.contract, rule, scene, seen),
            None => Claims::default(),
        };
        let mut hazards = Hazards::new();
        hazards.add::<N, R>(&self.contract, scene, seen, claims);
        let speed = seen.ego.speed;
        let wanted = allowed(&self.contract.ego, speed, proposal);
        let in_effect = self.memory.in_effect(&self.contract);
        let check = |a| check::<R>(&self.contract, &hazards, speed, in_effect, a);
        let verdict = check(wanted);
        let accepted = |a| Some(check(a)).filter(|verdict| verdict.margin >= 0.0);
        let nearest = || nearest(&self.contract.ego, speed, wanted, accepted);
        let found = if verdict.margin >= 0.0 {
            Some((wanted, verdict))
        } else {
            nearest()
        };
        let cause = if !proposal.is_finite() {
            Cause::Fallback(Fault::Proposal)
        } else if verdict.margin >= 0.0 {
            Cause::Policy
        } else if found.is_some() || self.memory.plan.is_some() {
            Cause::Shielded(Intervention {
                action: if found.is_some() {
                    Action::Nearest
                } else {
                    Action::Remembered
                },
                reason: self.reason(&hazards, speed, in_effect, wanted),
            })
        } else {
            Cause::Fallback(Fault::Unverified)
        };
        let acceleration = match found {
            Some((acceleration, verified)) => {
                self.memory.plan = Some(verified.plan);
                acceleration
            }
            None if self.memory.plan.is_none() && leaves(&hazards) => {
                allowed(&self.contract.ego, speed, self.contract.ego.go)
            }
            None => self.carry_on(),
        };
        Decision {
            acceleration,
            cause,
            margin: found.map_or(verdict.margin, |(_, verified)| verified.margin),
            breach,
            prediction: None,
        }
    }

    /// The next command of the remembered plan, which is then one command shorter; braking, if there is none.
    fn carry_on(&mut self) -> f32 {
        let ego = self.contract.ego;
        let Some(plan) = self.memory.plan else {
            return -ego.braking;
        };
        self.memory.plan = Some(R::tail(plan));
        if plan.go > 0 { ego.go } else { -ego.braking }
    }

    /// Why `command` is refused: what stands in the way of the plan that goes farthest.
    fn reason(&self, hazards: &Hazards, speed: f32, in_effect: [f32; 2], command: f32) -> Reason {
        let contract = &self.contract;
        let departure = R::departure(contract, speed, in_effect, command);
        let mut needs = departure.braking.rest(contract.ego.braking);
        let mut stop = Reason::Stop {
            other: 0,
            available: 0.0,
            needs,
        };
        for hazard in hazards.iter() {
            let other = hazard.other;
            if R::stops_short(contract, hazard.limit, needs) >= 0.0 {
                continue;
            }
            let (clears, ego_speed) = margin::clearing(contract, departure.least, hazard.target);
            stop = Reason::Stop {
                other,
                available: hazard.limit,
                needs,
            };
            if passage_margin::<R>(contract, hazard, clears, ego_speed) >= 0.0 {
                needs = R::rest(contract, departure.most, clears);
                continue;
            }
            return match hazard.passage {
                Passage::Before { distance, speed } => Reason::Arrival {
                    other,
                    arrives: margin::arrival(contract, distance, speed),
                    clears,
                },
                Passage::Ahead { gap, speed } => {
                    let rush = R::rush(contract, speed, clears);
                    Reason::Entry {
                        other,
                        gap: gap - rush.distance,
                        needs: R::safe_gap(contract, rush.speed, ego_speed),
                    }
                }
                Passage::Never => stop,
            };
        }
        stop
    }
}

/// The best plan after one period at `command`.
fn check<R: Rules>(
    contract: &Contract,
    hazards: &Hazards,
    speed: f32,
    in_effect: [f32; 2],
    command: f32,
) -> Verified {
    let departure = R::departure(contract, speed, in_effect, command);
    best::<R>(contract, hazards, &departure)
}

/// Whether an ego without a safe plan accelerates out of its zones instead of braking: it stands in zones, and none
/// of the others is in its own.
fn leaves(hazards: &Hazards) -> bool {
    let mut inside = hazards.iter().filter(|h| h.limit < -NOSE).peekable();
    inside.peek().is_some()
        && inside.all(|h| matches!(h.passage, Passage::Before { distance, .. } if distance > 0.0))
}
