//! The ego gets through.

use super::{Context, Found};
use crate::case::{Case, Noise, Other, Proposals, Push};
use crate::place::{Place, Right, Road, Shape};
use crate::report::{Failure, Verdict};
use crate::run::{Miss, explain, journey};
use crate::strategies;
use cede_controller::dangerous::Rules;
use cede_controller::{Contract, FREE};

/// Nobody else is there.
pub(super) fn alone<R: Rules + Clone>(context: &Context<'_>, _: &'static str) -> Found {
    let shapes = [
        Shape::RightAngle,
        Shape::LeftTurn,
        Shape::Merging(30),
        Shape::SBend,
    ];
    let mend = "check ego.go and ego.max_speed of the contract: with nobody there, the ego goes as they let it";
    let cases: Vec<_> = shapes.map(|shape| case(context, shape, Vec::new())).into();
    judged::<R>(context, &cases, mend)
}

/// Another is nearer and crosses first.
pub(super) fn after<R: Rules + Clone>(context: &Context<'_>, _: &'static str) -> Found {
    let contract = &context.subject.contract;
    let speed = (contract.other().max_speed * 5.0).min(80.0) as u16;
    let other = |before| Other {
        road: Road::First,
        before,
        speed,
        script: go_on(),
    };
    let cases: Vec<_> = [Shape::RightAngle, Shape::Skew(60), Shape::LeftTurn]
        .into_iter()
        .flat_map(|shape| [50, 150].map(|before| case(context, shape, vec![other(before)])))
        .collect();
    let mend = "the policy waits although the other has left: train it on encounters in which the other goes first";
    judged::<R>(context, &cases, mend)
}

/// Another waits for the ego: at its line if there is a rule of precedence, else far enough from it that no courtesy
/// need be assumed.
pub(super) fn courteous<R: Rules + Clone>(context: &Context<'_>, _: &'static str) -> Found {
    let contract = &context.subject.contract;
    let waits = |shape| match contract.precedence() {
        Some(rule) => {
            let before = i16::try_from((rule.distance * 10.0) as u16)
                .unwrap_or(i16::MAX)
                .saturating_add(500);
            Some(Other {
                road: Road::First,
                before,
                speed: 40,
                script: go_on(),
            })
        }
        None => {
            let metres = courtesy(context, shape)?;
            Some(Other {
                road: Road::First,
                before: (metres * 10.0) as i16,
                speed: 0,
                script: Vec::new(),
            })
        }
    };
    let shapes = [Shape::RightAngle, Shape::Skew(60), Shape::LeftTurn];
    let cases = shapes.map(|shape| waits(shape).map(|other| case(context, shape, vec![other])));
    let cases: Vec<_> = cases.into_iter().flatten().collect();
    if cases.is_empty() {
        let why = "under this contract nobody can wait so far from the zone, on 200 m of road, that the ego may go: \
                   at a crossing it goes only where nobody is. A rule of precedence in the contract changes that";
        return Found::new(Verdict::Skipped(why.to_owned()), 0);
    }
    let mend = "the policy does not take a gap that the shield would let it take: train it on more of these, or replace it";
    judged::<R>(context, &cases, mend)
}

/// It goes on at its speed, and accelerates after a stop.
fn go_on() -> Vec<Push> {
    vec![Push {
        periods: 255,
        quarters: 1,
    }]
}

/// How far (m) before its zone another at rest has to be, so that the ego can clear its own from rest at its line.
fn courtesy(context: &Context<'_>, shape: Shape) -> Option<f64> {
    let contract = &context.subject.contract;
    let (ego, other) = (contract.ego(), contract.other());
    let place = place(contract, shape);
    let junction = place.junction(context.subject.vehicle.footprint).ok()?;
    let zone = junction
        .conflict(Road::Own.path(), Road::First.path())?
        .zones()
        .next()?;
    let way = zone.ego.to - zone.ego.from + 4.0 * contract.position_error() + 2.0;
    let clears = time(way, ego.go, ego.max_speed * 0.8) + 3.0 * contract.period();
    // Twice the time: the ego need not go as hard as it can, nor start at its line.
    let metres = f64::from(reach(1.5 * clears, other.acceleration, other.max_speed)) + 5.0;
    (metres < f64::from(place.arm) - 20.0).then_some(metres)
}

/// Seconds for `way` metres from rest.
fn time(way: f32, acceleration: f32, most: f32) -> f32 {
    let ramp = most * most / (2.0 * acceleration);
    if way < ramp {
        (2.0 * way / acceleration).sqrt()
    } else {
        most / acceleration + (way - ramp) / most
    }
}

/// Metres in `time` seconds from rest.
fn reach(time: f32, acceleration: f32, most: f32) -> f32 {
    let ramp = (most / acceleration).min(time);
    0.5 * acceleration * ramp * ramp + most * (time - ramp)
}

fn place(contract: &Contract, shape: Shape) -> Place {
    let arm = strategies::arm(contract).max(200);
    Place {
        shape,
        arm,
        tolerance: 10,
        right: Right::Nobody,
    }
}

/// The ego 30 m before its line, at half its speed.
fn case(context: &Context<'_>, shape: Shape, others: Vec<Other>) -> Case {
    let contract = &context.subject.contract;
    let ego = contract.ego();
    let stop = ego.max_speed * ego.max_speed / (8.0 * ego.braking)
        + 2.0 * contract.period() * ego.max_speed;
    Case {
        place: place(contract, shape),
        before: (10.0 * stop.max(25.0)).min(1500.0) as u16,
        speed: (5.0 * ego.max_speed) as u16,
        others,
        proposals: Proposals::Policy,
        noise: Noise::NONE,
    }
}

/// The time (s) that a patient person allows.
fn allowed(contract: &Contract) -> f64 {
    let ego = contract.ego();
    let way = 120.0;
    f64::from(20.0 + 2.0 * time(way, ego.go.min(FREE), ego.max_speed))
}

fn judged<R: Rules + Clone>(context: &Context<'_>, cases: &[Case], mend: &str) -> Found {
    let subject = &context.subject;
    let duration = allowed(&subject.contract);
    let mut longest = 0.0_f64;
    let mut skipped = 0;
    for case in cases {
        let message = match journey::<R>(subject, case, duration) {
            Ok(Some(time)) => {
                longest = longest.max(time);
                continue;
            }
            Ok(None) => format!("the ego is not through after {duration:.0} s"),
            Err(Miss::Skip(_)) => {
                skipped += 1;
                continue;
            }
            Err(Miss::Broken(what)) => what,
        };
        let failure = Failure {
            message,
            mend: Some(mend.to_owned()),
            case: Some(explain::<R>(subject, case, &subject.as_contracted())),
        };
        return Found::new(Verdict::Failed(failure), cases.len() as u32);
    }
    let judged = cases.len() as u32 - skipped;
    let mut found = Found::new(Verdict::Passed, judged);
    if judged == 0 {
        found.verdict =
            Verdict::Skipped("no plan is safe at the start of any of its cases".to_owned());
    }
    found.skipped = skipped;
    found.numbers = vec![
        ("longest time (s)".to_owned(), longest),
        ("time allowed (s)".to_owned(), duration),
    ];
    found
}
