//! Others just outside the contract are reported.

use super::{Context, Found};
use crate::case::{Case, Noise, Push};
use crate::hunt::hunt;
use crate::place::Road;
use crate::report::Verdict;
use crate::run::{Miss, drive, explain, junction};
use crate::strategies;
use cede_controller::Breach;
use cede_controller::dangerous::Rules;
use proptest::strategy::Strategy;

/// Calls within which the breach is to be reported.
const CALLS: u32 = 3;

/// Another that accelerates too hard is reported.
pub(super) fn breach_named<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    let subject = &context.subject;
    let contract = subject.contract;
    let other = contract.other();
    // What is gained in one period beyond what is allowed must exceed what errors may explain.
    let hidden = 2.0 * (2.0 * contract.speed_error() + 2.0 * contract.slack());
    let quarters = 5.0 + 4.0 * hidden / (other.acceleration * contract.period());
    if contract.precedence().is_some() {
        let why = "the contract has a rule of precedence: the others of its cases have shields, and break nothing";
        return Found::new(Verdict::Skipped(why.to_owned()), 0);
    }
    let gained = 0.25 * quarters * other.acceleration * contract.period() * (CALLS + 1) as f32;
    if quarters > 120.0 || gained > 0.5 * other.max_speed {
        let why =
            "speed_error and slack hide an acceleration as hard as that, within the speed limit";
        return Found::new(Verdict::Skipped(why.to_owned()), 0);
    }
    let cases = (strategies::case(&contract), strategies::script_outside());
    let strategy = cases.prop_map(move |(mut case, mut script)| {
        case.others.truncate(1);
        case.noise = Noise::NONE;
        if let (Some(first), Some(other)) = (script.first_mut(), case.others.first_mut()) {
            *first = Push {
                periods: first.periods,
                quarters: first.quarters.max(quarters as i8),
            };
            other.road = Road::First;
            other.speed = other.speed.min((contract.other().max_speed * 3.0) as u16);
            other.script = script;
        }
        case
    });
    let truth = subject.as_contracted();
    let test = |case: &Case| {
        let junction = junction(case, subject)?;
        let conflict = junction.conflict(Road::Own.path(), Road::First.path());
        let zone = conflict.and_then(|conflict| conflict.zones().next());
        let zone = zone.ok_or_else(|| Miss::skip("no zone"))?;
        let mut named = false;
        let mut matters = true;
        drive::<R>(subject, (case, &junction), &truth, |call| {
            let (ego, others) = (call.world.ego.state.s, &call.world.others);
            matters &= others
                .iter()
                .all(|other| other.state.s < f64::from(zone.other.to));
            matters &= ego < f64::from(zone.ego.to);
            // A follower may have to brake instead of breaking the contract.
            matters &= !crate::world::follower::is_ahead(
                zone,
                ego,
                others.first().map_or(0.0, |o| o.state.s),
            );
            named |= call.decision.breach == Some(Breach::Other(1));
            if !matters {
                return Err(Miss::skip("it has passed"));
            }
            if call.world.step < CALLS || named {
                return Ok(());
            }
            Err(Miss::broken(
                "other 1 breaks the contract, and nobody reports it",
            ))
        })
        .map(drop)
    };
    let caught = hunt((id, context.seed, context.cases), &strategy, test);
    context.found(caught, |case| explain::<R>(subject, case, &truth), |_| None)
}
