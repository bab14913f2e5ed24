//! What holds in a closed loop.

use super::{Context, Found};
use crate::case::Case;
use crate::run::{Call, Miss, Verdict, drive, explain, junction, overlap};
use crate::subject::Subject;
use crate::vehicle::{Bold, Truth, mend};
use cede_controller::dangerous::Rules;
use cede_controller::{Breach, Cause, Fault};

/// A speed (m/s) by which rounding may exceed a limit.
const ROUNDING: f64 = 2e-3;

/// No overlap, with the vehicle's own numbers.
pub(super) fn no_overlap<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    overlaps::<R>(context, id, &context.subject.measured())
}

/// No overlap, with the contract's numbers.
pub(super) fn no_overlap_contracted<R: Rules + Clone>(
    context: &Context<'_>,
    id: &'static str,
) -> Found {
    overlaps::<R>(context, id, &context.subject.as_contracted())
}

fn overlaps<R: Rules + Clone>(context: &Context<'_>, id: &'static str, truth: &Truth) -> Found {
    let subject = &context.subject;
    let test = |case: &Case| match overlap::<R>(subject, case, truth)? {
        None => Ok(()),
        Some(overlap) => Err(Miss::broken(overlap)),
    };
    let caught = context.hunted(id, test);
    let explain = |case: &Case| explain::<R>(subject, case, truth);
    context.found(caught, explain, |case| {
        Some(mend_of::<R>(subject, case, truth))
    })
}

/// Which number of the contract to change so that `case` has no overlap, tried in the closed loop.
fn mend_of<R: Rules + Clone>(subject: &Subject<'_>, case: &Case, truth: &Truth) -> String {
    let bold = subject.vehicle.bolder(&subject.contract);
    let works = |bold: &[Bold]| {
        let Ok(contract) = mend(&subject.contract, bold) else {
            return false;
        };
        let mended = Subject {
            contract,
            ..*subject
        };
        !matches!(overlap::<R>(&mended, case, truth), Ok(Some(_)))
    };
    if *truth == subject.as_contracted() || bold.is_empty() {
        return "no number of the contract explains it: the shield is wrong. Please report the case and the seed"
            .to_owned();
    }
    if let Some(one) = bold.iter().find(|one| works(std::slice::from_ref(one))) {
        return format!("{one}; with that, this case has no overlap");
    }
    let named: Vec<_> = bold.iter().map(Bold::to_string).collect();
    let all = named.join("; ");
    match works(&bold) {
        true => format!("{all}; with all of that, this case has no overlap"),
        false => format!("{all}; this case has an overlap even then, or the contract is refused"),
    }
}

/// Every call of a drive keeps `rule`.
fn always<R: Rules + Clone>(
    context: &Context<'_>,
    id: &'static str,
    truth: &Truth,
    rule: impl Fn(&Call<'_, '_, '_, R>) -> Verdict,
) -> Found {
    context.cases::<R>(id, truth, |case| {
        let junction = junction(case, &context.subject)?;
        drive::<R>(&context.subject, (case, &junction), truth, &rule).map(drop)
    })
}

/// Seconds since the first call, and what is wrong then.
fn at<R: Rules>(call: &Call<'_, '_, '_, R>, what: impl std::fmt::Display) -> Miss {
    Miss::Broken(format!("after {:.2} s: {what}", call.world.time()))
}

/// There is always a plan.
pub(super) fn plan<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    let truth = context.subject.as_contracted();
    always::<R>(context, id, &truth, |call| {
        let none =
            call.decision.plan.is_none() || call.decision.cause == Cause::Fallback(Fault::NoPlan);
        if none {
            Err(at(call, format_args!("no plan; {}", call.decision)))
        } else {
            Ok(())
        }
    })
}

/// Who keeps the contract is not reported.
pub(super) fn no_false_breach<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    let truth = context.subject.as_contracted();
    always::<R>(context, id, &truth, |call| match call.decision.breach {
        None => Ok(()),
        Some(breach) => Err(at(
            call,
            format_args!("{breach:?}, though everybody keeps the contract"),
        )),
    })
}

/// The vehicle as it was measured does what it is commanded.
pub(super) fn vehicle_keeps_contract<R: Rules + Clone>(
    context: &Context<'_>,
    id: &'static str,
) -> Found {
    let truth = context.subject.measured();
    let mut found = always::<R>(context, id, &truth, |call| match call.decision.breach {
        Some(Breach::Ego) => Err(at(call, "the ego deviated from its commands")),
        _ => Ok(()),
    });
    let bold = context.subject.vehicle.bolder(&context.subject.contract);
    if let crate::report::Verdict::Failed(failure) = &mut found.verdict
        && failure.mend.is_none()
    {
        let named: Vec<_> = bold.iter().map(Bold::to_string).collect();
        failure.mend = Some(named.join("; ")).filter(|mend| !mend.is_empty());
    }
    found
}

/// The speed limit is kept by whoever starts within it.
pub(super) fn speed_limit<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    let truth = context.subject.as_contracted();
    let limit = f64::from(context.subject.contract.ego().max_speed);
    always::<R>(context, id, &truth, |call| {
        let speed = call.world.ego.state.v;
        if call.seen.ego.s.is_nan() {
            // Without the ego's own state the shield carries on with its plan, at the least speed that it may have.
            return Err(Miss::skip("the ego's own state is missing"));
        }
        if speed <= limit + ROUNDING {
            return Ok(());
        }
        Err(at(
            call,
            format_args!("{speed:.3} m/s, and ego.max_speed = {limit}"),
        ))
    })
}
