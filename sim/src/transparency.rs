//! How much of what good drivers do the shield would allow.

use crate::meeting::{path, recorded, sensed};
use cede_controller::kinematics::State;
use cede_controller::{
    ConflictKind, Contract, ContractError, Footprint, Observation, Shield, Track,
};
use cede_data::encounter::{Encounter, Participant, Role, Sample};
use rayon::prelude::*;

/// Recorded steps of one role in one kind of encounter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transparency {
    /// Whose steps.
    pub role: Role,
    /// How the two routes conflict.
    pub kind: ConflictKind,
    /// Steps at which both vehicles are there.
    pub steps: u64,
    /// Those whose recorded acceleration the shield accepts.
    pub accepted: u64,
}

impl Transparency {
    const fn none(role: Role, kind: ConflictKind) -> Self {
        Self {
            role,
            kind,
            steps: 0,
            accepted: 0,
        }
    }

    /// Accepted steps over all; NaN without steps.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.accepted as f64 / self.steps as f64
    }
}

/// The share of recorded steps that a shield under `contract` accepts, for each role and kind.
///
/// At every recorded step the ego is where it was, the other is, and the shield judges the acceleration
/// that was recorded (limited to what the contract's ego can do), while the one before it is still in
/// effect. Nothing is remembered from step to step and no precedence is assumed, so every step is
/// judged against the worst case. Footprints are the paper's. Encounters that are no junction
/// ([`crate::Meeting::new`]) are left out.
#[must_use]
pub fn transparency(encounters: &[&Encounter], contract: Contract) -> Vec<Transparency> {
    let mut tables = tables(encounters, &[contract]);
    tables.pop().unwrap_or_default()
}

/// What is accepted under one contract of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swept {
    /// Hardest acceleration of the other, in m/s².
    pub acceleration: f32,
    /// Braking of the ego, in m/s².
    pub braking: f32,
    /// Steps of one role in one kind of encounter.
    pub counted: Transparency,
}

/// [`transparency`] under contracts that differ from `contract` in the other's acceleration
/// (0.5 … 4 m/s²) and the ego's braking (3 … 8 m/s²).
///
/// A contract's ego accelerates and brakes no harder than the others: where the sweep asks for less of them, the ego's
/// acceleration is cut, and where the ego brakes harder, so do they. A recorded acceleration counts as the hardest one
/// that the ego may then command.
///
/// # Errors
/// If `contract` does not allow for one of them.
pub fn sweep(encounters: &[&Encounter], contract: Contract) -> Result<Vec<Swept>, ContractError> {
    let grid = (1..=8_u8).flat_map(|half| (3..=8_u8).map(move |braking| (half, braking)));
    let contracts: Vec<Contract> = grid
        .map(|(half, braking)| {
            let (acceleration, braking) = (0.5 * f32::from(half), f32::from(braking));
            let (ego, other) = (contract.ego(), contract.other());
            let numbers = contract
                .to_builder()
                .other_acceleration(acceleration)
                .ego_acceleration(ego.acceleration.min(acceleration))
                .ego_go(ego.go.min(acceleration))
                .ego_braking(braking)
                .other_braking(other.braking.max(braking));
            numbers.build()
        })
        .collect::<Result<_, _>>()?;
    let tables = tables(encounters, &contracts);
    let rows = contracts.iter().zip(tables).flat_map(|(contract, table)| {
        table.into_iter().map(|counted| Swept {
            acceleration: contract.other().acceleration,
            braking: contract.ego().braking,
            counted,
        })
    });
    Ok(rows.collect())
}

/// A table for each of `contracts`, without rows for what does not occur.
fn tables(encounters: &[&Encounter], contracts: &[Contract]) -> Vec<Vec<Transparency>> {
    let counted: Vec<Vec<Transparency>> = encounters
        .par_iter()
        .flat_map_iter(|encounter| Role::BOTH.map(|role| count(contracts, encounter, role)))
        .collect();
    (0..contracts.len())
        .map(|i| table(&counted.iter().filter_map(|counts| counts.get(i))))
        .collect()
}

fn table<'c>(counted: &(impl Iterator<Item = &'c Transparency> + Clone)) -> Vec<Transparency> {
    let kinds = [
        ConflictKind::Crossing,
        ConflictKind::Merging,
        ConflictKind::Following,
        ConflictKind::None,
    ];
    let groups = kinds
        .into_iter()
        .flat_map(|kind| Role::BOTH.map(|role| (role, kind)));
    let total = |(role, kind)| {
        let of = counted.clone().filter(|t| (t.role, t.kind) == (role, kind));
        of.fold(Transparency::none(role, kind), |sum, t| Transparency {
            steps: sum.steps + t.steps,
            accepted: sum.accepted + t.accepted,
            ..sum
        })
    };
    groups.map(total).filter(|t| t.steps > 0).collect()
}

/// What shields under each of `contracts` accept of one recorded drive; no steps, if the routes are no junction.
fn count(contracts: &[Contract], encounter: &Encounter, role: Role) -> Vec<Transparency> {
    let mut counts = vec![Transparency::none(role, encounter.kind); contracts.len()];
    let (mine, theirs) = (role as usize, 1 - role as usize);
    let Ok(junction) = recorded(encounter, |_| Footprint::PAPER) else {
        return counts;
    };
    let enter = |&contract| Shield::<1>::enter(contract, &junction, path(mine)).ok();
    let shields: Vec<_> = contracts.iter().map(enter).collect();
    let vehicle = |participant: &Participant, sample: &Sample| {
        let state = State {
            s: sample.s,
            v: sample.v,
        };
        sensed(&participant.route, state)
    };
    let (ego, other) = (
        &encounter.participants[mine],
        &encounter.participants[theirs],
    );
    let mut previous = None;
    for (a, b) in ego.record.iter().zip(&other.record) {
        let observation = Observation {
            ego: vehicle(ego, a),
            tracks: &[Track::on(theirs as u16, path(theirs), vehicle(other, b))],
        };
        for (shield, count) in shields.iter().zip(&mut counts) {
            let margin = shield
                .as_ref()
                .map(|shield| shield.margin(&observation, previous.unwrap_or(a.a), a.a));
            count.steps += 1;
            count.accepted += u64::from(matches!(margin, Some(Ok(margin)) if margin >= 0.0));
        }
        previous = Some(a.a);
    }
    counts
}
