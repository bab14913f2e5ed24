//! What a decision is made of, once the observation is noted, and which plan is best there.

use super::actuation::Inherited;
use super::choice::{allowed, most, next};
use super::contract::Contract;
use super::hazard::{Hazard, Passage};
use super::hazards::Hazards;
use super::margin::Going;
use super::own::Own;
use super::rules::Rules;
use super::tracks::Tracks;
use super::unwatched::Closed;
use super::verified::{Verified, best, rest, spare};
use crate::junction::Way;
use crate::plan::Plan;

/// An ego without a safe plan that is less than this (m) in a zone stays there.
const NOSE: f32 = 0.5;

/// The hazards ahead of the ego, and what it may command.
pub(super) struct Scene<'s> {
    pub(super) ego: &'s Own,
    pub(super) hazards: &'s mut Hazards,
    /// What acts until the command is followed.
    pub(super) inherited: &'s Inherited<f32>,
    /// The hardest acceleration that may be commanded.
    pub(super) most: f32,
    /// How the ego goes.
    pub(super) going: Going<f32>,
}

impl<'s> Scene<'s> {
    /// What is ahead of the ego while `in_effect` (m/s²) is the most that acts. `hazards`, empty, is filled in place, because it
    /// is the largest thing on the stack.
    pub(super) fn new<const N: usize, R: Rules>(
        (contract, way): (&Contract, Way<'_>),
        (ego, tracks): (&'s Own, &Tracks<N>),
        closed: Option<Closed>,
        (inherited, in_effect): (&'s Inherited<f32>, f32),
        hazards: &'s mut Hazards,
    ) -> Self {
        hazards.add::<N, R>(contract, way, (ego, tracks), closed);
        let most = most(contract, ego.speed, in_effect);
        Self {
            ego,
            hazards,
            inherited,
            most,
            going: Going::of(contract),
        }
    }

    /// Tells of each hazard whether what is left of `plan`, carried on, is safe from it.
    pub(super) fn holds<R: Rules>(
        &self,
        contract: &Contract,
        plan: Plan,
    ) -> impl Fn(&Hazard) -> bool {
        let command = allowed(&contract.ego, self.most, next(contract, plan));
        let departure = R::departure(contract, self.ego.speed, self.inherited, command);
        // A part of the slack is for what rounding has taken since the plan was verified.
        let rounding = 0.2 * contract.slack;
        let spare = spare::<R>(contract, (departure, self.going), R::tail(plan));
        move |hazard| R::keeps(spare(hazard) + rounding)
    }

    /// Has the ego wait at its line, if the junction was told it. `goes`: the plan in force does not brake yet, and
    /// holds against everybody.
    pub(super) fn wait_at_line<R: Rules>(&mut self, contract: &Contract, way: Way<'_>, goes: bool) {
        let Some(path) = way.path(way.ego()).filter(|path| path.waits_at_line()) else {
            return;
        };
        let brakes = allowed(&contract.ego, self.most, -contract.ego.braking);
        let departure = R::departure(contract, self.ego.speed, self.inherited, brakes);
        let stop = rest::<R>(contract, departure.braking, 0.0) + contract.slack;
        let line = path.line() - self.ego.s - contract.position_error;
        self.hazards.wait_at(line, stop, goes);
    }

    /// The best plan after one period at `command`.
    pub(super) fn check<R: Rules>(&self, contract: &Contract, command: f32) -> Verified {
        let departure = R::departure(contract, self.ego.speed, self.inherited, command);
        best::<R>(contract, self.hazards, (&departure, &self.going))
    }

    /// Whether an ego without a safe plan accelerates out of its zones instead of braking: it stands in zones, none
    /// of the others may be in these, and from what is ahead some plan is safe. What is ahead is all that is left then.
    pub(super) fn leaves<R: Rules>(&mut self, contract: &Contract) -> bool {
        let outside = |passage| match passage {
            Passage::Before { distance, .. } | Passage::Walks { distance, .. } => distance > 0.0,
            // It comes from behind.
            Passage::Ahead { gap, .. } => gap > 0.0,
            Passage::Never => false,
        };
        let inside = |hazard: &Hazard| hazard.limit < -NOSE;
        let apart = |hazard: &Hazard| !inside(hazard) || outside(hazard.passage);
        if !self.hazards.iter().any(inside) || !self.hazards.iter().all(apart) {
            return false;
        }
        self.hazards.leave_out(inside);
        let go = allowed(&contract.ego, self.most, contract.ego.go);
        self.check::<R>(contract, go).margin >= 0.0
    }
}
