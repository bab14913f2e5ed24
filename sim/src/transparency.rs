//! How much of what good drivers do the shield would allow.

use crate::encounter::{Encounter, Participant, Role, Sample};
use cede_controller::{
    ConflictKind, Contract, ContractError, Footprint, Observation, Path, Scene, Shield, Vehicle,
};
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
/// judged against the worst case. Footprints are [`Footprint::PAPER`]'s.
///
/// # Errors
/// If a number of `contract` is out of its range.
pub fn transparency(
    encounters: &[&Encounter],
    contract: Contract,
) -> Result<Vec<Transparency>, ContractError> {
    let shield = Shield::<1>::new(contract)?;
    let counted: Vec<Transparency> = encounters
        .par_iter()
        .flat_map_iter(|encounter| {
            [Role::Left, Role::Other].map(|role| count(&shield, encounter, role))
        })
        .collect();
    let kinds = [
        ConflictKind::Crossing,
        ConflictKind::Merging,
        ConflictKind::Following,
        ConflictKind::None,
    ];
    let groups = kinds
        .into_iter()
        .flat_map(|kind| [(Role::Left, kind), (Role::Other, kind)]);
    let total = |(role, kind)| {
        let of = counted.iter().filter(|t| (t.role, t.kind) == (role, kind));
        of.fold(
            Transparency {
                role,
                kind,
                steps: 0,
                accepted: 0,
            },
            |sum, t| Transparency {
                steps: sum.steps + t.steps,
                accepted: sum.accepted + t.accepted,
                ..sum
            },
        )
    };
    Ok(groups.map(total).filter(|t| t.steps > 0).collect())
}

/// The share that is accepted under one contract of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swept {
    /// Hardest acceleration of the other, in m/s².
    pub acceleration: f32,
    /// Braking of the ego, in m/s².
    pub braking: f32,
    /// Of which encounters.
    pub kind: ConflictKind,
    /// Steps at which both vehicles are there, of both roles.
    pub steps: u64,
    /// Those whose recorded acceleration the shield accepts.
    pub accepted: u64,
}

/// [`transparency`] under contracts that differ from `contract` in the other's acceleration
/// (0.5 … 4 m/s²) and the ego's braking (3 … 8 m/s²).
///
/// # Errors
/// If a number of `contract` is out of its range.
pub fn sweep(encounters: &[&Encounter], contract: Contract) -> Result<Vec<Swept>, ContractError> {
    let mut rows = Vec::new();
    for (half, braking) in (1..=8_u8).flat_map(|half| (3..=8_u8).map(move |b| (half, b))) {
        let mut contract = contract;
        contract.other.acceleration = 0.5 * f32::from(half);
        contract.ego.braking = f32::from(braking);
        let counted = transparency(encounters, contract)?;
        for kind in [ConflictKind::Crossing, ConflictKind::Merging] {
            let of = || counted.iter().filter(|row| row.kind == kind);
            rows.push(Swept {
                acceleration: contract.other.acceleration,
                braking: contract.ego.braking,
                kind,
                steps: of().map(|row| row.steps).sum(),
                accepted: of().map(|row| row.accepted).sum(),
            });
        }
    }
    Ok(rows)
}

fn count(shield: &Shield<1>, encounter: &Encounter, role: Role) -> Transparency {
    let mut result = Transparency {
        role,
        kind: encounter.kind,
        steps: 0,
        accepted: 0,
    };
    let (mine, theirs) = (role as usize, 1 - role as usize);
    let (Some(ego), Some(other)) = (
        encounter.participants.get(mine),
        encounter.participants.get(theirs),
    ) else {
        return result;
    };
    // One other with the paper's footprint: there is a scene.
    let Ok(scene) = Scene::<1>::new(path(ego), &[path(other)]) else {
        return result;
    };
    let vehicle = |participant: &Participant, sample: &Sample| Vehicle {
        s: sample.s,
        speed: sample.v,
        pose: participant.route.pose(sample.s),
    };
    let mut previous = None;
    for (a, b) in ego.record.iter().zip(&other.record) {
        let observation = Observation {
            ego: vehicle(ego, a),
            others: [Some(vehicle(other, b))],
        };
        let margin = shield.margin(&scene, &observation, previous.unwrap_or(a.a), a.a);
        result.steps += 1;
        if margin.is_ok_and(|margin| margin >= 0.0) {
            result.accepted += 1;
        }
        previous = Some(a.a);
    }
    result
}

fn path(participant: &Participant) -> Path<'_, 128> {
    Path {
        route: &participant.route,
        footprint: Footprint::PAPER,
    }
}
