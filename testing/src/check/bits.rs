//! Any bits.

use super::{Context, Found};
use crate::hunt::hunt;
use crate::pilot::{Pilot, approach};
use crate::run::{Miss, Verdict};
use crate::strategies::{self, AnyCall, AnyCalls};
use crate::world::Seen;
use cede_controller::dangerous::Rules;
use cede_controller::{Contract, Decision, Fault, InputFault, Route, Subject, Vehicle};

/// Any bits are survived, and what is wrong with them is named.
pub(super) fn door<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    let subject = &context.subject;
    let test = |calls: &AnyCalls| {
        let footprint = subject.vehicle.footprint;
        let junction = calls.place.junction(footprint).map_err(Miss::skip)?;
        let (policy, contract) = (subject.policy, subject.contract);
        let mut pilot = Pilot::<R>::enter(policy, contract, &junction).map_err(Miss::skip)?;
        let mut flown = approach(policy, contract, &junction).map_err(Miss::skip)?;
        let mut last = None;
        for call in &calls.calls {
            let AnyCall {
                now,
                seen,
                proposal,
            } = call;
            let new = last.is_none_or(|last| *now > last);
            last = last.max(Some(*now));
            let _ = pilot.ready(&seen_at(call));
            let decisions = [
                pilot.decide(&seen_at(call), *proposal),
                flown.decide(*now, &seen.observation()),
            ];
            for decision in &decisions {
                admissible(&contract, decision)?;
                if new {
                    named(call, decision)?;
                }
            }
        }
        Ok(())
    };
    let caught = hunt(
        (id, context.seed, context.cases),
        &strategies::calls(),
        test,
    );
    context.found(caught, ToString::to_string, |_| None)
}

fn seen_at(call: &AnyCall) -> Seen {
    let AnyCall { now, seen, .. } = call;
    Seen {
        now: *now,
        ego: seen.ego,
        tracks: seen.tracks.clone(),
    }
}

/// A finite acceleration within the contract's, and a margin that is a number.
fn admissible(contract: &Contract, decision: &Decision) -> Verdict {
    let (ego, acceleration) = (contract.ego(), decision.acceleration);
    if !(-ego.braking..=ego.acceleration).contains(&acceleration) {
        return Err(Miss::Broken(format!(
            "{acceleration} m/s² is outside [-{}, {}]",
            ego.braking, ego.acceleration
        )));
    }
    if decision.margin.is_nan() {
        return Err(Miss::broken("the margin is no number"));
    }
    Ok(())
}

/// An ego or a proposal of which nothing can be believed is named.
fn named(call: &AnyCall, decision: &Decision) -> Verdict {
    let of_ego = matches!(
        decision.fault,
        Some(Fault::Input(InputFault {
            subject: Subject::Ego,
            ..
        }))
    );
    if unbelievable(&call.seen.ego) && !of_ego {
        return Err(Miss::Broken(format!(
            "the ego's state is impossible, and the fault is {:?}",
            decision.fault
        )));
    }
    let mut others = call.seen.tracks.iter();
    let odd = others.any(|track| {
        let vehicle = |s| Vehicle {
            s,
            speed: track.speed,
            pose: track.pose,
        };
        track
            .candidates()
            .any(|candidate| unbelievable(&vehicle(candidate.s)))
    });
    if odd && decision.fault.is_none() {
        return Err(Miss::broken(
            "a track's state is impossible, and no fault is named",
        ));
    }
    Ok(())
}

/// Whether a number is none, or outside every range of the interface.
fn unbelievable(vehicle: &Vehicle) -> bool {
    let Vehicle { s, speed, pose } = vehicle;
    let far = Route::<2>::MAX_COORDINATE;
    let within = |value: f32, low: f32, high: f32| low <= value && value <= high;
    let norm = pose.direction.x.hypot(pose.direction.y);
    !(within(*s, -600.0, 600.0)
        && within(*speed, -Vehicle::REVERSING, Vehicle::MAX_SPEED)
        && within(pose.position.x, -far, far)
        && within(pose.position.y, -far, far)
        && within(norm, 0.899, 1.101))
}
