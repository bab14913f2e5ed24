//! The policy on its own.

use super::{Context, Found};
use crate::pilot::approach;
use crate::place::{Place, Right, Road, Shape, TestJunction};
use crate::report::{Failure, Verdict};
use cede_controller::{Observation, Policy, Track, Vehicle};

/// Less than this (m/s²) between the least and the most is no answer.
const SAME: f32 = 0.2;

/// The policy's proposals depend on what it sees.
pub(super) fn answers(context: &Context<'_>, _: &'static str) -> Found {
    let proposals = [Shape::RightAngle, Shape::LeftTurn].map(|shape| {
        let place = Place {
            shape,
            arm: 80,
            tolerance: 10,
            right: Right::Nobody,
        };
        let junction = place.junction(context.subject.vehicle.footprint).ok()?;
        proposals(context, &junction)
    });
    let all: Vec<f32> = proposals.into_iter().flatten().flatten().collect();
    let most = all.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let least = all.iter().copied().fold(f32::INFINITY, f32::min);
    let verdict = judge(least, most, context.subject.policy);
    let mut found = Found::new(verdict, all.len() as u32);
    found.numbers = vec![
        ("least proposal (m/s²)".to_owned(), least.into()),
        ("most proposal (m/s²)".to_owned(), most.into()),
    ];
    found
}

fn judge(least: f32, most: f32, policy: Policy<'_>) -> Verdict {
    let features = policy.weights().features().name();
    let set = format!("its file says that it is told the features `{features}`");
    let (message, mend) = if most < least {
        (
            "no encounter could be proposed to it".to_owned(),
            "check the vehicle's footprint".to_owned(),
        )
    } else if most - least < SAME {
        let message = format!("the policy proposes {least:.2} to {most:.2} m/s², whatever it sees");
        (
            message,
            format!("replace the policy file; check the training and the normalisation: {set}"),
        )
    } else if most < SAME {
        let message = format!("the policy never proposes to go: at most {most:.2} m/s²");
        (
            message,
            format!("replace the policy file, or check the sign of its output: {set}"),
        )
    } else if least > -SAME {
        let message = format!("the policy never proposes to brake: at least {least:.2} m/s²");
        (
            message,
            format!("replace the policy file, or check the sign of its output: {set}"),
        )
    } else {
        return Verdict::Passed;
    };
    Verdict::Failed(Failure {
        message,
        mend: Some(mend),
        case: None,
    })
}

/// What it proposes, for both at some distances and speeds.
fn proposals(context: &Context<'_>, junction: &TestJunction) -> Option<Vec<f32>> {
    let conflict = junction.conflict(Road::Own.path(), Road::First.path())?;
    let zone = conflict.zones().next()?;
    let speeds = [0.0, 3.0, 7.0, 11.0];
    let distances = [2.0, 8.0, 18.0, 35.0];
    let vehicle = |road: Road, s: f32, speed: f32| {
        Some(Vehicle {
            s,
            speed,
            pose: junction.polyline(road.path())?.pose(s),
        })
    };
    let mut proposals = Vec::new();
    for (own, its) in pairs(&distances, &distances) {
        for (speed, its_speed) in pairs(&speeds, &speeds) {
            let ego = vehicle(Road::Own, zone.ego.from - own, speed)?;
            let other = vehicle(Road::First, zone.other.from - its, its_speed)?;
            let tracks = [Track::on(1, Road::First.path(), other)];
            let subject = &context.subject;
            let mut approach = approach(subject.policy, subject.contract, junction).ok()?;
            proposals.push(approach.proposal(&Observation {
                ego,
                tracks: &tracks,
            }));
        }
    }
    Some(proposals)
}

fn pairs<'a>(a: &'a [f32], b: &'a [f32]) -> impl Iterator<Item = (f32, f32)> + 'a {
    a.iter().flat_map(|a| b.iter().map(|b| (*a, *b)))
}
