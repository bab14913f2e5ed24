//! Drivers that try to be hit, and keep the contract.

use super::scenario::Scenario;
use crate::meeting::path;
use cede_controller::kinematics::{STEP, State};
use cede_controller::shield::margin::safe_gap;
use cede_controller::{RouteConflict, Zone};
use rand::RngExt;
use rand_pcg::Pcg64;

/// How an adversary chooses its acceleration.
#[derive(Clone, Copy, Debug)]
enum Manner {
    /// Anything the contract allows, held for a while.
    Random,
    /// Full acceleration or full braking, in turns.
    BangBang,
    /// Waits until it can arrive together with the ego, then goes for it.
    Aimed,
    /// Always full acceleration.
    Rush,
}

/// A vehicle that tries to collide with vehicle 0.
#[derive(Clone, Debug)]
pub(super) struct Adversary {
    manner: Manner,
    acceleration: f32,
    /// Steps for which the acceleration is still held.
    left: u32,
    /// Steps since the ego has been ahead in the lane with less than the safe gap.
    unsafe_for: u32,
}

impl Adversary {
    pub(super) fn random(rng: &mut Pcg64) -> Self {
        let manners = [
            Manner::Random,
            Manner::BangBang,
            Manner::Aimed,
            Manner::Rush,
        ];
        Self {
            manner: manners[rng.random_range(0..manners.len())],
            acceleration: 0.0,
            left: 0,
            unsafe_for: 0,
        }
    }

    /// The acceleration of vehicle `me` for the next step.
    pub(super) fn accelerate(
        &mut self,
        scenario: &Scenario,
        states: &[State],
        me: usize,
        rng: &mut Pcg64,
    ) -> f32 {
        let contract = &scenario.setup.contract;
        let wanted = self.wanted(scenario, states, me, rng);
        let limit = (contract.other().max_speed - states[me].v) / STEP;
        let free = wanted
            .clamp(-contract.other().braking, contract.other().acceleration)
            .min(limit);
        if self.must_brake(scenario, states, me) {
            free.min(-contract.follower().braking)
        } else {
            free
        }
    }

    fn wanted(&mut self, scenario: &Scenario, states: &[State], me: usize, rng: &mut Pcg64) -> f32 {
        match self.manner {
            Manner::Rush => 20.0,
            Manner::Aimed => aim(scenario, states, me),
            Manner::Random | Manner::BangBang => {
                if self.left == 0 {
                    self.left = rng.random_range(1..30);
                    self.acceleration = match self.manner {
                        Manner::Random => rng.random_range(-8.0..3.0),
                        _ if self.acceleration > 0.0 => -20.0,
                        _ => 20.0,
                    };
                }
                self.left -= 1;
                self.acceleration
            }
        }
    }

    /// The duty of one who finds the ego ahead in the lane: after the reaction time it brakes.
    pub(super) fn must_brake(&mut self, scenario: &Scenario, states: &[State], me: usize) -> bool {
        let contract = &scenario.setup.contract;
        let (ego, mine) = (states[0], states[me]);
        let too_near = zones(scenario, me).filter(|z| z.is_lane()).any(|zone| {
            let lead = ego.s - mine.s;
            let ahead = ego.s >= zone.ego.from && lead >= zone.middle();
            let there = ahead && mine.s <= zone.other.to && ego.s <= zone.ego.to;
            there && lead - zone.lead.to < safe_gap(contract, mine.v, ego.v)
        });
        self.unsafe_for = if too_near { self.unsafe_for + 1 } else { 0 };
        // The gap became unsafe up to a step ago, and this command lasts for another.
        let free = contract.follower().reaction / STEP - 2.0;
        self.unsafe_for as f32 > free
    }
}

/// The zones of vehicle `me` with vehicle 0, as that one sees them.
fn zones(scenario: &Scenario, me: usize) -> impl Iterator<Item = &Zone> {
    let conflict = scenario.junction.conflict(path(0), path(me));
    conflict.into_iter().flat_map(RouteConflict::zones)
}

/// The acceleration that brings `me` into the middle of its zone when the ego is in the middle of its own.
fn aim(scenario: &Scenario, states: &[State], me: usize) -> f32 {
    let (ego, mine) = (states[0], states[me]);
    let next = zones(scenario, me).find(|z| mine.s < z.other.to && ego.s < z.ego.to);
    let Some(zone) = next else { return 0.0 };
    let depth = |from: f32, s: f32| (from.max(-100.0) + 3.5 - s).max(0.0);
    let time = (depth(zone.ego.from, ego.s) / ego.v.max(0.5)).clamp(STEP, 20.0);
    // s = v t + a t²/2, solved for a.
    2.0 * (depth(zone.other.from, mine.s) - mine.v * time) / (time * time)
}
