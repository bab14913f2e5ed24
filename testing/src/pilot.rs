//! The ego's driver: the policy's proposals, or others, through a shield with rules of choice.

use crate::place::{Road, TestJunction};
use crate::world::Seen;
use cede_controller::dangerous::Rules;
use cede_controller::{
    Approach, Contract, Decision, Drive, EnterError, Instant, NotReady, Part, Policy, Shield,
};

/// What drives the ego through one junction.
pub(crate) struct Pilot<'j, 'w, R: Rules> {
    asked: Approach<'j, 'w>,
    shield: Shield<'j, 8, R>,
    last: Option<Instant>,
}

impl<R: Rules> Clone for Pilot<'_, '_, R>
where
    R: Clone,
{
    fn clone(&self) -> Self {
        Self {
            asked: self.asked.clone(),
            shield: self.shield.clone(),
            last: self.last,
        }
    }
}

impl<'j, 'w, R: Rules + Clone> Pilot<'j, 'w, R> {
    /// Enters `junction` on the ego's road.
    pub(crate) fn enter(
        policy: Policy<'w>,
        contract: Contract,
        junction: &'j TestJunction,
    ) -> Result<Self, EnterError> {
        Ok(Self {
            asked: approach(policy, contract, junction)?,
            shield: Shield::with_rules(contract, junction, Road::Own.path())?,
            last: None,
        })
    }

    /// The decision about `proposal` (m/s²), or about the policy's.
    pub(crate) fn decide(&mut self, seen: &Seen, proposal: Option<f32>) -> Decision {
        let new = self.last.is_none_or(|last| seen.now > last);
        let proposal = match proposal {
            Some(proposal) => proposal,
            None if new => self.asked.proposal(&seen.observation()),
            None => 0.0,
        };
        self.last = self.last.max(Some(seen.now));
        self.shield.filter(seen.now, &seen.observation(), proposal)
    }

    /// What the shield would make of `proposal` (m/s²); changes nothing.
    pub(crate) fn probe(&self, seen: &Seen, proposal: f32) -> Decision {
        self.shield
            .clone()
            .filter(seen.now, &seen.observation(), proposal)
    }

    /// Whether there is a plan.
    pub(crate) fn ready(&self, seen: &Seen) -> Result<f32, NotReady> {
        self.shield.ready(seen.now, &seen.observation())
    }

    /// Replaces the contract.
    pub(crate) fn set_contract(&mut self, contract: Contract) -> Result<(), EnterError> {
        self.shield.set_contract(contract)
    }

    /// Replaces the policy.
    pub(crate) fn set_policy(&mut self, policy: Policy<'w>) {
        self.asked.set_policy(policy);
    }
}

/// An approach on the ego's road, as it flies.
pub(crate) fn approach<'j, 'w>(
    policy: Policy<'w>,
    contract: Contract,
    junction: &'j TestJunction,
) -> Result<Approach<'j, 'w>, EnterError> {
    Drive::new(policy, contract, Part::Left).enter(junction, Road::Own.path())
}
